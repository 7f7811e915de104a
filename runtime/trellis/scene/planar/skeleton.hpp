// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include <trellis/scene/planar/world.hpp>

namespace trellis {

/// The medial axis of a planar world's free space as a graph: vertices at junctions and dead ends (and one on each
/// closed loop), and edges that are polylines on the medial axis, with the clearance of each point.
struct Skeleton {
  struct Edge {
    std::uint32_t from = 0;
    std::uint32_t to = 0;
    std::vector<Vec2> points;       ///< from vertices[from] to vertices[to], both included
    std::vector<double> clearance;  ///< distance to the nearest obstacle or boundary, per point, in metres
    double length = 0.0;            ///< of the polyline, in metres
  };
  std::vector<Vec2> vertices;
  std::vector<Edge> edges;
  double seconds = 0.0;  ///< duration of the construction
};

/// Computes the skeleton from the segment Voronoi diagram of obstacles and boundary. In the diagram, discs are polygons
/// of `disc_vertices` vertices; then the points move to the bisectors of the true discs. Omits parts of the medial axis
/// inside obstacles or outside the boundary, and the spurs into convex corners of the free space (edges that end on a
/// site). A pocket with only spurs, such as a square, has one vertex without edges. Deterministic.
/// \param spacing  the largest distance between points of an edge, in metres; <= 0 selects 1/200 of the world's
///     diagonal
/// \throws Error where the world has no free space.
Skeleton medial_axis(const World& world, double spacing = 0.0, int disc_vertices = 24);

/// As medial_axis, cached for the world and its copies as long as one of them exists. Thread-safe.
std::shared_ptr<const Skeleton> cached_medial_axis(const World& world);

}  // namespace trellis
