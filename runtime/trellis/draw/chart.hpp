// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <trellis/draw/canvas.hpp>
#include <trellis/draw/palette.hpp>
#include <trellis/draw/ticks.hpp>

namespace trellis::draw {

/// NaN is a gap. An arrow at the panel's edge marks values that are infinite or beyond a given end; the legend explains
/// it. Vectors of one series must have equal lengths, else Fault.

enum class Dash : std::uint8_t { solid, dashed, dotted };
enum class Marker : std::uint8_t { circle, square, diamond, cross, ring };

struct Axis {
  std::string label{};
  AxisScale scale = AxisScale::linear;
  std::optional<double> lo{};  ///< an end of the axis; else from the data
  std::optional<double> hi{};
  std::vector<std::string> categories{};  ///< of an x axis: the names of 0, 1, 2 ...
};

struct Series {
  /// `points` and `bars` have error bars; `steps` draw a histogram or a profile; a line's interval is a band.
  enum class Kind : std::uint8_t { line, points, bars, steps };

  Kind kind = Kind::line;
  std::string name{};       ///< in the legend; "": no entry
  std::vector<double> x{};  ///< of steps: the edges of the bins, one more than there are bins
  std::vector<double> y{};
  std::vector<double> lo{};  ///< the interval; empty: none
  std::vector<double> hi{};
  std::vector<double> x_lo{};  ///< of points: the interval of x; empty: none
  std::vector<double> x_hi{};
  std::vector<double> base{};       ///< of bars: where each begins; empty: 0
  std::vector<std::string> text{};  ///< of bars: printed above each; empty: none
  std::optional<Colour> colour{};   ///< else the palette's next
  Dash dash = Dash::solid;
  std::optional<Marker> marker{};  ///< of points, else the next one; of a line: drawn at its points, else none
  double width = 1.4;              ///< of lines and steps, points
  bool filled = false;             ///< of steps: down to zero
};

/// A horizontal line across the panel.
struct Reference {
  double y = 0.0;
  std::string label{};
  Dash dash = Dash::dashed;
  Colour colour = palette::muted;
};

/// A thin line between two points of the panel, or an arrow that ends beside the marker at `to`.
struct Connector {
  Point from{};
  Point to{};
  bool arrow = false;
};

/// A shaded interval of the x axis, over the panel's height or an interval of the y axis.
struct Shade {
  double from = 0.0;
  double to = 0.0;
  std::string name{};  ///< in the legend
  Colour colour = palette::shade;
  std::optional<std::pair<double, double>> y{};
};

/// Intervals of the x axis, marked in a strip above the panel.
struct Lane {
  std::string name{};  ///< in the legend
  Colour colour{};
  std::vector<std::pair<double, double>> stretches{};
};

struct Panel {
  std::string title{};  ///< of several lines, the last one is never left out
  Axis x{};
  Axis y{};
  std::vector<Series> series{};
  std::vector<Reference> references{};
  std::vector<Connector> connectors{};
  std::vector<Shade> shades{};
  std::vector<Lane> lanes{};
};

/// `automatic`: in a single panel where it covers no data, else above the panels.
enum class Legend : std::uint8_t { automatic, above, none };

/// Panels row by row, of equal size. Series of one name have one colour in all of them.
struct Figure {
  std::string title{};
  std::string caption{};
  std::vector<Panel> panels{};
  std::size_t columns = 1;
  bool share_x = false;  ///< one axis for all, with labels below the lowest panels only
  bool share_y = false;  ///< one axis for all, with labels left of the first column only
  double width = 504.0;  ///< points; larger only where the panels would not fit
  double panel_height = 150.0;
  Legend legend = Legend::automatic;
};

/// Draws a figure on white. Its panels and texts determine its height.
Canvas plot(const Figure& figure);

}  // namespace trellis::draw
