// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include <trellis/scene/planar/shapes.hpp>

namespace trellis {

// Each of these throws an Error that starts with `what` for a shape below the precision of its own coordinates, too
// (check_size).

/// \throws Error that starts with `what` unless the box has coordinates in ascending order within `most_distant`.
void check_box(const Box2& box, const std::string& what);
/// \throws Error that starts with `what` unless the disc has numbers within `most_distant` and a radius greater than 0,
///     or of 0 where a point is allowed.
void check_disc(const Disc& disc, const std::string& what, bool point_allowed);
/// \throws Error that starts with `what` for a shape below the precision of coordinates of up to `farthest` metres
void check_precision(const Shape& shape, double farthest, const std::string& what);
/// Returns the greatest absolute coordinate of a box.
double farthest_of(const Box2& box);
/// Checks a shape, makes polygons counter-clockwise, and appends its convex parts.
void validate(Shape& shape, const std::string& what, bool point_allowed, std::vector<ConvexShape>& parts);

}  // namespace trellis
