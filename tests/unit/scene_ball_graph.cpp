// SPDX-License-Identifier: GPL-3.0-or-later
// The graph of maximal balls: its balls are free and maximal, its edges free, and it leads wherever there is room.
#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>
#include <vector>

#include <trellis/base/error.hpp>
#include <trellis/base/random.hpp>
#include <trellis/scene/spatial/ball_graph.hpp>
#include <trellis/scene/spatial/free_distance.hpp>

#include "support/catch.hpp"
#include "unit/scene_spatial.hpp"

using namespace trellis;

namespace {

Obstacle3 block(const Vec3& lo, const Vec3& hi) { return {"block", {Cuboid{hi - lo}, {0.5 * (lo + hi), {}}}}; }

World3 floating(std::uint64_t seed, int count) {
  Stream stream(seed, "0", "floating");
  std::vector<Obstacle3> blocks;
  for (int i = 0; i < count; ++i) {
    const Vec3 lo{stream.uniform(0.5, 8.0), stream.uniform(0.5, 8.0), stream.uniform(0.5, 8.0)};
    blocks.push_back(
        block(lo, lo + Vec3{stream.uniform(0.2, 1.5), stream.uniform(0.2, 1.5), stream.uniform(0.2, 1.5)}));
  }
  return {{{0, 0, 0}, {10, 10, 10}}, blocks};
}

/// Two rooms and a hole of 0.5 x 0.6 m between them.
World3 two_rooms(Contain contain = Contain::robot) {
  return {{{0, 0, 0}, {10, 6, 6}},
          {block({4.5, 0, 0}, {5.5, 6, 2}), block({4.5, 0, 2.6}, {5.5, 6, 6}), block({4.5, 0, 2}, {5.5, 3, 2.6}),
           block({4.5, 3.5, 2}, {5.5, 6, 2.6})},
          contain};
}

World3 torus_and_ball() {
  const auto torus = std::make_shared<const Mesh>(spatial_tests::torus(2.0, 0.6, 24, 12).mesh("torus"));
  return {{{-4, -4, -3}, {4, 4, 3}}, {{"torus", {torus, {}}}, {"ball", {Sphere{0.5}, {{2.8, 2.8, 1.5}, {}}}}}};
}

/// For each ball the number of its part of the graph.
std::vector<std::size_t> parts(const BallGraph& graph) {
  std::vector<std::size_t> of(graph.balls.size());
  std::iota(of.begin(), of.end(), std::size_t{0});
  const auto root = [&](std::size_t i) {
    while (of[i] != i) i = of[i];
    return i;
  };
  for (const auto& edge : graph.edges) of[root(edge.from)] = root(edge.to);
  for (std::size_t i = 0; i < of.size(); ++i) of[i] = root(i);
  return of;
}

bool connected(const BallGraph& graph) {
  const auto of = parts(graph);
  return std::all_of(of.begin(), of.end(), [&](std::size_t i) { return i == of.front(); });
}

}  // namespace

TEST_CASE("balls are as large as they can be, and edges are free", "[scene][ball_graph]") {
  const std::vector<World3> worlds = {floating(1, 12), two_rooms(), two_rooms(Contain::none), torus_and_ball()};
  for (const World3& world : worlds) {
    const BallGraph graph = ball_graph(world, 0.15);
    const FreeDistance distance(world);
    CAPTURE(graph.balls.size(), graph.edges.size());
    REQUIRE(graph.balls.size() > 3);
    Stream stream(2, "0", "directions");
    for (const auto& ball : graph.balls) {
      CHECK(ball.radius >= graph.resolution);
      CHECK(distance(ball.centre) == Approx(ball.radius).epsilon(1e-9));
      // A larger ball that contains it would touch where it does: away from there, nothing has more room.
      const auto touched = distance.nearest(ball.centre);
      const Vec3 away = (1.0 / ball.radius) * (ball.centre - touched.point);
      const double further = 0.02 * ball.radius;
      const Vec3 beyond = ball.centre + further * away;
      const Box3& box = world.bounds();
      const bool outside = beyond.x < box.lo.x || beyond.y < box.lo.y || beyond.z < box.lo.z || beyond.x > box.hi.x ||
                           beyond.y > box.hi.y || beyond.z > box.hi.z;
      if (!outside) CHECK(distance(beyond) < ball.radius + 0.99999 * further);
    }
    for (const auto& edge : graph.edges) {
      REQUIRE(edge.points.size() == edge.clearance.size());
      REQUIRE(edge.points.size() >= 2);
      CHECK(norm(edge.points.front() - graph.balls[edge.from].centre) < 1e-12);
      CHECK(norm(edge.points.back() - graph.balls[edge.to].centre) < 1e-12);
      double length = 0.0;
      for (std::size_t i = 0; i < edge.points.size(); ++i) {
        CHECK(edge.clearance[i] > 0.0);
        CHECK(distance(edge.points[i]) == Approx(edge.clearance[i]).epsilon(1e-9));
        if (i == 0) continue;
        length += norm(edge.points[i] - edge.points[i - 1]);
        for (const double t : {0.25, 0.5, 0.75}) {
          CHECK(distance(edge.points[i - 1] + t * (edge.points[i] - edge.points[i - 1])) > 0.0);
        }
      }
      CHECK(length == Approx(edge.length));
    }
  }
}

TEST_CASE("the balls of a world of floating boxes are connected", "[scene][ball_graph]") {
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    const BallGraph graph = ball_graph(floating(seed, 20));
    CAPTURE(seed, graph.balls.size(), graph.edges.size());
    CHECK(connected(graph));
  }
}

TEST_CASE("balls lead through a hole, with its clearance, and not through one thinner than a cell",
          "[scene][ball_graph]") {
  const BallGraph graph = ball_graph(two_rooms());
  CHECK(connected(graph));
  // The widest path: the least clearance of edges between x = 4 and x = 6 that cross the wall.
  double widest = 0.0;
  for (const auto& edge : graph.edges) {
    for (std::size_t i = 0; i < edge.points.size(); ++i) {
      if (std::abs(edge.points[i].x - 5.0) < 0.2) widest = std::max(widest, edge.clearance[i]);
    }
  }
  CHECK(widest == Approx(0.25).margin(0.01));
  CHECK_FALSE(connected(ball_graph(two_rooms(), 0.6)));
}

TEST_CASE("free points lie in balls, but for corners and what is thinner than a cell", "[scene][ball_graph]") {
  const World3 world = floating(4, 15);
  const BallGraph graph = ball_graph(world);
  const FreeDistance distance(world);
  Stream stream(5, "0", "points");
  int wide = 0, covered = 0;
  for (int i = 0; i < 20000; ++i) {
    const Vec3 p{stream.uniform(0, 10), stream.uniform(0, 10), stream.uniform(0, 10)};
    if (distance(p) < 2.0 * graph.resolution) continue;
    ++wide;
    for (const auto& ball : graph.balls) {
      if (norm(p - ball.centre) > ball.radius) continue;
      ++covered;
      break;
    }
  }
  CHECK(covered > 0.97 * wide);
}

TEST_CASE("a world without obstacles has no graph unless its bounds contain the robot, and one without room has none",
          "[scene][ball_graph]") {
  CHECK(ball_graph(World3({{0, 0, 0}, {1, 2, 3}}, {}, Contain::reference)).balls.empty());
  const BallGraph box = ball_graph(World3({{0, 0, 0}, {1, 2, 3}}, {}));
  CHECK(connected(box));
  const World3 full({{0, 0, 0}, {1, 1, 1}}, {block({-1, -1, -1}, {2, 2, 2})});
  CHECK_THROWS_AS(ball_graph(full), Error);
  // The same object for copies of a world.
  const World3 rooms = two_rooms();
  const World3 copy = rooms;
  CHECK(cached_ball_graph(rooms) == cached_ball_graph(copy));
}
