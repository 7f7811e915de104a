// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include <trellis/scene/planar/shapes.hpp>

namespace trellis {

/// \throws Error that starts with `what` unless the box has coordinates in ascending order within `most_distant`.
void check_box(const Box2& box, const std::string& what);
/// \throws Error that starts with `what` unless the disc has numbers within `most_distant` and a radius greater than 0,
///     or of 0 where a point is allowed.
void check_disc(const Disc& disc, const std::string& what, bool point_allowed);
/// Checks a shape, makes polygons counter-clockwise, and appends its convex parts.
void validate(Shape& shape, const std::string& what, bool point_allowed, std::vector<ConvexShape>& parts);

}  // namespace trellis
