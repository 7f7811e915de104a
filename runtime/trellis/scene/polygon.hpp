// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include <trellis/scene/shapes.hpp>

namespace trellis {

// Polygon work, done by CGAL behind this header (polygon.cpp and polygon_offset.cpp are the only sources that meet it).

/// Checks that the vertices are at least three, finite, simple (no self-intersection, no repeated vertex) and enclose
/// an area; returns them counter-clockwise. Throws Error that names `what` ("obstacle 3") and the fault.
Polygon validated_polygon(Polygon polygon, const std::string& what);

/// A decomposition of a simple counter-clockwise polygon into few convex counter-clockwise parts that cover it exactly.
std::vector<Polygon> convex_parts(const Polygon& polygon);

/// A polygon with holes: outer boundary counter-clockwise, holes clockwise.
struct PolygonWithHoles {
  Polygon outer;
  std::vector<Polygon> holes;
};

/// The union of simple polygons as disjoint polygons with holes, computed exactly and rounded to doubles at the end. In
/// canonical order: every loop starts at its least vertex, loops and pieces are sorted.
std::vector<PolygonWithHoles> polygon_union(const std::vector<Polygon>& polygons);

/// The points within `distance` of the polygon (distance > 0, Minkowski sum with a disc approximated from outside by
/// a polygon of `arc_vertices` vertices) or, with distance < 0, eroded by -distance (possibly several or no parts).
std::vector<PolygonWithHoles> polygon_offset(const Polygon& polygon, double distance, int arc_vertices = 32);

}  // namespace trellis
