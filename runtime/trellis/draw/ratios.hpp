// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include <trellis/draw/canvas.hpp>
#include <trellis/draw/marks.hpp>

/// Ratios on a logarithmic axis: a row for each thing compared, a dot for each case that it was compared in.
namespace trellis::draw {

/// Cases that are drawn alike, on a line of their own in each row.
struct RatioGroup {
  std::string name{};
  Colour colour{};
  bool open = false;  ///< circles instead of discs
};

struct RatioDot {
  std::size_t group = 0;  ///< index into RatioFigure::groups
  std::string label{};    ///< printed right of the row whose largest it is; "": nothing
  double value = 1.0;     ///< infinity: an arrow at the right edge; 0: one at the left edge
  double lo = 1.0;        ///< its interval; NaN: none
  double hi = 1.0;
  std::string text{};  ///< printed instead of the label and the value
};

struct RatioRow {
  std::string name{};
  std::vector<std::vector<RatioDot>> panels{};  ///< the dots in each panel
};

/// A vertical line through all panels.
struct RatioLine {
  double x = 1.0;
  std::string label{};
  Dash dash = Dash::solid;
};

struct RatioFigure {
  std::string title{};
  std::string caption{};
  std::vector<std::string> panels{};  ///< their titles, side by side
  std::string x_label{};
  std::string texts = "largest";  ///< above what is printed beside the rows
  std::vector<RatioGroup> groups{};
  std::vector<RatioRow> rows{};  ///< from the top
  std::vector<RatioLine> lines{};
  double width = 700.0;  ///< points
};

/// Draws a figure on white. Its height is what its rows and texts need. A vertical bar marks the median of each row.
/// Throws Fault where a row has not as many panels as the figure.
Canvas plot(const RatioFigure& figure);

}  // namespace trellis::draw
