// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include <trellis/scene/planar/shapes.hpp>
#include <trellis/scene/spatial/mesh.hpp>

namespace trellis {

/// Whether all coordinates are numbers within `most_distant` of 0.
inline bool in_range(const Vec3& a) {
  return std::abs(a.x) <= most_distant && std::abs(a.y) <= most_distant && std::abs(a.z) <= most_distant;
}

inline Vec3 least_of(const Vec3& a, const Vec3& b) {
  return {std::min(a.x, b.x), std::min(a.y, b.y), std::min(a.z, b.z)};
}

inline Vec3 greatest_of(const Vec3& a, const Vec3& b) {
  return {std::max(a.x, b.x), std::max(a.y, b.y), std::max(a.z, b.z)};
}

/// Returns the smallest box along the axes that contains the points, of which there is one at least.
inline Box3 bounds_of(std::span<const Vec3> points) {
  Box3 box{points.front(), points.front()};
  for (const Vec3& p : points) box = {least_of(box.lo, p), greatest_of(box.hi, p)};
  return box;
}

/// Returns the corners of a box: that with index i is at `hi` in x, y or z where bit 0, 1 or 2 of i is set.
inline std::array<Vec3, 8> corners_of(const Box3& box) {
  std::array<Vec3, 8> corners;
  for (unsigned i = 0; i < 8; ++i) {
    corners[i] = {(i & 1U) != 0 ? box.hi.x : box.lo.x, (i & 2U) != 0 ? box.hi.y : box.lo.y,
                  (i & 4U) != 0 ? box.hi.z : box.lo.z};
  }
  return corners;
}

}  // namespace trellis
