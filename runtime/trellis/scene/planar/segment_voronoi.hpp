// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include <trellis/scene/planar/shapes.hpp>

namespace trellis {

/// The bounded part of the Voronoi diagram of points and open segments. An end point of a segment is a site of its own,
/// so the bisector of a segment and its own end point is an edge of the diagram, too.
struct SegmentVoronoi {
  static constexpr std::size_t no_source = std::numeric_limits<std::size_t>::max();

  struct Site {
    Vec2 a;
    Vec2 b;  ///< equal to a for a point
    bool point = true;
    /// Index of a given point there, or of a given segment that contains the site; no_source of a crossing.
    std::size_t source = no_source;
  };
  struct Vertex {
    Vec2 position;                       ///< rounded: an initial guess that the caller refines from the sites
    std::array<std::uint32_t, 3> sites;  ///< three of the nearest sites, in directions far apart
  };
  struct Edge {
    std::uint32_t from = 0, to = 0;                 ///< vertices
    std::uint32_t first_site = 0, second_site = 0;  ///< the sites that the edge is equidistant from
  };
  std::vector<Site> sites;
  std::vector<Vertex> vertices;
  std::vector<Edge> edges;
};

/// Returns the diagram of segments given by the indices of their end points, one segment at least. The points
/// are first rounded to a grid of at least 2^29 cells along the longer extent of all of them; where that makes segments
/// touch or cross, they are divided there. The sites have the coordinates given. Uses Boost.Polygon's Voronoi diagram;
/// only segment_voronoi.cpp includes it. It orders some events wrongly that are nearly simultaneous: vertices that are
/// not equally far from their sites, to four cells, are found, and the diagram is made anew on turned grids. Such a
/// vertex that all four grids have has no edges in the result. Deterministic.
/// \param points  metres
/// \throws Error where segments still cross after they were divided 100 times
SegmentVoronoi segment_voronoi(const std::vector<Vec2>& points,
                               const std::vector<std::pair<std::size_t, std::size_t>>& segments);

}  // namespace trellis
