// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include <trellis/scene/scene.hpp>

namespace trellis {

/// The medial axis of a planar world's free space as a graph: vertices at junctions and dead ends (and one on each
/// closed loop), edges polylines between them that keep to the medial axis, each point with its clearance.
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
  double seconds = 0.0;  ///< time that the construction took
};

/// The skeleton from the segment Voronoi diagram of obstacles and boundary. For the diagram discs are polygons of
/// `disc_vertices` vertices; its points are then moved to the true discs. Parts of the medial axis inside obstacles or
/// outside the boundary, and the spurs into convex corners of the free space (edges that end on a site), are left out;
/// a pocket with nothing but spurs, such as a square, keeps one vertex without edges. `spacing`: the largest distance
/// between points of an edge, in metres; <= 0 picks 1/200 of the world's diagonal. Deterministic. Throws Error where
/// the world leaves no free space.
Skeleton medial_axis(const World& world, double spacing = 0.0, int disc_vertices = 24);

/// The same, remembered for the world and its copies while one of them lives; safe to call from several threads at
/// once.
std::shared_ptr<const Skeleton> cached_medial_axis(const World& world);

}  // namespace trellis
