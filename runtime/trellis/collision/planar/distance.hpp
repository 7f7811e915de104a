// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <trellis/scene/planar/shapes.hpp>

namespace trellis {

/// Transforms the shape by the pose; reuses the memory of `out` if it contains a shape of the same kind.
void move_shape(const ConvexShape& shape, const Pose2& pose, ConvexShape& out);

/// Returns the exact distance between two closed convex shapes; 0 where they touch.
double distance(const ConvexShape& a, const ConvexShape& b);

/// Returns the point of `of` that is nearest to `from`. Requires that the two closed convex shapes are disjoint.
Vec2 nearest_point(const ConvexShape& from, const ConvexShape& of);

/// Returns the penetration depth: the length of the shortest translation after which the two closed convex shapes share
/// no interior point. 0 for disjoint shapes.
double penetration_depth(const ConvexShape& a, const ConvexShape& b);

/// Returns a lower bound on the distance: the distance between the bounding boxes.
double box_distance(const Box2& a, const Box2& b);

/// Returns the least distance of `inner` to the sides of `outer`; negative where `inner` extends beyond `outer`.
double margin_inside(const Box2& inner, const Box2& outer);

}  // namespace trellis
