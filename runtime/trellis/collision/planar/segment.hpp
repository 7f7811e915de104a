// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>

#include <trellis/collision/planar/kernel.hpp>
#include <trellis/scene/planar/shapes.hpp>

namespace trellis {

/// The motion of a point without turns: all points from + t along, t in [0, 1].
struct Segment2 {
  Vec2 from;
  Vec2 along;
};

/// Decides whether a segment comes within `reach` of a convex piece, by separating axes: those of the piece's edges and
/// the segment's normal. No place between two configurations is left out.
/// \param piece  a rectangle along the axes, a disc or a polygon, in the segment's frame
/// \param reach  metres, at least 0; closer than that is contact
/// \return a parameter in [0, 1] at which the segment is in contact; none where it is free
std::optional<double> contact(const Segment2& segment, const kernel::Piece& piece, double reach);

/// Returns the distance between a segment and a closed convex shape, in metres; 0 where they touch.
double distance(const Segment2& segment, const ConvexShape& shape);

/// Returns the area that a polygon sweeps on a motion without turns, a convex polygon.
/// \param along  not zero
Polygon swept(const Polygon& polygon, Vec2 along);

/// Returns a convex shape that contains all points within `by` metres of a shape: of a rectangle along the axes a
/// larger one, of another polygon its edges moved outwards, with one more edge at each sharp corner.
ConvexShape inflated(const ConvexShape& shape, double by);

}  // namespace trellis
