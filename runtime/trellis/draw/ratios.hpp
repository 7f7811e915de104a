// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include <trellis/draw/canvas.hpp>
#include <trellis/draw/marks.hpp>
#include <trellis/draw/ticks.hpp>

/// Ratios on a logarithmic axis: a row for each subject of the comparison, a dot for each case.
namespace trellis::draw {

/// Cases of one look, on their own line in each row.
struct RatioGroup {
  std::string name{};
  Colour colour{};
  bool open = false;  ///< circles instead of discs
};

struct RatioDot {
  std::size_t group = 0;  ///< index into RatioFigure::groups
  std::string label{};    ///< printed right of the row if its dot is the largest; "": nothing
  double value = 1.0;     ///< infinity: an arrow at the right edge; 0: one at the left edge
  double lo = 1.0;        ///< its interval, which may be unbounded: from 0, to infinity; NaN: none
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
  std::string texts = "largest";  ///< heading of the texts beside the rows
  std::vector<RatioGroup> groups{};
  std::vector<RatioRow> rows{};  ///< from the top
  std::vector<RatioLine> lines{};
  double width = 700.0;  ///< points
};

/// Returns the axis of all panels: it shows each dot and line, and of the intervals as much as lies within ten times
/// their range. An arrowhead marks an end of an interval that lies beyond.
Extent ratio_extent(const RatioFigure& figure);

/// Draws a figure on white. Its panels and texts determine its height. A vertical bar marks the median of each row.
/// \throws Fault where a row has another number of panels than the figure.
Canvas plot(const RatioFigure& figure);

}  // namespace trellis::draw
