// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <limits>
#include <numbers>
#include <utility>

#include "support/catch.hpp"
#include "support/fault.hpp"
#include "unit/scene_brute.hpp"

#include <trellis/base/error.hpp>
#include <trellis/scene/planar/polygon.hpp>

using namespace trellis;

namespace {

const Polygon square{{{0, 0}, {1, 0}, {1, 1}, {0, 1}}};

std::string fault_of(const Polygon& polygon) {
  return test::fault_of([&] { validated_polygon(polygon, "obstacle 3"); });
}

bool convex(const Polygon& polygon) {
  const auto& v = polygon.vertices;
  for (std::size_t i = 0; i < v.size(); ++i) {
    const Vec2 a = v[i], b = v[(i + 1) % v.size()], c = v[(i + 2) % v.size()];
    if (cross(b - a, c - b) <= 0.0) return false;
  }
  return v.size() >= 3;
}

// The laws of a decomposition: convex parts, areas that add up, and no point covered wrongly.
void check_parts(const Polygon& polygon, Stream& stream) {
  const auto parts = convex_parts(polygon);
  double sum = 0.0;
  for (const auto& part : parts) {
    CHECK(convex(part));
    sum += brute::area(part);
  }
  CHECK(sum == Approx(brute::area(polygon)).epsilon(1e-12));
  const Box2 box = bounding_box(polygon);
  for (int i = 0; i < 500; ++i) {
    const Vec2 p{stream.uniform(box.lo.x, box.hi.x), stream.uniform(box.lo.y, box.hi.y)};
    const auto covered =
        std::count_if(parts.begin(), parts.end(), [&](const Polygon& part) { return brute::inside(part, p); });
    REQUIRE(covered == (brute::inside(polygon, p) ? 1 : 0));
  }
}

}  // namespace

TEST_CASE("a valid polygon comes back counter-clockwise", "[scene][polygon]") {
  CHECK(validated_polygon(square, "x") == square);
  Polygon clockwise = square;
  std::reverse(clockwise.vertices.begin(), clockwise.vertices.end());
  CHECK(validated_polygon(clockwise, "x") == square);
  const Polygon collinear{{{0, 0}, {0.5, 0}, {1, 0}, {1, 1}, {0, 1}}};
  CHECK(validated_polygon(collinear, "x") == collinear);
}

TEST_CASE("what is wrong with a polygon is named", "[scene][polygon]") {
  using Catch::Matchers::Contains;
  CHECK_THAT(fault_of({}), Contains("obstacle 3") && Contains("at least 3 vertices, got 0"));
  CHECK_THAT(fault_of({{{0, 0}, {1, 0}}}), Contains("at least 3 vertices, got 2"));
  CHECK_THAT(fault_of({{{0, 0}, {1, 1}, {1, 0}, {0, 1}}}),
             Contains("obstacle 3") &&
                 Contains("the edge from vertex 1 to vertex 2 meets the edge from vertex 3 to vertex 4"));
  CHECK_THAT(fault_of({{{0, 0}, {1, 0}, {1, 1}, {1, 0}}}), Contains("vertices 2 and 4 are the same point (1, 0)"));
  CHECK_THAT(fault_of({{{0, 0}, {1, 0}, {1, 1}, {0, 0}}}),
             Contains("vertices 1 and 4 are the same point") && Contains("by itself"));
  CHECK_THAT(fault_of({{{0, 0}, {1, 1}, {2, 2}}}), Contains("encloses no area"));
  CHECK_THAT(fault_of({{{0, 0}, {2, 0}, {2, 1}, {2, -1}}}), Contains("runs back over"));
  // A vertex that touches an edge from inside.
  CHECK_THAT(fault_of({{{0, 0}, {4, 0}, {4, 4}, {2, 0}, {0, 4}}}), Contains("meets"));
  const double nan = std::numeric_limits<double>::quiet_NaN();
  CHECK_THAT(fault_of({{{0, 0}, {1, nan}, {1, 1}}}), Contains("vertex 2 must lie within 1e+09 m of 0"));
  const double inf = std::numeric_limits<double>::infinity();
  CHECK_THAT(fault_of({{{0, 0}, {1, 0}, {inf, 1}}}), Contains("vertex 3 must lie within 1e+09 m of 0"));
}

TEST_CASE("a convex polygon is one part", "[scene][polygon]") {
  CHECK(convex_parts(square) == std::vector{square});
  // Vertices in the middle of an edge go.
  const auto parts = convex_parts({{{0, 0}, {0.5, 0}, {1, 0}, {1, 1}, {0.5, 1}, {0, 1}, {0, 0.25}}});
  CHECK(parts == std::vector{square});
}

TEST_CASE("convex parts cover a polygon exactly", "[scene][polygon]") {
  Stream stream(1, "0", "parts");
  SECTION("an L, with straight vertices") {
    check_parts({{{0, 0}, {1, 0}, {2, 0}, {2, 1}, {1.5, 1}, {1, 1}, {1, 2}, {0, 2}, {0, 1}}}, stream);
  }
  SECTION("a comb, whose teeth are in line") {
    check_parts({{{0, 0}, {7, 0}, {7, 2}, {6, 2}, {6, 1}, {5, 1}, {5, 2}, {4, 2}, {4, 1}, {3, 1}, {3, 2}, {0, 2}}},
                stream);
  }
  SECTION("random stars, few and many vertices") {
    for (const int vertices : {5, 8, 13, 20, 31, 33, 60, 150}) {
      for (int k = 0; k < 4; ++k) check_parts(brute::random_star(stream, {3, -2}, 0.2, 2.0, vertices), stream);
    }
  }
}

TEST_CASE("unions have the area that inclusion and exclusion gives", "[scene][polygon]") {
  SECTION("disjoint squares stay two") {
    const auto pieces = polygon_union({square, {{{2, 0}, {3, 0}, {3, 1}, {2, 1}}}});
    CHECK(pieces.size() == 2);
    CHECK(brute::area(pieces) == Approx(2.0));
  }
  SECTION("overlapping squares") {
    const auto pieces = polygon_union({square, {{{0.5, 0.5}, {1.5, 0.5}, {1.5, 1.5}, {0.5, 1.5}}}});
    REQUIRE(pieces.size() == 1);
    CHECK(pieces[0].outer.vertices.size() == 8);
    CHECK(brute::area(pieces) == Approx(1.75));
  }
  SECTION("squares that share an edge leave no seam") {
    const auto pieces = polygon_union({square, {{{1, 0}, {2, 0}, {2, 1}, {1, 1}}}});
    REQUIRE(pieces.size() == 1);
    CHECK(pieces[0].outer == Polygon{{{0, 0}, {2, 0}, {2, 1}, {0, 1}}});
  }
  SECTION("a ring of boxes has a hole, clockwise") {
    const auto box = [](double x0, double y0, double x1, double y1) {
      return Polygon{rectangle_vertices({{x0, y0}, {x1, y1}})};
    };
    const auto pieces = polygon_union({box(0, 0, 4, 1), box(0, 3, 4, 4), box(0, 0, 1, 4), box(3, 0, 4, 4)});
    REQUIRE(pieces.size() == 1);
    REQUIRE(pieces[0].holes.size() == 1);
    CHECK(brute::area(pieces[0].holes[0]) == Approx(-4.0));
    CHECK(brute::area(pieces) == Approx(12.0));
  }
  SECTION("random stars against membership, in any order") {
    Stream stream(2, "0", "union");
    std::vector<Polygon> stars;
    stars.reserve(12);
    for (int i = 0; i < 12; ++i) {
      stars.push_back(brute::random_star(stream, {stream.uniform(0, 6), stream.uniform(0, 6)}, 0.3, 1.5, 5 + i));
    }
    const auto pieces = polygon_union(stars);
    for (int i = 0; i < 5000; ++i) {
      const Vec2 p{stream.uniform(-2, 8), stream.uniform(-2, 8)};
      const bool any = std::any_of(stars.begin(), stars.end(), [&](const Polygon& s) { return brute::inside(s, p); });
      REQUIRE(brute::inside(pieces, p) == any);
    }
    std::reverse(stars.begin(), stars.end());
    const auto again = polygon_union(stars);
    REQUIRE(again.size() == pieces.size());
    for (std::size_t i = 0; i < pieces.size(); ++i) {
      CHECK(again[i].outer == pieces[i].outer);
      CHECK(again[i].holes == pieces[i].holes);
    }
  }
}

TEST_CASE("a dilated convex polygon has the area of Steiner's formula", "[scene][polygon]") {
  for (const double r : {0.01, 0.5, 3.0}) {
    for (const int n : {8, 32, 100}) {
      const double area = brute::area(polygon_offset(square, r, n));
      const double outer = r / std::cos(std::numbers::pi / n);
      CHECK(area >= 1.0 + 4.0 * r + std::numbers::pi * r * r);
      CHECK(area <= 1.0 + 4.0 * outer + std::numbers::pi * outer * outer);
    }
  }
  // With a multiple of four arc vertices a box grows by exactly the distance along the axes.
  const Box2 box = bounding_box(polygon_offset(square, 0.5)[0].outer);
  CHECK(box.lo.x == Approx(-0.5));
  CHECK(box.hi.y == Approx(1.5));
}

TEST_CASE("dilation closes a narrow mouth to a hole", "[scene][polygon]") {
  const Polygon c{
      {{0, 0}, {4, 0}, {4, 1.9}, {3, 1.9}, {3, 1}, {1, 1}, {1, 3}, {3, 3}, {3, 2.1}, {4, 2.1}, {4, 4}, {0, 4}}};
  const auto pieces = polygon_offset(c, 0.2);
  REQUIRE(pieces.size() == 1);
  CHECK(pieces[0].holes.size() == 1);
}

TEST_CASE("erosion shrinks, splits and swallows", "[scene][polygon]") {
  const auto smaller = polygon_offset(square, -0.1);
  REQUIRE(smaller.size() == 1);
  CHECK(brute::area(smaller) == Approx(0.64));
  CHECK(polygon_offset(square, -0.6).empty());
  // Two rooms with a door narrower than the disc.
  const Polygon dumbbell{
      {{0, 0}, {2, 0}, {2, 0.9}, {4, 0.9}, {4, 0}, {6, 0}, {6, 2}, {4, 2}, {4, 1.1}, {2, 1.1}, {2, 2}, {0, 2}}};
  const auto rooms = polygon_offset(dumbbell, -0.2);
  CHECK(rooms.size() == 2);
  // A little more than two squares: the disc may lean into the door.
  CHECK(brute::area(rooms) >= 2 * 1.6 * 1.6 - 1e-12);
  CHECK(brute::area(rooms) <= 2 * (1.6 * 1.6 + 0.2 * 0.03));
  // The points farther than the distance from the border are those that remain.
  Stream stream(3, "0", "erosion");
  const Polygon star = brute::random_star(stream, {0, 0}, 0.8, 2.0, 9);
  const auto eroded = polygon_offset(star, -0.3, 64);
  const double outer = 0.3 / std::cos(std::numbers::pi / 64);
  for (int i = 0; i < 3000; ++i) {
    const Vec2 p{stream.uniform(-2, 2), stream.uniform(-2, 2)};
    double depth = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < star.vertices.size(); ++k) {
      depth = std::min(depth, norm(p - brute::nearest_on_segment(p, star.vertices[k],
                                                                 star.vertices[(k + 1) % star.vertices.size()])));
    }
    if (!brute::inside(star, p)) depth = -depth;
    if (depth > outer) REQUIRE(brute::inside(eroded, p));
    if (depth < 0.3) REQUIRE_FALSE(brute::inside(eroded, p));
  }
}

TEST_CASE("an offset refuses what makes no sense", "[scene][polygon]") {
  CHECK_THROWS_AS(polygon_offset(square, std::numeric_limits<double>::infinity()), Error);
  CHECK_THROWS_AS(polygon_offset(square, 0.1, 2), Error);
  CHECK(polygon_offset(square, 0.0)[0].outer == square);
}
