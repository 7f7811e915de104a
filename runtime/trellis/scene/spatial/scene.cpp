// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/scene/spatial/scene.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <utility>

#include <trellis/base/error.hpp>
#include <trellis/scene/set_up_cache.hpp>
#include <trellis/scene/spatial/aggregate.hpp>
#include <trellis/scene/spatial/erosion.hpp>

namespace trellis {

double SpatialScene::magnitude() const {
  const auto& [lo, hi] = world.bounds();
  return std::max({std::abs(lo.x), std::abs(lo.y), std::abs(lo.z), std::abs(hi.x), std::abs(hi.y), std::abs(hi.z),
                   robot.bounding_radius()});
}

std::string SpatialScene::body_name(std::size_t body) const {
  if (!robot.members().empty()) return fmt::format("robot {}", robot.members().at(body).number);
  return fmt::format("body {}", body + 1);
}

std::vector<TeamMember> SpatialScene::members() const {
  std::vector<TeamMember> members;
  for (const Robot3::Member& member : robot.members()) {
    std::vector<std::size_t> axes(member.robot->dimension());
    std::iota(axes.begin(), axes.end(), member.column);
    members.push_back({member.number, std::move(axes), true});
  }
  return members;
}

namespace {

/// The least distance between two parallel planes that enclose a solid; of a mesh along its axes.
double thickness(const Solid& solid, bool surface) {
  const auto* mesh = std::get_if<std::shared_ptr<const Mesh>>(&solid.shape);
  if (mesh != nullptr && (surface || !(*mesh)->closed())) return 0.0;
  const Box3 box = bounding_box({solid.shape, {}});
  const Vec3 extent = box.hi - box.lo;
  return std::min({extent.x, extent.y, extent.z});
}

}  // namespace

std::optional<ThinnestObstacle> SpatialScene::thinnest_obstacle() const {
  std::optional<ThinnestObstacle> found;
  for (std::size_t i = 0; i < world.obstacles().size(); ++i) {
    // What the points of a cloud sample is thicker than their balls.
    if (std::holds_alternative<std::shared_ptr<const PointCloud>>(world.obstacles()[i].solid.shape)) continue;
    const double thin = thickness(world.obstacles()[i].solid, world.surface());
    if (!found || thin < found->thickness) found = {i, thin};
  }
  return found;
}

namespace {

/// \param weight  of a robot alone: metres of the metric per radian
template <class F>
Space space_of(const Robot3& robot, const Box3& bounds, const F& weight) {
  const auto& [lo, hi] = bounds;
  if (robot.members().empty()) {
    if (robot.rotates()) return Space::se3({{{lo.x, hi.x}, {lo.y, hi.y}, {lo.z, hi.z}}}, weight(robot));
    return Space::euclidean({{lo.x, hi.x}, {lo.y, hi.y}, {lo.z, hi.z}});
  }
  std::vector<std::pair<double, Space>> factors;
  std::vector<std::string> names;
  for (const Robot3::Member& member : robot.members()) {
    factors.emplace_back(1.0, space_of(*member.robot, bounds, weight));
    names.push_back(factors.back().second.name());
  }
  const bool same = std::all_of(names.begin(), names.end(), [&](const std::string& name) { return name == names[0]; });
  const Space product = Space::product(factors);
  std::vector<std::size_t> all(product.dimension());
  std::iota(all.begin(), all.end(), std::size_t{0});
  return product.part(
      all, same ? fmt::format("({})^{}", names[0], names.size()) : fmt::format("{}", fmt::join(names, " x ")));
}

}  // namespace

Space SpatialScene::default_space(double weight) const {
  return space_of(robot, world.bounds(), [&](const Robot3&) { return weight; });
}

Space SpatialScene::own_space() const {
  return space_of(robot, world.bounds(), [](const Robot3& one) { return one.bounding_radius(); });
}

std::shared_ptr<const Scene> SpatialScene::shrunken(double scale) const {
  return std::make_shared<SpatialScene>(world, robot.scaled(scale));
}

std::shared_ptr<const Scene> SpatialScene::with_obstacles(const std::vector<std::size_t>& kept) const {
  std::vector<Obstacle3> obstacles;
  obstacles.reserve(kept.size());
  for (const std::size_t i : kept) obstacles.push_back(world.obstacles().at(i));
  return std::make_shared<SpatialScene>(world.with(std::move(obstacles)), robot);
}

std::shared_ptr<const Scene> SpatialScene::of_point() const {
  return std::make_shared<SpatialScene>(world, Robot3::point());
}

std::shared_ptr<const Scene> SpatialScene::reduced(const std::vector<std::size_t>& kept) const {
  const auto keeps = [&](std::size_t column) { return std::find(kept.begin(), kept.end(), column) != kept.end(); };
  // What the coordinates of a robot alone determine that are kept; none: nothing.
  const auto part_of = [&](const Robot3& one, std::size_t first) -> std::optional<Robot3> {
    const auto all_of = [&](std::size_t count) {
      for (std::size_t column = first; column < first + count; ++column) {
        if (!keeps(column)) return false;
      }
      return true;
    };
    if (all_of(one.dimension())) return one;
    constexpr std::size_t position = 3;
    if (!all_of(position)) return std::nullopt;
    if (one.is_point()) return Robot3::point();
    const double radius = one.inscribed_radius();
    if (!(radius > 0.0)) return std::nullopt;
    return Robot3("ball", {Solid{Sphere{radius}, {}}}, false);
  };
  if (robot.members().empty()) {
    auto part = part_of(robot, 0);
    return part ? std::make_shared<SpatialScene>(world, std::move(*part)) : nullptr;
  }
  std::vector<Robot3::Member> left;
  for (const Robot3::Member& member : robot.members()) {
    auto part = part_of(*member.robot, member.column);
    if (!part) continue;
    const auto place = std::find(kept.begin(), kept.end(), member.column) - kept.begin();
    const bool whole = part->dimension() == member.robot->dimension();
    left.push_back({whole ? member.robot : std::make_shared<const Robot3>(std::move(*part)),
                    static_cast<std::size_t>(place), member.number});
  }
  if (left.empty()) return nullptr;
  return std::make_shared<SpatialScene>(world, Robot3::team_of(std::move(left)).uncoupled(robot.passing()));
}

std::shared_ptr<const Scene> SpatialScene::eroded(double distance) const {
  static SetUpCache<World3, double> cache;
  return std::make_shared<SpatialScene>(
      *cache.get(world, distance, [&](const World3& of) { return trellis::eroded(of, distance); }), robot);
}

std::shared_ptr<const Scene> SpatialScene::aggregated(double error) const {
  constexpr std::size_t most_errors = 20;  // each of a sequence of refinements
  static SetUpCache<World3, double, most_errors> cache;
  return std::make_shared<SpatialScene>(
      *cache.get(world, error, [&](const World3& of) { return trellis::aggregated(of, error); }), robot);
}

const SpatialScene& spatial(const Scene& scene) {
  if (const SpatialScene* found = scene.spatial()) return *found;
  throw Fault("code for space received a planar scene");
}

}  // namespace trellis
