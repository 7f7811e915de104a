// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

#include <trellis/collision/spatial/turn.hpp>
#include <trellis/scene/spatial/obstacle_distance.hpp>

namespace trellis {

/// How the surfaces of two meshes lie to each other.
enum class SurfacePair : std::uint8_t {
  apart,   ///< all points of one are farther than the margin from the other
  meet,    ///< an edge of one passes through a triangle of the other, by more than the margin
  unknown  ///< in between
};

/// A pair of triangles, each by its place in its tree's order.
struct TrianglePair {
  std::uint32_t first = 0;
  std::uint32_t second = 0;
};

/// Compares the surfaces of two meshes, by both trees of boxes.
/// \param place  of the first mesh in the second one's frame
/// \param margin  in metres, far above rounding
/// \param guess  the pair of triangles that is compared before all others; on return the one that meets, if any does
SurfacePair compare_surfaces(const MeshDistance& first, const MeshDistance& second, const Turn& place, double margin,
                             TrianglePair& guess);

}  // namespace trellis
