// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include <trellis/scene/planar/shapes.hpp>

namespace trellis {

/// The bounded part of the Voronoi diagram of points and open segments. An end point of a segment is a site of its own,
/// so the bisector of a segment and its own end point is an edge of the diagram, too.
struct SegmentVoronoi {
  struct Site {
    Vec2 a;
    Vec2 b;  ///< equal to a for a point
    bool point = true;
  };
  struct Vertex {
    Vec2 position;                       ///< rounded: an initial guess that the caller refines from the sites
    std::array<std::uint32_t, 3> sites;  ///< three of the nearest sites
  };
  struct Edge {
    std::uint32_t from = 0, to = 0;                 ///< vertices; they may coincide
    std::uint32_t first_site = 0, second_site = 0;  ///< the sites that the edge is equidistant from
  };
  std::vector<Site> sites;
  std::vector<Vertex> vertices;
  std::vector<Edge> edges;
};

/// Returns the diagram of segments given by the indices of their end points. Segments may touch and cross (crossings
/// become sites). Uses CGAL's segment Delaunay graph; only segment_voronoi.cpp includes it. Deterministic.
SegmentVoronoi segment_voronoi(const std::vector<Vec2>& points,
                               const std::vector<std::pair<std::size_t, std::size_t>>& segments);

}  // namespace trellis
