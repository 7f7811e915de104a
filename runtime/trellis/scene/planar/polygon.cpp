// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/scene/planar/polygon.hpp>

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Partition_traits_2.h>
#include <CGAL/Polygon_2_algorithms.h>
#include <CGAL/intersections.h>
#include <CGAL/partition_2.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <list>
#include <numeric>
#include <utility>

#include <trellis/base/error.hpp>
#include <trellis/scene/limits.hpp>

namespace trellis {

namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Point = Kernel::Point_2;

// Up to this many vertices, compute a minimal partition in O(n^4) time (about a millisecond). Beyond, compute at most
// four times as many parts in O(n log n).
constexpr std::size_t optimal_partition_vertices = 32;

std::vector<Point> points_of(const std::vector<Vec2>& vertices) {
  std::vector<Point> points;
  points.reserve(vertices.size());
  for (const Vec2 v : vertices) points.emplace_back(v.x, v.y);
  return points;
}

// Collinear vertices do not change the set, but the partition algorithms may fail on them, and each would cost
// collision checks a needless axis.
std::vector<Point> without_straight_vertices(const std::vector<Point>& points) {
  std::vector<Point> kept;
  const std::size_t n = points.size();
  for (std::size_t i = 0; i < n; ++i) {
    // Compare with the given neighbours, not with the last vertex of the result: each inner vertex of a straight
    // stretch lies between two collinear neighbours, so the result does not depend on where the loop starts.
    if (!CGAL::collinear(points[(i + n - 1) % n], points[i], points[(i + 1) % n])) kept.push_back(points[i]);
  }
  return kept;
}

Polygon polygon_of(const std::vector<Point>& points) {
  Polygon polygon;
  polygon.vertices.reserve(points.size());
  for (const Point& p : points) polygon.vertices.push_back({p.x(), p.y()});
  return polygon;
}

// Names the first pair of edges that intersect; call it only for polygons that are not simple.
std::string crossing_edges(const std::vector<Point>& points) {
  const std::size_t n = points.size();
  const auto edge = [&](std::size_t i) { return Kernel::Segment_2(points[i], points[(i + 1) % n]); };
  const auto text = [&](std::size_t i) {
    return fmt::format("the edge from vertex {} to vertex {}", i + 1, (i + 1) % n + 1);
  };
  // Neighbours share a vertex; they are at fault only where one overlaps the other.
  for (std::size_t i = 0; i < n; ++i) {
    const auto &a = points[i], &b = points[(i + 1) % n], &c = points[(i + 2) % n];
    if (CGAL::collinear(a, b, c) && !CGAL::collinear_are_ordered_along_line(a, b, c)) {
      return fmt::format("{} runs back over {}", text((i + 1) % n), text(i));
    }
  }
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = i + 2; j < n; ++j) {
      if (i == 0 && j == n - 1) continue;
      if (CGAL::do_intersect(edge(i), edge(j))) return fmt::format("{} meets {}", text(i), text(j));
    }
  }
  return "it is not simple";
}

}  // namespace

Polygon validated_polygon(Polygon polygon, const std::string& what) {
  auto& vertices = polygon.vertices;
  const std::size_t n = vertices.size();
  if (n < 3) throw Error(fmt::format("{}: a polygon needs at least 3 vertices, got {}", what, n));
  if (n > most_vertices) {
    throw Error(fmt::format("{}: a polygon has at most {} vertices, got {}", what, most_vertices, n));
  }
  for (std::size_t i = 0; i < n; ++i) {
    if (!in_range(vertices[i])) {
      throw Error(fmt::format("{}: vertex {} must lie within {:g} m of 0 in x and in y, got ({}, {})", what, i + 1,
                              most_distant, vertices[i].x, vertices[i].y));
    }
  }
  std::vector<std::size_t> order(n);
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return std::tuple(vertices[a].x, vertices[a].y, a) < std::tuple(vertices[b].x, vertices[b].y, b);
  });
  for (std::size_t k = 1; k < n; ++k) {
    if (vertices[order[k - 1]] == vertices[order[k]]) {
      const auto [first, second] = std::pair(order[k - 1] + 1, order[k] + 1);
      const char* hint = first == 1 && second == n ? "; the last vertex is joined to the first by itself" : "";
      throw Error(fmt::format("{}: vertices {} and {} are the same point ({}, {}){}", what, first, second,
                              vertices[order[k]].x, vertices[order[k]].y, hint));
    }
  }
  const auto points = points_of(vertices);
  const bool flat = std::all_of(points.begin() + 2, points.end(),
                                [&](const Point& p) { return CGAL::collinear(points[0], points[1], p); });
  if (flat) throw Error(fmt::format("{}: all vertices lie on one line, so the polygon encloses no area", what));
  if (!CGAL::is_simple_2(points.begin(), points.end(), Kernel())) {
    throw Error(fmt::format("{}: the polygon crosses or touches itself: {}", what, crossing_edges(points)));
  }
  if (CGAL::orientation_2(points.begin(), points.end(), Kernel()) == CGAL::CLOCKWISE) {
    std::reverse(vertices.begin(), vertices.end());
  }
  return polygon;
}

std::vector<Polygon> convex_parts(const Polygon& polygon) {
  const auto points = without_straight_vertices(points_of(polygon.vertices));
  if (CGAL::is_convex_2(points.begin(), points.end(), Kernel())) return {polygon_of(points)};

  using Traits = CGAL::Partition_traits_2<Kernel>;
  std::list<Traits::Polygon_2> partition;
  if (points.size() <= optimal_partition_vertices) {
    CGAL::optimal_convex_partition_2(points.begin(), points.end(), std::back_inserter(partition), Traits());
  } else {
    CGAL::approx_convex_partition_2(points.begin(), points.end(), std::back_inserter(partition), Traits());
  }
  std::vector<Polygon> parts;
  for (const auto& part : partition) {
    parts.push_back(polygon_of(without_straight_vertices({part.vertices_begin(), part.vertices_end()})));
  }
  return parts;
}

}  // namespace trellis
