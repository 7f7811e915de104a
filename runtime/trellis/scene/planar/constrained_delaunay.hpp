// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include <trellis/scene/planar/shapes.hpp>

namespace trellis {

/// A triangle of a triangulation.
struct DelaunayTriangle {
  static constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();
  std::array<Vec2, 3> corners;              ///< counter-clockwise, the least (by x, then y) first
  std::array<std::uint32_t, 3> neighbours;  ///< across the side opposite each corner; none at the hull
};

/// Returns the constrained Delaunay triangulation of points and of segments between them, given by the points' indices.
/// Segments may touch, cross and overlap. Triangles are sorted by their corners. Only the source of this header
/// includes CGAL.
std::vector<DelaunayTriangle> constrained_delaunay(const std::vector<Vec2>& points,
                                                   const std::vector<std::pair<std::size_t, std::size_t>>& segments);

}  // namespace trellis
