// SPDX-License-Identifier: GPL-3.0-or-later
// Certificates of motions: what they say holds at all configurations, not only at those that a search checks.
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include <trellis/collision/checker.hpp>
#include <trellis/collision/planar/distance.hpp>
#include <trellis/collision/planar/segment.hpp>
#include <trellis/collision/planar/separation.hpp>
#include <trellis/collision/spatial/separation.hpp>
#include <trellis/scene/planar/scene.hpp>
#include <trellis/scene/spatial/scene.hpp>
#include "collision_worlds.hpp"
#include "support/catch.hpp"

using namespace collision_test;

namespace {

constexpr double resolution = 0.05;
constexpr double tolerance = certificate_share * resolution;

struct Counts {
  int certified = 0;
  int refuted = 0;
};

/// Compares certificates of random motions between valid configurations with many configurations on them.
Counts compare_with_configurations(const Case& c, const Checker& checker, std::uint64_t seed, int motions) {
  Stream stream(seed, c.name, "certificates");
  Configuration a(c.space.dimension()), b(c.space.dimension()), q(c.space.dimension());
  Counts counts;
  for (int i = 0; i < motions;) {
    random_motion(stream, c.space, a, b);
    if (!checker.valid(a) || !checker.valid(b)) continue;
    ++i;
    Certificate certificate{tolerance};
    checker.certify(a, b, certificate);
    CAPTURE(c.name, a, b, certificate.clearance, certificate.nearest);
    if (!certificate.valid()) {
      ++counts.refuted;
      c.space.interpolate(a, b, *certificate.refuted_at, q);
      REQUIRE(reference_clearance(c, q) <= 4.0 * tolerance);
      continue;
    }
    ++counts.certified;
    double least = std::numeric_limits<double>::infinity();
    constexpr int parts = 200;
    for (int k = 0; k <= parts; ++k) {
      c.space.interpolate(a, b, static_cast<double>(k) / parts, q);
      least = std::min(least, reference_clearance(c, q));
    }
    constexpr double rounding = 1e-9;
    REQUIRE(certificate.clearance > 0.0);
    REQUIRE(least >= certificate.clearance - rounding);
    const double between = planar(*c.scene).robot.displacement_bound(c.space, a, b) / parts;
    REQUIRE(certificate.clearance >= 0.9 * (least - between) - rounding);
  }
  return counts;
}

/// The shape with its points: the corners of a polygon, and points of its edges and of a disc's circle.
std::vector<Vec2> outline_points(const ConvexShape& shape, int each) {
  std::vector<Vec2> points;
  if (const auto* disc = std::get_if<Disc>(&shape)) {
    for (int k = 0; k < 8 * each; ++k) {
      const double angle = std::numbers::pi * k / (4.0 * each);
      points.push_back(disc->centre + disc->radius * Vec2{std::cos(angle), std::sin(angle)});
    }
    return points;
  }
  const auto& v = std::get<Polygon>(shape).vertices;
  for (std::size_t i = 0; i < v.size(); ++i) {
    for (int k = 0; k < each; ++k) {
      points.push_back(v[i] + static_cast<double>(k) / each * (v[(i + 1) % v.size()] - v[i]));
    }
  }
  return points;
}

std::vector<ConvexShape> convex_shapes() {
  std::vector<ConvexShape> shapes = {
      Disc{{0.2, -0.4}, 0.3}, Polygon{{{-0.4, -0.2}, {0.4, -0.2}, {0.4, 0.2}, {-0.4, 0.2}}},
      Polygon{{{0, 0}, {1, 0.001}, {0, 0.002}}}, Polygon{{{-0.5, 0}, {0, -0.2}, {0.4, 0.1}, {0.1, 0.4}}}};
  const World world = mixed_world();
  for (const auto& part : world.parts()) shapes.push_back(part.shape);
  return shapes;
}

}  // namespace

TEST_CASE("a certified motion is free at all configurations, with the clearance that it states",
          "[collision][certificate]") {
  auto cases = mixed_cases();
  for (Case& c : paper_cases()) cases.push_back(std::move(c));
  for (const Case& c : cases) {
    const auto checker = make_planar_checker(c.scene, c.space, resolution);
    const Counts counts = compare_with_configurations(c, *checker, 1, 150);
    CAPTURE(c.name);
    CHECK(counts.certified > 20);
  }
}

TEST_CASE("both planar backends give the same certificates", "[collision][certificate]") {
  for (const Case& c : mixed_cases()) {
    const auto checker = make_planar_checker(c.scene, c.space, resolution);
    const auto other = make_fcl_checker(c.scene, c.space, resolution);
    Stream stream(3, c.name, "certificates");
    Configuration a(c.space.dimension()), b(c.space.dimension());
    for (int i = 0; i < 100; ++i) {
      random_motion(stream, c.space, a, b);
      Certificate one{tolerance}, two{tolerance};
      checker->certify(a, b, one);
      other->certify(a, b, two);
      REQUIRE(one.refuted_at == two.refuted_at);
      REQUIRE(one.clearance == two.clearance);
    }
  }
}

TEST_CASE("a certificate refutes a motion through a wall that is thinner than the resolution",
          "[collision][certificate]") {
  for (const double wall : {0.1, 0.01, 1e-4, 1e-6}) {
    const Case c = make_case("bar", World({{0, 0}, {10, 10}}, {box(5, 0, 5 + wall, 9)}),
                             Robot::rigid({Box2{{-0.2, -0.001}, {0.2, 0.001}}}), {});
    const auto checker = make_planar_checker(c.scene, c.space, 3.0);
    const Configuration a = {4, 2, 1.5}, b = {6, 2, 1.4};
    CAPTURE(wall);
    REQUIRE(checker->motion(a, b).valid);  // sampled: the end alone
    Certificate certificate{certificate_share * 3.0};
    checker->certify(a, b, certificate);
    REQUIRE_FALSE(certificate.valid());
    Configuration q(3);
    c.space.interpolate(a, b, *certificate.refuted_at, q);
    REQUIRE_FALSE(checker->valid(q));
  }
}

TEST_CASE("a body that does not move may be close to contact", "[collision][certificate]") {
  // The first link rests a micrometre above the floor of an obstacle while the second one turns.
  Arm arm;
  arm.links = {1.0, 0.5};
  arm.widths = {0.1, 0.05};
  arm.base = {1, 1};
  const Case c = make_case("arm", World({{0, 0}, {4, 4}}, {box(1, 0.5, 2, 0.95 - 1e-6)}), Robot::arm(arm), {});
  const auto checker = make_planar_checker(c.scene, c.space, resolution);
  const Configuration a = {0, 0.3}, b = {0, 1.5};
  REQUIRE(checker->valid(a));
  Certificate certificate{tolerance};
  checker->certify(a, b, certificate);
  CHECK(certificate.valid());
  CHECK(certificate.clearance == Approx(1e-6).epsilon(0.11));
}

TEST_CASE("a motion without turns along a wall is certified at any distance", "[collision][certificate]") {
  for (const bool rotates : {false, true}) {
    const Case c = make_case("square", World({{0, 0}, {10, 10}}, {box(0, 0, 10, 1)}),
                             Robot::rigid({Box2{{-0.5, -0.5}, {0.5, 0.5}}}, rotates), {});
    const auto checker = make_planar_checker(c.scene, c.space, resolution);
    const double gap = 1e-9;
    Configuration a = {1, 1.5 + gap}, b = {9, 1.5 + gap};
    if (rotates) {
      a.push_back(0);
      b.push_back(0);
    }
    Certificate certificate{tolerance};
    checker->certify(a, b, certificate);
    CHECK(certificate.valid());
    CHECK(certificate.clearance == Approx(gap).epsilon(1e-3));
  }
}

TEST_CASE("a motion across the end of a period is certified on both sides of it", "[collision][certificate]") {
  // A ring of positions: x wraps, and a wall stands across it.
  const Space ring("ring", {{"x", 0, 10, 1, true}, {"y", 0, 10, 1, false}});
  const auto scene =
      std::make_shared<const PlanarScene>(World({{-1, -1}, {11, 11}}, {box(9.5, 0, 9.6, 4)}), Robot::point());
  const auto checker = make_planar_checker(scene, ring, 2.0);
  const auto certified = [&](const Configuration& a, const Configuration& b) {
    Certificate certificate{tolerance};
    checker->certify(a, b, certificate);
    CHECK(checker->motion(a, b).valid == certificate.valid());
    return certificate.valid();
  };
  CHECK_FALSE(certified({9, 2}, {1, 2}));
  CHECK_FALSE(certified({1, 2}, {9, 2}));
  CHECK(certified({9, 6}, {1, 6}));
  CHECK(certified({9.7, 2}, {1, 2}));
}

TEST_CASE("a point does not pass where obstacles touch", "[collision][certificate][point]") {
  const auto scene = std::make_shared<const PlanarScene>(
      World({{0, 0}, {4, 4}}, {box(0, 2, 2, 4), box(2, 0, 4, 2), {"", Disc{{1, 1}, 0.5}}, {"", Disc{{1, 2}, 0.5}}}),
      Robot::point());
  const Space space = default_space(planar(*scene).robot, planar(*scene).world, 1.0);
  for (const char* backend : {"planar", "fcl"}) {
    const auto checker = make_checker(backend, scene, space, 0.05);
    CAPTURE(backend);
    // Through the common corner, and through the point where two discs touch.
    for (const auto& [a, b] : {std::pair(Configuration{1.7, 1.7}, Configuration{2.33, 2.33}),
                               std::pair(Configuration{0.5, 1.5}, Configuration{1.53, 1.5})}) {
      const MotionReport report = checker->motion(a, b);
      CHECK_FALSE(report.valid);
      Configuration q(2);
      space.interpolate(a, b, report.invalid_at, q);
      CHECK_FALSE(checker->valid(q));
      Certificate certificate{tolerance};
      checker->certify(a, b, certificate);
      CHECK_FALSE(certificate.valid());
    }
  }
}

TEST_CASE("an inflated shape contains all points within the distance", "[collision][certificate]") {
  Stream stream(5, "", "inflated shapes");
  for (const ConvexShape& shape : convex_shapes()) {
    for (const double by : {1e-6, 0.01, 0.5}) {
      const ConvexShape larger = inflated(shape, by);
      for (const Vec2 p : outline_points(shape, 8)) {
        for (int k = 0; k < 16; ++k) {
          const double angle = stream.uniform(0.0, 2.0 * std::numbers::pi);
          const Vec2 q = p + by * (1.0 - 1e-9) * Vec2{std::cos(angle), std::sin(angle)};
          REQUIRE(distance(larger, ConvexShape(Disc{q, 0.0})) <= 1e-12);
        }
      }
      // And no point that is much farther.
      for (const Vec2 p : outline_points(larger, 8)) {
        REQUIRE(distance(shape, ConvexShape(Disc{p, 0.0})) <= std::numbers::sqrt2 * by * (1.0 + 1e-6));
      }
    }
  }
}

TEST_CASE("the swept area of a polygon is the union of its shapes on the motion", "[collision][certificate]") {
  Stream stream(6, "", "sweeps");
  for (const ConvexShape& shape : convex_shapes()) {
    const auto* polygon = std::get_if<Polygon>(&shape);
    if (polygon == nullptr) continue;
    for (int i = 0; i < 50; ++i) {
      const Vec2 along{stream.uniform(-2.0, 2.0), i % 5 == 0 ? 0.0 : stream.uniform(-2.0, 2.0)};
      const ConvexShape area = swept(*polygon, along);
      for (const Vec2 p : polygon->vertices) {
        REQUIRE(distance(area, ConvexShape(Disc{p + stream.uniform() * along, 0.0})) <= 1e-12);
      }
      // A point of the area is at a place of the polygon.
      for (const Vec2 p : outline_points(area, 2)) {
        REQUIRE(distance(Segment2{p, -1.0 * along}, shape) <= 1e-12);
      }
    }
  }
}

namespace {

Pose2 pose_at(Vec2 p, double angle) { return {p.x, p.y, std::cos(angle), std::sin(angle)}; }

}  // namespace

TEST_CASE("the gap at the middle of a motion is the distance, and the bound holds throughout",
          "[collision][certificate]") {
  Stream stream(8, "", "gaps");
  const auto shapes = convex_shapes();
  MovingConvex moving;
  Convex robot, obstacle;
  ConvexShape placed;
  for (const ConvexShape& shape : shapes) {
    write_convex(shape, robot);
    for (const ConvexShape& other : shapes) {
      write_convex(other, obstacle);
      for (int i = 0; i < 60; ++i) {
        const Vec2 middle{stream.uniform(-6.0, 12.0), stream.uniform(-6.0, 12.0)};
        const Vec2 half{stream.uniform(-1.0, 1.0), i % 3 == 0 ? 0.0 : stream.uniform(-1.0, 1.0)};
        // Right angles have parallel edges, with as much gap along either.
        const double angle =
            i % 4 == 0 ? 0.5 * std::numbers::pi * static_cast<double>(i % 16 / 4) : stream.uniform(-3.0, 3.0);
        const double turn = i % 5 == 0 ? 0.0 : stream.uniform(-1.5, 1.5);
        moving.set(robot, pose_at(middle, angle), half, turn);
        const MovingConvex::Gap gap = moving.gap(obstacle);
        move_shape(shape, pose_at(middle, angle), placed);
        CAPTURE(middle, half, angle, turn);
        REQUIRE(gap.middle == Approx(distance(placed, other)).margin(1e-12));
        REQUIRE(gap.throughout <= gap.middle + 1e-12);
        const Box2 box = moving.box();
        for (int k = -10; k <= 10; ++k) {
          const double t = 0.1 * k;
          move_shape(shape, pose_at(middle + t * half, angle + t * turn), placed);
          REQUIRE(gap.throughout <= distance(placed, other) + 1e-12);
          REQUIRE(margin_inside(bounding_box(placed), box) >= -1e-12);
        }
        // A short motion loses little.
        constexpr double part = 1e-4;
        moving.set(robot, pose_at(middle, angle), part * half, part * turn);
        REQUIRE(moving.gap(obstacle).throughout >= gap.middle - part * 30.0);
      }
    }
  }
}

TEST_CASE("a motion along an obstacle keeps its gap", "[collision][certificate]") {
  Convex bar, wall;
  write_convex(Box2{{-0.3, -0.1}, {0.3, 0.1}}, bar);
  write_convex(Box2{{-10, -1}, {10, 0}}, wall);
  MovingConvex moving;
  moving.set(bar, pose_at({0, 0.1 + 1e-3}, 0.0), {5, 0}, 0.0);
  CHECK(moving.gap(wall).throughout == Approx(1e-3).epsilon(1e-9));
}

TEST_CASE("a motion in space that stays close to contact is certified with a bound of its clearance",
          "[collision][certificate][space]") {
  const World3 world({{0, 0, 0}, {4, 4, 4}}, {{"plate", {Cuboid{{4, 4, 1}}, {{2, 2, 0.5}, {}}}}});
  const Robot3 bodies[] = {Robot3("ball", {{Sphere{0.2}, {}}}), Robot3("box", {{Cuboid{{0.4, 0.4, 0.4}}, {}}})};
  for (const Robot3& robot : bodies) {
    const auto scene = std::make_shared<const SpatialScene>(world, robot);
    const Space space = scene->default_space(1.0);
    const auto checker = make_checker("fcl", scene, space, resolution);
    for (const double gap : {1e-3, 1e-4, 1e-5}) {
      const double height = 1.2 + gap;
      const Configuration a = {1, 1, height, 0, 0, 0, 1}, b = {1.1, 1.05, height, 0, 0, 0, 1};
      Certificate certificate{tolerance};
      checker->certify(a, b, certificate);
      CAPTURE(robot.name(), gap, certificate.checks);
      REQUIRE(certificate.valid());
      CHECK(certificate.clearance <= gap);
      CHECK(certificate.clearance > 0.3 * gap);
      // Not divided down to the tolerance.
      CHECK(certificate.checks < 100000);
    }
  }
}

TEST_CASE("a motion in space along an obstacle, with a turn about its normal, is certified at any distance",
          "[collision][certificate][space]") {
  const Shape3 box = Cuboid{{0.4, 0.3, 0.4}};
  const auto mesh = [](const Vec3& half) {
    std::vector<Vec3> vertices;
    for (const double x : {-half.x, half.x}) {
      for (const double y : {-half.y, half.y}) {
        for (const double z : {-half.z, half.z}) vertices.push_back({x, y, z});
      }
    }
    return std::make_shared<const Mesh>(std::move(vertices),
                                        std::vector<Triangle>{{0, 1, 3},
                                                              {0, 3, 2},
                                                              {4, 6, 7},
                                                              {4, 7, 5},
                                                              {0, 4, 5},
                                                              {0, 5, 1},
                                                              {2, 3, 7},
                                                              {2, 7, 6},
                                                              {0, 2, 6},
                                                              {0, 6, 4},
                                                              {1, 5, 7},
                                                              {1, 7, 3}},
                                        "box");
  };
  const std::vector<std::pair<std::string, Robot3>> bodies = {
      {"ball", Robot3("ball", {{Sphere{0.2}, {}}})},
      {"box", Robot3("box", {{box, {}}})},
      {"capsule", Robot3("capsule", {{Capsule{0.2, 0.3}, {{}, rotation_of({0.5 * std::numbers::pi, 0, 0})}}})},
      {"cylinder", Robot3("cylinder", {{Cylinder{0.3, 0.4}, {}}})},
      {"mesh", Robot3("mesh", {{mesh({0.2, 0.15, 0.2}), {}}})}};
  const std::vector<World3> worlds = {
      World3({{0, 0, 0}, {4, 4, 4}}, {{"plate", {Cuboid{{4, 4, 1}}, {{2, 2, 0.5}, {}}}}}),
      World3({{0, 0, 0}, {4, 4, 4}}, {{"mesh", {mesh({2, 2, 0.5}), {{2, 2, 0.5}, {}}}}}),
      World3({{0, 0, 1}, {4, 4, 4}}, {})};
  for (const World3& world : worlds) {
    for (const auto& [name, robot] : bodies) {
      const auto scene = std::make_shared<const SpatialScene>(world, robot);
      const Space space = scene->default_space(1.0);
      for (const char* const backend : {"fcl", "fcl_plain"}) {
        const auto checker = make_checker(backend, scene, space, resolution);
        for (const double gap : {1e-3, 1e-5, 1e-6, 1e-7, 1e-9}) {
          const double height = 1.2 + gap;
          const Quaternion turned = rotation_of({0, 0, 1.0});
          const Configuration a = {1, 1, height, 0, 0, 0, 1}, b = {3, 2, height, 0, 0, turned.z, turned.w};
          Certificate certificate{tolerance};
          // As of a path: its points first.
          for (const View q : {View(a), View(b)}) checker->certify(q, q, certificate);
          checker->certify(a, b, certificate);
          CAPTURE(name, world.obstacles().size(), backend, gap, certificate.checks, certificate.clearance);
          REQUIRE(certificate.valid());
          CHECK(certificate.clearance <= gap * (1.0 + 1e-6));
          CHECK(certificate.clearance >= 0.5 * gap);
          CHECK(certificate.checks < 20000);
          // A motion into the obstacle is refuted.
          const Configuration low = {3, 2, 1.2 - 1e-3, 0, 0, turned.z, turned.w};
          Certificate refuted{tolerance};
          checker->certify(a, low, refuted);
          CHECK_FALSE(refuted.valid());
        }
      }
    }
  }
}

TEST_CASE("a bar that slides over the edge of another one is certified at any distance",
          "[collision][certificate][space]") {
  // Both are turned by an eighth about their length, so that two edges meet.
  constexpr double eighth = 0.25 * std::numbers::pi;
  const double reach = 0.1 * std::numbers::sqrt2;
  const World3 world({{-4, -4, -4}, {4, 4, 4}}, {{"bar", {Cuboid{{6, 0.2, 0.2}}, {{}, rotation_of({eighth, 0, 0})}}}});
  const Robot3 robot("bar", {{Cuboid{{0.2, 3, 0.2}}, {{}, rotation_of({0, eighth, 0})}}});
  const auto scene = std::make_shared<const SpatialScene>(world, robot);
  const auto checker = make_checker("fcl", scene, scene->default_space(1.0), resolution);
  for (const double gap : {1e-3, 1e-5, 1e-6, 1e-8}) {
    const double height = 2.0 * reach + gap;
    const Configuration a = {-1, 0, height, 0, 0, 0, 1}, b = {1, 0.5, height, 0, 0, 0, 1};
    Certificate certificate{tolerance};
    for (const View q : {View(a), View(b)}) checker->certify(q, q, certificate);
    checker->certify(a, b, certificate);
    CAPTURE(gap, certificate.checks, certificate.clearance);
    REQUIRE(certificate.valid());
    CHECK(certificate.clearance <= gap * (1.0 + 1e-6));
    CHECK(certificate.clearance >= 0.5 * gap);
    CHECK(certificate.checks < 20000);
  }
}

TEST_CASE("gaps along directions of separation in space are bounds throughout a motion",
          "[collision][certificate][space]") {
  Stream stream(11, "", "separation in space");
  const auto place = [&](double spread) {
    return Pose3{{stream.uniform(-spread, spread), stream.uniform(-spread, spread), stream.uniform(-spread, spread)},
                 rotation_of({stream.uniform(-3.0, 3.0), stream.uniform(-3.0, 3.0), stream.uniform(-3.0, 3.0)})};
  };
  const Shape3 shapes[] = {Sphere{0.3}, Cuboid{{0.6, 0.2, 0.05}}, Capsule{0.1, 0.5}, Cylinder{0.2, 0.4}};
  int separated = 0;
  for (const Shape3& shape : shapes) {
    for (const Shape3& other : shapes) {
      for (int i = 0; i < 300; ++i) {
        const Pose3 part = place(0.3);
        const Solid still{other, place(2.0)};
        const Pose3 middle{place(1.0).position, place(0.0).orientation};
        const Vec3 translation = i % 4 == 0 ? Vec3{} : place(0.5).position;
        const double turn = i % 5 == 0 ? 0.0 : stream.uniform(0.0, 1.5);
        const Vec3 arbitrary = place(1.0).position;
        const BodyMotion motion{middle.position, translation, 1.0 / norm(arbitrary) * arbitrary, turn};
        const SeparationGap gap = separation_gap({shape, middle * part}, motion, still);
        const Box3 bounds{{-2, -2, -2}, {2, 2, 2}};
        const SeparationGap inside = gap_inside({shape, middle * part}, motion, bounds);
        if (gap.throughout > 0.0) ++separated;
        for (int k = -8; k <= 8; ++k) {
          const double s = 0.125 * k;
          const Pose3 pose{middle.position + s * translation, rotation_of(s * turn * motion.axis) * middle.orientation};
          // Points of the solid: its centre, corners and ends, and some of the rims.
          const Pose3 at = pose * part;
          const Box3 box = bounding_box(Solid{shape, at});
          const Vec3 low = box.lo - bounds.lo, high = bounds.hi - box.hi;
          const double margin = std::min({low.x, low.y, low.z, high.x, high.y, high.z});
          CAPTURE(i, s, turn);
          REQUIRE(inside.throughout <= margin + 1e-12);
          if (s == 0.0) REQUIRE(inside.middle == Approx(margin).margin(1e-12));
          std::vector<Vec3> points = {at.position};
          double radius = 0.0;
          if (const auto* cuboid = std::get_if<Cuboid>(&shape)) {
            for (const double x : {-0.5, 0.5}) {
              for (const double y : {-0.5, 0.5}) {
                for (const double z : {-0.5, 0.5}) {
                  points.push_back(at({x * cuboid->size.x, y * cuboid->size.y, z * cuboid->size.z}));
                }
              }
            }
          } else if (const auto* capsule = std::get_if<Capsule>(&shape)) {
            radius = capsule->radius;
            for (const double z : {-0.5, 0.5}) points.push_back(at({0, 0, z * capsule->length}));
          } else if (const auto* cylinder = std::get_if<Cylinder>(&shape)) {
            for (int side = 0; side < 24; ++side) {
              const double angle = std::numbers::pi * side / 12.0;
              for (const double z : {-0.5, 0.5}) {
                points.push_back(
                    at({cylinder->radius * std::cos(angle), cylinder->radius * std::sin(angle), z * cylinder->length}));
              }
            }
          } else {
            radius = std::get<Sphere>(shape).radius;
          }
          for (const Vec3& point : points) REQUIRE(gap.throughout <= distance_to(still, point) - radius + 1e-12);
          if (s != 0.0) continue;
          for (const Vec3& point : points) REQUIRE(gap.middle <= distance_to(still, point) - radius + 1e-12);
        }
      }
    }
  }
  CHECK(separated > 500);
}

TEST_CASE("certificates of bodies in space hold at all configurations", "[collision][certificate][space]") {
  const World3 world({{0, 0, 0}, {4, 4, 4}},
                     {{"plate", {Cuboid{{0.02, 3, 4}}, {{2, 1.5, 2}, rotation_of({0, 0, 0.2})}}},
                      {"ball", {Sphere{0.4}, {{1, 3.2, 2}, {}}}},
                      {"column", {Cylinder{0.2, 3}, {{3, 3, 2}, {}}}},
                      {"pill", {Capsule{0.2, 1}, {{1, 1, 1}, rotation_of({0.5, 0, 0})}}}});
  const Robot3 bodies[] = {Robot3::point(), Robot3("bar", {{Cuboid{{0.8, 0.01, 0.01}}, {}}}),
                           Robot3("two balls", {{Sphere{0.1}, {{0.3, 0, 0}, {}}}, {Sphere{0.15}, {{-0.3, 0, 0}, {}}}})};
  for (const Robot3& robot : bodies) {
    const auto scene = std::make_shared<const SpatialScene>(world, robot);
    const Space space = scene->default_space(1.0);
    const auto checker = make_checker("fcl", scene, space, 0.5);
    const auto plain = make_checker("fcl_plain", scene, space, 0.5);
    Stream stream(7, robot.name(), "certificates");
    Configuration a(space.dimension()), b(space.dimension()), q(space.dimension());
    int certified = 0;
    int refuted = 0;
    for (int i = 0; i < 150;) {
      random_motion(stream, space, a, b);
      if (!checker->valid(a) || !checker->valid(b)) continue;
      ++i;
      Certificate certificate{certificate_share * 0.5};
      checker->certify(a, b, certificate);
      Certificate other{certificate_share * 0.5};
      plain->certify(a, b, other);
      CAPTURE(robot.name(), a, b);
      CHECK(certificate.valid() == other.valid());
      double least = std::numeric_limits<double>::infinity();
      constexpr int parts = 400;
      for (int k = 0; k <= parts; ++k) {
        space.interpolate(a, b, static_cast<double>(k) / parts, q);
        least = std::min(least, plain->clearance(q));
      }
      if (certificate.valid()) {
        ++certified;
        REQUIRE(least > 0.0);
        REQUIRE(certificate.clearance <= least * (1.0 + 1e-3));
        if (robot.is_point()) REQUIRE(checker->motion(a, b).valid);
      } else {
        ++refuted;
        space.interpolate(a, b, *certificate.refuted_at, q);
        REQUIRE(plain->clearance(q) <= 1e-4);
        if (robot.is_point()) REQUIRE_FALSE(checker->motion(a, b).valid);
      }
    }
    CAPTURE(robot.name());
    CHECK(certified > 10);
    CHECK(refuted > 0);
  }
}
