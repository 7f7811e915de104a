// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/scene/planar/scene.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include <trellis/base/error.hpp>
#include <trellis/scene/planar/aggregate.hpp>
#include <trellis/scene/planar/erosion.hpp>
#include <trellis/scene/planar/reduced_robot.hpp>
#include <trellis/scene/set_up_cache.hpp>

namespace trellis {

double PlanarScene::magnitude() const {
  const auto& [lo, hi] = world.bounds();
  return std::max({std::abs(lo.x), std::abs(lo.y), std::abs(hi.x), std::abs(hi.y), robot.bounding_radius()});
}

namespace {

/// The least distance between two parallel lines that enclose a convex shape.
double thickness(const ConvexShape& shape) {
  if (const auto* disc = std::get_if<Disc>(&shape)) return 2.0 * disc->radius;
  const auto& v = std::get<Polygon>(shape).vertices;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < v.size(); ++i) {
    const Vec2 edge = v[(i + 1) % v.size()] - v[i];
    double most = 0.0;
    for (const Vec2 p : v) most = std::max(most, cross(edge, p - v[i]) / norm(edge));
    least = std::min(least, most);
  }
  return least;
}

}  // namespace

std::optional<ThinnestObstacle> PlanarScene::thinnest_obstacle() const {
  std::optional<ThinnestObstacle> found;
  for (const World::Part& part : world.parts()) {
    const double thin = thickness(part.shape);
    if (!found || thin < found->thickness) found = {part.obstacle, thin};
  }
  return found;
}

std::vector<TeamMember> PlanarScene::members() const {
  std::vector<TeamMember> members;
  for (const Robot::Member& member : robot.members()) {
    std::vector<std::size_t> axes(member.robot->dimension());
    std::iota(axes.begin(), axes.end(), member.axis);
    members.push_back({member.number, std::move(axes), member.robot->translates()});
  }
  return members;
}

Space PlanarScene::default_space(double weight) const { return trellis::default_space(robot, world, weight); }

std::shared_ptr<const Scene> PlanarScene::shrunken(double scale) const {
  // An arm is thinned instead: a shorter arm would reach other places and collide where the arm does not.
  return std::make_shared<PlanarScene>(world, robot.shrunken(scale));
}

std::shared_ptr<const Scene> PlanarScene::with_obstacles(const std::vector<std::size_t>& kept) const {
  std::vector<Obstacle> obstacles;
  obstacles.reserve(kept.size());
  for (const std::size_t i : kept) obstacles.push_back(world.obstacles().at(i));
  return std::make_shared<PlanarScene>(World(world.bounds(), std::move(obstacles)), robot);
}

std::shared_ptr<const Scene> PlanarScene::of_point() const {
  return std::make_shared<PlanarScene>(world, Robot::point());
}

std::shared_ptr<const Scene> PlanarScene::reduced(const std::vector<std::size_t>& kept) const {
  auto part = reduced_robot(robot, kept);
  return part ? std::make_shared<PlanarScene>(world, std::move(*part)) : nullptr;
}

std::shared_ptr<const Scene> PlanarScene::eroded(double distance) const {
  static SetUpCache<World, double> cache;
  return std::make_shared<PlanarScene>(
      *cache.get(world, distance, [&](const World& of) { return trellis::eroded(of, distance); }), robot);
}

std::shared_ptr<const Scene> PlanarScene::aggregated(double error) const {
  constexpr std::size_t most_errors = 20;  // each of a sequence of refinements
  static SetUpCache<World, double, most_errors> cache;
  return std::make_shared<PlanarScene>(
      *cache.get(world, error, [&](const World& of) { return trellis::aggregated(of, error); }), robot);
}

const PlanarScene& planar(const Scene& scene) {
  if (const PlanarScene* found = scene.planar()) return *found;
  throw Fault("code for the plane received a scene of space");
}

std::shared_ptr<const PlanarScene> planar_scene(std::shared_ptr<const Scene> scene) {
  const PlanarScene& found = planar(*scene);
  return {std::move(scene), &found};
}

Space default_space(const Robot& robot, const World& world, double weight) {
  if (!robot.members().empty()) {
    std::vector<std::pair<double, Space>> factors;
    std::vector<std::string> names;
    for (const Robot::Member& member : robot.members()) {
      factors.emplace_back(1.0, default_space(*member.robot, world, weight));
      names.push_back(factors.back().second.name());
    }
    const bool same =
        std::all_of(names.begin(), names.end(), [&](const std::string& name) { return name == names[0]; });
    std::string name =
        same ? fmt::format("({})^{}", names[0], names.size()) : fmt::format("{}", fmt::join(names, " x "));
    return {std::move(name), Space::product(factors).axes()};
  }
  const auto& [lo, hi] = world.bounds();
  const std::pair x{lo.x, hi.x}, y{lo.y, hi.y};
  const std::size_t angles = robot.dimension() - (robot.translates() ? 2 : 0);
  if (robot.translates() && angles == 0) return Space::euclidean({x, y});
  const auto& limits = robot.limits();
  const bool full = std::none_of(limits.begin(), limits.end(), [](const auto& limit) { return limit.has_value(); });
  if (robot.translates() && angles == 1 && full) return Space::se2(x, y, weight);
  std::vector<std::pair<double, Space>> factors;
  if (robot.translates()) factors.emplace_back(1.0, Space::euclidean({x, y}));
  // Adjacent factors of one kind form a power: "R^2 x SO(2)^3".
  std::vector<std::pair<std::string, std::size_t>> names;
  for (std::size_t i = 0; i < angles; ++i) {
    const bool bounded = i < limits.size() && limits[i];
    if (bounded) {
      factors.emplace_back(1.0, Space("R", {{"theta", limits[i]->first, limits[i]->second, weight, false}}));
    } else {
      factors.emplace_back(1.0, Space::so2(weight));
    }
    const std::string& name = factors.back().second.name();
    if (names.empty() || names.back().first != name) names.emplace_back(name, 0);
    ++names.back().second;
  }
  std::string name = robot.translates() ? "R^2" : "";
  for (const auto& [factor, power] : names) {
    name += (name.empty() ? "" : " x ") + (power == 1 ? factor : fmt::format("{}^{}", factor, power));
  }
  return {std::move(name), Space::product(factors).axes()};
}

}  // namespace trellis
