// SPDX-License-Identifier: GPL-3.0-or-later
// Pictures of space: the order of what hides what, and whole figures.
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <string>
#include <vector>

#include <trellis/base/error.hpp>
#include <trellis/base/random.hpp>
#include <trellis/draw/depth_order.hpp>
#include <trellis/draw/spatial.hpp>
#include <trellis/draw/surface.hpp>

#include "draw_pictures.hpp"
#include "support/catch.hpp"
#include "support/golden.hpp"

using namespace trellis;
using namespace trellis::draw;

namespace {

Surface box(const Point3& lo, const Point3& hi) {
  Surface out;
  for (unsigned i = 0; i < 8; ++i) {
    out.vertices.push_back({(i & 1U) != 0 ? hi.x : lo.x, (i & 2U) != 0 ? hi.y : lo.y, (i & 4U) != 0 ? hi.z : lo.z});
  }
  out.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                   {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return out;
}

struct Draws {
  Stream stream{7, "draw_spatial", "test"};
  double operator()(double lo, double hi) { return lo + (hi - lo) * stream.uniform(); }
};

/// The depth of the polygon's plane where the ray to the camera through p meets it; none outside of the polygon.
double depth_at(const SpatialItem& face, const Point3& p, const Camera& camera) {
  const Point3 d = camera.direction();
  const Point3 r = camera.right();
  const Point3 u = camera.up();
  double sign = 0.0;
  const std::size_t count = face.points.size();
  for (std::size_t i = 0; i < count; ++i) {
    const Point3 a = face.points[i] - p;
    const Point3 b = face.points[(i + 1) % count] - p;
    const double turn = dot(r, a) * dot(u, b) - dot(u, a) * dot(r, b);
    if (sign == 0.0) sign = turn;
    if (turn * sign < 0.0) return -std::numeric_limits<double>::infinity();
  }
  const Point3 normal = cross(face.points[1] - face.points[0], face.points[2] - face.points[0]);
  return dot(d, p) + dot(normal, face.points[0] - p) / dot(normal, d);
}

}  // namespace

TEST_CASE("far to near: the last of the faces over a point is the nearest, also of faces that cross", "[draw]") {
  Draws draw;
  const Camera camera{20.0, 35.0};
  for (int scene = 0; scene < 20; ++scene) {
    std::vector<SpatialItem> items;
    for (std::uint32_t i = 0; i < 30; ++i) {
      const Point3 at{draw(0, 10), draw(0, 10), draw(0, 10)};
      SpatialItem face{.style = i};
      for (int k = 0; k < 3; ++k) {
        face.points.push_back(at + Point3{draw(-4, 4), draw(-4, 4), draw(-4, 4)});
        face.edges.push_back(true);
      }
      items.push_back(face);
    }
    const auto ordered = far_to_near(items, camera.direction(), 1e-9, 100000);
    for (int ray = 0; ray < 200; ++ray) {
      const Point3 p{draw(0, 10), draw(0, 10), draw(0, 10)};
      std::uint32_t nearest = 99;
      double depth = -1e9;
      for (const SpatialItem& item : items) {
        const double there = depth_at(item, p, camera);
        if (there > depth) {
          depth = there;
          nearest = item.style;
        }
      }
      std::uint32_t last = 99;
      for (const SpatialItem& item : ordered) {
        if (depth_at(item, p, camera) > -1e9) last = item.style;
      }
      CHECK(last == nearest);
    }
  }
}

TEST_CASE("far to near cuts lines where a face hides a part, and keeps edges that are no cuts", "[draw]") {
  const SpatialItem face{
      SpatialItem::Kind::face, {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}}, {true, true, true, true}, 1};
  const SpatialItem line{SpatialItem::Kind::line, {{0, 0, -1}, {0, 0, 1}}, {}, 2};
  const SpatialItem dot{SpatialItem::Kind::dot, {{0.5, 0, 0}}, {}, 3};
  const auto ordered = far_to_near({line, dot, face}, {0, 0, 1}, 1e-9, 100);
  REQUIRE(ordered.size() == 4);
  CHECK(ordered[0].style == 2);
  CHECK(ordered[0].points[1].z == Approx(0.0));
  CHECK(ordered[1].style == 1);
  CHECK(ordered[2].style == 3);  // in the plane: on the face
  CHECK(ordered[3].points[0].z == Approx(0.0));
  // A second face across the first: its halves have three drawn edges each.
  const SpatialItem across{
      SpatialItem::Kind::face, {{0, -1, -1}, {0, 1, -1}, {0, 1, 1}, {0, -1, 1}}, {true, true, true, true}, 4};
  for (const SpatialItem& item : far_to_near({face, across}, {0.1, 0, 1}, 1e-9, 100)) {
    if (item.points.size() == 4 && item.style == 1) continue;
    CHECK(std::count(item.edges.begin(), item.edges.end(), true) == 3);
  }
  // Nothing is cut beyond the limit.
  CHECK(far_to_near({line, dot, face}, {0, 0, 1}, 1e-9, 2).size() == 3);
}

TEST_CASE("clustering merges vertices, and drops triangles without area", "[draw]") {
  const Surface whole = box({0.1, 0.1, 0.1}, {0.9, 0.9, 0.9});
  CHECK(clustered(whole, 0.05).triangles.size() == 12);
  CHECK(clustered(whole, 1.0).triangles.empty());
  CHECK(clustered(whole, 1.0).vertices.size() == 1);
  CHECK(feature_edges(whole).size() == 12);  // no diagonals
}

TEST_CASE("what closes the view is before a side that faces the camera", "[draw]") {
  const Camera camera;  // from +x, -y and above
  const Point3 lo{0, 0, 0};
  const Point3 hi{10, 10, 2};
  CHECK(closes_view(box({0, 0, 2}, {10, 10, 2.1}), lo, hi, camera));
  CHECK_FALSE(closes_view(box({0, 0, -0.1}, {10, 10, 0}), lo, hi, camera));
  CHECK(closes_view(box({-0.5, -0.5, 0}, {10, 0, 2}), lo, hi, camera));
  CHECK_FALSE(closes_view(box({0, 10, 0}, {10, 10.5, 2}), lo, hi, camera));
  CHECK_FALSE(closes_view(box({4, 4, 0}, {6, 6, 2}), lo, hi, camera));
  CHECK_FALSE(closes_view(box({0, 0, 1.9}, {3, 3, 2}), lo, hi, camera));
}

TEST_CASE("a grid of space counts samples in its cells", "[draw]") {
  const Grid3 grid({0, 0, 0}, {2, 3, 1}, 1.0);
  CHECK(grid.size() == 6);
  std::vector<double> counts(6, 0.0);
  CHECK(grid.count({1.5, 2.5, 0.5}, 2.0, counts));
  CHECK_FALSE(grid.count({2.5, 2.5, 0.5}, 2.0, counts));
  CHECK(counts[5] == 2.0);
  CHECK(grid.centre(5) == Point3{1.5, 2.5, 0.5});
  CHECK(grid.count({2.0, 3.0, 1.0}, 1.0, counts));
  CHECK(counts[5] == 3.0);
  CHECK_THROWS_AS(Grid3({0, 0, 0}, {1, 0, 1}, 1.0), Fault);
  CHECK_THROWS_AS(Grid3({0, 0, 0}, {1, 1, 1}, 1e-4), Fault);
}

TEST_CASE("a figure of space has all formats, the same bytes twice, and a bounded size", "[draw]") {
  SpatialFigure figure{.title = "a slot", .lo = {0, 0, 0}, .hi = {4, 4, 4}, .cell = 2.0, .width = 300.0};
  figure.obstacles = {box({1.5, 0, 0}, {2.5, 4, 1.8}), box({1.5, 0, 2.2}, {2.5, 4, 4})};
  figure.start = {box({0.4, 1.8, 1.8}, {0.8, 2.2, 2.2})};
  figure.goal = {box({3.2, 1.8, 1.8}, {3.6, 2.2, 2.2})};
  SpatialPanel panel{.title = "two paths"};
  panel.paths = {{{0.6, 2, 2}, {3.4, 2, 2}}};
  panel.poses = {box({1.8, 1.9, 1.9}, {2.2, 2.1, 2.1})};
  panel.invalid = {true};
  panel.layers = {{"tree", Role::tree, {0, 1, 2, 3, 4, 5, 6, 7}}};
  figure.panels = {panel};
  check_formats(plot(figure));
  test::check_golden("spatial.svg", plot(figure).render(Format::svg));

  SECTION("a fine mesh is bounded") {
    Surface fine{.closed = false};
    constexpr std::uint32_t side = 60;
    for (std::uint32_t i = 0; i <= side; ++i) {
      for (std::uint32_t j = 0; j <= side; ++j) {
        fine.vertices.push_back({4.0 * i / side, 4.0 * j / side, 1.0 + 0.3 * std::sin(0.7 * i) * std::cos(0.9 * j)});
      }
    }
    for (std::uint32_t i = 0; i < side; ++i) {
      for (std::uint32_t j = 0; j < side; ++j) {
        const std::uint32_t at = i * (side + 1) + j;
        fine.triangles.push_back({at, at + side + 1, at + 1});
        fine.triangles.push_back({at + 1, at + side + 1, at + side + 2});
      }
    }
    figure.obstacles = {fine};
    CHECK(plot(figure).render(Format::svg).size() < 3'000'000);
  }
  SECTION("a layer must fit the grid") {
    figure.panels[0].layers[0].mean.pop_back();
    CHECK_THROWS_AS(plot(figure), Fault);
  }
  SECTION("from straight above and from below") {
    figure.camera = {0.0, 90.0};
    check_formats(plot(figure));
    figure.camera = {200.0, -40.0};
    check_formats(plot(figure));
  }
}
