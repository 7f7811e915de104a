// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <trellis/scene/shapes.hpp>

namespace trellis {

/// The shape moved by the pose; `out` keeps its memory where it already holds a shape of the same kind.
void move_shape(const ConvexShape& shape, const Pose2& pose, ConvexShape& out);

/// The exact distance between two closed convex shapes; 0 where they touch.
double distance(const ConvexShape& a, const ConvexShape& b);

/// The penetration depth: the length of the shortest translation that leaves the two closed convex shapes without a
/// common interior point. 0 where they are apart.
double penetration_depth(const ConvexShape& a, const ConvexShape& b);

/// A lower bound on the distance: the distance between their boxes.
double box_distance(const Box2& a, const Box2& b);

/// How far the box lies inside the other on its nearest side; negative where it sticks out.
double margin_inside(const Box2& inner, const Box2& outer);

}  // namespace trellis
