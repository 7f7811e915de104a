// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include <trellis/draw/canvas.hpp>
#include <trellis/draw/planar.hpp>

/// Pictures of a robot on its path and of its two-dimensional space, from plain numbers.
namespace trellis::draw {

/// One axis of a two-dimensional space.
struct SpaceAxis {
  std::string name{};
  double lo = 0.0;
  double hi = 1.0;
  bool angle = false;  ///< in radians
};

/// Numbers over the cells of the space, row by row from the lowest. Empty: no rows.
struct CellMap {
  std::size_t columns = 0;
  std::size_t rows = 0;
  std::vector<double> values{};
};

/// A path of the robot, in the world and in its space, side by side.
struct MotionRow {
  std::string world_title{};
  std::string space_title{};
  std::vector<std::vector<WorldShape>> poses{};  ///< from start to goal: the robot's parts
  std::vector<bool> invalid{};                   ///< of each pose
  std::vector<std::vector<Point>> path{};        ///< in the space, in pieces where it wraps around
  std::vector<Point> nodes{};
  CellMap density{};  ///< density of the proposals
};

struct MotionFigure {
  std::string title{};
  std::string caption{};
  Rect world{};
  std::vector<WorldShape> obstacles{};
  SpaceAxis x{};
  SpaceAxis y{};
  CellMap blocked{};  ///< not 0 where a configuration is invalid
  Point start{};      ///< in the space
  Point goal{};
  std::vector<MotionRow> rows{};
  double width = 504.0;    ///< points
  bool scale_bar = false;  ///< below the first picture of the world, in metres
};

/// Draws a figure on white. Its rows and texts determine its height.
Canvas plot(const MotionFigure& figure);

}  // namespace trellis::draw
