// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/draw/motion.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include <trellis/base/error.hpp>
#include <trellis/draw/page.hpp>
#include <trellis/draw/palette.hpp>
#include <trellis/draw/ticks.hpp>
#include <trellis/draw/worlds.hpp>

namespace trellis::draw {

namespace {

constexpr double tallest = 1.5;     ///< height of a panel, in widths
constexpr double tick_room = 26.0;  ///< points, left of the space
constexpr double tick_length = 3.0;
constexpr double path_width = 1.3;
constexpr double end_radius = 3.2;
constexpr double node_radius = 0.9;
constexpr std::size_t most_ticks = 6;
/// Shades of the density, drawn on top of each other; the steps are uniform in its square root.
constexpr std::size_t shades = 8;
constexpr double shade_opacity = 0.14;

constexpr Colour bias_colour = palette::blue;
constexpr Colour path_colour = palette::vermillion;
constexpr Colour invalid_colour = palette::vermillion;

/// Returns the cells that `chosen` selects as one path, with a rectangle for each run of them in a row.
template <class F>
Path cells(const CellMap& map, const Rect& plot, const F& chosen) {
  Path path;
  const double width = plot.width / static_cast<double>(map.columns);
  const double height = plot.height / static_cast<double>(map.rows);
  for (std::size_t row = 0; row < map.rows; ++row) {
    const double top = plot.bottom() - static_cast<double>(row + 1) * height;
    for (std::size_t from = 0; from < map.columns;) {
      std::size_t to = from;
      while (to < map.columns && chosen(map.values[row * map.columns + to])) ++to;
      if (to > from) {
        append(path, Path::rectangle({plot.x + static_cast<double>(from) * width, top,
                                      static_cast<double>(to - from) * width, height}));
      }
      from = to + 1;
    }
  }
  return path;
}

struct SpaceTicks {
  std::vector<double> at;
  std::vector<std::string> labels;
};

/// "π/2" for 1, "−π" for -2.
std::string quarters_text(int quarters) {
  if (quarters == 0) return "0";
  const int numerator = std::abs(quarters % 2 == 0 ? quarters / 2 : quarters);
  return fmt::format("{}{}π{}", quarters < 0 ? "−" : "", numerator == 1 ? "" : fmt::format("{}", numerator),
                     quarters % 2 == 0 ? "" : "/2");
}

/// Angles have ticks at quarters and halves of a turn; those of several turns at fewer.
SpaceTicks ticks_of(const SpaceAxis& axis) {
  if (!axis.angle) {
    Ticks ticks = linear_ticks({axis.lo, axis.hi}, most_ticks);
    return {std::move(ticks.at), std::move(ticks.labels)};
  }
  constexpr double quarter = 0.5 * std::numbers::pi;
  constexpr int most = 9;
  const double rounding = 1e-9 * (axis.hi - axis.lo);
  int step = 1;
  while ((axis.hi - axis.lo) / (quarter * step) > most) step *= 2;
  const int first = static_cast<int>(std::ceil((axis.lo - rounding) / (quarter * step)));
  const int last = static_cast<int>(std::floor((axis.hi + rounding) / (quarter * step)));
  SpaceTicks ticks;
  for (int i = first; i <= last; ++i) {
    ticks.at.push_back(quarter * (i * step));
    ticks.labels.push_back(quarters_text(i * step));
  }
  return ticks;
}

/// Returns the printed name: "θ₂" for "theta2", and "θ₁" for "theta" beside it.
std::string printed(const SpaceAxis& axis, const SpaceAxis& other) {
  constexpr std::string_view theta = "theta";
  if (!axis.name.starts_with(theta)) return axis.name;
  constexpr std::array<const char*, 10> below = {"₀", "₁", "₂", "₃", "₄", "₅", "₆", "₇", "₈", "₉"};
  if (axis.name == theta && other.name == "theta2") return "θ₁";
  std::string name = "θ";
  for (const char c : axis.name.substr(theta.size())) {
    if (c < '0' || c > '9') return axis.name;
    name += below.at(static_cast<std::size_t>(c - '0'));
  }
  return name;
}

class MotionPlot {
 public:
  explicit MotionPlot(const MotionFigure& figure) : figure_(figure) {
    if (!(figure_.width > 4.0 * page::border) || !(figure_.world.width > 0.0) || !(figure_.world.height > 0.0) ||
        !(figure_.x.hi > figure_.x.lo) || !(figure_.y.hi > figure_.y.lo)) {
      throw Fault("a picture of a motion without an extent");
    }
    check(figure_.blocked);
    for (const auto& row : figure_.rows) {
      check(row.density);
      if (row.invalid.size() != row.poses.size()) throw Fault("a picture of a motion needs the validity of each pose");
      if (!row.density.values.empty()) shaded_ = true;
      if (!row.nodes.empty()) nodes_ = true;
      if (std::find(row.invalid.begin(), row.invalid.end(), true) != row.invalid.end()) invalid_ = true;
    }
    lay_out();
  }

  [[nodiscard]] Canvas draw() const {
    Canvas canvas(figure_.width, height_);
    canvas.fill(Path::rectangle({0.0, 0.0, figure_.width, height_}), palette::paper);
    page::block(canvas, title_, {page::border, page::border}, {page::title_font, palette::ink});
    for (std::size_t i = 0; i < legend_.size(); ++i) {
      draw_entry(canvas, legend_[i], {page::border + rows_.at[i].x, legend_top_ + rows_.at[i].y});
    }
    for (std::size_t i = 0; i < figure_.rows.size(); ++i) {
      draw_world(canvas, figure_.rows[i], frames_[i]);
      draw_space(canvas, figure_.rows[i], frames_[i]);
    }
    page::block(canvas, caption_,
                {page::border, height_ - page::border - page::block_height(caption_, page::caption_font)},
                {page::caption_font, palette::muted});
    return canvas;
  }

 private:
  enum class Entry : std::uint8_t { start, goal, between, blocked_pose, obstacle, bias, path, nodes };

  struct Frame {
    Rect world;
    Rect space;
    std::vector<std::string> world_title;
    std::vector<std::string> space_title;
  };

  static void check(const CellMap& map) {
    if (map.values.size() != map.columns * map.rows) throw Fault("a map of cells whose numbers are more or fewer");
  }

  static const char* name_of(Entry entry) {
    switch (entry) {
      case Entry::start: return "start";
      case Entry::goal: return "goal";
      case Entry::between: return "on the path";
      case Entry::blocked_pose: return "on the path, invalid";
      case Entry::obstacle: return "obstacle";
      case Entry::bias: return "proposals: the darker, the more";
      case Entry::path: return "path";
      case Entry::nodes: return "nodes";
    }
    throw Fault("unknown entry of a legend");
  }

  [[nodiscard]] double text_width() const { return figure_.width - 2.0 * page::border; }

  void lay_out() {
    legend_ = {Entry::start, Entry::goal, Entry::between};
    if (invalid_) legend_.push_back(Entry::blocked_pose);
    legend_.push_back(Entry::obstacle);
    if (shaded_) legend_.push_back(Entry::bias);
    legend_.push_back(Entry::path);
    if (nodes_) legend_.push_back(Entry::nodes);
    std::vector<std::string> names;
    names.reserve(legend_.size());
    for (const Entry entry : legend_) names.emplace_back(name_of(entry));
    rows_ = page::flow(names, text_width());
    title_ = page::wrapped(figure_.title, text_width(), page::title_font, 3);
    caption_ = page::wrapped(figure_.caption, text_width(), page::caption_font, 40);
    legend_top_ = page::border + page::block_height(title_, page::title_font) + (title_.empty() ? 0.0 : 4.0);

    // Both panels have the same width, and at most a page's height.
    const double column = 0.5 * (text_width() - page::gap - tick_room);
    const auto fitted = [&](double width, double height) {
      const double scale = std::min(column / width, tallest * column / height);
      return Rect{0.0, 0.0, width * scale, height * scale};
    };
    const Rect world = fitted(figure_.world.width, figure_.world.height);
    // Axes of one unit have one scale.
    const bool alike = figure_.x.angle == figure_.y.angle;
    const Rect space =
        alike ? fitted(figure_.x.hi - figure_.x.lo, figure_.y.hi - figure_.y.lo) : Rect{0.0, 0.0, column, column};
    const double below = tick_length + 2.0 * page::line_height(page::tick_font) + 2.0;
    double y = legend_top_ + rows_.height;
    frames_.reserve(figure_.rows.size());
    for (const auto& row : figure_.rows) {
      Frame frame;
      frame.world_title = page::wrapped(row.world_title, column, page::panel_font, 3);
      frame.space_title = page::wrapped(row.space_title, column, page::panel_font, 3);
      y += std::max(page::block_height(frame.world_title, page::panel_font),
                    page::block_height(frame.space_title, page::panel_font)) +
           3.0;
      frame.world = world;
      frame.world.x = page::border;
      frame.world.y = y;
      frame.space = space;
      frame.space.x = page::border + column + page::gap + tick_room;
      frame.space.y = y;
      const double bar = has_scale_bar(row) ? scale_bar_height() + 3.0 : 0.0;
      y += std::max(world.height + bar, space.height + below) + 0.7 * page::gap;
      frames_.push_back(std::move(frame));
    }
    height_ = y + (caption_.empty() ? 0.0 : page::block_height(caption_, page::caption_font)) + page::border;
  }

  [[nodiscard]] bool has_scale_bar(const MotionRow& row) const {
    return figure_.scale_bar && &row == &figure_.rows.front();
  }

  void draw_world(Canvas& canvas, const MotionRow& row, const Frame& frame) const {
    const Rect& plot = frame.world;
    page::block(canvas, frame.world_title,
                {plot.x, plot.y - 3.0 - page::block_height(frame.world_title, page::panel_font)},
                {page::panel_font, palette::ink});
    {
      const auto clip = canvas.clip(Path::rectangle(plot));
      const double scale = plot.width / figure_.world.width;
      const Transform map{.xx = scale,
                          .yy = -scale,
                          .x0 = plot.x - scale * figure_.world.x,
                          .y0 = plot.bottom() + scale * figure_.world.y};
      draw_obstacles(canvas, figure_.obstacles, map);
      const std::size_t count = row.poses.size();
      for (std::size_t i = 1; i + 1 < count; ++i) {
        const Colour colour = row.invalid[i] ? invalid_colour : bias_colour;
        for (const Path& part : robot_paths(row.poses[i], map)) {
          canvas.fill(part, colour.faded(0.18));
          canvas.stroke(part, {colour.faded(0.75), 0.5});
        }
      }
      if (count > 0) {
        for (const Path& part : robot_paths(row.poses.front(), map)) canvas.fill(part, start_colour);
        outline(canvas, robot_paths(row.poses.front(), map), plot.grown(10.0));
      }
      if (count > 1) {
        for (const Path& part : robot_paths(row.poses.back(), map)) canvas.fill(part, goal_colour);
        outline(canvas, robot_paths(row.poses.back(), map), plot.grown(10.0));
      }
    }
    canvas.stroke(Path::rectangle(plot), {palette::frame, 0.8, {}, Cap::butt, Join::miter});
    if (has_scale_bar(row)) {
      draw_scale_bar(canvas, {plot.x, plot.bottom() + 3.0}, plot.width / 3.0, plot.width / figure_.world.width);
    }
  }

  void draw_space(Canvas& canvas, const MotionRow& row, const Frame& frame) const {
    const Rect& plot = frame.space;
    page::block(canvas, frame.space_title,
                {plot.x, plot.y - 3.0 - page::block_height(frame.space_title, page::panel_font)},
                {page::panel_font, palette::ink});
    const double sx = plot.width / (figure_.x.hi - figure_.x.lo);
    const double sy = plot.height / (figure_.y.hi - figure_.y.lo);
    const Transform map{.xx = sx, .yy = -sy, .x0 = plot.x - sx * figure_.x.lo, .y0 = plot.bottom() + sy * figure_.y.lo};
    {
      const auto clip = canvas.clip(Path::rectangle(plot));
      const Path blocked = cells(figure_.blocked, plot, [](double v) { return v != 0.0; });
      if (!blocked.verbs().empty()) canvas.fill(blocked, obstacle_colour);
      draw_density(canvas, row.density, plot);
      for (const Point p : row.nodes) canvas.fill(Path::circle(map(p), node_radius), palette::ink.faded(0.55));
      for (const auto& piece : row.path) {
        canvas.stroke(Path::polyline(piece).mapped(map), {path_colour, path_width, {}, Cap::round});
      }
      draw_end(canvas, map(figure_.start), end_radius, true);
      draw_end(canvas, map(figure_.goal), end_radius, false);
    }
    canvas.stroke(Path::rectangle(plot), {palette::frame, 0.8, {}, Cap::butt, Join::miter});
    draw_axes(canvas, plot, map);
  }

  static void draw_density(Canvas& canvas, const CellMap& density, const Rect& plot) {
    double most = 0.0;
    for (const double v : density.values) most = std::max(most, v);
    if (!(most > 0.0)) return;
    for (std::size_t k = 0; k < shades; ++k) {
      const double root = (static_cast<double>(k) + 0.5) / static_cast<double>(shades);
      const Path shade = cells(density, plot, [&](double v) { return v > root * root * most; });
      if (!shade.verbs().empty()) canvas.fill(shade, bias_colour.faded(shade_opacity));
    }
  }

  void draw_axes(Canvas& canvas, const Rect& plot, const Transform& map) const {
    const Pen pen{palette::frame, 0.6};
    const SpaceTicks across = ticks_of(figure_.x);
    double y = plot.bottom() + tick_length;
    for (std::size_t i = 0; i < across.at.size(); ++i) {
      const double x = map({across.at[i], figure_.y.lo}).x;
      canvas.line({x, plot.bottom()}, {x, y}, pen);
      canvas.text(across.labels[i], {x, y + 1.0}, {page::tick_font, palette::ink, Align::centre, Stand::top});
    }
    y += page::line_height(page::tick_font) + 1.0;
    canvas.text(printed(figure_.x, figure_.y), {plot.centre().x, y},
                {page::label_font, palette::ink, Align::centre, Stand::top});
    const SpaceTicks up = ticks_of(figure_.y);
    for (std::size_t i = 0; i < up.at.size(); ++i) {
      const double at = map({figure_.x.lo, up.at[i]}).y;
      canvas.line({plot.x - tick_length, at}, {plot.x, at}, pen);
      canvas.text(up.labels[i], {plot.x - tick_length - 1.5, at},
                  {page::tick_font, palette::ink, Align::right, Stand::middle});
    }
    canvas.text(printed(figure_.y, figure_.x), {plot.x - tick_room + 1.0, plot.centre().y},
                {page::label_font, palette::ink, Align::centre, Stand::middle, 90.0});
  }

  static void draw_entry(Canvas& canvas, Entry entry, Point at) {
    const Point middle{at.x + 0.5 * page::swatch, at.y + 0.5 * page::line_height(page::legend_font)};
    const Rect box{middle.x - 6.0, middle.y - 2.5, 12.0, 5.0};
    const auto pose = [&](const Colour& colour) {
      canvas.fill(Path::rectangle(box), colour.faded(0.18));
      canvas.stroke(Path::rectangle(box), {colour.faded(0.75), 0.5});
    };
    switch (entry) {
      case Entry::start:
      case Entry::goal:
        canvas.fill(Path::rectangle(box), entry == Entry::start ? start_colour : goal_colour);
        outline(canvas, {Path::rectangle(box)}, box.grown(10.0));
        break;
      case Entry::between: pose(bias_colour); break;
      case Entry::blocked_pose: pose(invalid_colour); break;
      case Entry::obstacle:
        canvas.fill(Path::rectangle(box), obstacle_colour);
        canvas.stroke(Path::rectangle(box), {obstacle_edge, 0.4});
        break;
      case Entry::bias:
        for (std::size_t k = 0; k < shades; ++k) {
          const double left = static_cast<double>(k) / static_cast<double>(shades) * box.width;
          canvas.fill(Path::rectangle({box.x + left, box.y, box.width - left, box.height}),
                      bias_colour.faded(shade_opacity));
        }
        break;
      case Entry::path:
        canvas.line({at.x, middle.y}, {at.x + page::swatch, middle.y}, {path_colour, path_width, {}, Cap::round});
        break;
      case Entry::nodes:
        for (const double x : {-4.0, 0.0, 4.0}) {
          canvas.fill(Path::circle({middle.x + x, middle.y}, node_radius), palette::ink.faded(0.55));
        }
        break;
    }
    page::entry_name(canvas, name_of(entry), at);
  }

  MotionFigure figure_;
  std::vector<Frame> frames_;
  std::vector<Entry> legend_;
  page::LegendRows rows_;
  std::vector<std::string> title_;
  std::vector<std::string> caption_;
  double legend_top_ = 0.0;
  double height_ = 0.0;
  bool shaded_ = false;
  bool nodes_ = false;
  bool invalid_ = false;
};

}  // namespace

Canvas plot(const MotionFigure& figure) { return MotionPlot(figure).draw(); }

}  // namespace trellis::draw
