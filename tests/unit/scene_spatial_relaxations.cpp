// SPDX-License-Identifier: GPL-3.0-or-later
// Worlds of guiding spaces: eroded obstacles, and hulls of several.
#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include <trellis/base/error.hpp>
#include <trellis/base/random.hpp>
#include <trellis/scene/spatial/aggregate.hpp>
#include <trellis/scene/spatial/erosion.hpp>
#include <trellis/scene/spatial/scene.hpp>

#include "support/catch.hpp"
#include "unit/scene_spatial.hpp"

using namespace trellis;

namespace {

const Box3 bounds{{-10, -10, -10}, {10, 10, 10}};

Vec3 drawn(Stream& stream, double size) {
  return {stream.uniform(-size, size), stream.uniform(-size, size), stream.uniform(-size, size)};
}

std::shared_ptr<const Mesh> random_hull(Stream& stream, int points) {
  std::vector<Vec3> all;
  for (int i = 0; i < points; ++i) all.push_back(drawn(stream, 1.0));
  return std::make_shared<const Mesh>(Mesh::hull(all, "hull"));
}

std::vector<Solid> some_solids(Stream& stream) {
  const Pose3 pose{drawn(stream, 3.0), normalised(rotation_of(drawn(stream, 2.0)))};
  return {{Sphere{0.7}, pose},
          {Cuboid{{1.0, 1.4, 2.0}}, pose},
          {Cylinder{0.6, 1.5}, pose},
          {Capsule{0.5, 1.5}, pose},
          {random_hull(stream, 20), pose}};
}

/// The depth of a point inside a solid, by the distance from points outside of it in many directions.
bool within(const Solid& solid, const Vec3& p, double depth, Stream& stream) {
  constexpr int directions = 300;
  for (int i = 0; i < directions; ++i) {
    const Vec3 v = drawn(stream, 1.0);
    if (norm(v) > 1.0 || norm(v) == 0.0) continue;
    if (distance_to(solid, p + (depth / norm(v)) * v) > 0.0) return false;
  }
  return true;
}

}  // namespace

TEST_CASE("what is eroded lies within the obstacle, as deep as was asked", "[scene][spatial]") {
  Stream stream(1, "erosion", "test");
  constexpr double d = 0.12;
  for (int round = 0; round < 5; ++round) {
    for (const Solid& solid : some_solids(stream)) {
      const World3 world = eroded(World3(bounds, {{"thing", solid}}), d);
      REQUIRE(world.obstacles().size() == 1);
      CHECK(world.obstacles()[0].name == "thing eroded by 0.12");
      const Solid& rest = world.obstacles()[0].solid;
      const Box3 box = bounding_box(solid);
      int inside = 0;
      for (int i = 0; i < 400; ++i) {
        const Vec3 p{stream.uniform(box.lo.x, box.hi.x), stream.uniform(box.lo.y, box.hi.y),
                     stream.uniform(box.lo.z, box.hi.z)};
        if (distance_to(rest, p) == 0.0) {
          ++inside;
          CHECK(within(solid, p, 0.999 * d, stream));
        } else if (distance_to(solid, p) == 0.0 && std::holds_alternative<std::shared_ptr<const Mesh>>(solid.shape)) {
          // Nothing more is lost: a point deeper than d from all sides is still there.
          const auto& mesh = *std::get<std::shared_ptr<const Mesh>>(solid.shape);
          CHECK(distance_to_surface(mesh, solid.pose.inverse()(p)) <= d * (1 + 1e-9));
        }
      }
      CHECK(inside > 0);
    }
  }
}

TEST_CASE("what is not twice as thick vanishes, and a mesh that is not closed is refused by name", "[scene][spatial]") {
  Stream stream(2, "erosion", "test");
  for (const Solid& solid : some_solids(stream)) {
    CHECK(eroded(World3(bounds, {{"thing", solid}}), 1.5).obstacles().empty());
  }
  // 0.8 - 0.6 is more than 0.2 by a rounding error.
  CHECK(eroded(World3(bounds, {{"plate", {Cuboid{{0.8 - 0.6, 0.5, 0.5}}, {}}}}), 0.1).obstacles().empty());
  const auto sheet = std::make_shared<const Mesh>(std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}},
                                                  std::vector<Triangle>{{0, 1, 2}}, "sheet");
  CHECK_THROWS_WITH(eroded(World3(bounds, {{"the sheet", {sheet, {}}}}), 0.1),
                    Catch::Matchers::Contains("the sheet") && Catch::Matchers::Contains("not closed"));
}

TEST_CASE(
    "a closed mesh that is not convex is eroded on a grid: what is left is deep enough, and all that is deeper is",
    "[scene][spatial][slow]") {
  // A cube with a corner pushed in.
  const auto dent = std::make_shared<const Mesh>(
      std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {0.4, 0.4, 0.4}, {0, 1, 1}},
      std::vector<Triangle>{{3, 2, 1},
                            {3, 1, 0},
                            {4, 5, 6},
                            {4, 6, 7},
                            {0, 1, 5},
                            {0, 5, 4},
                            {1, 2, 6},
                            {1, 6, 5},
                            {2, 3, 7},
                            {2, 7, 6},
                            {3, 0, 4},
                            {3, 4, 7}},
      "dent");
  CHECK(dent->closed());
  CHECK_FALSE(dent->convex());
  const auto torus = std::make_shared<const Mesh>(spatial_tests::torus(1.0, 0.4, 24, 12).mesh("torus"));
  Stream stream(5, "erosion", "grid");
  for (const auto& mesh : {dent, torus}) {
    for (const double d : {0.05, 0.12}) {
      const World3 world = eroded(World3(bounds, {{"thing", {mesh, {}}}}), d);
      REQUIRE(world.obstacles().size() == 1);
      const auto& rest = *std::get<std::shared_ptr<const Mesh>>(world.obstacles()[0].solid.shape);
      CHECK(rest.closed());
      const Vec3 lo = mesh->bounds().lo, extent = mesh->bounds().hi - mesh->bounds().lo;
      const double cell = std::max(d / 6.0, std::cbrt(extent.x * extent.y * extent.z / 200'000.0));
      int left = 0, lost = 0;
      for (int i = 0; i < 2000; ++i) {
        const Vec3 p = lo + Vec3{extent.x * stream.uniform(), extent.y * stream.uniform(), extent.z * stream.uniform()};
        const double depth = contains(*mesh, p) ? distance_to_surface(*mesh, p) : 0.0;
        const bool there = contains(rest, p);
        left += there ? 1 : 0;
        lost += there ? 0 : 1;
        if (there) CHECK(depth >= d);
        if (depth > d + 2.0 * std::sqrt(3.0) * cell) CHECK(there);
      }
      CHECK(left > 20);
      CHECK(lost > 20);
    }
  }
  // It is thinner than 0.9 m everywhere.
  CHECK(eroded(World3(bounds, {{"thing", {torus, {}}}}), 0.45).obstacles().empty());
}

TEST_CASE("hulls of near obstacles contain them, and no point is farther than the error", "[scene][spatial]") {
  Stream stream(3, "aggregate", "test");
  for (int round = 0; round < 4; ++round) {
    std::vector<Obstacle3> obstacles;
    for (int i = 0; i < 3; ++i) {
      for (Solid& solid : some_solids(stream)) obstacles.push_back({"thing", std::move(solid)});
    }
    const World3 world(bounds, obstacles);
    for (const double error : {0.1, 0.5}) {
      const World3 coarse = aggregated(world, error);
      CHECK(coarse.obstacles().size() <= obstacles.size());
      for (int i = 0; i < 3000; ++i) {
        const Vec3 p = drawn(stream, 5.0);
        double fine = 1e9, hull = 1e9;
        for (const auto& obstacle : world.obstacles()) fine = std::min(fine, distance_to(obstacle.solid, p));
        for (const auto& obstacle : coarse.obstacles()) hull = std::min(hull, distance_to(obstacle.solid, p));
        if (fine == 0.0) CHECK(hull <= 1e-9);
        if (hull == 0.0) CHECK(fine <= 1.2 * error);
      }
    }
    CHECK(aggregated(world, 0.0).identity() == world.identity());
  }
}

TEST_CASE("a wall of boxes becomes one hull", "[scene][spatial]") {
  std::vector<Obstacle3> wall;
  for (int i = 0; i < 6; ++i) {
    wall.push_back({"brick " + std::to_string(i + 1), {Cuboid{{1, 1, 1}}, {{i + 0.5, 0.5, 0.5}, {}}}});
  }
  const World3 coarse = aggregated(World3(bounds, wall), 0.05);
  REQUIRE(coarse.obstacles().size() == 1);
  CHECK_THAT(coarse.obstacles()[0].name, Catch::Matchers::StartsWith("hull of 6 obstacles, brick "));
  CHECK(std::get<std::shared_ptr<const Mesh>>(coarse.obstacles()[0].solid.shape)->volume() == Approx(6.0));
}
