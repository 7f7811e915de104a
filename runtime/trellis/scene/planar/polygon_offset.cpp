// SPDX-License-Identifier: GPL-3.0-or-later
// Union and offset. A separate source, because arrangements with an exact construction kernel take most of a minute to
// compile.
#include <CGAL/Boolean_set_operations_2.h>
#include <CGAL/Exact_predicates_exact_constructions_kernel.h>
#include <CGAL/Polygon_2.h>
#include <CGAL/Polygon_with_holes_2.h>
#include <CGAL/minkowski_sum_2.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>
#include <tuple>

#include <trellis/base/error.hpp>
#include <trellis/scene/planar/polygon.hpp>

namespace trellis {

namespace {

using Kernel = CGAL::Exact_predicates_exact_constructions_kernel;
using ExactPolygon = CGAL::Polygon_2<Kernel>;
using ExactWithHoles = CGAL::Polygon_with_holes_2<Kernel>;

ExactPolygon exact(const std::vector<Vec2>& vertices) {
  ExactPolygon polygon;
  for (const Vec2 v : vertices) polygon.push_back({v.x, v.y});
  if (polygon.orientation() == CGAL::CLOCKWISE) polygon.reverse_orientation();
  return polygon;
}

// A lazy number rounds from its interval, which depends on its history; the exact value does not.
double nearest_double(const Kernel::FT& x) { return CGAL::to_double(x.exact()); }

// Rounds to doubles, removes collinear vertices (exactly collinear ones, and those that coincide after rounding) and
// starts at the least vertex, so that equal sets give equal results.
Polygon rounded(const ExactPolygon& polygon) {
  Polygon result;
  const std::size_t n = polygon.size();
  for (std::size_t i = 0; i < n; ++i) {
    const auto& p = polygon[i];
    if (CGAL::collinear(polygon[(i + n - 1) % n], p, polygon[(i + 1) % n])) continue;
    const Vec2 v{nearest_double(p.x()), nearest_double(p.y())};
    if (result.vertices.empty() || result.vertices.back() != v) result.vertices.push_back(v);
  }
  auto& vertices = result.vertices;
  while (vertices.size() > 1 && vertices.front() == vertices.back()) vertices.pop_back();
  std::rotate(vertices.begin(),
              std::min_element(vertices.begin(), vertices.end(),
                               [](Vec2 a, Vec2 b) { return std::tie(a.x, a.y) < std::tie(b.x, b.y); }),
              vertices.end());
  return result;
}

bool before(const Polygon& a, const Polygon& b) {
  return std::lexicographical_compare(a.vertices.begin(), a.vertices.end(), b.vertices.begin(), b.vertices.end(),
                                      [](Vec2 p, Vec2 q) { return std::tie(p.x, p.y) < std::tie(q.x, q.y); });
}

template <class Range>
std::vector<PolygonWithHoles> rounded_all(const Range& polygons) {
  std::vector<PolygonWithHoles> result;
  for (const ExactWithHoles& polygon : polygons) {
    PolygonWithHoles& out = result.emplace_back();
    out.outer = rounded(polygon.outer_boundary());
    for (auto hole = polygon.holes_begin(); hole != polygon.holes_end(); ++hole) out.holes.push_back(rounded(*hole));
    // Remove holes narrower than the rounding.
    std::erase_if(out.holes, [](const Polygon& hole) { return hole.vertices.size() < 3; });
    std::sort(out.holes.begin(), out.holes.end(), before);
  }
  std::erase_if(result, [](const PolygonWithHoles& p) { return p.outer.vertices.size() < 3; });
  std::sort(result.begin(), result.end(),
            [](const PolygonWithHoles& a, const PolygonWithHoles& b) { return before(a.outer, b.outer); });
  return result;
}

// Returns a regular polygon whose edges touch the circle of this radius from outside. With a multiple of four edges it
// touches in the directions of the axes, so that offsets of boxes have the correct extents.
ExactPolygon circumscribed(double radius, int vertices) {
  const double step = 2.0 * std::numbers::pi / vertices;
  const double corner = radius / std::cos(0.5 * step);
  ExactPolygon polygon;
  for (int i = 0; i < vertices; ++i) {
    const double angle = (i + 0.5) * step;
    polygon.push_back({corner * std::cos(angle), corner * std::sin(angle)});
  }
  return polygon;
}

}  // namespace

std::vector<PolygonWithHoles> polygon_union(const std::vector<Polygon>& polygons) {
  std::vector<ExactPolygon> given;
  given.reserve(polygons.size());
  for (const auto& polygon : polygons) given.push_back(exact(polygon.vertices));
  std::vector<ExactWithHoles> joined;
  CGAL::join(given.begin(), given.end(), std::back_inserter(joined));
  return rounded_all(joined);
}

std::vector<PolygonWithHoles> polygon_offset(const Polygon& polygon, double distance, int arc_vertices) {
  if (!std::isfinite(distance))
    throw Error(fmt::format("polygon offset: the distance must be finite, got {}", distance));
  if (arc_vertices < 3) {
    throw Error(fmt::format("polygon offset: an arc needs at least 3 vertices, got {}", arc_vertices));
  }
  const ExactPolygon given = exact(polygon.vertices);
  if (distance == 0.0) return {{rounded(given), {}}};
  const ExactPolygon disc = circumscribed(std::abs(distance), arc_vertices);
  if (distance > 0.0) return rounded_all(std::vector{CGAL::minkowski_sum_2(given, disc)});

  // Eroding a set is dilating its complement. A frame that is wider than the disc replaces the unbounded complement: it
  // removes the same area next to the polygon.
  const auto box = given.bbox();
  const double margin = 3.0 * std::abs(distance) + (box.xmax() - box.xmin()) + (box.ymax() - box.ymin());
  const ExactPolygon frame = exact(
      rectangle_vertices({{box.xmin() - margin, box.ymin() - margin}, {box.xmax() + margin, box.ymax() + margin}}));
  ExactWithHoles complement(frame);
  ExactPolygon hole = given;
  hole.reverse_orientation();
  complement.add_hole(hole);
  const ExactWithHoles taken = CGAL::minkowski_sum_2(complement, disc);
  std::vector<ExactWithHoles> rest;
  CGAL::difference(ExactWithHoles(given), taken, std::back_inserter(rest));
  return rounded_all(rest);
}

}  // namespace trellis
