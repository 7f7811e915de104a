// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "support/catch.hpp"
#include "unit/scene_spatial.hpp"
#include "unit/scene_spatial_worlds.hpp"

#include <trellis/scene/spatial/distance_field.hpp>
#include <trellis/scene/spatial/robot.hpp>
#include <trellis/scene/spatial/world.hpp>

using namespace trellis;
using namespace trellis::spatial_tests;

namespace {

constexpr double half = world_half;

/// The depth of p in the solid: the radius of the largest ball about p inside.
double depth_in(const Solid& solid, const Vec3& p) {
  return Robot3("body", {{solid.shape, {solid.pose.position - p, solid.pose.orientation}}}).inscribed_radius();
}

bool is_mesh(const Solid& solid) { return std::holds_alternative<std::shared_ptr<const Mesh>>(solid.shape); }

/// The same as ObstacleDistance, obstacle by obstacle and triangle by triangle.
double reference(const World3& world, const Vec3& p) {
  double least = inf;
  for (const Obstacle3& obstacle : world.obstacles()) {
    const Solid& solid = obstacle.solid;
    if (world.surface() && is_mesh(solid)) {
      const Mesh& mesh = *std::get<std::shared_ptr<const Mesh>>(solid.shape);
      least = std::min(least, distance_to_surface(mesh, solid.pose.inverse()(p)));
      continue;
    }
    const double outside = distance_to(solid, p);
    least = std::min(least, outside > 0.0 ? outside : -std::max(0.0, depth_in(solid, p)));
  }
  return least;
}

}  // namespace

TEST_CASE("distances from obstacles are those of each obstacle by itself") {
  Stream stream(1, "distance", "worlds");
  for (int round = 0; round < 30; ++round) {
    const World3 world = random_world(stream, 1 + static_cast<std::size_t>(round) % 7, round % 3 == 0);
    const auto distance = world.distances()->distance();
    for (int i = 0; i < 200; ++i) {
      const Vec3 p = random_point(stream, 1.5 * half);
      INFO(round << ": " << p.x << " " << p.y << " " << p.z);
      CHECK((*distance)(p) == Approx(reference(world, p)).margin(1e-9));
    }
  }
}

TEST_CASE("the nearest point of the obstacles lies on them, at the distance") {
  Stream stream(2, "distance", "nearest");
  for (int round = 0; round < 30; ++round) {
    const World3 world = random_world(stream, 1 + static_cast<std::size_t>(round) % 7, round % 3 == 0);
    const auto distance = world.distances()->distance();
    for (int i = 0; i < 100; ++i) {
      const Vec3 p = random_point(stream, half);
      const NearestObstacle found = distance->nearest(p);
      INFO(round << ": " << p.x << " " << p.y << " " << p.z);
      CHECK(found.distance == (*distance)(p));
      CHECK(norm(p - found.point) == Approx(std::abs(found.distance)).margin(1e-9));
      // The point lies in the obstacle, and no deeper than its surface.
      const Solid& solid = world.obstacles().at(found.obstacle).solid;
      CHECK(distance_to(solid, found.point) <= 1e-9);
      CHECK(depth_in(solid, found.point) <= 1e-9);
    }
  }
}

TEST_CASE("a tree of a mesh's triangles says what all triangles say") {
  Stream stream(3, "distance", "mesh");
  for (const Soup& soup :
       {torus(2, 0.7, 40, 24), nested(), open_box({-1, -2, -1}, {1, 2, 1}), box({0, 0, 0}, {1, 1, 1})}) {
    const MeshDistance mesh(shared(soup));
    for (int i = 0; i < 2000; ++i) {
      Vec3 p = random_point(stream, 3.0);
      // Level with vertices and edges, too.
      if (i % 4 == 0) p = {std::round(p.x), std::round(p.y), p.z};
      if (i % 4 == 1) p = {p.x, std::round(p.y), std::round(p.z)};
      CHECK(mesh.contains(p) == contains(mesh.mesh(), p));
      CHECK(mesh.to_surface(p) == Approx(distance_to_surface(mesh.mesh(), p)).margin(1e-12));
      CHECK(mesh.to_surface(p, 0.3) == Approx(std::min(0.3, distance_to_surface(mesh.mesh(), p))).margin(1e-12));
    }
  }
}

TEST_CASE("a distance field's bounds enclose the distance") {
  Stream stream(4, "distance", "bounds");
  for (int round = 0; round < 20; ++round) {
    const World3 world = random_world(stream, 1 + static_cast<std::size_t>(round) % 7, round % 3 == 0);
    const auto fields = world.distances();
    for (std::size_t level = 0; level < fields->size(); ++level) {
      const DistanceField& field = fields->level(level);
      for (int i = 0; i < 100; ++i) {
        // Also far from the field's region.
        const Vec3 p = random_point(stream, i % 10 == 0 ? 10.0 * half : half);
        const double truth = reference(world, p);
        const auto [lower, upper] = field.bounds(p);
        INFO(round << ", level " << level << ": " << p.x << " " << p.y << " " << p.z);
        CHECK(lower <= truth);
        CHECK(truth <= upper);
        CHECK(lower == field.lower_bound(p));
        CHECK(upper == field.upper_bound(p));
        const Vec3 from_centre = p - field.centre(field.nearest(p));
        CHECK(truth - lower <= 2.0 * norm(from_centre) + 1e-4);
      }
    }
  }
}

TEST_CASE("a distance field's voxels have the distances of their centres") {
  Stream stream(5, "distance", "voxels");
  const World3 world = random_world(stream, 5, false);
  const auto distance = world.distances()->distance();
  const DistanceField field(distance, {{-4, -3, -1}, {4, 3, 1}}, 0.25);
  CHECK(field.spacing() == 0.25);
  CHECK(field.counts() == std::array<std::size_t, 3>{33, 25, 9});
  CHECK(field.origin() == Vec3{-4, -3, -1});
  field.fill();
  for (std::size_t i = 0; i < field.size(); ++i) {
    const auto [x, y, z] = field.place(i);
    CHECK(field.index(x, y, z) == i);
    CHECK(field.centre(i) == field.centre(x, y, z));
    CHECK(field.nearest(field.centre(i)) == i);
    CHECK(field.value(i) == static_cast<float>((*distance)(field.centre(i))));
  }
  // No voxel is computed beyond the region: the nearest one counts.
  CHECK(field.nearest({-100, 0, 0}) == field.nearest({-4, 0, 0}));
  CHECK(field.nearest({100, 100, 100}) == field.size() - 1);
}

TEST_CASE("a distance field's region limits the number of voxels") {
  const World3 world(bounds, {{"", {Sphere{1}, {}}}});
  const DistanceField field(world.distances()->distance(), bounds, 1e-9);
  CHECK(field.size() <= DistanceField::most_voxels);
  CHECK(field.size() > DistanceField::most_voxels / 2);
  const DistanceField flat(world.distances()->distance(), {{0, 0, 0}, {1e6, 1e-6, 1e-6}}, 1e-30);
  CHECK(flat.size() <= DistanceField::most_voxels);
  CHECK(flat.lower_bound({5, 0, 0}) <= 4.0);
}

TEST_CASE("a world without obstacles is free everywhere") {
  const World3 world(bounds, {});
  const auto fields = world.distances();
  CHECK(fields->level(0).lower_bound({1, 2, 3}) > 1e38);
  CHECK(fields->level(0).upper_bound({100, 2, 3}) > 1e38);
  CHECK(fields->level(0).gradient({1, 2, 3}) == Vec3{});
}

TEST_CASE("copies of a world share its distance fields, and the levels double their spacing") {
  Stream stream(6, "distance", "levels");
  const World3 world = random_world(stream, 5, false);
  const World3 copy = world;
  CHECK(world.distances() == copy.distances());
  CHECK(world.distances() != world.with(world.obstacles()).distances());
  const auto fields = world.distances();
  REQUIRE(fields->size() > 3);
  for (std::size_t level = 1; level < fields->size(); ++level) {
    CHECK(fields->level(level).spacing() == Approx(2.0 * fields->level(level - 1).spacing()));
    CHECK(fields->level_of(1.001 * fields->level(level).spacing()) == level);
  }
  CHECK(fields->level_of(0.0) == 0);
  CHECK(fields->level_of(inf) == fields->size() - 1);
}

TEST_CASE("a distance field's gradient leads away from obstacles and out of them") {
  Stream stream(7, "distance", "gradient");
  for (int round = 0; round < 10; ++round) {
    const World3 world = random_world(stream, 3, round % 3 == 0);
    const auto fields = world.distances();
    const ObstacleDistance& distance = *fields->distance();
    for (int i = 0; i < 100; ++i) {
      const Vec3 p = random_point(stream, half);
      const double here = distance(p);
      const Vec3 along = fields->level(0).gradient(p);
      const double h = 1e-3 * std::abs(here);
      if (h < 1e-6) continue;
      // Towards the nearest point the distance shrinks by the length of the step.
      CHECK(norm(along) == Approx(1.0));
      CHECK(distance(p - h * along) == Approx(here - h).margin(1e-9));
    }
  }
}

TEST_CASE("threads share a distance field") {
  Stream stream(8, "distance", "threads");
  const World3 world = random_world(stream, 6, false);
  const World3 same = world.with(world.obstacles());
  std::vector<Vec3> points;
  for (int i = 0; i < 5000; ++i) points.push_back(random_point(stream, half));
  std::vector<std::vector<double>> found(4, std::vector<double>(points.size()));
  std::vector<std::thread> threads;
  for (std::size_t t = 0; t < found.size(); ++t) {
    threads.emplace_back([&, t] {
      const auto fields = world.distances();
      for (std::size_t i = 0; i < points.size(); ++i) found[t][i] = fields->level(1).lower_bound(points[i]);
    });
  }
  for (std::thread& thread : threads) thread.join();
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double alone = same.distances()->level(1).lower_bound(points[i]);
    for (const auto& of_thread : found) CHECK(of_thread[i] == alone);
  }
}
