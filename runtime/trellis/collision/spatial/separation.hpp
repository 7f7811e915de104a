// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <limits>

#include <trellis/scene/spatial/shapes.hpp>

namespace trellis {

/// A part of a motion of a rigid body in space, seen from its middle: the reference point moves straight, and the body
/// turns about an axis through it at a constant rate.
struct BodyMotion {
  Vec3 reference;    ///< the reference point at the middle
  Vec3 translation;  ///< from the middle to the end, in metres
  Vec3 axis;         ///< of the turn, of unit length
  double turn = 0;   ///< from the middle to the end, in radians, at least 0
};

/// How far a direction separates two solids, in metres. Negative where none of those tried separates them.
struct SeparationGap {
  double middle = -std::numeric_limits<double>::infinity();      ///< a lower bound on the distance at the middle
  double throughout = -std::numeric_limits<double>::infinity();  ///< one on the distance throughout the motion
};

/// Returns the largest gap throughout the motion along the directions tried: the normals of both solids' faces, those
/// of two edges (of boxes and capsules), the axis of a cylinder, and from one middle to the other. A displacement along
/// the obstacle does not lower it. At the middle it is the distance up to rounding where these are the nearest parts. A
/// mesh of more than 64 vertices is not compared, nor is a cloud of points: then the gap is minus infinity.
/// \param moving  a solid of the body, where it is at the middle of the motion
/// \param still   in the same frame
SeparationGap separation_gap(const Solid& moving, const BodyMotion& motion, const Solid& still);

/// Returns how far a solid stays inside a box, as `separation_gap` from its sides.
SeparationGap gap_inside(const Solid& moving, const BodyMotion& motion, const Box3& bounds);

}  // namespace trellis
