// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "support/catch.hpp"
#include "support/worlds.hpp"
#include "unit/scene_brute.hpp"

#include <trellis/scene/planar/scene.hpp>
#include <trellis/scene/planar/triangulation.hpp>

using namespace trellis;

namespace {

std::vector<World> worlds() {
  return {test::rectangle_world({}), test::rectangle_world(test::cup()), test::rectangle_world(test::trap()),
          planar(*test::point_problem(3).scene).world,
          // Obstacles that cross each other and the boundary.
          test::rectangle_world({{2, 4, 8, 6}, {4, 2, 6, 8}, {-1, -1, 1.5, 2.2}, {9, 3, 12, 4}})};
}

}  // namespace

TEST_CASE("triangles lie in the free space and know each other across whole sides", "[scene][triangulation]") {
  for (const World& world : worlds()) {
    for (const double size : {0.4, 1.0}) {
      CAPTURE(world.obstacles().size(), size);
      const Triangulation t(world, size);
      const auto& triangles = t.triangles();
      REQUIRE(triangles.size() > 20);
      double sum = 0.0;
      for (std::uint32_t i = 0; i < triangles.size(); ++i) {
        sum += triangles[i].area;
        CHECK(brute::is_free(world, triangles[i].centroid()));
        CHECK(t.find(triangles[i].centroid()) == i);
        for (std::size_t k = 0; k < 3; ++k) {
          const auto across = triangles[i].neighbours[k];
          if (!across) continue;
          const auto& back = triangles[*across].neighbours;
          CHECK(std::count(back.begin(), back.end(), std::optional<std::uint32_t>(i)) == 1);
          const auto& corners = triangles[*across].corners;
          for (const std::size_t c : {(k + 1) % 3, (k + 2) % 3}) {
            CHECK(std::count(corners.begin(), corners.end(), triangles[i].corners[c]) == 1);
          }
        }
      }
      CHECK(sum == Approx(t.area()));
    }
  }
}

TEST_CASE("the triangles cover the free space, but for what is left beside discs", "[scene][triangulation]") {
  for (const World& world : worlds()) {
    const Triangulation t(world, 0.5);
    Stream stream(1, "", "points");
    int covered = 0;
    int free = 0;
    for (int i = 0; i < 20000; ++i) {
      const Vec2 p{stream.uniform(0, 10), stream.uniform(0, 10)};
      const bool is_free = brute::is_free(world, p);
      const auto triangle = t.find(p);
      if (triangle) CHECK(is_free);
      free += is_free ? 1 : 0;
      covered += triangle ? 1 : 0;
    }
    CHECK(covered <= free);
    CHECK(covered >= 0.98 * free);
    CHECK(t.area() == Approx(100.0 * covered / 20000).epsilon(0.02));
  }
}

TEST_CASE("triangles are larger where obstacles are far", "[scene][triangulation]") {
  const World world({{0, 0}, {100, 100}}, {{"", Box2{{40, 40}, {41, 42}}}, {"", Disc{{70, 20}, 2}}});
  const double size = 0.5;
  const Triangulation t(world, size);
  const double equilateral = 0.25 * std::sqrt(3.0) * size * size;
  CHECK(static_cast<double>(t.triangles().size()) < 0.2 * t.area() / equilateral);
  double largest = 0.0;
  for (const auto& triangle : t.triangles()) {
    largest = std::max(largest, triangle.area);
    if (brute::clearance(world, triangle.centroid()) < 2.0 * size) CHECK(triangle.area < 4.0 * equilateral);
  }
  CHECK(largest > 20.0 * equilateral);
  CHECK(t.area() == Approx(100.0 * 100.0 - 2.0 - 4.0 * 3.14159).epsilon(1e-4));
}

TEST_CASE("points drawn from a triangle are uniform in it", "[scene][triangulation]") {
  const Triangulation t(test::rectangle_world(test::cup()), 1.0);
  Stream stream(2, "", "draws");
  const std::uint32_t some = 17;
  const Vec2 middle = t.triangles()[some].centroid();
  Vec2 mean;
  constexpr int draws = 20000;
  for (int i = 0; i < draws; ++i) {
    const Vec2 p = t.sample(some, stream);
    mean = mean + (1.0 / draws) * p;
  }
  CHECK(norm(mean - middle) < 0.01);
}

TEST_CASE("a triangulation is the same each time, and too fine a one is refused", "[scene][triangulation]") {
  const World world = planar(*test::point_problem(4).scene).world;
  const Triangulation a(world, 0.3);
  const Triangulation b(world, 0.3);
  REQUIRE(a.triangles().size() == b.triangles().size());
  for (std::size_t i = 0; i < a.triangles().size(); ++i) {
    CHECK(a.triangles()[i].corners == b.triangles()[i].corners);
    CHECK(a.triangles()[i].neighbours == b.triangles()[i].neighbours);
  }
  CHECK_THROWS_WITH(Triangulation(world, 1e-3),
                    Catch::Matchers::Contains("0.001 m") && Catch::Matchers::Contains("10 x 10"));
}

TEST_CASE("obstacles that reach far out of the world cost no more than what is inside", "[scene][triangulation]") {
  // Sides of a million metres, along an axis and across: segments of the triangles' size were 5 million.
  for (const double far : {20.0, 1e6}) {
    CAPTURE(far);
    const World world(Box2{{0, 0}, {10, 10}}, {{"wedge", Polygon{{{4, 4}, {4 + far, 4}, {4, 6}}}},
                                               {"spike", Polygon{{{1, 8}, {2, 8}, {1.5, 8 + far}}}}});
    const Triangulation t(world, 0.5);
    CHECK(t.triangles().size() < 2000);
    double free = 0.0;
    constexpr int side = 400;
    for (int i = 0; i < side; ++i) {
      for (int j = 0; j < side; ++j) {
        if (brute::is_free(world, {(i + 0.5) * 10 / side, (j + 0.5) * 10 / side})) ++free;
      }
    }
    CHECK(t.area() == Approx(100.0 * free / (side * side)).epsilon(0.01));
  }
}
