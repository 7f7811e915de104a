// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include <trellis/scene/spatial/world.hpp>

namespace trellis {

/// A skeleton of a spatial world's free space: maximal balls, which touch what bounds the space in two points or more,
/// so that their centres lie on its medial axis, and edges where two of them overlap.
///
/// Every point whose distance from obstacles is at least `resolution` lies in a ball, or in what was left out: corners.
/// Where the balls of two points are joined, so are the points, and a path of the graph is free.
struct BallGraph {
  struct Ball {
    Vec3 centre;
    double radius = 0.0;  ///< the distance of the centre from obstacles (and bounds, see FreeDistance), in metres
  };
  struct Edge {
    std::uint32_t from = 0;
    std::uint32_t to = 0;
    /// From one centre to the other through the portal: the middle of the disc in which the balls' surfaces meet, moved
    /// within its plane away from obstacles.
    std::vector<Vec3> points;
    std::vector<double> clearance;  ///< distance from obstacles, per point, in metres
    double length = 0.0;            ///< of the polyline, in metres
  };
  std::vector<Ball> balls;
  std::vector<Edge> edges;
  double resolution = 0.0;  ///< metres: the side of the smallest cells that were searched for balls
};

/// Computes the graph from an octree of cells, by falling distance of their centres from obstacles: a cell whose centre
/// no ball covers gets the maximal ball that contains the one about its centre. Cells are divided while they are large
/// for their distance, so that balls of neighbouring cells overlap. Balls less than half as large as a neighbour are
/// left out where their neighbours are connected without them: those in corners. Deterministic.
/// \param resolution  metres; <= 0 selects 1/128 of the longest side of the bounds
/// \param spacing  the largest distance between points of an edge, in metres; <= 0 selects 1/200 of the diagonal
/// \throws Error where the world has no free space
BallGraph ball_graph(const World3& world, double resolution = 0.0, double spacing = 0.0);

/// As ball_graph, cached for the world and its copies as long as one of them exists. Thread-safe.
std::shared_ptr<const BallGraph> cached_ball_graph(const World3& world);

}  // namespace trellis
