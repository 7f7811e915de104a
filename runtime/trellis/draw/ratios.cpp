// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/draw/ratios.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <trellis/base/error.hpp>
#include <trellis/draw/page.hpp>
#include <trellis/draw/text.hpp>
#include <trellis/draw/ticks.hpp>

namespace trellis::draw {

namespace {

using namespace page;  // NOLINT(google-build-using-namespace): what all pictures have in common

constexpr double lane = 6.5;        ///< height of a group's line in a row
constexpr double row_margin = 3.5;  ///< above and below a row's lines
constexpr double dot_radius = 2.1;
constexpr double most_name = 110.0;  ///< width of a row's name
constexpr double name_gap = 6.0;
constexpr double tick_length = 3.0;
constexpr double cut_length = 4.0;  ///< of the arrowhead of an interval that continues beyond the axis
constexpr double cut_half = 2.0;
constexpr double label_gap = 9.0;  ///< between the axis and the label of a row's largest dot
constexpr Font label_small{.size = 6.0};
constexpr Colour stripe = rgb(0xF5F5F5);
constexpr double widest_labels = 0.35;  ///< of a panel's width: names of dots, which may be shortened
constexpr double widest_texts = 0.55;   ///< of a panel's width: numbers, which may not
constexpr double farthest = 10.0;       ///< the axis covers intervals up to so many times beyond dots and lines

/// Whether a logarithmic axis can show a ratio.
bool on_axis(double ratio) { return std::isfinite(ratio) && ratio > 0.0; }

class Plot {
 public:
  explicit Plot(const RatioFigure& figure) : figure_(figure) {
    for (const RatioRow& row : figure.rows) {
      if (row.panels.size() != figure.panels.size()) throw Fault("a row of ratios has other panels than its figure");
    }
    lay_out();
  }

  Canvas draw() {
    Canvas canvas(figure_.width, height_);
    canvas.fill(Path::rectangle({0.0, 0.0, figure_.width, height_}), palette::paper);
    block(canvas, title_, {border, border}, {title_font, palette::ink});
    legend(canvas);
    for (std::size_t r = 0; r < figure_.rows.size(); ++r) {
      if (r % 2 == 0) canvas.fill(Path::rectangle({border, row_top(r), figure_.width - 2.0 * border, row_}), stripe);
      const auto& lines = names_[r];
      block(canvas, lines, {border + 2.0, row_top(r) + 0.5 * (row_ - block_height(lines, tick_font))},
            {tick_font, palette::ink});
    }
    for (std::size_t p = 0; p < figure_.panels.size(); ++p) panel(canvas, p);
    block(canvas, caption_, {border, bottom_ + below_ + 6.0}, {caption_font, palette::muted});
    return canvas;
  }

 private:
  void lay_out() {
    double widest = 0.0;
    for (const RatioRow& row : figure_.rows) {
      names_.push_back(wrapped(row.name, most_name, tick_font, 3));
      for (const auto& line : names_.back()) widest = std::max(widest, text_extents(line, tick_font).width);
    }
    const auto n = static_cast<double>(std::max<std::size_t>(figure_.panels.size(), 1));
    left_ = border + 2.0 + widest + name_gap;
    panel_width_ = (figure_.width - left_ - border - 6.0 - gap * (n - 1.0)) / n;
    for (const RatioRow& row : figure_.rows) {
      for (const auto& dots : row.panels) {
        for (const RatioDot& one : dots) {
          const double most = (one.text.empty() ? widest_labels : widest_texts) * panel_width_;
          const double needed = text_extents(label_of(one), label_small).width + label_gap;
          label_room_ = std::max(label_room_, std::min(needed, most));
        }
      }
    }
    x_label_ = wrapped(figure_.x_label, panel_width_ - label_room_, label_font, 6);
    title_ = wrapped(figure_.title, figure_.width - 2.0 * border, title_font, 3);
    caption_ = wrapped(figure_.caption, figure_.width - 2.0 * border, caption_font, 40);
    std::vector<std::string> entries;
    // A single group needs no name.
    if (figure_.groups.size() > 1) shown_ = figure_.groups.size();
    for (std::size_t g = 0; g < shown_; ++g) entries.push_back(figure_.groups[g].name);
    medians_ = std::any_of(figure_.rows.begin(), figure_.rows.end(), [](const RatioRow& row) {
      return std::any_of(row.panels.begin(), row.panels.end(), [](const auto& dots) { return dots.size() > 1; });
    });
    if (medians_) entries.emplace_back("median of all problems");
    entries_ = flow(entries, figure_.width - 2.0 * border);
    double y = border + block_height(title_, title_font) + 4.0;
    legend_top_ = y;
    y += entries_.height + line_height(panel_font) + 2.0 + line_height(label_small) + 3.0;
    top_ = y;
    row_ = 2.0 * row_margin + lane * static_cast<double>(std::max<std::size_t>(figure_.groups.size(), 3));
    bottom_ = top_ + row_ * static_cast<double>(figure_.rows.size());
    below_ = tick_length + 3.0 + line_height(tick_font) + 2.0 + block_height(x_label_, label_font);
    height_ = bottom_ + below_ + (caption_.empty() ? 0.0 : 6.0 + block_height(caption_, caption_font)) + border;

    extent_ = ratio_extent(figure_);
  }

  [[nodiscard]] double row_top(std::size_t row) const { return top_ + row_ * static_cast<double>(row); }

  void legend(Canvas& canvas) const {
    const double middle = 0.5 * line_height(legend_font);
    for (std::size_t g = 0; g < shown_ + (medians_ ? 1 : 0); ++g) {
      const Point at{border + entries_.at[g].x, legend_top_ + entries_.at[g].y};
      const Point centre{at.x + 0.5 * swatch, at.y + middle};
      if (g < shown_) {
        canvas.line({at.x + 1.0, centre.y}, {at.x + swatch - 1.0, centre.y}, whisker(figure_.groups[g]));
        dot(canvas, figure_.groups[g], centre);
        entry_name(canvas, figure_.groups[g].name, at);
      } else {
        canvas.line({centre.x, at.y}, {centre.x, at.y + 2.0 * middle}, {palette::ink, 1.6});
        entry_name(canvas, "median of all problems", at);
      }
    }
  }

  static Pen whisker(const RatioGroup& group) { return {group.colour.faded(0.45), 0.8}; }

  static void dot(Canvas& canvas, const RatioGroup& group, Point at) {
    const Path circle = Path::circle(at, dot_radius);
    canvas.fill(circle, group.open ? palette::paper : group.colour.faded(0.85));
    canvas.stroke(circle, {group.colour, 0.9});
  }

  void panel(Canvas& canvas, std::size_t p) const {
    const double x0 = left_ + static_cast<double>(p) * (panel_width_ + gap);
    const marks::Scale x(extent_, AxisScale::log, x0, x0 + panel_width_ - label_room_);
    const Ticks ticks =
        log_ticks(extent_, static_cast<std::size_t>(std::max(2.0, (panel_width_ - label_room_) / 34.0)));
    for (const double at : ticks.at) canvas.line({x.inside(at), top_}, {x.inside(at), bottom_}, {palette::grid, 0.5});
    canvas.text(figure_.panels[p], {x0, top_ - line_height(label_small) - 5.0},
                {panel_font, palette::ink, Align::left, Stand::bottom});
    lines(canvas, x, x0);
    if (label_room_ > 0.0) {
      canvas.text(figure_.texts, {x0 + panel_width_ - label_room_ + label_gap, top_ - 3.0},
                  {label_small, palette::muted, Align::left, Stand::bottom});
    }
    for (std::size_t r = 0; r < figure_.rows.size(); ++r) row(canvas, figure_.rows[r].panels[p], r, x);
    canvas.line({x0, bottom_}, {x0 + panel_width_ - label_room_, bottom_}, {palette::frame, 0.8, {}, Cap::square});
    for (std::size_t i = 0; i < ticks.at.size(); ++i) {
      const double at = x.inside(ticks.at[i]);
      canvas.line({at, bottom_}, {at, bottom_ + tick_length}, {palette::frame, 0.8});
      canvas.text(ticks.labels[i], {at, bottom_ + tick_length + 2.0},
                  {tick_font, palette::ink, Align::centre, Stand::top});
    }
    for (const double minor : ticks.minor) {
      const double at = x.inside(minor);
      canvas.line({at, bottom_}, {at, bottom_ + 0.55 * tick_length}, {palette::frame, 0.5});
    }
    block(canvas, x_label_,
          {x0 + 0.5 * (panel_width_ - label_room_), bottom_ + tick_length + 4.0 + line_height(tick_font)},
          {label_font, palette::ink, Align::centre});
  }

  /// "cup 2.3". Where there is no room for all of it, the name is shortened.
  static std::string label_of(const RatioDot& dot, double room = std::numeric_limits<double>::infinity()) {
    if (!dot.text.empty()) return dot.text;
    if (dot.label.empty()) return "";
    const std::string number = " " + number_text(dot.value, dot.value < 0.995 ? 2 : dot.value < 99.5 ? 1 : 0);
    if (text_extents(dot.label + number, label_small).width <= room) return dot.label + number;
    return shorten(dot.label, room - text_extents(number, label_small).width, label_small) + number;
  }

  /// Draws the vertical lines, each with its label above.
  void lines(Canvas& canvas, const marks::Scale& x, double x0) const {
    for (const RatioLine& line : figure_.lines) {
      const double at = x.inside(line.x);
      canvas.line({at, top_}, {at, bottom_},
                  {palette::frame, 0.9, marks::dashes(line.dash, 0.9), Cap::butt, Join::miter});
    }
    // Labels that would overlap stand to the left and to the right of their lines; all stay above the axis.
    const double room = panel_width_ - label_room_;
    for (std::size_t i = 0; i < figure_.lines.size(); ++i) {
      const double share = figure_.lines.size() == 1 ? 0.5 : i == 0 ? 1.0 : 0.0;
      const double shift = share == 1.0 ? 2.0 : share == 0.0 ? -2.0 : 0.0;
      const std::string label = shorten(figure_.lines[i].label, room, label_small);
      const double width = text_extents(label, label_small).width;
      const double left = x.inside(figure_.lines[i].x) + shift - share * width;
      canvas.text(label, {std::clamp(left, x0, x0 + room - width), top_ - 3.0},
                  {label_small, palette::muted, Align::left, Stand::bottom});
    }
  }

  void row(Canvas& canvas, const std::vector<RatioDot>& dots, std::size_t r, const marks::Scale& x) const {
    const double lanes = lane * static_cast<double>(std::max<std::size_t>(figure_.groups.size(), 1));
    const double y0 = row_top(r) + 0.5 * (row_ - lanes) + 0.5 * lane;
    std::vector<double> values;
    const RatioDot* largest = nullptr;
    for (const RatioDot& one : dots) {
      if (std::isnan(one.value)) continue;
      values.push_back(one.value);
      if (largest == nullptr || one.value > largest->value) largest = &one;
      const double y = y0 + lane * static_cast<double>(one.group);
      if (!std::isnan(one.lo) && !std::isnan(one.hi) && one.lo < one.hi) interval(canvas, one, y, x);
    }
    for (const RatioDot& one : dots) {
      if (std::isnan(one.value)) continue;
      const double y = y0 + lane * static_cast<double>(one.group);
      if (!on_axis(one.value)) {
        const bool right = one.value > 0.0;
        marks::arrow(canvas, {right ? x.inside(one.value) : x.from(), y}, right ? 1 : -1, 0,
                     figure_.groups[one.group].colour);
      } else {
        dot(canvas, figure_.groups[one.group], {x.inside(one.value), y});
      }
    }
    if (values.empty()) return;
    if (values.size() == 1) {
      label(canvas, *largest, y0, x);
      return;
    }
    std::sort(values.begin(), values.end());
    const std::size_t half = values.size() / 2;
    const double middle =
        values.size() % 2 == 1 || std::isinf(values[half]) ? values[half] : 0.5 * (values[half - 1] + values[half]);
    if (on_axis(middle)) {
      canvas.line({x.inside(middle), row_top(r) + 1.5}, {x.inside(middle), row_top(r) + row_ - 1.5},
                  {palette::ink, 1.6});
    }
    label(canvas, *largest, y0, x);
  }

  /// Draws a dot's interval. An arrowhead marks an end that the axis does not show.
  void interval(Canvas& canvas, const RatioDot& one, double y, const marks::Scale& x) const {
    const Pen pen = whisker(figure_.groups[one.group]);
    const auto end = [&](double value, int side) {
      const bool cut = value > 0.0 ? x.beyond(value) != 0 : side < 0;
      const double at = cut && side < 0 && !(value > 0.0) ? x.from() : x.inside(value);
      // The arrow of a dot beyond the axis is there already.
      const bool marked = !on_axis(one.value) && (side > 0) == (one.value > 0.0);
      if (cut && !marked) {
        // Beside the axis, where no dot covers it.
        const Path head = Path::polygon(
            std::array{Point{at + side * cut_length, y}, Point{at, y - cut_half}, Point{at, y + cut_half}});
        canvas.fill(head, figure_.groups[one.group].colour.faded(0.7));
      }
      return at;
    };
    const double lo = end(one.lo, -1);
    const double hi = end(one.hi, 1);
    if (hi > lo) canvas.line({lo, y}, {hi, y}, pen);
  }

  void label(Canvas& canvas, const RatioDot& largest, double y0, const marks::Scale& x) const {
    const std::string text = label_of(largest, label_room_ - label_gap);
    if (text.empty()) return;
    const double y = y0 + lane * static_cast<double>(largest.group);
    canvas.text(text, {x.inside(std::numeric_limits<double>::max()) + label_gap, y},
                {label_small, palette::ink, Align::left, Stand::middle});
  }

  const RatioFigure& figure_;
  std::vector<std::vector<std::string>> names_;
  std::vector<std::string> title_;
  std::vector<std::string> caption_;
  std::vector<std::string> x_label_;
  LegendRows entries_;
  std::size_t shown_ = 0;  ///< groups in the legend
  bool medians_ = false;   ///< some row has several dots, and a median of them
  Extent extent_;
  double left_ = 0.0;
  double panel_width_ = 0.0;
  double label_room_ = 0.0;  ///< right of the axis, for the labels of dots
  double legend_top_ = 0.0;
  double top_ = 0.0;
  double row_ = 0.0;
  double bottom_ = 0.0;
  double below_ = 0.0;  ///< height of the axis below the rows
  double height_ = 0.0;
};

}  // namespace

Extent ratio_extent(const RatioFigure& figure) {
  Extent extent;
  const auto each = [&](auto&& use) {
    for (const RatioRow& row : figure.rows) {
      for (const auto& dots : row.panels) std::for_each(dots.begin(), dots.end(), use);
    }
  };
  for (const RatioLine& line : figure.lines) extent.add(line.x, AxisScale::log);
  each([&](const RatioDot& dot) { extent.add(dot.value, AxisScale::log); });
  if (!extent.empty()) {
    const Extent near{extent.lo / farthest, extent.hi * farthest};
    each([&](const RatioDot& dot) {
      for (const double end : {dot.lo, dot.hi}) {
        if (on_axis(end)) extent.add(std::clamp(end, near.lo, near.hi), AxisScale::log);
      }
    });
  }
  return extent.fitted(AxisScale::log, 0.04);
}

Canvas plot(const RatioFigure& figure) { return Plot(figure).draw(); }

}  // namespace trellis::draw
