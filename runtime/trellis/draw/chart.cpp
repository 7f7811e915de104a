// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/draw/chart.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>

#include <trellis/base/error.hpp>
#include <trellis/draw/marks.hpp>
#include <trellis/draw/page.hpp>
#include <trellis/draw/text.hpp>

namespace trellis::draw {

namespace {

using page::block;
using page::block_height;
using page::border;
using page::caption_font;
using page::entry_width;
using page::gap;
using page::label_font;
using page::legend_font;
using page::line_height;
using page::panel_font;
using page::swatch;
using page::tick_font;
using page::title_font;
using page::wrapped;

constexpr double tick_length = 3.0;
constexpr double tick_gap = 2.5;
constexpr double least_width = 40.0;  ///< of a panel
constexpr double lane_height = 4.0;
constexpr double lane_gap = 1.5;
constexpr double slant = 35.0;
constexpr double longest_name = 110.0;  ///< points, of a category

/// The layout of the names below a category axis.
struct Names {
  enum class Set : std::uint8_t { flat, slanted, upright };
  Set set = Set::flat;
  std::vector<std::vector<std::string>> lines;  ///< of each category
  std::size_t stride = 1;                       ///< draw every stride-th name
  double height = 0.0;
  double left = 0.0;  ///< overhang beyond the panel's left edge
};

/// \param slanted  forces slanted names, where another panel needs them
Names set_names(const std::vector<std::string>& categories, double width, bool slanted) {
  Names names;
  if (categories.empty()) return names;
  const double slot = width / static_cast<double>(categories.size());
  const double line = line_height(tick_font);
  constexpr std::size_t most_lines = 3;
  bool flat = !slanted;
  std::size_t deepest = 0;
  for (const auto& category : categories) {
    auto lines = wrap_text(category, slot - 4.0, tick_font, most_lines + 1);
    // Prefer a slanted word to a broken one.
    std::string joined;
    for (const auto& l : lines) joined += (joined.empty() ? "" : " ") + l;
    std::string whole;
    for (const auto& l : wrap_text(category, 1e9, tick_font)) whole += (whole.empty() ? "" : " ") + l;
    flat = flat && lines.size() <= most_lines && joined == whole;
    deepest = std::max(deepest, lines.size());
    names.lines.push_back(std::move(lines));
  }
  if (flat) {
    names.height = static_cast<double>(deepest) * line;
    return names;
  }
  const double angle = slant * std::numbers::pi / 180.0;
  names.set = slot * std::sin(angle) >= 0.95 * line ? Names::Set::slanted : Names::Set::upright;
  if (names.set == Names::Set::upright) names.stride = static_cast<std::size_t>(std::max(1.0, std::ceil(line / slot)));
  for (std::size_t i = 0; i < categories.size(); ++i) {
    std::string one;
    for (const auto& l : wrap_text(categories[i], 1e9, tick_font)) one += (one.empty() ? "" : " ") + l;
    names.lines[i] = {shorten(one, longest_name, tick_font)};
    if (i % names.stride != 0) continue;
    const double length = text_extents(names.lines[i][0], tick_font).width;
    if (names.set == Names::Set::upright) {
      names.height = std::max(names.height, length);
      continue;
    }
    names.height = std::max(names.height, length * std::sin(angle) + line * std::cos(angle));
    names.left = std::max(names.left, length * std::cos(angle) - (static_cast<double>(i) + 0.5) * slot);
  }
  return names;
}

// The entries of the legend.

struct Entry {
  enum class Sign : std::uint8_t { line, points, patch, step, lane, arrow };
  Sign sign = Sign::line;
  std::string name;
  Colour colour;
  bool interval = false;
  Dash dash = Dash::solid;
  std::optional<Marker> marker;
};

std::vector<Entry> entries(const std::vector<Panel>& panels, bool arrows) {
  std::vector<Entry> found;
  const auto add = [&](Entry entry) {
    const bool known = std::any_of(found.begin(), found.end(),
                                   [&](const Entry& e) { return e.name == entry.name && e.sign == entry.sign; });
    if (!entry.name.empty() && !known) found.push_back(std::move(entry));
  };
  constexpr std::array signs = {Entry::Sign::line, Entry::Sign::points, Entry::Sign::patch, Entry::Sign::step};
  for (const auto& panel : panels) {
    for (const auto& s : panel.series) {
      add({signs.at(static_cast<std::size_t>(s.kind)), s.name, *s.colour, !s.lo.empty() || !s.hi.empty(), s.dash,
           s.marker});
    }
  }
  for (const auto& panel : panels) {
    for (const auto& shade : panel.shades) add({Entry::Sign::patch, shade.name, shade.colour, false, Dash::solid, {}});
    for (const auto& lane : panel.lanes) {
      if (!lane.stretches.empty()) add({Entry::Sign::lane, lane.name, lane.colour, false, Dash::solid, {}});
    }
  }
  if (arrows) add({Entry::Sign::arrow, "infinite or beyond the axis", palette::muted, false, Dash::solid, {}});
  return found;
}

void draw_entry(Canvas& canvas, const Entry& entry, Point at) {
  const double height = line_height(legend_font);
  const double middle = at.y + 0.5 * height;
  const Rect box{at.x, middle - 3.5, swatch, 7.0};
  const Pen pen{entry.colour, 1.4, marks::dashes(entry.dash, 1.4), Cap::butt, Join::miter};
  switch (entry.sign) {
    case Entry::Sign::line:
      if (entry.interval) canvas.fill(Path::rectangle(box), entry.colour.faded(0.22));
      canvas.line({box.x, middle}, {box.right(), middle}, pen);
      if (entry.marker) marks::marker(canvas, *entry.marker, box.centre(), entry.colour);
      break;
    case Entry::Sign::points:
      if (entry.interval)
        canvas.line({box.centre().x, box.y - 0.5}, {box.centre().x, box.bottom() + 0.5}, {entry.colour, 0.8});
      marks::marker(canvas, entry.marker.value_or(Marker::circle), box.centre(), entry.colour);
      break;
    case Entry::Sign::patch: canvas.fill(Path::rectangle({box.x + 2.0, box.y, 12.0, box.height}), entry.colour); break;
    case Entry::Sign::step: {
      if (entry.dash != Dash::solid) {
        canvas.line({box.x, middle}, {box.right(), middle}, pen);
        break;
      }
      if (entry.interval) canvas.fill(Path::rectangle(box), entry.colour.faded(0.22));
      const double x = box.centre().x;
      canvas.stroke(Path::polyline(std::array{Point{box.x, middle + 2.0}, Point{x, middle + 2.0},
                                              Point{x, middle - 2.0}, Point{box.right(), middle - 2.0}}),
                    pen);
      break;
    }
    case Entry::Sign::lane:
      canvas.fill(Path::rectangle({box.x, middle - 0.5 * lane_height, swatch, lane_height}), entry.colour);
      break;
    case Entry::Sign::arrow: marks::arrow(canvas, {box.centre().x, middle - 4.0}, 0, -1, entry.colour); break;
  }
  page::entry_name(canvas, entry.name, at);
}

page::LegendRows flow(const std::vector<Entry>& legend, double width) {
  std::vector<std::string> names;
  names.reserve(legend.size());
  for (const auto& entry : legend) names.push_back(entry.name);
  return page::flow(names, width);
}

/// One panel's position and axes.
struct Cell {
  marks::Frame frame;
  Extent x;
  Extent y;
  Ticks x_ticks;
  Ticks y_ticks;
  Names names;
  bool label_x = true;
  bool label_y = true;
  std::vector<std::string> title;
  std::vector<std::string> x_label;
  std::vector<std::string> y_label;
  double left = 0.0, right = 0.0, top = 0.0, bottom = 0.0;  ///< margins around the frame
};

/// Returns the height of the strips above the frame.
double lanes_height(const Panel& panel) { return static_cast<double>(panel.lanes.size()) * (lane_height + lane_gap); }

std::string axis_label(const Axis& axis, const Ticks& ticks) {
  if (ticks.exponent == 0) return axis.label;
  const std::string factor = "×" + power_text(ticks.exponent);
  return axis.label.empty() ? factor : fmt::format("{} ({})", axis.label, factor);
}

/// Returns a panel's title in at most two lines. Where it has several lines, the last one stands below these, whole: it
/// distinguishes panels of one name.
std::vector<std::string> title_lines(const std::string& title, double width) {
  const std::size_t last = title.rfind('\n');
  if (last == std::string::npos) return wrapped(title, width, panel_font, 2);
  std::vector<std::string> lines = wrapped(title.substr(0, last), width, panel_font, 2);
  lines.push_back(shorten(title.substr(last + 1), width, panel_font));
  return lines;
}

class Plot {
 public:
  explicit Plot(const Figure& figure) : figure_(figure) {
    if (figure_.columns == 0 || !(figure_.width > 0.0 && figure_.panel_height > 0.0)) {
      throw Fault("a figure without columns, width or height");
    }
    figure_.panel_height = std::max(figure_.panel_height, 30.0);
    for (const auto& panel : figure_.panels) marks::check(panel);
    if (figure_.panels.empty()) figure_.panels.emplace_back();
    figure_.columns = std::min(figure_.columns, figure_.panels.size());
    style();
    cells_.resize(figure_.panels.size());
    extents();
  }

  Canvas draw() {
    lay_out(0.0, false);
    bool arrows = false;
    for (std::size_t p = 0; p < cells_.size(); ++p) {
      Canvas scratch(width_, height_);
      arrows = marks::draw(scratch, figure_.panels[p], cells_[p].frame) || arrows;
    }
    if (figure_.legend != Legend::none) legend_ = entries(figure_.panels, arrows);
    for (auto& entry : legend_) entry.name = shorten(entry.name, width_ - 2.0 * border - swatch - 4.0, legend_font);
    std::optional<Rect> inside;
    if (figure_.legend == Legend::automatic && cells_.size() == 1 && legend_.size() <= 6) inside = free_place();
    if (!inside) lay_out(flow(legend_, width_ - 2.0 * border).height, true);

    Canvas canvas(width_, height_);
    canvas.fill(Path::rectangle({0.0, 0.0, width_, height_}), palette::paper);
    double y = border;
    block(canvas, title_, {border, y}, {title_font, palette::ink});
    y += block_height(title_, title_font) + (title_.empty() ? 0.0 : 4.0);
    if (!inside) {
      const page::LegendRows rows = flow(legend_, width_ - 2.0 * border);
      for (std::size_t i = 0; i < legend_.size(); ++i) {
        draw_entry(canvas, legend_[i], {border + rows.at[i].x, y + rows.at[i].y});
      }
    }
    for (std::size_t p = 0; p < cells_.size(); ++p) panel(canvas, figure_.panels[p], cells_[p]);
    if (inside) {
      canvas.fill(Path::rectangle(*inside), palette::paper.faded(0.85));
      Point at{inside->x + 4.0, inside->y + 3.0};
      for (const auto& entry : legend_) {
        draw_entry(canvas, entry, at);
        at.y += line_height(legend_font) + 1.0;
      }
    }
    block(canvas, caption_, {border, height_ - border - block_height(caption_, caption_font)},
          {caption_font, palette::muted});
    return canvas;
  }

 private:
  /// Assigns colours and markers to names, in the order of the names.
  void style() {
    std::map<std::string, Colour> colours;
    std::map<std::string, Marker> markers;
    std::size_t unnamed = 0;
    std::size_t next = 0;
    for (auto& panel : figure_.panels) {
      for (auto& s : panel.series) {
        const std::string key = s.name.empty() ? fmt::format("\n{}", unnamed++) : s.name;
        if (!s.colour) {
          const auto [found, fresh] = colours.try_emplace(key, palette::nth(next));
          if (fresh) ++next;
          s.colour = found->second;
        }
        if (s.kind == Series::Kind::points && !s.marker) {
          s.marker = markers.try_emplace(key, static_cast<Marker>(markers.size() % 4)).first->second;
        }
      }
    }
  }

  [[nodiscard]] Extent x_extent(const Panel& panel) const {
    if (!panel.x.categories.empty()) return {-0.5, static_cast<double>(panel.x.categories.size()) - 0.5};
    Extent extent;
    bool tight = true;
    for (const auto& s : panel.series) {
      const bool bars = s.kind == Series::Kind::bars;
      const double half = bars && panel.x.scale == AxisScale::linear ? 0.5 * marks::bar_pitch(panel) : 0.0;
      for (const double x : s.x) {
        extent.add(x - half, panel.x.scale);
        extent.add(x + half, panel.x.scale);
      }
      for (const auto* ends : {&s.x_lo, &s.x_hi}) {
        for (const double x : *ends) extent.add(x, panel.x.scale);
      }
      tight = tight && s.kind != Series::Kind::points && (!bars || half > 0.0);
    }
    return extent.fitted(panel.x.scale, tight ? 0.0 : 0.04);
  }

  [[nodiscard]] Extent y_extent(const Panel& panel) const {
    Extent extent;
    bool on_zero = false;
    for (const auto& s : panel.series) {
      for (const auto* values : {&s.y, &s.lo, &s.hi, &s.base}) {
        for (const double y : *values) extent.add(y, panel.y.scale);
      }
      on_zero = on_zero || s.filled || (s.kind == Series::Kind::bars && s.base.empty());
    }
    for (const auto& reference : panel.references) extent.add(reference.y, panel.y.scale);
    if (on_zero && !extent.empty()) extent.add(0.0, panel.y.scale);
    return extent.fitted(panel.y.scale, 0.05);
  }

  /// Adds space above for the text of the highest bar.
  [[nodiscard]] Extent with_texts(Extent extent, const Panel& panel, double width) const {
    const double room = marks::bar_text(panel, width).room;
    if (room == 0.0) return extent;
    Extent bars;
    for (const auto& s : panel.series) {
      if (s.text.empty()) continue;
      for (const auto* values : {&s.y, &s.lo, &s.hi, &s.base}) {
        for (const double y : *values) bars.add(y, panel.y.scale);
      }
    }
    if (bars.empty()) return extent;
    const double share = 1.0 - std::min(0.6, (room + 2.0) / figure_.panel_height);
    if (panel.y.scale == AxisScale::linear) {
      extent.hi = std::max(extent.hi, std::min(extent.lo + (bars.hi - extent.lo) / share, 2.0 * most_number));
    } else {
      const double decades = (std::log10(bars.hi) - std::log10(extent.lo)) / share;
      extent.hi = std::max(extent.hi, std::pow(10.0, std::min(std::log10(extent.lo) + decades, 300.5)));
    }
    return extent;
  }

  /// Computes the ends of all axes; given ends override the others.
  void extents() {
    const auto ends = [](Extent& extent, const Axis& axis) {
      if (axis.lo) extent.lo = *axis.lo;
      if (axis.hi) extent.hi = *axis.hi;
      if (extent.lo < extent.hi) return;
      // Only one end is given, and the data lie beyond it.
      const double size = std::max(1.0, std::abs(extent.lo));
      const bool log = axis.scale == AxisScale::log;
      if (axis.lo) {
        extent.hi = log ? 10.0 * extent.lo : extent.lo + size;
      } else {
        extent.lo = log ? 0.1 * extent.hi : extent.hi - size;
      }
    };
    const double width = (figure_.width - 2.0 * border) / static_cast<double>(figure_.columns) - 45.0;
    Extent all_x;
    Extent all_y;
    for (std::size_t p = 0; p < cells_.size(); ++p) {
      const Panel& panel = figure_.panels[p];
      const Panel& first = figure_.panels.front();
      const bool same_x = panel.x.scale == first.x.scale && panel.x.categories == first.x.categories;
      if ((figure_.share_x && !same_x) || (figure_.share_y && panel.y.scale != first.y.scale)) {
        throw Fault("panels that share an axis have other scales or categories");
      }
      cells_[p].x = x_extent(panel);
      cells_[p].y = y_extent(panel);
      all_x.add(cells_[p].x);
      all_y.add(cells_[p].y);
    }
    // The space for texts is a share of the axis, so add it after the axis has its ends.
    const double text_width = std::max(width, least_width);
    Extent with_room = all_y;
    for (std::size_t p = 0; p < cells_.size(); ++p) {
      if (figure_.share_y) {
        with_room.add(with_texts(all_y, figure_.panels[p], text_width));
      } else {
        cells_[p].y = with_texts(cells_[p].y, figure_.panels[p], text_width);
      }
    }
    all_y = with_room;
    for (std::size_t p = 0; p < cells_.size(); ++p) {
      Cell& cell = cells_[p];
      if (figure_.share_x) cell.x = all_x;
      if (figure_.share_y) cell.y = all_y;
      ends(cell.x, figure_.panels[p].x);
      ends(cell.y, figure_.panels[p].y);
      cell.label_x = !figure_.share_x || p + figure_.columns >= cells_.size();
      cell.label_y = !figure_.share_y || p % figure_.columns == 0;
    }
  }

  /// Returns as many ticks as fit beside each other.
  static Ticks x_ticks(const Cell& cell, const Axis& axis, double width) {
    for (auto most = static_cast<std::size_t>(std::clamp(width / 32.0, 2.0, 9.0));; --most) {
      Ticks ticks = axis_ticks(cell.x, axis.scale, most);
      const marks::Scale scale(cell.x, axis.scale, 0.0, width);
      double end = -1e9;
      bool room = true;
      for (std::size_t i = 0; i < ticks.at.size(); ++i) {
        const double half = 0.5 * text_extents(ticks.labels[i], tick_font).width;
        room = room && scale(ticks.at[i]) - half >= end;
        end = scale(ticks.at[i]) + half + 6.0;
      }
      if (room || most == 2) return ticks;
    }
  }

  void surroundings(Cell& cell, const Panel& panel, double width, bool slanted) const {
    const double tick_line = line_height(tick_font);
    const double label_line = line_height(label_font);
    cell.y_ticks =
        axis_ticks(cell.y, panel.y.scale, static_cast<std::size_t>(std::clamp(figure_.panel_height / 24.0, 2.0, 9.0)));
    cell.left = cell.right = cell.top = cell.bottom = 0.0;
    if (cell.label_y) {
      double widest = 0.0;
      for (const auto& label : cell.y_ticks.labels) widest = std::max(widest, text_extents(label, tick_font).width);
      cell.y_label = wrapped(axis_label(panel.y, cell.y_ticks), figure_.panel_height + 10.0, label_font, 3);
      cell.left = tick_length + tick_gap + widest;
      if (!cell.y_label.empty()) cell.left += 4.0 + block_height(cell.y_label, label_font);
    }
    cell.names = set_names(panel.x.categories, width, slanted);
    cell.x_ticks = panel.x.categories.empty() ? x_ticks(cell, panel.x, width) : Ticks{};
    if (cell.label_x) {
      cell.x_label = wrapped(axis_label(panel.x, cell.x_ticks), width + 20.0, label_font, 2);
      if (panel.x.categories.empty()) {
        cell.bottom += tick_length + tick_gap + tick_line;
        const marks::Scale scale(cell.x, panel.x.scale, 0.0, width);
        for (std::size_t i = 0; i < cell.x_ticks.at.size(); ++i) {
          const double half = 0.5 * text_extents(cell.x_ticks.labels[i], tick_font).width;
          cell.right = std::max(cell.right, scale(cell.x_ticks.at[i]) + half - width);
          cell.left = std::max(cell.left, half - scale(cell.x_ticks.at[i]));
        }
      } else {
        cell.bottom += tick_gap + 2.0 + cell.names.height;
        cell.left = std::max(cell.left, cell.names.left);
      }
      if (!cell.x_label.empty()) cell.bottom += 3.0 + static_cast<double>(cell.x_label.size()) * label_line;
    } else if (panel.x.categories.empty()) {
      cell.bottom += tick_length;
    }
    cell.title = title_lines(panel.title, width);
    cell.top = lanes_height(panel) + (cell.title.empty() ? 3.0 : 4.0 + block_height(cell.title, panel_font));
    if (cell.label_y) cell.top = std::max(cell.top, 0.5 * tick_line);
  }

  /// Margins depend on the panels' width and the width on the margins: iterates a few times until both converge.
  void lay_out(double legend_height, bool keep_width) {
    const std::size_t columns = figure_.columns;
    const std::size_t rows = (cells_.size() + columns - 1) / columns;
    const auto n = static_cast<double>(columns);
    const double space = (keep_width ? width_ : figure_.width) - 2.0 * border - gap * (n - 1.0);
    double width = std::max(least_width, space / n - 40.0);
    std::vector<double> left(columns);
    std::vector<double> right(columns);
    bool slanted = false;
    for (int round = 0; round < 4; ++round) {
      std::fill(left.begin(), left.end(), 0.0);
      std::fill(right.begin(), right.end(), 0.0);
      for (std::size_t p = 0; p < cells_.size(); ++p) {
        surroundings(cells_[p], figure_.panels[p], width, slanted);
        left[p % columns] = std::max(left[p % columns], cells_[p].left);
        right[p % columns] = std::max(right[p % columns], cells_[p].right);
      }
      const double around =
          std::accumulate(left.begin(), left.end(), 0.0) + std::accumulate(right.begin(), right.end(), 0.0);
      // Names never return from slanted to flat: otherwise the iteration would alternate with the width.
      slanted = slanted || std::any_of(cells_.begin(), cells_.end(),
                                       [](const Cell& cell) { return cell.names.set != Names::Set::flat; });
      width = std::max(least_width, (space - around) / n);
      width_ = 2.0 * border + gap * (n - 1.0) + around + n * width;
    }
    const double text_width = width_ - 2.0 * border;
    title_ = wrapped(figure_.title, text_width, title_font, 3);
    caption_ = wrapped(figure_.caption, text_width, caption_font, 40);
    double y = border + block_height(title_, title_font) + (title_.empty() ? 0.0 : 4.0) + legend_height;
    for (std::size_t r = 0; r < rows; ++r) {
      const std::size_t begin = r * columns;
      const std::size_t end = std::min(begin + columns, cells_.size());
      double top = 0.0;
      double bottom = 0.0;
      for (std::size_t p = begin; p < end; ++p) {
        top = std::max(top, cells_[p].top);
        bottom = std::max(bottom, cells_[p].bottom);
      }
      double x = border;
      for (std::size_t p = begin; p < end; ++p) {
        const std::size_t c = p - begin;
        Cell& cell = cells_[p];
        cell.frame.plot = {x + left[c], y + top, width, figure_.panel_height};
        const Rect& plot = cell.frame.plot;
        cell.frame.x = marks::Scale(cell.x, figure_.panels[p].x.scale, plot.x, plot.right());
        cell.frame.y = marks::Scale(cell.y, figure_.panels[p].y.scale, plot.bottom(), plot.y);
        x += left[c] + width + right[c] + gap;
      }
      y += top + figure_.panel_height + bottom + (r + 1 < rows ? gap : 0.0);
    }
    height_ = y + (caption_.empty() ? 0.0 : 8.0 + block_height(caption_, caption_font)) + border;
  }

  /// Returns a position in the only panel where a legend covers no data.
  [[nodiscard]] std::optional<Rect> free_place() const {
    if (legend_.empty()) return std::nullopt;
    Canvas scratch(width_, height_);
    Canvas ink(width_, height_);
    const Rect& plot = cells_[0].frame.plot;
    for (const auto& s : figure_.panels[0].shades) shade(ink, cells_[0], s);
    marks::draw(ink, figure_.panels[0], cells_[0].frame);
    marks::label_references(scratch, ink, figure_.panels[0], cells_[0].frame);
    const Ink seen = ink.ink();
    Rect box;
    for (const auto& entry : legend_) box.width = std::max(box.width, entry_width(entry.name) + 8.0);
    box.height = static_cast<double>(legend_.size()) * (line_height(legend_font) + 1.0) + 5.0;
    const Rect room = plot.grown(-4.0);
    if (box.width > 0.6 * room.width || box.height > 0.7 * room.height) return std::nullopt;
    for (const auto& [right, down] : {Point{1.0, 0.0}, Point{0.0, 0.0}, Point{1.0, 1.0}, Point{0.0, 1.0},
                                      Point{0.5, 0.0}, Point{0.5, 1.0}, Point{1.0, 0.5}, Point{0.0, 0.5}}) {
      box.x = room.x + right * (room.width - box.width);
      box.y = room.y + down * (room.height - box.height);
      if (seen.in(box.grown(2.0)) < 0.01) return box;
    }
    return std::nullopt;
  }

  static bool blank(const Panel& panel) {
    const auto nothing = [](const Series& s) {
      return std::all_of(s.y.begin(), s.y.end(), [](double y) { return std::isnan(y); }) ||
             std::all_of(s.x.begin(), s.x.end(), [](double x) { return std::isnan(x); });
    };
    const bool texts = std::any_of(panel.series.begin(), panel.series.end(), [](const Series& s) {
      return std::any_of(s.text.begin(), s.text.end(), [](const std::string& text) { return !text.empty(); });
    });
    return !texts && std::all_of(panel.series.begin(), panel.series.end(), nothing);
  }

  void panel(Canvas& canvas, const Panel& panel, const Cell& cell) const {
    const Rect& plot = cell.frame.plot;
    block(canvas, cell.title, {plot.x, plot.y - lanes_height(panel) - 4.0 - block_height(cell.title, panel_font)},
          {panel_font, palette::ink});
    for (const auto& one : panel.shades) shade(canvas, cell, one);
    grid(canvas, panel, cell);
    const bool empty = blank(panel);
    {
      Canvas ink(width_, height_);
      marks::draw(ink, panel, cell.frame);
      marks::draw(canvas, panel, cell.frame);
      marks::label_references(canvas, ink, panel, cell.frame);
    }
    axes(canvas, panel, cell);
    if (empty) {
      canvas.text("no data", plot.centre(),
                  {{.size = 9.0, .italic = true}, palette::muted, Align::centre, Stand::middle});
    }
  }

  static void shade(Canvas& canvas, const Cell& cell, const Shade& one) {
    const Rect& plot = cell.frame.plot;
    const double top = one.y ? cell.frame.y.inside(one.y->second) : plot.y;
    const double bottom = one.y ? cell.frame.y.inside(one.y->first) : plot.bottom();
    stretch(canvas, cell, one.from, one.to, top, bottom - top, one.colour);
  }

  static void stretch(Canvas& canvas, const Cell& cell, double from, double to, double y, double height,
                      const Colour& colour) {
    if (std::isnan(from) || std::isnan(to)) return;
    const double a = cell.frame.x.inside(std::min(from, to));
    const double b = cell.frame.x.inside(std::max(from, to));
    if (b > a) canvas.fill(Path::rectangle({a, y, b - a, height}), colour);
  }

  static void grid(Canvas& canvas, const Panel& panel, const Cell& cell) {
    const Rect& plot = cell.frame.plot;
    const Pen pen{palette::grid, 0.5};
    for (const double y : cell.y_ticks.at) {
      canvas.line({plot.x, cell.frame.y.inside(y)}, {plot.right(), cell.frame.y.inside(y)}, pen);
    }
    for (const double x : cell.x_ticks.at) {
      canvas.line({cell.frame.x.inside(x), plot.y}, {cell.frame.x.inside(x), plot.bottom()}, pen);
    }
    // Draw the zero line where numbers have both signs.
    if (panel.y.scale == AxisScale::linear && cell.y.lo < 0.0 && cell.y.hi > 0.0) {
      canvas.line({plot.x, cell.frame.y(0.0)}, {plot.right(), cell.frame.y(0.0)}, {palette::frame, 0.6});
    }
  }

  static void axes(Canvas& canvas, const Panel& panel, const Cell& cell) {
    const Rect& plot = cell.frame.plot;
    const Pen pen{palette::frame, 0.8, {}, Cap::square};
    canvas.line({plot.x, plot.y}, {plot.x, plot.bottom()}, pen);
    canvas.line({plot.x, plot.bottom()}, {plot.right(), plot.bottom()}, pen);
    y_axis(canvas, cell);
    x_axis(canvas, cell);
    double y = plot.y - lanes_height(panel);
    for (const auto& lane : panel.lanes) {
      for (const auto& [from, to] : lane.stretches) stretch(canvas, cell, from, to, y, lane_height, lane.colour);
      y += lane_height + lane_gap;
    }
  }

  static void y_axis(Canvas& canvas, const Cell& cell) {
    const Rect& plot = cell.frame.plot;
    const Pen pen{palette::frame, 0.8};
    double widest = 0.0;
    for (std::size_t i = 0; i < cell.y_ticks.at.size(); ++i) {
      const double y = cell.frame.y.inside(cell.y_ticks.at[i]);
      canvas.line({plot.x - tick_length, y}, {plot.x, y}, pen);
      if (!cell.label_y) continue;
      canvas.text(cell.y_ticks.labels[i], {plot.x - tick_length - tick_gap, y},
                  {tick_font, palette::ink, Align::right, Stand::middle});
      widest = std::max(widest, text_extents(cell.y_ticks.labels[i], tick_font).width);
    }
    for (const double at : cell.y_ticks.minor) {
      const double y = cell.frame.y.inside(at);
      canvas.line({plot.x - 0.55 * tick_length, y}, {plot.x, y}, {palette::frame, 0.5});
    }
    if (!cell.label_y) return;
    Point at{plot.x - tick_length - tick_gap - widest - 4.0 - block_height(cell.y_label, label_font), plot.centre().y};
    for (const auto& line : cell.y_label) {
      canvas.text(line, at, {label_font, palette::ink, Align::centre, Stand::top, 90.0});
      at.x += line_height(label_font);
    }
  }

  static void x_axis(Canvas& canvas, const Cell& cell) {
    const Rect& plot = cell.frame.plot;
    const double y = plot.bottom();
    const TextStyle style{tick_font, palette::ink, Align::centre, Stand::top};
    double end = -1e9;
    for (std::size_t i = 0; i < cell.x_ticks.at.size(); ++i) {
      const double x = cell.frame.x.inside(cell.x_ticks.at[i]);
      canvas.line({x, y}, {x, y + tick_length}, {palette::frame, 0.8});
      const double half = 0.5 * text_extents(cell.x_ticks.labels[i], tick_font).width;
      if (!cell.label_x || x - half < end) continue;
      canvas.text(cell.x_ticks.labels[i], {x, y + tick_length + tick_gap - 1.0}, style);
      end = x + half + 3.0;
    }
    for (const double at : cell.x_ticks.minor) {
      const double x = cell.frame.x.inside(at);
      canvas.line({x, y}, {x, y + 0.55 * tick_length}, {palette::frame, 0.5});
    }
    if (!cell.label_x) return;
    const double below = y + tick_gap + 2.0;
    for (std::size_t i = 0; i < cell.names.lines.size(); i += cell.names.stride) {
      const double x = cell.frame.x(static_cast<double>(i));
      switch (cell.names.set) {
        case Names::Set::flat: block(canvas, cell.names.lines[i], {x, below - 1.0}, style); break;
        case Names::Set::slanted:
          canvas.text(cell.names.lines[i][0], {x + 3.0, below},
                      {tick_font, palette::ink, Align::right, Stand::top, slant});
          break;
        case Names::Set::upright:
          canvas.text(cell.names.lines[i][0], {x, below}, {tick_font, palette::ink, Align::right, Stand::middle, 90.0});
          break;
      }
    }
    const double height =
        cell.names.lines.empty() ? tick_length + tick_gap + line_height(tick_font) : tick_gap + 2.0 + cell.names.height;
    block(canvas, cell.x_label, {plot.centre().x, y + height + 3.0}, {label_font, palette::ink, Align::centre});
  }

  Figure figure_;
  std::vector<Cell> cells_;
  std::vector<Entry> legend_;
  std::vector<std::string> title_;
  std::vector<std::string> caption_;
  double width_ = 0.0;
  double height_ = 0.0;
};

}  // namespace

Canvas plot(const Figure& figure) { return Plot(figure).draw(); }

}  // namespace trellis::draw
