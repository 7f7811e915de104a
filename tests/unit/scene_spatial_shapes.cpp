// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "support/catch.hpp"
#include "unit/scene_spatial.hpp"

#include <trellis/scene/spatial/point_cloud.hpp>
#include <trellis/scene/spatial/robot.hpp>
#include <trellis/scene/spatial/shapes.hpp>
#include <trellis/scene/spatial/world.hpp>

using namespace trellis;
using namespace trellis::spatial_tests;
using Catch::Matchers::Contains;

namespace {

std::shared_ptr<const Mesh> shared(const Soup& soup) { return std::make_shared<const Mesh>(soup.mesh()); }

std::vector<Shape3> all_shapes() {
  const std::vector<Vec3> points = {{0.3, 0, 0}, {-0.4, 0.2, 0.5}, {0.1, 0.9, -0.3}};
  return {Sphere{0.7},
          Cuboid{{1, 2, 0.5}},
          Cylinder{0.4, 1.5},
          Capsule{0.3, 1.2},
          shared(box({-0.2, -1, 0}, {0.4, 0.5, 2})),
          std::make_shared<const PointCloud>(points, 0.5, "points")};
}

/// Whether a point of the shape's frame belongs to it.
struct Inside {
  Vec3 p;
  bool operator()(const Sphere& s) const { return norm(p) <= s.radius; }
  bool operator()(const Cuboid& s) const {
    return 2 * std::abs(p.x) <= s.size.x && 2 * std::abs(p.y) <= s.size.y && 2 * std::abs(p.z) <= s.size.z;
  }
  bool operator()(const Cylinder& s) const { return std::hypot(p.x, p.y) <= s.radius && 2 * std::abs(p.z) <= s.length; }
  bool operator()(const Capsule& s) const {
    const double z = std::clamp(p.z, -0.5 * s.length, 0.5 * s.length);
    return norm(p - Vec3{0, 0, z}) <= s.radius;
  }
  bool operator()(const std::shared_ptr<const Mesh>& mesh) const { return contains(*mesh, p); }
  bool operator()(const std::shared_ptr<const PointCloud>& cloud) const {
    return std::any_of(cloud->points().begin(), cloud->points().end(),
                       [&](const Vec3& centre) { return norm(p - centre) <= cloud->radius(); });
  }
};

bool inside(const Solid& solid, const Vec3& p) { return std::visit(Inside{solid.pose.inverse()(p)}, solid.shape); }

}  // namespace

TEST_CASE("bounding boxes and farthest points hold all of a solid, and are reached", "[scene][spatial]") {
  Stream stream(1, "0", "tests");
  for (const Shape3& shape : all_shapes()) {
    for (int round = 0; round < 8; ++round) {
      const Solid solid{shape, random_pose(stream, 1)};
      const Box3 bounds = bounding_box(solid);
      const double radius = farthest_from_origin(solid);
      Vec3 lo{inf, inf, inf}, hi{-inf, -inf, -inf};
      double farthest = 0.0;
      for (int i = 0; i < 40000; ++i) {
        const Vec3 p = random_point(stream, 3);
        if (!inside(solid, p)) continue;
        lo = {std::min(lo.x, p.x), std::min(lo.y, p.y), std::min(lo.z, p.z)};
        hi = {std::max(hi.x, p.x), std::max(hi.y, p.y), std::max(hi.z, p.z)};
        farthest = std::max(farthest, norm(p));
      }
      const Vec3 below = lo - bounds.lo, above = bounds.hi - hi;
      const double least = std::min({below.x, below.y, below.z, above.x, above.y, above.z, radius - farthest});
      const double most = std::max({below.x, below.y, below.z, above.x, above.y, above.z, radius - farthest});
      INFO("shape " << shape.index());
      REQUIRE(least > -1e-12);
      REQUIRE(most < 0.45);
    }
  }
}

TEST_CASE("bounds of solids along the axes are exact", "[scene][spatial]") {
  const Pose3 at{{1, 2, 3}, {}};
  CHECK(bounding_box({Cuboid{{2, 4, 6}}, at}) == Box3{{0, 0, 0}, {2, 4, 6}});
  CHECK(bounding_box({Cylinder{0.5, 2}, at}) == Box3{{0.5, 1.5, 2}, {1.5, 2.5, 4}});
  CHECK(bounding_box({Capsule{0.5, 2}, at}) == Box3{{0.5, 1.5, 1.5}, {1.5, 2.5, 4.5}});
  CHECK(farthest_from_origin({Cuboid{{2, 4, 4}}, {}}) == 3.0);
  CHECK(farthest_from_origin({Sphere{1}, {{0, 3, 4}, {}}}) == 6.0);
}

TEST_CASE("a scaled solid is the same about the origin", "[scene][spatial]") {
  Stream stream(4, "0", "tests");
  for (const Shape3& shape : all_shapes()) {
    const Solid solid{shape, random_pose(stream, 1)};
    const Solid half = scaled(solid, 0.5);
    for (int i = 0; i < 2000; ++i) {
      const Vec3 p = random_point(stream, 3);
      REQUIRE(inside(half, 0.5 * p) == inside(solid, p));
    }
  }
}

TEST_CASE("faults of solids name the solid and the number", "[scene][spatial]") {
  const auto fault = [](const Solid& solid, bool point = false) {
    return fault_of([&] { check_solid(solid, "obstacle 2", point); });
  };
  for (const Shape3& shape : all_shapes()) CHECK(fault({shape, {}}).empty());
  CHECK(fault({Sphere{0}, {}}, true).empty());
  CHECK_THAT(fault({Sphere{0}, {}}), Contains("obstacle 2: a sphere needs a radius greater than 0"));
  CHECK_THAT(fault({Sphere{-1}, {}}, true), Contains("a radius of at least 0"));
  CHECK_THAT(fault({Sphere{std::nan("")}, {}}), Contains("sphere"));
  CHECK_THAT(fault({Cuboid{{1, 0, 1}}, {}}), Contains("a box needs a length along y greater than 0"));
  CHECK_THAT(fault({Cuboid{{1, 1, inf}}, {}}), Contains("at most 1e+09 m, got inf"));
  CHECK_THAT(fault({Cylinder{1, 0}, {}}), Contains("a cylinder needs a length"));
  CHECK_THAT(fault({Capsule{0, 1}, {}}), Contains("a capsule needs a radius"));
  CHECK_THAT(fault({std::shared_ptr<const Mesh>(), {}}), Contains("it has no mesh"));
  CHECK_THAT(fault({Sphere{1}, {{0, std::nan(""), 0}, {}}}), Contains("its position must lie within"));
  CHECK_THAT(fault({Sphere{1}, {{}, {0, 0, 0, 2}}}), Contains("norm 1, got x y z w = (0, 0, 0, 2) of norm 2"));
  CHECK_THAT(fault({Sphere{1}, {{}, {0, 0, 0, 0}}}), Contains("norm 1"));
}

TEST_CASE("a world names its obstacles and validates them", "[scene][spatial]") {
  const World3 world({{0, 0, 0}, {1, 1, 1}}, {{"", {Sphere{1}, {}}}, {"maze.obj", {Sphere{2}, {}}}});
  CHECK(world.obstacles()[0].name == "obstacle 1");
  CHECK(world.obstacles()[1].name == "maze.obj");
  const std::vector<World3> copies(2, world);
  CHECK(copies.back().identity() == world.identity());
  CHECK(World3().identity() != world.identity());
  CHECK(world.contain() == Contain::robot);
  CHECK_THAT(fault_of([] { World3({{0, 0, 0}, {1, 1, 0}}, {}); }), Contains("zmin < zmax"));
  CHECK_THAT(fault_of([] { World3({{0, 0, -inf}, {1, 1, 1}}, {}); }), Contains("within 1e+09 m"));
  CHECK_THAT(fault_of([] {
               World3({{0, 0, 0}, {1, 1, 1}}, {{"", {Sphere{1}, {}}}, {"", {Sphere{0}, {}}}});
             }),
             Contains("obstacle 2: a sphere needs a radius"));
}

TEST_CASE("the largest ball about the reference point lies inside, and a larger one does not", "[scene][spatial]") {
  Stream stream(5, "0", "tests");
  std::size_t around = 0;
  for (const Shape3& shape : all_shapes()) {
    if (std::holds_alternative<std::shared_ptr<const PointCloud>>(shape)) continue;  // no robot's shape
    for (int round = 0; round < 30; ++round) {
      const Solid solid{shape, random_pose(stream, 0.4)};
      const Robot3 robot("body", {solid});
      const double radius = robot.inscribed_radius();
      if (!inside(solid, {})) {
        REQUIRE(radius == 0.0);
        continue;
      }
      ++around;
      bool larger_leaves = false;
      for (int i = 0; i < 4000; ++i) {
        const Vec3 v = random_point(stream, 1);
        const double length = norm(v);
        REQUIRE(inside(solid, (radius * (1 - 1e-9) / length) * v));
        larger_leaves = larger_leaves || !inside(solid, ((1.1 * radius + 0.02) / length) * v);
      }
      CHECK(larger_leaves);
    }
  }
  CHECK(around > 40);
}

TEST_CASE("a rigid body has poses, radii and a bound on its motion", "[scene][spatial]") {
  CHECK(Robot3::point().is_point());
  CHECK(Robot3::point().dimension() == 3);
  const auto mesh = shared(box({-0.1, -0.1, -1}, {0.1, 0.1, 1}));
  const Robot3 robot("bar", {{mesh, {{2, 0, 0}, {}}}, {mesh, {}}, {Sphere{0.2}, {{0, 0, 1}, {}}}});
  CHECK(robot.dimension() == 7);
  CHECK(robot.bounding_radius() == Approx(std::sqrt(2.1 * 2.1 + 0.01 + 1)));
  CHECK(robot.inscribed_radius() == Approx(0.1));
  const Robot3 half = robot.scaled(0.5);
  CHECK(half.bounding_radius() == Approx(0.5 * robot.bounding_radius()));
  CHECK(std::get<4>(half.solids()[0].shape) == std::get<4>(half.solids()[1].shape));
  CHECK_THAT(fault_of([&] { static_cast<void>(robot.scaled(-1)); }), Contains("greater than 0"));
  CHECK_THAT(fault_of([] { Robot3("none", {}); }), Contains("robot 'none': it needs at least one shape"));
  CHECK_THAT(fault_of([] {
               Robot3("r", {{Sphere{1}, {}}, {Sphere{-1}, {}}});
             }),
             Contains("robot 'r': shape 2: a sphere"));

  Stream stream(6, "0", "tests");
  for (int i = 0; i < 200; ++i) {
    const Pose3 a = random_pose(stream, 1), b = random_pose(stream, 1);
    const auto row = [](const Pose3& p) {
      const auto& q = p.orientation;
      return Configuration{p.position.x, p.position.y, p.position.z, q.x, q.y, q.z, q.w};
    };
    CHECK(robot.pose(row(a)) == a);
    const double bound = robot.displacement_bound(row(a), row(b));
    for (const Vec3& v : mesh->vertices()) {
      const Vec3 p = v + Vec3{2, 0, 0};
      // The length of the path, not only its ends.
      double length = 0.0;
      Vec3 last = a(p);
      for (int k = 1; k <= 20; ++k) {
        const double t = k / 20.0;
        const Pose3 at{a.position + t * (b.position - a.position), interpolated(a.orientation, b.orientation, t)};
        length += norm(at(p) - last);
        last = at(p);
      }
      REQUIRE(length <= bound + 1e-12);
    }
  }
}
