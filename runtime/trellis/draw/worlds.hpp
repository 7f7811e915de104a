// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <vector>

#include <trellis/draw/planar.hpp>

/// How worlds and robots look in all pictures of them.
namespace trellis::draw {

inline constexpr Colour start_colour = rgb(0x555555);
/// The start is filled, the goal is an outline: in every picture, on the page and in the session.
inline constexpr Colour goal_colour = palette::paper;
inline constexpr Colour obstacle_colour = rgb(0xC9C9C9);
inline constexpr Colour obstacle_edge = rgb(0x8C8C8C);

Path path_of(const WorldShape& shape, const Transform& map);
void append(Path& to, const Path& path);
/// What of a robot is drawn: its parts, or a mark where they are too small to be seen.
std::vector<Path> robot_paths(const std::vector<WorldShape>& parts, const Transform& map);
/// The outline of the paths' union, outside of it: within `page` and none of the paths from `at` on.
void outline(Canvas& canvas, const std::vector<Path>& paths, const Rect& page, std::size_t at = 0);
/// In the lower left corner of a plot of the world: a bar as long as a round number of metres, at most a third of the
/// plot's width. \param scale  points to the metre
void draw_scale_bar(Canvas& canvas, const Rect& plot, double scale);
/// A start or a goal that is a point, as a disc.
void draw_end(Canvas& canvas, Point at, double radius, bool start);
void draw_obstacles(Canvas& canvas, const std::vector<WorldShape>& obstacles, const Transform& map);

}  // namespace trellis::draw
