// SPDX-License-Identifier: GPL-3.0-or-later
// Union and offset. A separate source, because arrangements with an exact construction kernel take most of a minute to
// compile.
#include <CGAL/Boolean_set_operations_2.h>
#include <CGAL/Exact_predicates_exact_constructions_kernel.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_2.h>
#include <CGAL/Polygon_2_algorithms.h>
#include <CGAL/Polygon_with_holes_2.h>
#include <CGAL/minkowski_sum_2.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <numbers>
#include <numeric>
#include <tuple>

#include <trellis/base/error.hpp>
#include <trellis/scene/planar/planar_box_tree.hpp>
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

// A lazy number rounds from its interval, which depends on its history; the exact value does not, nor does an interval
// of one double.
double nearest_double(const Kernel::FT& x) {
  const auto [least, greatest] = CGAL::to_interval(x);
  return least == greatest ? least : CGAL::to_double(x.exact());
}
double nearest_double(double x) { return x; }

// Rounds to doubles, removes collinear vertices (exactly collinear ones, and those that coincide after rounding) and
// starts at the least vertex, so that equal sets give equal results.
template <class Points>
Polygon rounded(const Points& polygon) {
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

// Removes what is narrower than the rounding, and sorts.
std::vector<PolygonWithHoles> canonical(std::vector<PolygonWithHoles> polygons) {
  const auto narrow = [](const Polygon& loop) { return loop.vertices.size() < 3; };
  for (auto& polygon : polygons) {
    std::erase_if(polygon.holes, narrow);
    std::sort(polygon.holes.begin(), polygon.holes.end(), before);
  }
  std::erase_if(polygons, [&](const PolygonWithHoles& p) { return narrow(p.outer); });
  std::sort(polygons.begin(), polygons.end(),
            [](const PolygonWithHoles& a, const PolygonWithHoles& b) { return before(a.outer, b.outer); });
  return polygons;
}

PolygonWithHoles rounded(const ExactWithHoles& polygon) {
  PolygonWithHoles result;
  result.outer = rounded(polygon.outer_boundary());
  for (auto hole = polygon.holes_begin(); hole != polygon.holes_end(); ++hole) result.holes.push_back(rounded(*hole));
  return result;
}

template <class Range>
std::vector<PolygonWithHoles> rounded_all(const Range& polygons) {
  std::vector<PolygonWithHoles> result;
  for (const ExactWithHoles& polygon : polygons) result.push_back(rounded(polygon));
  return canonical(std::move(result));
}

// Returns a polygon that overlaps no other one as its part of their union. No point of it is constructed, so doubles
// suffice.
PolygonWithHoles alone(const Polygon& polygon) {
  using Doubles = CGAL::Exact_predicates_inexact_constructions_kernel;
  std::vector<Doubles::Point_2> points;
  points.reserve(polygon.vertices.size());
  for (const Vec2 v : polygon.vertices) points.emplace_back(v.x, v.y);
  if (CGAL::orientation_2(points.begin(), points.end(), Doubles()) == CGAL::CLOCKWISE) {
    std::reverse(points.begin(), points.end());
  }
  return {rounded(points), {}};
}

// Returns the indices of the polygons in groups: those of different groups have boxes that do not meet.
std::vector<std::vector<std::uint32_t>> groups_of(const std::vector<Polygon>& polygons) {
  std::vector<Box2> boxes;
  boxes.reserve(polygons.size());
  for (const auto& polygon : polygons) boxes.push_back(bounding_box(polygon));
  const PlanarBoxTree tree(boxes);
  std::vector<std::uint32_t> root(polygons.size());
  std::iota(root.begin(), root.end(), 0U);
  const auto root_of = [&](std::uint32_t i) {
    while (root[i] != i) i = root[i] = root[root[i]];
    return i;
  };
  for (std::uint32_t i = 0; i < polygons.size(); ++i) {
    tree.each([&](const Box2& other) { return boxes_meet(boxes[i], other); },
              [&](std::uint32_t j) {
                if (j < i && boxes_meet(boxes[i], boxes[j])) root[root_of(j)] = root_of(i);
              });
  }
  std::map<std::uint32_t, std::vector<std::uint32_t>> groups;
  for (std::uint32_t i = 0; i < polygons.size(); ++i) groups[root_of(i)].push_back(i);
  std::vector<std::vector<std::uint32_t>> result;
  result.reserve(groups.size());
  for (auto& group : groups) result.push_back(std::move(group.second));
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
  std::vector<PolygonWithHoles> result;
  for (const auto& group : groups_of(polygons)) {
    if (group.size() == 1) {
      result.push_back(alone(polygons[group.front()]));
      continue;
    }
    std::vector<ExactPolygon> given;
    given.reserve(group.size());
    for (const std::uint32_t i : group) given.push_back(exact(polygons[i].vertices));
    std::vector<ExactWithHoles> joined;
    CGAL::join(given.begin(), given.end(), std::back_inserter(joined));
    for (const auto& polygon : joined) result.push_back(rounded(polygon));
  }
  return canonical(std::move(result));
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
