// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <vector>

#include <trellis/draw/planar.hpp>

/// The look of worlds and robots in all pictures.
namespace trellis::draw {

inline constexpr Colour start_colour = rgb(0x555555);
/// The start is filled, the goal is an outline: in every picture, on the page and in the session.
inline constexpr Colour goal_colour = palette::paper;
inline constexpr Colour obstacle_colour = rgb(0xC9C9C9);
inline constexpr Colour obstacle_edge = rgb(0x8C8C8C);

Path path_of(const WorldShape& shape, const Transform& map);
void append(Path& to, const Path& path);
/// Returns the parts of a robot, or a mark where they are too small on paper.
std::vector<Path> robot_paths(const std::vector<WorldShape>& parts, const Transform& map);
/// Draws the outline of the union of paths, on its outer side: within `page`, outside the paths from `at` on.
void outline(Canvas& canvas, const std::vector<Path>& paths, const Rect& page, std::size_t at = 0);
/// The height in points of the row that draw_scale_bar() draws.
double scale_bar_height();
/// Draws a scale bar, which belongs below a plot of the world, where it covers nothing: a round number of metres, and
/// the number to the right of it. \param at  its left upper corner \param most  its largest length, points
/// \param scale  points per metre
void draw_scale_bar(Canvas& canvas, Point at, double most, double scale);
/// Draws a start or a goal that is a point, as a disc.
void draw_end(Canvas& canvas, Point at, double radius, bool start);
void draw_obstacles(Canvas& canvas, const std::vector<WorldShape>& obstacles, const Transform& map);

}  // namespace trellis::draw
