// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include <trellis/scene/planar/shapes.hpp>

namespace trellis {

// Polygon operations by CGAL (only polygon.cpp and polygon_offset.cpp include it).

/// Checks that the vertices are at least three, finite, simple (no self-intersection, no repeated vertex) and enclose
/// an area. \return them counter-clockwise
/// \throws Error that names `what` ("obstacle 3") and the fault.
Polygon validated_polygon(Polygon polygon, const std::string& what);

/// Decomposes a simple counter-clockwise polygon into few convex counter-clockwise parts that cover it exactly.
std::vector<Polygon> convex_parts(const Polygon& polygon);

/// A polygon with holes: outer boundary counter-clockwise, holes clockwise.
struct PolygonWithHoles {
  Polygon outer;
  std::vector<Polygon> holes;
};

/// Returns the union of simple polygons as disjoint polygons with holes: an exact computation, rounded to doubles at
/// the end. The order is canonical: every loop starts at its least vertex, and loops and pieces are sorted.
std::vector<PolygonWithHoles> polygon_union(const std::vector<Polygon>& polygons);

/// Returns the points within `distance` metres of the polygon (distance > 0: the Minkowski sum with a disc, which a
/// circumscribed polygon of `arc_vertices` vertices replaces), or, with distance < 0, the polygon eroded by -distance
/// (several parts or none are possible).
std::vector<PolygonWithHoles> polygon_offset(const Polygon& polygon, double distance, int arc_vertices = 32);

}  // namespace trellis
