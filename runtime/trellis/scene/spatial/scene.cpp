// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/scene/spatial/scene.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include <trellis/base/error.hpp>
#include <trellis/scene/cache_by_world.hpp>
#include <trellis/scene/spatial/aggregate.hpp>
#include <trellis/scene/spatial/erosion.hpp>

namespace trellis {

double SpatialScene::magnitude() const {
  const auto& [lo, hi] = world.bounds();
  return std::max({std::abs(lo.x), std::abs(lo.y), std::abs(lo.z), std::abs(hi.x), std::abs(hi.y), std::abs(hi.z),
                   robot.bounding_radius()});
}

std::string SpatialScene::body_name(std::size_t body) const { return fmt::format("body {}", body + 1); }

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

Space SpatialScene::default_space(double weight) const {
  const auto& [lo, hi] = world.bounds();
  if (robot.rotates()) return Space::se3({{{lo.x, hi.x}, {lo.y, hi.y}, {lo.z, hi.z}}}, weight);
  return Space::euclidean({{lo.x, hi.x}, {lo.y, hi.y}, {lo.z, hi.z}});
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
  const auto all_of = [&](std::size_t count) {
    for (std::size_t column = 0; column < count; ++column) {
      if (!keeps(column)) return false;
    }
    return true;
  };
  if (all_of(robot.dimension())) return std::make_shared<SpatialScene>(world, robot);
  constexpr std::size_t position = 3;
  if (!all_of(position)) return nullptr;
  if (robot.is_point()) return of_point();
  const double radius = robot.inscribed_radius();
  if (!(radius > 0.0)) return nullptr;
  return std::make_shared<SpatialScene>(world, Robot3("ball", {Solid{Sphere{radius}, {}}}, false));
}

std::shared_ptr<const Scene> SpatialScene::eroded(double distance) const {
  static CacheByWorld<World3, double> cache;
  return std::make_shared<SpatialScene>(
      *cache.get(world, distance, [&](const World3& of) { return trellis::eroded(of, distance); }), robot);
}

std::shared_ptr<const Scene> SpatialScene::aggregated(double error) const {
  constexpr std::size_t most_errors = 20;  // each of a sequence of refinements
  static CacheByWorld<World3, double, most_errors> cache;
  return std::make_shared<SpatialScene>(
      *cache.get(world, error, [&](const World3& of) { return trellis::aggregated(of, error); }), robot);
}

const SpatialScene& spatial(const Scene& scene) {
  if (const SpatialScene* found = scene.spatial()) return *found;
  throw Fault("code for space received a planar scene");
}

}  // namespace trellis
