// SPDX-License-Identifier: GPL-3.0-or-later
// Lower bounds on the distance from an invalid configuration to valid ones.
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <optional>
#include <vector>

#include <trellis/collision/checker.hpp>
#include <trellis/collision/planar/distance.hpp>
#include <trellis/scene/planar/scene.hpp>
#include "collision_worlds.hpp"
#include "support/catch.hpp"

using namespace collision_test;

namespace {

constexpr double pi = std::numbers::pi;

/// A configuration at a distance from q, in an even direction of the metric; false where it leaves the space.
bool at_distance(Stream& stream, const Space& space, View q, double distance, Configuration& out) {
  std::vector<double> direction(q.size());
  double squares = 0.0;
  for (double& x : direction) {
    x = stream.normal();
    squares += x * x;
  }
  for (std::size_t j = 0; j < q.size(); ++j) {
    out[j] = q[j] + distance * direction[j] / std::sqrt(squares) / space.axes()[j].weight;
  }
  space.normalise(out);
  return space.contains(out);
}

/// The shapes' overlap along a direction.
double overlap(const ConvexShape& a, const ConvexShape& b, Vec2 direction) {
  const auto support = [](const ConvexShape& shape, Vec2 n) {
    if (const auto* disc = std::get_if<Disc>(&shape)) return dot(disc->centre, n) + disc->radius;
    double most = -std::numeric_limits<double>::infinity();
    for (const Vec2 v : std::get<Polygon>(shape).vertices) most = std::max(most, dot(v, n));
    return most;
  };
  return support(a, direction) + support(b, -1.0 * direction);
}

struct Bound {
  int invalid = 0;
  int positive = 0;
};

/// Tests the bound at random invalid configurations of a case.
Bound check_bound(const Case& c, const Space& space, std::uint64_t seed, int count) {
  const auto checker = make_planar_checker(c.scene, space, 0.05);
  Stream stream(seed, "", "invalid radius");
  Configuration q(space.dimension()), other(space.dimension());
  Bound bound;
  for (int i = 0; i < count; ++i) {
    space.sample_uniform(stream, q);
    const double radius = checker->invalid_radius(q);
    if (checker->valid(q)) {
      REQUIRE(radius == 0.0);
      continue;
    }
    ++bound.invalid;
    REQUIRE(radius >= 0.0);
    REQUIRE(radius <= space.diameter());
    if (radius <= 0.0) continue;
    ++bound.positive;
    for (int k = 0; k < 40; ++k) {
      // Most of them at the edge of the ball.
      const double share = k % 4 == 0 ? stream.uniform() : 1.0 - 1e-9;
      if (!at_distance(stream, space, q, share * radius, other)) continue;
      CAPTURE(c.name, radius, share);
      REQUIRE_FALSE(checker->valid(other));
    }
  }
  return bound;
}

}  // namespace

TEST_CASE("the penetration depth is the least overlap over all directions", "[collision]") {
  Stream stream(1, "", "depth");
  const auto shape = [&]() -> ConvexShape {
    const Vec2 at{stream.uniform(-1, 1), stream.uniform(-1, 1)};
    if (stream.uniform() < 0.3) return Disc{at, stream.uniform(0, 1)};
    // Corners on an ellipse are those of a convex polygon.
    const double a = stream.uniform(0.1, 1.5), b = stream.uniform(0.1, 1.5);
    const auto corners = static_cast<int>(3 + stream.below(5));
    Polygon polygon;
    for (int i = 0; i < corners; ++i) {
      const double angle = 2 * pi * (i + stream.uniform(0.0, 0.7)) / corners;
      polygon.vertices.push_back(at + Vec2{a * std::cos(angle), b * std::sin(angle)});
    }
    return polygon;
  };
  int overlapping = 0;
  for (int i = 0; i < 500; ++i) {
    const ConvexShape a = shape(), b = shape();
    double least = std::numeric_limits<double>::infinity();
    for (int k = 0; k < 7200; ++k) {
      const double angle = 2 * pi * k / 7200;
      least = std::min(least, overlap(a, b, {std::cos(angle), std::sin(angle)}));
    }
    const double depth = penetration_depth(a, b);
    CHECK(depth == penetration_depth(b, a));
    CHECK(depth == Approx(std::max(0.0, least)).margin(5e-3));
    CHECK((depth > 0.0) == (distance(a, b) == 0.0));
    overlapping += depth > 0.0 ? 1 : 0;
  }
  CHECK(overlapping > 100);
}

TEST_CASE("no configuration within the invalid radius is valid", "[collision]") {
  std::uint64_t seed = 0;
  for (const auto& cases : {paper_cases(), mixed_cases()}) {
    for (const Case& c : cases) {
      CAPTURE(c.name);
      const Bound bound = check_bound(c, c.space, ++seed, 1500);
      CHECK(bound.invalid > 50);
      CHECK(bound.positive > 9 * bound.invalid / 10);
    }
  }
}

TEST_CASE("the invalid radius is one of the metric, whatever its weights", "[collision]") {
  for (const double angle : {0.02, 1.0 / pi, 5.0}) {
    for (const Case& c : mixed_cases()) {
      std::vector<Axis> axes = c.space.axes();
      for (std::size_t j = 0; j < axes.size(); ++j) {
        const bool position = c.scene->translates() && j < 2;
        axes[j].weight = position ? (j == 0 ? 0.5 : 2.0) : angle;
      }
      CAPTURE(c.name, angle);
      const Bound bound = check_bound(c, Space("weighted", axes), 7, 400);
      CHECK(bound.positive > 9 * bound.invalid / 10);
    }
  }
}

TEST_CASE("the invalid radius of a disc far inside an obstacle is its depth", "[collision]") {
  const Case c =
      make_case("half-plane", World({{0, 0}, {100, 100}}, {box(0, 0, 100, 50)}), Robot::disc(0.5), {{Disc{{}, 0.5}}});
  const auto checker = make_planar_checker(c.scene, c.space, 0.05);
  Stream stream(2, "", "half-plane");
  double sum = 0.0;
  constexpr int count = 500;
  for (int i = 0; i < count; ++i) {
    const Configuration q{stream.uniform(40, 60), stream.uniform(30, 49)};
    const double truth = 50.5 - q[1];
    const double radius = checker->invalid_radius(q);
    REQUIRE(radius <= truth);
    sum += radius / truth;
  }
  CHECK(sum / count > 0.99);
}

TEST_CASE("a robot that turns is invalid about as far as its inscribed disc says, and outside of the world",
          "[collision]") {
  const Shape shape = Box2{{-0.3, -0.1}, {0.3, 0.1}};
  const Case c =
      make_case("half-plane", World({{0, 0}, {100, 100}}, {box(0, 0, 100, 50)}), Robot::rigid({shape}), {{shape}});
  const auto checker = make_planar_checker(c.scene, c.space, 0.05);
  for (const double theta : {0.0, 0.7, 1.5}) {
    // It is free at 50.1, where it lies flat.
    CHECK(checker->invalid_radius(Configuration{50, 45, theta}) > 5.05);
    CHECK(checker->invalid_radius(Configuration{50, 45, theta}) <= 5.1 + 0.5);
    CHECK(checker->invalid_radius(Configuration{50, 103, theta}) > 3.0);
  }
  CHECK(checker->invalid_radius(Configuration{50, 60, 0}) == 0.0);
  CHECK(checker->invalid_radius(Configuration{50, std::numeric_limits<double>::quiet_NaN(), 0}) == 0.0);
}

TEST_CASE("where no joint can free an arm the invalid radius is the diameter of its space", "[collision]") {
  // The first body does not move at all.
  Body foot;
  foot.parts = {Polygon{rectangle_vertices({{-1, -1}, {1, 1}})}};
  Body link;
  link.parts = {Polygon{rectangle_vertices({{0, -0.1}, {1, 0.1}})}};
  link.parent = 0;
  link.angle_axis = 0;
  const Robot arm("arm", {foot, link}, false, {5, 5});
  const auto scene = std::make_shared<const PlanarScene>(World({{0, 0}, {10, 10}}, {box(5.5, 5.5, 7, 7)}), arm);
  const Space space = default_space(arm, planar(*scene).world, 1.0 / pi);
  const auto checker = make_planar_checker(scene, space, 0.05);
  CHECK(checker->invalid_radius(Configuration{0.1}) == space.diameter());
}

TEST_CASE("where a position wraps around the checker gives no invalid radius", "[collision]") {
  const Shape shape = Disc{{}, 0.5};
  Case c = make_case("ring", World({{0, 0}, {10, 10}}, {box(0, 2, 3, 8)}), Robot::disc(0.5), {{shape}});
  std::vector<Axis> axes = c.space.axes();
  axes[0].periodic = true;
  const auto checker = make_planar_checker(c.scene, Space("ring", axes), 0.05);
  CHECK_FALSE(checker->valid(Configuration{1, 5}));
  CHECK(checker->invalid_radius(Configuration{1, 5}) == 0.0);
}

TEST_CASE("FCL's backend bounds no invalid radius", "[collision]") {
  const Case c = paper_cases().front();
  const auto checker = make_fcl_checker(c.scene, c.space, 0.05);
  CHECK_FALSE(checker->valid(Configuration{5, 1, 0}));
  CHECK(checker->invalid_radius(Configuration{5, 1, 0}) == 0.0);
}
