// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <trellis/draw/surface.hpp>

namespace trellis::draw {

/// A part of a picture of space.
struct SpatialItem {
  enum class Kind : std::uint8_t {
    face,  ///< a convex polygon in a plane, of 3 corners or more
    line,  ///< from the first point to the second
    dot    ///< at the first point
  };
  Kind kind = Kind::face;
  std::vector<Point3> points{};
  /// Of a face, for each corner: whether the edge from it to the next one is drawn.
  std::vector<bool> edges{};
  std::uint32_t style = 0;  ///< the caller's
};

/// Orders items such that none hides one after it from a camera that is far away: faces, which are not to cross other
/// faces but in lines, and lines are cut where they cross the plane of a face (binary space partition). Deterministic.
/// \param to_camera  the direction of the camera
/// \param tolerance  metres: a point so near to a plane lies in it
/// \param most       beyond this number of items no more are cut: what is left is ordered by the depth of its middle
std::vector<SpatialItem> far_to_near(std::vector<SpatialItem> items, const Point3& to_camera, double tolerance,
                                     std::size_t most);

}  // namespace trellis::draw
