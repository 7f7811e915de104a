// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/draw/marks.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <span>

#include <trellis/base/error.hpp>
#include <trellis/draw/text.hpp>

namespace trellis::draw::marks {

namespace {

constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();
constexpr double far_outside = 1e5;
constexpr double marker_radius = 2.3;
constexpr double arrow_length = 8.0;
constexpr double arrow_half = 2.4;
constexpr double cap_half = 2.0;
constexpr double band_alpha = 0.22;

double nth(const std::vector<double>& values, std::size_t i, double otherwise = not_a_number) {
  return values.empty() ? otherwise : values[i];
}

bool has_interval(const Series& s) { return !s.lo.empty() || !s.hi.empty(); }

/// Whether a point has coordinates, even beyond the edges.
bool known(double x, double y) { return !std::isnan(x) && !std::isnan(y); }
bool drawable(double x, double y) { return std::isfinite(x) && std::isfinite(y); }

/// Series of one kind stand side by side where two of them share an x position.
struct Places {
  std::size_t count = 1;
  double pitch = 0.0;                 ///< points from one position to the next
  std::vector<std::size_t> position;  ///< of each series of the panel

  [[nodiscard]] double width() const { return pitch * (count > 1 ? 0.8 : 0.66) / static_cast<double>(count); }
  [[nodiscard]] double shift(std::size_t series) const {
    if (count == 1) return 0.0;
    return (static_cast<double>(position[series]) - 0.5 * static_cast<double>(count - 1)) * width();
  }
};

Places places(const Panel& panel, const Frame& frame, Series::Kind kind) {
  Places found;
  found.position.resize(panel.series.size(), 0);
  std::vector<double> seen;
  std::size_t count = 0;
  bool met = false;
  for (std::size_t s = 0; s < panel.series.size(); ++s) {
    const Series& series = panel.series[s];
    if (series.kind != kind) continue;
    found.position[s] = count++;
    for (const double x : series.x) met = met || std::find(seen.begin(), seen.end(), x) != seen.end();
    seen.insert(seen.end(), series.x.begin(), series.x.end());
  }
  if (met) found.count = count;
  if (!panel.x.categories.empty()) {
    found.pitch = std::abs(frame.x(1.0) - frame.x(0.0));
    return found;
  }
  // Points stay at their numbers; only categories have space beside them.
  if (kind == Series::Kind::points) found.count = 1;
  std::vector<double> at;
  for (const double x : seen) {
    if (!std::isnan(x)) at.push_back(frame.x(x));
  }
  std::sort(at.begin(), at.end());
  found.pitch = 0.3 * frame.plot.width;
  for (std::size_t i = 1; i < at.size(); ++i) {
    if (at[i] - at[i - 1] > 1e-9) found.pitch = std::min(found.pitch, at[i] - at[i - 1]);
  }
  return found;
}

/// Draws one panel's marks; `beyond` records whether an edge mark was necessary.
class Marks {
 public:
  Marks(Canvas& canvas, const Panel& panel, const Frame& frame) : canvas_(canvas), panel_(panel), frame_(frame) {}

  bool draw() {
    const Places bars = places(panel_, frame_, Series::Kind::bars);
    const Places points = places(panel_, frame_, Series::Kind::points);
    {
      // The clip leaves a line on the edge its full width.
      const auto inside = canvas_.clip(Path::rectangle(frame_.plot.grown(0.8)));
      each(Series::Kind::steps, [&](const Series& s, std::size_t) { step_area(s); });
      each(Series::Kind::line, [&](const Series& s, std::size_t) { band(s); });
      each(Series::Kind::bars, [&](const Series& s, std::size_t i) { bar_areas(s, i, bars); });
      for (const auto& connector : panel_.connectors) {
        const Point from = place(connector.from.x, connector.from.y);
        const Point to = place(connector.to.x, connector.to.y);
        if (!known(from.x, from.y) || !known(to.x, to.y)) continue;
        if (connector.arrow) {
          arrow_between(from, to);
        } else {
          canvas_.line(from, to, {palette::muted, 0.6});
        }
      }
      for (const auto& reference : panel_.references) {
        if (std::isnan(reference.y) || frame_.y.beyond(reference.y) != 0) continue;
        const double y = frame_.y(reference.y);
        canvas_.line({frame_.plot.x, y}, {frame_.plot.right(), y},
                     {reference.colour, 0.8, dashes(reference.dash, 0.8), Cap::butt});
      }
      each(Series::Kind::steps, [&](const Series& s, std::size_t) { step_line(s); });
      each(Series::Kind::line, [&](const Series& s, std::size_t) { line(s); });
    }
    each(Series::Kind::line, [&](const Series& s, std::size_t) { line_points(s); });
    each(Series::Kind::bars, [&](const Series& s, std::size_t i) { bar_whiskers(s, i, bars); });
    each(Series::Kind::points, [&](const Series& s, std::size_t i) { points_of(s, i, points); });
    for (const auto& reference : panel_.references) {
      if (std::isnan(reference.y)) continue;
      if (const int off = frame_.y.beyond(reference.y); off != 0) {
        edge({0.5 * (frame_.plot.x + frame_.plot.right()), 0.0}, 0, off, reference.colour);
      }
    }
    add_obstacles(bars);
    each(Series::Kind::bars, [&](const Series& s, std::size_t i) { bar_texts(s, i, bars); });
    return beyond_;
  }

 private:
  void each(Series::Kind kind, const std::function<void(const Series&, std::size_t)>& act) {
    for (std::size_t s = 0; s < panel_.series.size(); ++s) {
      if (panel_.series[s].kind == kind) act(panel_.series[s], s);
    }
  }

  [[nodiscard]] Point place(double x, double y) const { return {frame_.x(x), frame_.y(y)}; }

  /// Draws an arrow between two markers, with space for both.
  void arrow_between(Point from, Point to) {
    const double length = std::hypot(to.x - from.x, to.y - from.y);
    constexpr double room = marker_radius + 1.2;
    constexpr double head = 4.5;
    if (length <= 2.0 * room + 1.0) return;
    const Point along{(to.x - from.x) / length, (to.y - from.y) / length};
    const auto at = [&](double back, double aside) {
      return Point{to.x - along.x * (room + back) - along.y * aside, to.y - along.y * (room + back) + along.x * aside};
    };
    const double tail = std::min(head, length - 2.0 * room);
    canvas_.line({from.x + along.x * room, from.y + along.y * room}, at(0.5 * tail, 0.0), {palette::muted, 0.8});
    canvas_.fill(Path::polygon(std::array{at(0.0, 0.0), at(tail, 1.7), at(tail, -1.7)}), palette::muted);
  }

  /// Draws an arrow at the edge, at the height of `at`.
  void edge(Point at, int dx, int dy, const Colour& colour) {
    beyond_ = true;
    const Rect& plot = frame_.plot;
    Point tip{std::clamp(at.x, plot.x, plot.right()), std::clamp(at.y, plot.y, plot.bottom())};
    if (dy != 0) {
      tip.y = dy > 0 ? plot.y : plot.bottom();
      arrow(canvas_, tip, 0, -dy, colour);
    } else {
      tip.x = dx > 0 ? plot.right() : plot.x;
      arrow(canvas_, tip, dx, 0, colour);
    }
  }

  /// Marks (x, y) at an edge where it is infinite or, with `ends`, beyond an end. \return whether it did
  bool edge_of(double x, double y, double shift, const Colour& colour, bool ends) {
    const auto off = [ends](const Scale& scale, double v) {
      return ends || !std::isfinite(v) || std::abs(v) > most_number ? scale.beyond(v) : 0;
    };
    const int dx = off(frame_.x, x);
    const int dy = off(frame_.y, y);
    if (dx == 0 && dy == 0) return false;
    edge({frame_.x(x) + shift, frame_.y(y)}, dx, dy, colour);
    return true;
  }

  // Lines. A run is a sequence of points without a gap.
  template <class Use>
  void runs(std::size_t size, const std::function<bool(std::size_t)>& in, const Use& use) {
    for (std::size_t from = 0; from < size;) {
      std::size_t to = from;
      while (to < size && in(to)) ++to;
      if (to > from) use(from, to);
      from = std::max(to, from + 1);
    }
  }

  void band(const Series& s) {
    if (!has_interval(s)) return;
    const auto lo = [&](std::size_t i) { return nth(s.lo, i, s.y[i]); };
    const auto hi = [&](std::size_t i) { return nth(s.hi, i, s.y[i]); };
    const auto in = [&](std::size_t i) { return std::isfinite(s.x[i]) && known(lo(i), hi(i)); };
    runs(s.y.size(), in, [&](std::size_t from, std::size_t to) {
      if (to - from == 1) {
        whisker(frame_.x(s.x[from]), lo(from), hi(from), *s.colour);
        return;
      }
      std::vector<Point> outline;
      for (std::size_t i = from; i < to; ++i) outline.push_back(place(s.x[i], hi(i)));
      for (std::size_t i = to; i-- > from;) outline.push_back(place(s.x[i], lo(i)));
      canvas_.fill(Path::polygon(outline), s.colour->faded(band_alpha));
    });
  }

  void line(const Series& s) {
    const auto in = [&](std::size_t i) { return drawable(s.x[i], s.y[i]) && std::abs(s.y[i]) <= most_number; };
    runs(s.y.size(), in, [&](std::size_t from, std::size_t to) {
      std::vector<Point> at;
      for (std::size_t i = from; i < to; ++i) at.push_back(place(s.x[i], s.y[i]));
      const bool dot = std::all_of(at.begin(), at.end(), [&](Point p) {
        return std::abs(p.x - at[0].x) < 0.5 * s.width && std::abs(p.y - at[0].y) < 0.5 * s.width;
      });
      if (dot) {
        canvas_.fill(Path::circle(at[0], s.width), *s.colour);
      } else {
        canvas_.stroke(Path::polyline(at), {*s.colour, s.width, dashes(s.dash, s.width), Cap::butt});
      }
    });
  }

  /// Marks an infinite interval; the clip handles one that only leaves the frame.
  void endless(const Series& s, std::size_t i, double x) {
    for (const double v : {nth(s.lo, i), nth(s.hi, i)}) {
      if (std::isinf(v)) edge({x, 0.0}, 0, v > 0.0 ? 1 : -1, *s.colour);
    }
  }

  /// Draws the marks of a line that the frame does not clip.
  void line_points(const Series& s) {
    for (std::size_t i = 0; i < s.y.size(); ++i) {
      if (std::isfinite(s.x[i])) endless(s, i, frame_.x.inside(s.x[i]));
      if (!known(s.x[i], s.y[i]) || edge_of(s.x[i], s.y[i], 0.0, *s.colour, false) || !s.marker) continue;
      if (frame_.x.beyond(s.x[i]) != 0 || frame_.y.beyond(s.y[i]) != 0) continue;
      draw::marks::marker(canvas_, *s.marker, place(s.x[i], s.y[i]), *s.colour);
    }
  }

  // Steps.
  [[nodiscard]] bool bin(const Series& s, std::size_t i) const { return known(s.x[i], s.x[i + 1]); }

  /// Fills the area between two heights, over all bins where both exist; one polygon for adjacent bins, so that no seam
  /// shows.
  void between(const Series& s, const std::function<double(std::size_t)>& lo,
               const std::function<double(std::size_t)>& hi, double alpha) {
    const auto in = [&](std::size_t i) { return bin(s, i) && known(lo(i), hi(i)); };
    runs(s.y.size(), in, [&](std::size_t from, std::size_t to) {
      std::vector<Point> outline;
      const auto add = [&](double x, double y) { outline.push_back({frame_.x.inside(x), frame_.y.inside(y)}); };
      for (std::size_t i = from; i < to; ++i) {
        add(s.x[i], hi(i));
        add(s.x[i + 1], hi(i));
      }
      for (std::size_t i = to; i-- > from;) {
        add(s.x[i + 1], lo(i));
        add(s.x[i], lo(i));
      }
      canvas_.fill(Path::polygon(outline), s.colour->faded(alpha));
    });
  }

  void step_area(const Series& s) {
    const auto height = [&](std::size_t i) { return s.y[i]; };
    if (s.filled)
      between(
          s, [](std::size_t) { return 0.0; }, height, 0.18);
    if (!has_interval(s)) return;
    const auto lo = [&](std::size_t i) { return nth(s.lo, i, s.y[i]); };
    between(
        s, lo, [&](std::size_t i) { return nth(s.hi, i, s.y[i]); }, band_alpha);
  }

  void step_line(const Series& s) {
    const auto in = [&](std::size_t i) { return bin(s, i) && std::isfinite(s.y[i]); };
    runs(s.y.size(), in, [&](std::size_t from, std::size_t to) {
      std::vector<Point> at;
      for (std::size_t i = from; i < to; ++i) {
        const double y = frame_.y(s.y[i]);
        at.push_back({frame_.x(s.x[i]), y});
        at.push_back({frame_.x(s.x[i + 1]), y});
      }
      canvas_.stroke(Path::polyline(at), {*s.colour, s.width, dashes(s.dash, s.width), Cap::butt, Join::miter});
    });
    for (std::size_t i = 0; i < s.y.size(); ++i) {
      if (!bin(s, i)) continue;
      const double middle = 0.5 * (frame_.x.inside(s.x[i]) + frame_.x.inside(s.x[i + 1]));
      endless(s, i, middle);
      if (std::isnan(s.y[i])) continue;
      if (const int off = frame_.y.beyond(s.y[i]); off != 0) edge({middle, 0.0}, 0, off, *s.colour);
    }
  }

  // Error bars.
  void whisker(double x, double lo, double hi, const Colour& colour, bool on_bar = false) {
    if (on_bar && known(lo, hi) && lo != hi) {
      // Visible on a dark bar too.
      canvas_.line({x, frame_.y.inside(lo)}, {x, frame_.y.inside(hi)}, {palette::paper.faded(0.6), 2.0});
    }
    const auto end = [&](double v) {
      const double y = frame_.y.inside(v);
      if (const int off = frame_.y.beyond(v); off != 0) {
        edge({x, 0.0}, 0, off, colour);
      } else {
        canvas_.line({x - cap_half, y}, {x + cap_half, y}, {colour, 0.8});
      }
      return y;
    };
    // Skip an interval of zero width.
    if (!known(lo, hi) || lo == hi || x < frame_.plot.x - 1.0 || x > frame_.plot.right() + 1.0) return;
    const double from = end(std::min(lo, hi));
    const double to = end(std::max(lo, hi));
    canvas_.line({x, from}, {x, to}, {colour, 0.8});
  }

  /// Draws the interval of x of a point at a height, clipped to the frame.
  void whisker_across(double y, double lo, double hi, const Colour& colour) {
    if (!known(lo, hi) || lo == hi || y < frame_.plot.y - 1.0 || y > frame_.plot.bottom() + 1.0) return;
    const double from = frame_.x.inside(lo);
    const double to = frame_.x.inside(hi);
    canvas_.line({from, y}, {to, y}, {colour, 0.8});
    for (const double x : {from, to}) canvas_.line({x, y - cap_half}, {x, y + cap_half}, {colour, 0.8});
  }

  void points_of(const Series& s, std::size_t index, const Places& at) {
    const double shift = at.shift(index);
    for (std::size_t i = 0; i < s.y.size(); ++i) {
      if (!known(s.x[i], s.y[i])) continue;
      if (frame_.x.beyond(s.x[i]) == 0 && has_interval(s)) {
        whisker(frame_.x(s.x[i]) + shift, nth(s.lo, i, s.y[i]), nth(s.hi, i, s.y[i]), *s.colour);
      }
      if (!s.x_lo.empty() || !s.x_hi.empty()) {
        whisker_across(frame_.y(s.y[i]), nth(s.x_lo, i, s.x[i]), nth(s.x_hi, i, s.x[i]), *s.colour);
      }
      if (edge_of(s.x[i], s.y[i], shift, *s.colour, true)) continue;
      const Point p = place(s.x[i], s.y[i]);
      draw::marks::marker(canvas_, *s.marker, {p.x + shift, p.y}, *s.colour);
    }
  }

  // Bars.
  [[nodiscard]] double base(const Series& s, std::size_t i) const { return nth(s.base, i, 0.0); }

  void bar_areas(const Series& s, std::size_t index, const Places& at) {
    const double half = 0.5 * at.width();
    for (std::size_t i = 0; i < s.y.size(); ++i) {
      if (!known(s.x[i], s.y[i]) || std::isnan(base(s, i)) || frame_.x.beyond(s.x[i]) != 0) continue;
      const double x = frame_.x(s.x[i]) + at.shift(index);
      const double from = frame_.y.inside(base(s, i));
      const double to = frame_.y.inside(s.y[i]);
      // A bar of zero length remains visible.
      const double height = std::max(std::abs(to - from), 0.8);
      canvas_.fill(Path::rectangle({x - half, std::min(from, to) - (height > 0.8 ? 0.0 : 0.4), 2.0 * half, height}),
                   *s.colour);
    }
  }

  void bar_whiskers(const Series& s, std::size_t index, const Places& at) {
    for (std::size_t i = 0; i < s.y.size(); ++i) {
      if (!known(s.x[i], s.y[i]) || std::isnan(base(s, i))) continue;
      if (edge_of(s.x[i], s.y[i], at.shift(index), palette::ink, true) || !has_interval(s)) continue;
      whisker(frame_.x(s.x[i]) + at.shift(index), nth(s.lo, i, s.y[i]), nth(s.hi, i, s.y[i]), palette::ink, true);
    }
  }

  /// Adds what a text beside bars must not cover: the bars, their whiskers and arrows, connectors and the zero line.
  void add_obstacles(const Places& at) {
    const Rect& plot = frame_.plot;
    const auto add = [&](Point a, Point b, double width) {
      taken_.push_back(
          Rect{std::min(a.x, b.x), std::min(a.y, b.y), std::abs(a.x - b.x), std::abs(a.y - b.y)}.grown(0.5 * width));
    };
    each(Series::Kind::bars, [&](const Series& s, std::size_t index) {
      for (std::size_t i = 0; i < s.y.size(); ++i) {
        if (!known(s.x[i], s.y[i]) || std::isnan(base(s, i)) || frame_.x.beyond(s.x[i]) != 0) continue;
        const double x = frame_.x(s.x[i]) + at.shift(index);
        const double half = 0.5 * at.width();
        add({x - half, frame_.y.inside(base(s, i))}, {x + half, frame_.y.inside(s.y[i])}, 0.8);
        double lowest = s.y[i];
        double highest = s.y[i];
        for (const double v : {nth(s.lo, i), nth(s.hi, i)}) {
          if (std::isnan(v)) continue;
          lowest = std::min(lowest, v);
          highest = std::max(highest, v);
        }
        add({x - cap_half, frame_.y.inside(lowest)}, {x + cap_half, frame_.y.inside(highest)}, 0.8);
        if (frame_.y.beyond(highest) > 0) add({x - arrow_half, plot.y}, {x + arrow_half, plot.y + arrow_length}, 1.2);
        if (frame_.y.beyond(lowest) < 0) {
          add({x - arrow_half, plot.bottom() - arrow_length}, {x + arrow_half, plot.bottom()}, 1.2);
        }
      }
    });
    for (const auto& connector : panel_.connectors) {
      const Point from = place(connector.from.x, connector.from.y);
      const Point to = place(connector.to.x, connector.to.y);
      if (known(from.x, from.y) && known(to.x, to.y)) add(from, to, 0.6);
    }
    if (panel_.y.scale == AxisScale::linear && frame_.y.beyond(0.0) == 0) {
      add({plot.x, frame_.y(0.0)}, {plot.right(), frame_.y(0.0)}, 0.6);
    }
  }

  /// Returns the area of a text that covers other marks.
  [[nodiscard]] double covered(const Rect& text) const {
    double area = 0.0;
    for (const Rect& other : taken_) {
      const double wide = std::min(text.right(), other.right()) - std::max(text.x, other.x);
      const double high = std::min(text.bottom(), other.bottom()) - std::max(text.y, other.y);
      if (wide > 0.0 && high > 0.0) area += wide * high;
    }
    return area;
  }

  /// Prints the texts of bars above them, or as near as there is a place where they cover nothing.
  void bar_texts(const Series& s, std::size_t index, const Places& at) {
    if (s.text.empty()) return;
    const BarText set = bar_text(panel_, frame_.plot.width);
    const Rect& plot = frame_.plot;
    for (std::size_t i = 0; i < s.y.size(); ++i) {
      if (std::isnan(s.x[i]) || frame_.x.beyond(s.x[i]) != 0 || s.text[i].empty()) continue;
      double top = plot.bottom();
      double bottom = plot.y;
      const bool cut = !std::isnan(s.y[i]) && frame_.y.beyond(s.y[i]) != 0;
      for (const double v :
           {base(s, i), s.y[i], cut ? not_a_number : nth(s.lo, i), cut ? not_a_number : nth(s.hi, i)}) {
        if (std::isnan(v)) continue;
        top = std::min(top, frame_.y.inside(v));
        bottom = std::max(bottom, frame_.y.inside(v));
      }
      const TextExtents size = text_extents(s.text[i], set.font);
      const double height = set.upright ? size.width : size.cap;
      const double width = set.upright ? size.cap : size.width;
      // A text may be wider than its bar, but stays beside the axis.
      const double x = std::max(frame_.x(s.x[i]) + at.shift(index), plot.x + 0.5 * width + 1.0);
      Rect best;
      double least = std::numeric_limits<double>::infinity();
      const auto attempt = [&](double y, double penalty) {
        const Rect rect{x - 0.5 * width, y, width, height};
        if (rect.y < plot.y + 1.0 || rect.bottom() > plot.bottom() - 1.0) return;
        const double cost = 1000.0 * covered(rect.grown(0.7)) + penalty;
        if (cost >= least) return;
        least = cost;
        best = rect;
      };
      constexpr double away = 2.0;    // from the bar
      constexpr double below = 10.0;  // points of distance that a place below costs more
      for (double shift = 0.0; shift < plot.height; shift += 1.5) {
        attempt(top - away - height - shift, shift);
        attempt(bottom + away + shift, shift + below);
        if (least <= shift) break;
      }
      if (!std::isfinite(least)) best = {x - 0.5 * width, plot.y + 1.0, width, height};
      if (covered(best) > 0.0) canvas_.fill(Path::rectangle(best.grown(1.0)), palette::paper.faded(0.85));
      TextStyle style{set.font, palette::ink, Align::centre};
      if (set.upright) style = {set.font, palette::ink, Align::left, Stand::middle, 90.0};
      canvas_.text(s.text[i], {x, best.bottom()}, style);
      taken_.push_back(best);
    }
  }

  Canvas& canvas_;
  const Panel& panel_;
  const Frame& frame_;
  std::vector<Rect> taken_;  ///< where texts of bars would cover a mark
  bool beyond_ = false;
};

}  // namespace

Scale::Scale(const Extent& extent, AxisScale kind, double from, double to)
    : extent_(extent), kind_(kind), from_(from), to_(to) {}

double Scale::share(double value) const {
  if (kind_ == AxisScale::linear) return (value - extent_.lo) / (extent_.hi - extent_.lo);
  if (value <= 0.0) return -std::numeric_limits<double>::infinity();
  const double from = std::log(extent_.lo);
  return (std::log(value) - from) / (std::log(extent_.hi) - from);
}

double Scale::operator()(double value) const {
  if (std::isnan(value)) return value;
  const double at = from_ + (to_ - from_) * share(value);
  return std::clamp(at, std::min(from_, to_) - far_outside, std::max(from_, to_) + far_outside);
}

double Scale::inside(double value) const {
  return std::clamp((*this)(value), std::min(from_, to_), std::max(from_, to_));
}

int Scale::beyond(double value) const {
  // A rounding error is not beyond the edge.
  constexpr double slack = 1e-9;
  const double at = share(value);
  return at < -slack ? -1 : at > 1.0 + slack ? 1 : 0;
}

double bar_pitch(const Panel& panel) {
  std::vector<double> at;
  for (const auto& series : panel.series) {
    if (series.kind != Series::Kind::bars) continue;
    std::copy_if(series.x.begin(), series.x.end(), std::back_inserter(at),
                 [](double x) { return std::abs(x) <= most_number; });
  }
  std::sort(at.begin(), at.end());
  double pitch = std::numeric_limits<double>::infinity();
  for (std::size_t i = 1; i < at.size(); ++i) {
    if (at[i] > at[i - 1]) pitch = std::min(pitch, at[i] - at[i - 1]);
  }
  return std::isfinite(pitch) ? pitch : 1.0;
}

BarText bar_text(const Panel& panel, double width) {
  BarText set;
  std::vector<const std::string*> texts;
  for (const auto& series : panel.series) {
    for (const auto& text : series.text) {
      if (!text.empty()) texts.push_back(&text);
    }
  }
  if (texts.empty()) return set;
  const std::size_t count = panel.x.categories.empty() ? texts.size() : panel.x.categories.size();
  const double pitch = width / static_cast<double>(std::max<std::size_t>(count, 1)) - 3.0;
  const auto widest = [&] {
    double most = 0.0;
    for (const auto* text : texts) most = std::max(most, text_extents(*text, set.font).width);
    return most;
  };
  constexpr double smallest = 5.5;
  if (const double needed = widest(); needed > pitch) {
    if (needed * smallest / set.font.size <= pitch) {
      set.font.size *= pitch / needed;
    } else {
      set.font.size = smallest;
      set.upright = true;
    }
  }
  set.room = (set.upright ? widest() : text_extents("0", set.font).cap) + 6.0;
  return set;
}

void check(const Panel& panel) {
  for (const auto& s : panel.series) {
    const std::size_t n = s.y.size();
    const bool steps = s.kind == Series::Kind::steps;
    const bool fits = s.x.size() == n + (steps && n > 0 ? 1 : 0) || (steps && n == 0 && s.x.size() <= 1);
    const auto optional = [n](std::size_t size) { return size == 0 || size == n; };
    if (!fits || !optional(s.lo.size()) || !optional(s.hi.size()) || !optional(s.base.size()) ||
        !optional(s.text.size()) || !optional(s.x_lo.size()) || !optional(s.x_hi.size())) {
      throw Fault(fmt::format("a chart's series '{}' has {} x, {} y, {} lo, {} hi, {} base, {} text", s.name,
                              s.x.size(), n, s.lo.size(), s.hi.size(), s.base.size(), s.text.size()));
    }
  }
  for (const Axis* axis : {&panel.x, &panel.y}) {
    const auto proper = [axis](double v) {
      return std::abs(v) <= most_number && (axis->scale == AxisScale::linear || v > 1.0 / most_number);
    };
    const bool ends = (!axis->lo || proper(*axis->lo)) && (!axis->hi || proper(*axis->hi));
    if (!ends || (axis->lo && axis->hi && !(*axis->lo < *axis->hi))) {
      throw Fault(fmt::format("a chart's axis '{}' has improper ends", axis->label));
    }
  }
}

std::vector<double> dashes(Dash dash, double width) {
  switch (dash) {
    case Dash::solid: return {};
    case Dash::dashed: return {2.0 + 2.0 * width, 1.4 + 1.2 * width};
    case Dash::dotted: return {width, 1.0 + width};
  }
  return {};
}

void marker(Canvas& canvas, Marker kind, Point at, const Colour& colour) {
  const double r = marker_radius;
  const Pen edge{palette::paper, 0.5};
  const auto shape = [&](const Path& path) {
    canvas.fill(path, colour);
    canvas.stroke(path, edge);
  };
  switch (kind) {
    case Marker::circle: shape(Path::circle(at, r)); break;
    case Marker::square: shape(Path::rectangle({at.x - 0.9 * r, at.y - 0.9 * r, 1.8 * r, 1.8 * r})); break;
    case Marker::diamond:
      shape(Path::polygon(std::array{Point{at.x, at.y - 1.3 * r}, Point{at.x + 1.3 * r, at.y},
                                     Point{at.x, at.y + 1.3 * r}, Point{at.x - 1.3 * r, at.y}}));
      break;
    case Marker::ring:
      canvas.fill(Path::circle(at, r), palette::paper);
      canvas.stroke(Path::circle(at, r - 0.3), {colour, 1.1});
      break;
    case Marker::cross: {
      const double d = 0.85 * r;
      Path path;
      path.move_to({at.x - d, at.y - d}).line_to({at.x + d, at.y + d});
      path.move_to({at.x - d, at.y + d}).line_to({at.x + d, at.y - d});
      canvas.stroke(path, {colour, 1.4, {}, Cap::butt});
      break;
    }
  }
}

void arrow(Canvas& canvas, Point tip, int dx, int dy, const Colour& colour) {
  // `along` is the distance back from the tip, `across` the distance to its side.
  const auto at = [&](double along, double across) {
    return Point{tip.x - dx * along - dy * across, tip.y - dy * along + dx * across};
  };
  constexpr double head = 5.0;
  const Path shape = Path::polygon(std::array{at(0.3, 0), at(head, arrow_half), at(head, 0.5), at(arrow_length, 0.5),
                                              at(arrow_length, -0.5), at(head, -0.5), at(head, -arrow_half)});
  canvas.stroke(shape, {palette::paper, 1.2});
  canvas.fill(shape, colour);
}

bool draw(Canvas& canvas, const Panel& panel, const Frame& frame) { return Marks(canvas, panel, frame).draw(); }

void label_references(Canvas& canvas, Canvas& ink, const Panel& panel, const Frame& frame) {
  const Font font{.size = 7.0};
  const Rect& plot = frame.plot;
  for (const auto& reference : panel.references) {
    if (std::isnan(reference.y) || reference.label.empty()) continue;
    const std::string text = shorten(reference.label, plot.width - 8.0, font);
    const TextExtents size = text_extents(text, font);
    const double y = frame.y.inside(reference.y);
    const Ink seen = ink.ink(1.0);
    Rect best;
    double least = std::numeric_limits<double>::infinity();
    for (const double top : {y - size.height() - 1.0, y + 1.5}) {
      for (const double share : {1.0, 0.0, 0.5, 0.75, 0.25}) {
        const Rect rect{plot.x + 3.0 + share * (plot.width - 6.0 - size.width), top, size.width, size.height()};
        if (rect.y < plot.y || rect.bottom() > plot.bottom()) continue;
        if (const double covered = seen.in(rect); covered < least - 0.5) {
          least = covered;
          best = rect;
        }
      }
    }
    if (!std::isfinite(least)) best = {plot.x + 3.0, std::max(plot.y, y - size.height()), size.width, size.height()};
    canvas.fill(Path::rectangle({best.x - 1.0, best.y, best.width + 2.0, best.height}), palette::paper.faded(0.75));
    canvas.text(text, {best.x, best.y}, {font, reference.colour, Align::left, Stand::top});
    ink.fill(Path::rectangle(best), palette::ink);
  }
}

}  // namespace trellis::draw::marks
