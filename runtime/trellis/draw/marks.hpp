// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include <trellis/draw/chart.hpp>

/// What plot() draws inside the frame of a panel.
namespace trellis::draw::marks {

/// From the numbers of an axis to points on paper.
class Scale {
 public:
  Scale() = default;
  Scale(const Extent& extent, AxisScale kind, double from, double to);

  /// Finite for all but NaN: what is far outside is put well outside.
  [[nodiscard]] double operator()(double value) const;
  /// The same, put on the edge where it is outside.
  [[nodiscard]] double inside(double value) const;
  /// -1 below the axis, 1 above it, else 0.
  [[nodiscard]] int beyond(double value) const;
  [[nodiscard]] double from() const { return from_; }

 private:
  [[nodiscard]] double share(double value) const;

  Extent extent_{0.0, 1.0};
  AxisScale kind_ = AxisScale::linear;
  double from_ = 0.0;
  double to_ = 1.0;
};

struct Frame {
  Rect plot;
  Scale x;
  Scale y;
};

/// How the texts above bars are set: smaller where they would meet, upright where that is not enough.
struct BarText {
  Font font{.size = 6.5};
  bool upright = false;
  double room = 0.0;  ///< points that the tallest needs above its bar; 0: there are none
};
BarText bar_text(const Panel& panel, double width);

/// The width of one bar's place among its neighbours: the least distance between two, 1 where there is none.
double bar_pitch(const Panel& panel);

/// Throws Fault unless the vectors of each series fit each other.
void check(const Panel& panel);

std::vector<double> dashes(Dash dash, double width);
void marker(Canvas& canvas, Marker kind, Point at, const Colour& colour);
/// Its tip at `tip`, pointing along (dx, dy), one of which is 0 and the other 1 or -1.
void arrow(Canvas& canvas, Point tip, int dx, int dy, const Colour& colour);

/// Series, connectors and reference lines. Every series has a colour and, where it needs one, a marker.
/// Returns whether anything had to be marked at an edge.
bool draw(Canvas& canvas, const Panel& panel, const Frame& frame);

/// Each label at that end of its line where it covers least of what `ink` shows; adds the labels to `ink`.
void label_references(Canvas& canvas, Canvas& ink, const Panel& panel, const Frame& frame);

}  // namespace trellis::draw::marks
