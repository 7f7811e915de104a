// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include <trellis/draw/chart.hpp>

/// The marks that plot() draws inside the frame of a panel.
namespace trellis::draw::marks {

/// Maps the numbers of an axis to points on paper.
class Scale {
 public:
  Scale() = default;
  Scale(const Extent& extent, AxisScale kind, double from, double to);

  /// Finite for all values except NaN: clamps values far outside to a position well outside.
  [[nodiscard]] double operator()(double value) const;
  /// The same, clamped to the edge.
  [[nodiscard]] double inside(double value) const;
  /// Returns -1 below the axis, 1 above it, else 0.
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

/// The layout of the texts above bars: smaller where they would overlap, vertical where that is not enough.
struct BarText {
  Font font{.size = 6.5};
  bool upright = false;
  double room = 0.0;  ///< height in points of the tallest text above its bar; 0: no texts
};
BarText bar_text(const Panel& panel, double width);

/// Returns the width of one bar's position: the least distance between two positions, 1 where there is only one.
double bar_pitch(const Panel& panel);

/// \throws Fault unless the vectors of each series have matching lengths.
void check(const Panel& panel);

std::vector<double> dashes(Dash dash, double width);
void marker(Canvas& canvas, Marker kind, Point at, const Colour& colour);
/// Draws an arrow with its tip at `tip`, pointing along (dx, dy), one of which is 0 and the other 1 or -1.
void arrow(Canvas& canvas, Point tip, int dx, int dy, const Colour& colour);

/// Draws series, connectors and reference lines. Every series has a colour and, where it needs one, a marker.
/// \return whether it marked anything at an edge
bool draw(Canvas& canvas, const Panel& panel, const Frame& frame);

/// Draws each label at the end of its line where it covers less ink of `ink`; adds the labels to `ink`.
void label_references(Canvas& canvas, Canvas& ink, const Panel& panel, const Frame& frame);

}  // namespace trellis::draw::marks
