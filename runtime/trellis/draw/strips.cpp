// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/draw/strips.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include <trellis/base/error.hpp>
#include <trellis/draw/marks.hpp>
#include <trellis/draw/page.hpp>
#include <trellis/draw/text.hpp>
#include <trellis/draw/ticks.hpp>

namespace trellis::draw {

namespace {

using namespace page;  // NOLINT(google-build-using-namespace): what all pictures have in common

constexpr double strip_height = 13.0;
constexpr double strip_gap = 4.0;
constexpr double tick_length = 3.0;
constexpr double most_name_share = 0.36;  ///< of the figure's width
constexpr double most_ratio = 4.0;        ///< where the colours saturate
constexpr double key_width = 150.0;
constexpr double key_height = 8.0;

Colour mixed(const Colour& colour, double share) {
  const auto part = [share](double paper, double full) { return paper + share * (full - paper); };
  return {part(palette::paper.r, colour.r), part(palette::paper.g, colour.g), part(palette::paper.b, colour.b), 1.0};
}

class Plot {
 public:
  explicit Plot(const StripFigure& figure) : figure_(figure) {
    for (const Strip& strip : figure.strips) {
      const std::size_t bins = strip.share.size();
      if (strip.target.size() != bins || strip.edges.size() != bins + (bins > 0 ? 1 : 0)) {
        throw Fault(fmt::format("a strip of {} bins has {} edges and a target of {}", bins, strip.edges.size(),
                                strip.target.size()));
      }
    }
    lay_out();
  }

  [[nodiscard]] Canvas draw() const {
    Canvas canvas(figure_.width, height_);
    canvas.fill(Path::rectangle({0.0, 0.0, figure_.width, height_}), palette::paper);
    block(canvas, title_, {border, border}, {title_font, palette::ink});
    key(canvas);
    for (std::size_t i = 0; i < figure_.strips.size(); ++i) strip(canvas, i);
    axis(canvas);
    block(canvas, caption_, {border, height_ - border - block_height(caption_, caption_font)},
          {caption_font, palette::muted});
    return canvas;
  }

 private:
  void lay_out() {
    const double text_width = figure_.width - 2.0 * border;
    title_ = wrapped(figure_.title, text_width, title_font, 3);
    caption_ = wrapped(figure_.caption, text_width, caption_font, 40);
    double widest = 0.0;
    for (const Strip& strip : figure_.strips) {
      names_.push_back(shorten(strip.name, most_name_share * figure_.width, tick_font));
      widest = std::max(widest, text_extents(names_.back(), tick_font).width);
      for (const double edge : strip.edges) extent_.add(edge);
    }
    extent_ = extent_.fitted(AxisScale::linear, 0.0);
    left_ = border + widest + 6.0;
    right_ = figure_.width - border - 8.0;
    key_top_ = border + block_height(title_, title_font) + (title_.empty() ? 0.0 : 4.0);
    top_ = key_top_ + key_height + 2.0 + line_height(tick_font) + 8.0;
    bottom_ = top_ + static_cast<double>(figure_.strips.size()) * (strip_height + strip_gap);
    height_ = bottom_ + tick_length + 2.0 + line_height(tick_font) + 2.0 + line_height(label_font) +
              (caption_.empty() ? 0.0 : 6.0 + block_height(caption_, caption_font)) + border;
  }

  /// Draws the colour key, from no sample to four times the target's share.
  void key(Canvas& canvas) const {
    const std::string said = "samples' share / target's share";
    const double label = text_extents(said, legend_font).width;
    canvas.text(said, {border, key_top_ + 0.5 * key_height}, {legend_font, palette::ink, Align::left, Stand::middle});
    const double from = border + label + 10.0 + key_height + 22.0;
    const double to = std::min(from + key_width, figure_.width - border - 8.0);
    const Rect none{border + label + 10.0, key_top_, key_height, key_height};
    bin(canvas, none, 0.0, 1.0);
    canvas.stroke(Path::rectangle(none), {palette::frame, 0.5});
    const TextStyle below{tick_font, palette::ink, Align::centre, Stand::top};
    canvas.text("0", {none.centre().x, key_top_ + key_height + 1.0}, below);
    const marks::Scale scale({1.0 / most_ratio, most_ratio}, AxisScale::log, from, to);
    constexpr int steps = 48;
    for (int i = 0; i < steps; ++i) {
      const double a = std::pow(most_ratio, 2.0 * i / steps - 1.0);
      const double b = std::pow(most_ratio, 2.0 * (i + 1) / steps - 1.0);
      canvas.fill(Path::rectangle({scale(a), key_top_, scale(b) - scale(a) + 0.3, key_height}),
                  strip_colour(std::sqrt(a * b), 1.0));
    }
    canvas.stroke(Path::rectangle({from, key_top_, to - from, key_height}), {palette::frame, 0.5});
    struct Mark {
      double at;
      const char* text;
    };
    constexpr std::array marks = {Mark{0.25, "≤ 1/4"}, Mark{0.5, "1/2"}, Mark{1.0, "1"}, Mark{2.0, "2"},
                                  Mark{4.0, "≥ 4"}};
    const bool roomy = to - from > 100.0;
    for (const Mark& mark : marks) {
      if (!roomy && (mark.at == 0.5 || mark.at == 2.0)) continue;
      canvas.line({scale(mark.at), key_top_ + key_height}, {scale(mark.at), key_top_ + key_height + 1.5},
                  {palette::frame, 0.5});
      canvas.text(mark.text, {scale(mark.at), key_top_ + key_height + 1.0}, below);
    }
  }

  static void bin(Canvas& canvas, const Rect& box, double share, double target) {
    canvas.fill(Path::rectangle(box), strip_colour(share, target));
    if (share != 0.0 || !(target > 0.0)) return;
    canvas.line({box.x, box.bottom()}, {box.right(), box.y}, {palette::ink, 0.7});
    canvas.line({box.x, box.y}, {box.right(), box.bottom()}, {palette::ink, 0.7});
  }

  void strip(Canvas& canvas, std::size_t i) const {
    const Strip& of = figure_.strips[i];
    const marks::Scale x(extent_, AxisScale::linear, left_, right_);
    const double y = top_ + static_cast<double>(i) * (strip_height + strip_gap);
    canvas.text(names_[i], {left_ - 6.0, y + 0.5 * strip_height},
                {tick_font, palette::ink, Align::right, Stand::middle});
    for (std::size_t k = 0; k < of.share.size(); ++k) {
      if (std::isnan(of.share[k])) continue;
      const double from = x.inside(of.edges[k]);
      bin(canvas, {from, y, x.inside(of.edges[k + 1]) - from, strip_height}, of.share[k], of.target[k]);
    }
    if (of.edges.empty()) return;
    const double from = x.inside(of.edges.front());
    canvas.stroke(Path::rectangle({from, y, x.inside(of.edges.back()) - from, strip_height}), {palette::frame, 0.6});
  }

  void axis(Canvas& canvas) const {
    const marks::Scale x(extent_, AxisScale::linear, left_, right_);
    const Ticks ticks = linear_ticks(extent_, static_cast<std::size_t>(std::clamp((right_ - left_) / 40.0, 2.0, 9.0)));
    for (std::size_t i = 0; i < ticks.at.size(); ++i) {
      const double at = x.inside(ticks.at[i]);
      canvas.line({at, bottom_}, {at, bottom_ + tick_length}, {palette::frame, 0.8});
      canvas.text(ticks.labels[i], {at, bottom_ + tick_length + 2.0},
                  {tick_font, palette::ink, Align::centre, Stand::top});
    }
    canvas.text(shorten(figure_.x_label, right_ - left_ + 20.0, label_font),
                {0.5 * (left_ + right_), bottom_ + tick_length + 4.0 + line_height(tick_font)},
                {label_font, palette::ink, Align::centre, Stand::top});
  }

  const StripFigure& figure_;
  std::vector<std::string> names_;
  std::vector<std::string> title_;
  std::vector<std::string> caption_;
  Extent extent_;
  double left_ = 0.0;
  double right_ = 0.0;
  double key_top_ = 0.0;
  double top_ = 0.0;
  double bottom_ = 0.0;
  double height_ = 0.0;
};

}  // namespace

Colour strip_colour(double share, double target) {
  if (!(target > 0.0)) return palette::paper;
  constexpr double darkest_grey = 0.75;
  const double log_ratio = std::log(std::max(share / target, 1e-12)) / std::log(most_ratio);
  if (log_ratio < 0.0) return mixed(palette::loss, std::min(1.0, -log_ratio));
  return mixed(palette::ink, darkest_grey * std::min(1.0, log_ratio));
}

Canvas plot(const StripFigure& figure) { return Plot(figure).draw(); }

}  // namespace trellis::draw
