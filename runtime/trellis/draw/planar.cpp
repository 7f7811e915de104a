// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/draw/planar.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include <trellis/base/error.hpp>
#include <trellis/draw/circles.hpp>
#include <trellis/draw/page.hpp>
#include <trellis/draw/text.hpp>
#include <trellis/draw/worlds.hpp>

namespace trellis::draw {

namespace {

constexpr double most_cells = 1e6;
/// Of the cells with samples, the share whose circles fit into their cells.
constexpr double fitting = 0.95;
constexpr double fitting_diameter = 0.95;  ///< cells
constexpr double largest_diameter = 2.2;
constexpr double tallest = 1.5;  ///< height of a panel, in widths of its column

double largest(const std::vector<CircleLayer>& layers) {
  double most = 0.0;
  for (const auto& layer : layers) {
    for (const double mean : layer.mean) most = std::max(most, mean);
  }
  return most;
}

/// A symbol of the legend.
struct Entry {
  enum class Sign : std::uint8_t { circles, start, goal, path, obstacle };
  Sign sign = Sign::circles;
  std::string name;
  CircleLook look{};
};

class Plot {
 public:
  explicit Plot(const PlanarFigure& figure) : figure_(figure), grid_(figure.world, figure.cell) {
    if (figure_.columns == 0 || !(figure_.width > 2.0 * page::border)) {
      throw Fault("a picture of a world without columns or width");
    }
    if (figure_.panels.empty()) figure_.panels.emplace_back();
    figure_.columns = std::min(figure_.columns, figure_.panels.size());
    for (const auto& panel : figure_.panels) {
      for (const auto& layer : panel.layers) check(layer);
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
    for (std::size_t p = 0; p < frames_.size(); ++p) draw_panel(canvas, p);
    page::block(canvas, caption_,
                {page::border, height_ - page::border - page::block_height(caption_, page::caption_font)},
                {page::caption_font, palette::muted});
    return canvas;
  }

 private:
  void check(const CircleLayer& layer) const {
    if (layer.mean.size() != grid_.size()) {
      throw Fault(fmt::format("the layer '{}' has {} cells, its grid {}", layer.name, layer.mean.size(), grid_.size()));
    }
    for (const double mean : layer.mean) {
      if (!(mean >= 0.0 && mean <= 1e15)) throw Fault(fmt::format("the layer '{}' counts {:g}", layer.name, mean));
    }
  }

  [[nodiscard]] CircleLook look(const PlanarPanel& panel, const CircleLayer& layer) const {
    if (layer.colour) return {*layer.colour, 0.55};
    return circle_look(layer.role, figure_.colours, panel.layers.size() == 1);
  }

  void add(Entry entry) {
    const bool known =
        std::any_of(legend_.begin(), legend_.end(), [&](const Entry& e) { return e.name == entry.name; });
    if (entry.name.empty() || known) return;
    legend_.push_back(std::move(entry));
  }

  void make_legend() {
    using Sign = Entry::Sign;
    // Overlapping layers have the most different looks, so the legend explains these.
    auto by_layers = figure_.panels;
    std::stable_sort(by_layers.begin(), by_layers.end(),
                     [](const auto& a, const auto& b) { return a.layers.size() > b.layers.size(); });
    for (const auto& panel : by_layers) {
      for (const auto& layer : panel.layers) add({Sign::circles, layer.name, look(panel, layer)});
    }
    const bool paths = std::any_of(figure_.panels.begin(), figure_.panels.end(), [](const PlanarPanel& panel) {
      return !panel.paths.empty() || !panel.team_paths.empty();
    });
    const bool moving = std::any_of(figure_.panels.begin(), figure_.panels.end(),
                                    [](const PlanarPanel& panel) { return !panel.team_at.empty(); });
    if (!figure_.start.empty() || (!figure_.team.empty() && !moving)) add({Sign::start, "start", {}});
    if (moving) add({Sign::start, "robot", {}});
    if (!figure_.goal.empty() || !figure_.team.empty()) add({Sign::goal, "goal", {}});
    if (paths) add({Sign::path, "path", {}});
    if (!figure_.obstacles.empty()) add({Sign::obstacle, "obstacle", {}});
    std::vector<std::string> names;
    names.reserve(legend_.size());
    for (auto& entry : legend_) {
      entry.name = shorten(entry.name, text_width() - page::entry_width(""), page::legend_font);
      names.push_back(entry.name);
    }
    rows_ = page::flow(names, text_width());
  }

  [[nodiscard]] double text_width() const { return figure_.width - 2.0 * page::border; }

  void lay_out() {
    make_legend();
    const auto columns = static_cast<double>(figure_.columns);
    const double column = (text_width() - page::gap * (columns - 1.0)) / columns;
    const Rect& world = figure_.world;
    scale_ = std::min(column / world.width, tallest * column / world.height);
    title_ = page::wrapped(figure_.title, text_width(), page::title_font, 3);
    caption_ = page::wrapped(figure_.caption, text_width(), page::caption_font, 40);
    legend_top_ = page::border + page::block_height(title_, page::title_font) + (title_.empty() ? 0.0 : 4.0);
    double y = legend_top_ + rows_.height;
    const std::size_t count = figure_.panels.size();
    frames_.resize(count);
    for (std::size_t begin = 0; begin < count; begin += figure_.columns) {
      const std::size_t end = std::min(begin + figure_.columns, count);
      double top = 0.0;
      double bottom = 0.0;
      for (std::size_t p = begin; p < end; ++p) {
        const PlanarPanel& panel = figure_.panels[p];
        Frame& frame = frames_[p];
        frame.title = page::wrapped(panel.title, column, page::panel_font, 3);
        frame.area = area_per_sample(panel.layers, grid_.cell() / parts_of_cell(panel)) * scale_ * scale_;
        frame.sizes = visible_sizes(sizes_explained(panel.layers), frame.area);
        if (!frame.title.empty()) top = std::max(top, page::block_height(frame.title, page::panel_font) + 3.0);
        const double below = frame.sizes.empty() ? 0.0 : circle_sizes_height(frame.sizes, frame.area) + 3.0;
        bottom = std::max(bottom, below + (has_scale_bar(p) ? scale_bar_height() + 3.0 : 0.0));
      }
      for (std::size_t p = begin; p < end; ++p) {
        frames_[p].plot = {page::border + static_cast<double>(p - begin) * (column + page::gap), y + top,
                           world.width * scale_, world.height * scale_};
      }
      y += top + world.height * scale_ + bottom + (end < count ? 0.7 * page::gap : 0.0);
    }
    height_ = y + (caption_.empty() ? 0.0 : 8.0 + page::block_height(caption_, page::caption_font)) + page::border;
  }

  struct Frame {
    Rect plot;
    std::vector<std::string> title;
    double area = 0.0;          ///< square points for each sample
    std::vector<double> sizes;  ///< mean counts in the legend below
  };

  /// Returns the map from the world to paper.
  [[nodiscard]] Transform map(const Rect& plot) const {
    return {.xx = scale_,
            .yy = -scale_,
            .x0 = plot.x - scale_ * figure_.world.x,
            .y0 = plot.bottom() + scale_ * figure_.world.y};
  }

  /// Circles of the robots of a team are beside each other: a cell has so many parts along a side.
  static double parts_of_cell(const PlanarPanel& panel) {
    const bool team = !panel.layers.empty() && panel.layers.front().colour;
    return team ? std::ceil(std::sqrt(static_cast<double>(panel.layers.size()))) : 1.0;
  }
  /// Where the circle of a layer is in each cell, from its centre.
  [[nodiscard]] Point place_in_cell(const PlanarPanel& panel, std::size_t layer) const {
    const double parts = parts_of_cell(panel);
    if (parts == 1.0) return {};
    const auto i = static_cast<double>(layer);
    const double column = std::fmod(i, parts);
    const double row = std::floor(i / parts);
    const double side = grid_.cell() / parts;
    return {(column - 0.5 * (parts - 1.0)) * side, (0.5 * (parts - 1.0) - row) * side};
  }

  [[nodiscard]] bool has_scale_bar(std::size_t p) const { return figure_.scale_bar && p == 0; }

  void draw_panel(Canvas& canvas, std::size_t p) const {
    const PlanarPanel& panel = figure_.panels[p];
    const Frame& frame = frames_[p];
    const Rect& plot = frame.plot;
    page::block(canvas, frame.title, {plot.x, plot.y - 3.0 - page::block_height(frame.title, page::panel_font)},
                {page::panel_font, palette::ink});
    {
      const auto clip = canvas.clip(Path::rectangle(plot));
      const Transform to_paper = map(plot);
      draw_obstacles(canvas, figure_.obstacles, to_paper);
      for (const auto& path : panel.paths) {
        canvas.stroke(Path::polyline(path).mapped(to_paper), {palette::ink.faded(0.6), 0.6});
      }
      const bool strong = panel.layers.empty();
      for (const auto& [colour, points] : panel.team_paths) {
        canvas.stroke(Path::polyline(points).mapped(to_paper),
                      {colour.faded(strong ? 0.8 : 0.4), strong ? 0.9 : 0.5, {}, Cap::round});
      }
      const auto start = robot_paths(figure_.start, to_paper);
      const auto goal = robot_paths(figure_.goal, to_paper);
      for (const Path& part : start) canvas.fill(part, start_colour);
      const std::vector<CircleLayer> layers = below_each_other(panel.layers);
      for (std::size_t k = 0; k < layers.size(); ++k) {
        const CircleLayer& layer = layers[k];
        Circles circles;
        const Point place = place_in_cell(panel, k);
        for (std::size_t i = 0; i < layer.mean.size(); ++i) {
          const Point centre = grid_.centre(i);
          circles.add(to_paper({centre.x + place.x, centre.y + place.y}), circle_radius(layer.mean[i] * frame.area));
        }
        circles.draw(canvas, look(panel, layer));
      }
      // Above the circles, which would cover small robots.
      outline(canvas, start, plot.grown(10.0));
      outline(canvas, goal, plot.grown(10.0));
      draw_team(canvas, panel, to_paper);
    }
    canvas.stroke(Path::rectangle(plot), {palette::frame, 0.8, {}, Cap::butt, Join::miter});
    if (has_scale_bar(p)) {
      const double below = frame.sizes.empty() ? 0.0 : circle_sizes_height(frame.sizes, frame.area) + 3.0;
      draw_scale_bar(canvas, {plot.x, plot.bottom() + below + 3.0}, plot.width / 3.0, scale_);
    }
    if (!panel.note.empty()) draw_note(canvas, panel.note, plot);
    draw_sizes(canvas, panel, frame);
  }

  void draw_team(Canvas& canvas, const PlanarPanel& panel, const Transform& to_paper) const {
    const bool moves = !panel.team_at.empty();
    for (const TeamRobot& robot : figure_.team) {
      for (const Path& part : robot_paths(robot.goal, to_paper)) canvas.stroke(part, {robot.colour, 0.9});
    }
    for (std::size_t i = 0; i < figure_.team.size(); ++i) {
      const TeamRobot& robot = figure_.team[i];
      const std::vector<Path> parts = robot_paths(moves ? panel.team_at.at(i) : robot.start, to_paper);
      const double filling = panel.layers.empty() ? 0.85 : 0.6;
      Point middle;
      double extent = 0.0;
      for (const Path& part : parts) {
        canvas.fill(part, robot.colour.faded(filling));
        canvas.stroke(part, {robot.colour, 0.6});
        const Rect box = bounds(part);
        if (const double least = std::min(box.width, box.height); least > extent) {
          extent = least;
          middle = box.centre();
        }
      }
      const double width = text_extents(robot.name, page::tick_font).width;
      if (extent > width + 1.0 && extent > 0.8 * page::line_height(page::tick_font)) {
        canvas.text(robot.name, middle, {page::tick_font, palette::paper, Align::centre, Stand::middle});
      }
    }
  }

  static Rect bounds(const Path& path) {
    Point lo = path.points().front();
    Point hi = lo;
    for (const Point p : path.points()) {
      lo = {std::min(lo.x, p.x), std::min(lo.y, p.y)};
      hi = {std::max(hi.x, p.x), std::max(hi.y, p.y)};
    }
    return {lo.x, lo.y, hi.x - lo.x, hi.y - lo.y};
  }

  void draw_sizes(Canvas& canvas, const PlanarPanel& panel, const Frame& frame) const {
    if (frame.sizes.empty()) return;
    // With several layers the legend refers to none of them.
    const CircleLook grey{palette::muted, 0.3};
    draw_circle_sizes(canvas, frame.sizes, frame.area,
                      panel.layers.size() == 1 ? look(panel, panel.layers.front()) : grey, frame.plot);
  }

  static void draw_entry(Canvas& canvas, const Entry& entry, Point at) {
    const Point middle{at.x + 0.5 * page::swatch, at.y + 0.5 * page::line_height(page::legend_font)};
    const Rect box{middle.x - 6.0, middle.y - 2.5, 12.0, 5.0};
    switch (entry.sign) {
      case Entry::Sign::circles: {
        Circles circles;
        circles.add(middle, 4.0);
        circles.draw(canvas, entry.look);
        break;
      }
      case Entry::Sign::start:
      case Entry::Sign::goal:
        if (entry.sign == Entry::Sign::start) canvas.fill(Path::rectangle(box), start_colour);
        outline(canvas, {Path::rectangle(box)}, box.grown(10.0));
        break;
      case Entry::Sign::path:
        canvas.line({at.x, middle.y}, {at.x + page::swatch, middle.y}, {palette::ink.faded(0.6), 0.8});
        break;
      case Entry::Sign::obstacle:
        canvas.fill(Path::rectangle(box), obstacle_colour);
        canvas.stroke(Path::rectangle(box), {obstacle_edge, 0.4});
        break;
    }
    page::entry_name(canvas, entry.name, at);
  }

  PlanarFigure figure_;
  Grid grid_;
  std::vector<Frame> frames_;
  std::vector<Entry> legend_;
  page::LegendRows rows_;
  std::vector<std::string> title_;
  std::vector<std::string> caption_;
  double legend_top_ = 0.0;
  double scale_ = 1.0;  ///< points for each metre
  double height_ = 0.0;
};

}  // namespace

Colour colour_of(Role role, RoleColours colours) {
  constexpr std::array safe = {palette::target, palette::tree, palette::expansion, palette::baseline};
  constexpr std::array paper = {rgb(0xE00000), rgb(0x0000E0), rgb(0x9B009B), rgb(0x008A00)};
  return (colours == RoleColours::safe ? safe : paper).at(static_cast<std::size_t>(role));
}

Grid::Grid(const Rect& world, double cell) : world_(world), cell_(cell) {
  // Omit a last cell that exists only by rounding.
  const auto cells = [&](double length) { return std::max(1.0, std::ceil(length / cell - 1e-9)); };
  const double across = cells(world.width);
  const double up = cells(world.height);
  const bool places = std::isfinite(world.x) && std::isfinite(world.y);
  if (!(places && world.width > 0.0 && world.height > 0.0 && cell > 0.0 && across * up <= most_cells)) {
    throw Fault(fmt::format("a grid of cells of {:g} in a world of {:g} x {:g}", cell, world.width, world.height));
  }
  columns_ = static_cast<std::size_t>(across);
  rows_ = static_cast<std::size_t>(up);
}

bool Grid::count(Point p, double weight, std::vector<double>& counts) const {
  const double x = p.x - world_.x;
  const double y = p.y - world_.y;
  if (!(x >= 0.0 && y >= 0.0 && x <= world_.width && y <= world_.height)) return false;
  // The first and the last cell of a coordinate: two cells where it lies on their common edge.
  const auto cells = [this](double length, std::size_t most) {
    const double at = length / cell_;
    const double edge = std::round(at);
    const bool on_edge = std::abs(at - edge) < 1e-9 * std::max(1.0, edge) && edge > 0.0;
    const auto index = [most](double i) { return std::min(most - 1, static_cast<std::size_t>(i)); };
    return on_edge ? std::pair(index(edge - 1.0), index(edge)) : std::pair(index(at), index(at));
  };
  const auto [left, right] = cells(x, columns_);
  const auto [low, high] = cells(y, rows_);
  const double part = weight / static_cast<double>((right - left + 1) * (high - low + 1));
  for (std::size_t row = low; row <= high; ++row) {
    for (std::size_t column = left; column <= right; ++column) counts.at(row * columns_ + column) += part;
  }
  return true;
}

Point Grid::centre(std::size_t index) const {
  const auto middle = [&](std::size_t i, double length) {
    const double lo = static_cast<double>(i) * cell_;
    return 0.5 * (lo + std::min(lo + cell_, length));
  };
  return {world_.x + middle(index % columns_, world_.width), world_.y + middle(index / columns_, world_.height)};
}

double area_per_sample(const std::vector<CircleLayer>& layers, double cell) {
  std::vector<double> counts;
  for (const auto& layer : layers) {
    std::copy_if(layer.mean.begin(), layer.mean.end(), std::back_inserter(counts), [](double n) { return n > 0.0; });
  }
  if (counts.empty()) return 0.0;
  std::sort(counts.begin(), counts.end());
  const auto last = static_cast<double>(counts.size() - 1);
  const double usual = counts[static_cast<std::size_t>(std::ceil(fitting * last))];
  const auto area = [&](double diameter) { return std::numbers::pi * std::pow(0.5 * diameter * cell, 2); };
  return std::min(area(fitting_diameter) / usual, area(largest_diameter) / counts.back());
}

std::vector<double> sizes_explained(const std::vector<CircleLayer>& layers) {
  const double most = largest(layers);
  if (!(most > 0.0)) return {};
  // 1, 2 or 5 times a power of ten, and two more sizes, a quarter or a fifth of the one before.
  const double power = std::pow(10.0, std::floor(std::log10(most) + 1e-9));
  const double lead = most / power * (1.0 + 1e-9);
  const double digit = lead >= 5.0 ? 5.0 : lead >= 2.0 ? 2.0 : 1.0;
  const double top = digit * power;
  const double next = digit == 2.0 ? top / 4.0 : top / 5.0;
  const double least = digit == 5.0 ? next / 5.0 : digit == 2.0 ? next / 5.0 : next / 4.0;
  return {least, next, top};
}

Canvas plot(const PlanarFigure& figure) { return Plot(figure).draw(); }

}  // namespace trellis::draw
