// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/draw/spatial.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <tuple>
#include <utility>

#include <trellis/base/error.hpp>
#include <trellis/draw/circles.hpp>
#include <trellis/draw/depth_order.hpp>
#include <trellis/draw/page.hpp>
#include <trellis/draw/text.hpp>
#include <trellis/draw/ticks.hpp>
#include <trellis/draw/worlds.hpp>

namespace trellis::draw {

namespace {

constexpr double most_cells = 1e6;
constexpr double tallest = 1.3;           ///< height of a panel, in widths of its column
constexpr double marked_below = 4.0;      ///< points; a smaller robot has a mark
constexpr double failed_radius = 0.9;     ///< points
constexpr double edges_from = 4.0;        ///< points; smaller faces have no edges
constexpr double mark_radius = 2.2;       ///< points
constexpr std::size_t most_items = 9000;  ///< of a figure, after cuts
constexpr double seam = 0.6;              ///< points: hides lines between faces that touch
constexpr double cut_beyond = 0.15;       ///< of the longest side: farther outside of the bounds, obstacles are cut off
constexpr double faint = 0.3;             ///< opacity of what obstacles hide
constexpr int shades = 20;
constexpr Colour pose_colour = rgb(0x9CC6E3);
constexpr Colour invalid_colour = rgb(0xEBA27A);
constexpr Colour path_colour = palette::vermillion;

double& along(Point3& p, std::size_t axis) { return axis == 0 ? p.x : axis == 1 ? p.y : p.z; }
double along(const Point3& p, std::size_t axis) { return axis == 0 ? p.x : axis == 1 ? p.y : p.z; }

struct Box {
  Point3 lo;
  Point3 hi;

  void add(const Point3& p) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      along(lo, axis) = std::min(along(lo, axis), along(p, axis));
      along(hi, axis) = std::max(along(hi, axis), along(p, axis));
    }
  }
  [[nodiscard]] Point3 corner(unsigned bits) const {
    return {(bits & 1U) != 0 ? hi.x : lo.x, (bits & 2U) != 0 ? hi.y : lo.y, (bits & 4U) != 0 ? hi.z : lo.z};
  }
  [[nodiscard]] Point3 centre() const { return 0.5 * (lo + hi); }
  [[nodiscard]] double longest() const { return std::max({hi.x - lo.x, hi.y - lo.y, hi.z - lo.z}); }
};

using Ends = std::pair<std::uint32_t, std::uint32_t>;

/// Returns the faces of a surface: two triangles in one plane that make a convex quadrilateral are one. Each is a list
/// of vertices, followed by the number of a triangle of it.
std::vector<std::vector<std::uint32_t>> polygons_of(const Surface& surface, const std::vector<Point3>& normals) {
  std::map<Ends, std::size_t> sides;  // directed
  for (std::size_t i = 0; i < surface.triangles.size(); ++i) {
    const auto& t = surface.triangles[i];
    for (std::size_t k = 0; k < 3; ++k) sides.emplace(Ends{t[k], t[(k + 1) % 3]}, i);
  }
  const auto turns_left = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c, const Point3& normal) {
    const auto& v = surface.vertices;
    return dot(cross(v[b] - v[a], v[c] - v[b]), normal) > 0.0;
  };
  std::vector<bool> used(surface.triangles.size(), false);
  std::vector<std::vector<std::uint32_t>> out;
  for (std::size_t i = 0; i < surface.triangles.size(); ++i) {
    if (used[i]) continue;
    used[i] = true;
    const auto& t = surface.triangles[i];
    const auto number = static_cast<std::uint32_t>(i);
    std::vector<std::uint32_t> face{t[0], t[1], t[2], number};
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = t[k];
      const std::uint32_t b = t[(k + 1) % 3];
      const std::uint32_t c = t[(k + 2) % 3];
      const auto other = sides.find({b, a});
      if (other == sides.end() || used[other->second]) continue;
      constexpr double plane = 1.0 - 1e-12;
      const Point3& normal = normals[i];
      if (dot(normal, normals[other->second]) < plane) continue;
      const auto& u = surface.triangles[other->second];
      const std::uint32_t d = u[0] != a && u[0] != b ? u[0] : u[1] != a && u[1] != b ? u[1] : u[2];
      if (!turns_left(c, a, d, normal) || !turns_left(d, b, c, normal)) continue;
      used[other->second] = true;
      face = {a, d, b, c, number};
      break;
    }
    out.push_back(std::move(face));
  }
  return out;
}

/// The meaning of a face, a line or a dot.
enum class Part : std::uint8_t { obstacle, start, goal, pose, invalid, path, tree, failed, layer };

struct Style {
  Part part = Part::obstacle;
  std::size_t index = 0;  ///< of the layer
  double radius = 0.0;    ///< of a dot, points
  Colour fill{};          ///< of a face, shaded
};

Colour base_colour(Part part) {
  switch (part) {
    case Part::start: return start_colour;
    case Part::goal: return goal_colour;
    case Part::pose: return pose_colour;
    case Part::invalid: return invalid_colour;
    default: return obstacle_colour;
  }
}

Pen edge_pen(Part part) {
  switch (part) {
    case Part::start:
    case Part::goal: return {palette::ink, 0.7, {}, Cap::round};
    case Part::pose: return {palette::blue, 0.4, {}, Cap::round};
    case Part::invalid: return {palette::vermillion, 0.4, {}, Cap::round};
    default: return {obstacle_edge, 0.4, {}, Cap::round};
  }
}

/// Cuts a convex polygon off above a limit of an axis.
void cut(SpatialItem& face, std::size_t axis, double limit, double sign) {
  SpatialItem part{.kind = face.kind, .style = face.style};
  const std::size_t count = face.points.size();
  for (std::size_t i = 0; i < count; ++i) {
    const Point3& p = face.points[i];
    const Point3& q = face.points[(i + 1) % count];
    const double a = sign * (limit - along(p, axis));
    const double b = sign * (limit - along(q, axis));
    if (a >= 0.0) {
      part.points.push_back(p);
      part.edges.push_back(face.edges[i] && !(a == 0.0 && b < 0.0));
    }
    if ((a > 0.0 && b < 0.0) || (a < 0.0 && b > 0.0)) {
      part.points.push_back(p + (a / (a - b)) * (q - p));
      part.edges.push_back(a < 0.0 && face.edges[i]);
    }
  }
  face = std::move(part);
}

struct Extent2 {
  double x0 = std::numeric_limits<double>::infinity();
  double y0 = std::numeric_limits<double>::infinity();
  double x1 = -std::numeric_limits<double>::infinity();
  double y1 = -std::numeric_limits<double>::infinity();

  void add(Point p) {
    x0 = std::min(x0, p.x);
    y0 = std::min(y0, p.y);
    x1 = std::max(x1, p.x);
    y1 = std::max(y1, p.y);
  }
};

/// Finds the faces of which nothing is seen: draws each in its order into a raster of their numbers.
class SeenFaces {
 public:
  explicit SeenFaces(const Rect& plot)
      : plot_(plot),
        columns_(static_cast<std::size_t>(std::ceil(plot.width * cells)) + 1),
        rows_(static_cast<std::size_t>(std::ceil(plot.height * cells)) + 1),
        last_(columns_ * rows_, none) {}

  void draw(const std::vector<Point>& polygon, std::uint32_t number) {
    double top = std::numeric_limits<double>::infinity();
    double bottom = -top;
    for (const Point& p : polygon) {
      top = std::min(top, p.y);
      bottom = std::max(bottom, p.y);
    }
    const auto row_of = [&](double y) {
      return static_cast<std::size_t>(std::clamp((y - plot_.y) * cells, 0.0, static_cast<double>(rows_ - 1)));
    };
    for (std::size_t row = row_of(top); row <= row_of(bottom); ++row) {
      const double y = plot_.y + (static_cast<double>(row) + 0.5) / cells;
      double from = std::numeric_limits<double>::infinity();
      double to = -from;
      for (std::size_t i = 0; i < polygon.size(); ++i) {
        const Point& a = polygon[i];
        const Point& b = polygon[(i + 1) % polygon.size()];
        if ((a.y <= y) == (b.y <= y)) continue;
        const double x = a.x + (y - a.y) / (b.y - a.y) * (b.x - a.x);
        from = std::min(from, x);
        to = std::max(to, x);
      }
      if (!(from <= to)) continue;
      const auto last = static_cast<double>(columns_ - 1);
      const auto begin = static_cast<std::size_t>(std::clamp(std::ceil((from - plot_.x) * cells - 0.5), 0.0, last));
      const auto end = static_cast<std::size_t>(std::clamp(std::ceil((to - plot_.x) * cells - 0.5), 0.0, last));
      for (std::size_t column = begin; column < end; ++column) last_[row * columns_ + column] = number;
    }
  }
  /// Whether a face that was drawn after `number` covers a point.
  [[nodiscard]] bool covered(Point p, std::uint32_t number) const {
    const double x = (p.x - plot_.x) * cells;
    const double y = (p.y - plot_.y) * cells;
    if (!(x >= 0.0 && y >= 0.0 && x < static_cast<double>(columns_) && y < static_cast<double>(rows_))) return false;
    const std::uint32_t last = last_[static_cast<std::size_t>(y) * columns_ + static_cast<std::size_t>(x)];
    return last != none && last > number;
  }
  [[nodiscard]] std::vector<bool> seen(std::size_t count) const {
    std::vector<bool> out(count, false);
    for (const std::uint32_t number : last_) {
      if (number != none) out[number] = true;
    }
    return out;
  }

 private:
  static constexpr double cells = 2.5;  ///< for each point
  static constexpr std::uint32_t none = 0xFFFFFFFFU;
  Rect plot_;
  std::size_t columns_;
  std::size_t rows_;
  std::vector<std::uint32_t> last_;
};

/// Faces of one colour, lines or circles that are drawn together.
struct Batch {
  Colour fill;
  Part part = Part::obstacle;
  std::size_t index = 0;  ///< of the layer
  Path shapes;
  Path edges;
  Circles circles{true};
};

/// Collects parts of a picture, which come from far to near, into few batches. A part joins a batch of its look that
/// comes after all parts that it covers.
class Batches {
 public:
  explicit Batches(const Rect& plot)
      : plot_(plot),
        columns_(static_cast<std::size_t>(plot.width / side) + 1),
        rows_(static_cast<std::size_t>(plot.height / side) + 1),
        last_(columns_ * rows_, 0) {}

  /// \param edges  whether edges will be added, which cover the batch's faces
  Batch& batch(const Style& style, const Extent2& extent, bool edges) {
    // The first batch that a part in these cells may join.
    std::size_t first = 0;
    const Cells cells = cells_of(extent);
    for_each(cells, [&](std::size_t& last) { first = std::max(first, last); });
    const auto key = std::tuple{static_cast<int>(style.part), style.index, style.fill.r, style.fill.g, style.fill.b};
    std::vector<std::size_t>& known = by_look_[key];
    const auto found = std::lower_bound(known.begin(), known.end(), first);
    std::size_t at = 0;
    if (found != known.end()) {
      at = *found;
    } else {
      at = all_.size();
      all_.push_back({style.fill, style.part, style.index, {}, {}, Circles(true)});
      known.push_back(at);
    }
    // Later faces may not be below edges of this batch.
    for_each(cells, [&](std::size_t& last) { last = std::max(last, edges ? at + 1 : at); });
    return all_[at];
  }

  [[nodiscard]] const std::vector<Batch>& all() const { return all_; }

 private:
  static constexpr double side = 3.0;  ///< of a cell, points
  struct Cells {
    std::size_t x0, y0, x1, y1;
  };

  [[nodiscard]] Cells cells_of(const Extent2& extent) const {
    constexpr double rim = 0.5;  // lines reach farther than their points
    const auto cell = [](double x, std::size_t count) {
      return static_cast<std::size_t>(std::clamp(x / side, 0.0, static_cast<double>(count - 1)));
    };
    return {cell(extent.x0 - rim - plot_.x, columns_), cell(extent.y0 - rim - plot_.y, rows_),
            cell(extent.x1 + rim - plot_.x, columns_), cell(extent.y1 + rim - plot_.y, rows_)};
  }
  template <class F>
  void for_each(const Cells& cells, const F& f) {
    for (std::size_t row = cells.y0; row <= cells.y1; ++row) {
      for (std::size_t column = cells.x0; column <= cells.x1; ++column) f(last_[row * columns_ + column]);
    }
  }

  Rect plot_;
  std::size_t columns_;
  std::size_t rows_;
  std::vector<std::size_t> last_;  ///< of each cell: the least batch for what comes next there
  std::vector<Batch> all_;
  std::map<std::tuple<int, std::size_t, double, double, double>, std::vector<std::size_t>> by_look_;
};

/// Adds a polygon and its drawn edges to a batch.
void add_face(Batch& batch, const SpatialItem& item, const std::vector<Point>& outline, bool edges) {
  // One orientation: faces of a batch may overlap, and those of two orientations would cancel each other.
  double area = 0.0;
  for (std::size_t k = 0; k < outline.size(); ++k) {
    const Point& a = outline[k];
    const Point& b = outline[(k + 1) % outline.size()];
    area += a.x * b.y - b.x * a.y;
  }
  std::vector<Point> corners = outline;
  if (area < 0.0) std::reverse(corners.begin(), corners.end());
  append(batch.shapes, Path::polygon(corners));
  for (std::size_t k = 0; edges && k < outline.size(); ++k) {
    if (item.edges[k]) batch.edges.move_to(outline[k]).line_to(outline[(k + 1) % outline.size()]);
  }
}

/// A symbol of the legend.
struct Entry {
  enum class Sign : std::uint8_t { circles, tree, failed, start, goal, pose, invalid, path, obstacle };
  Sign sign = Sign::circles;
  std::string name;
  CircleLook look{};
};

class SpatialPlot {
 public:
  explicit SpatialPlot(const SpatialFigure& figure)
      : figure_(figure), grid_(figure.lo, figure.hi, figure.cell), world_{figure.lo, figure.hi} {
    if (figure_.columns == 0 || !(figure_.width > 2.0 * page::border)) {
      throw Fault("a picture of a world without columns or width");
    }
    if (figure_.panels.empty()) figure_.panels.emplace_back();
    figure_.columns = std::min(figure_.columns, figure_.panels.size());
    for (const auto& panel : figure_.panels) {
      for (const auto& layer : panel.layers) {
        if (layer.mean.size() == grid_.size()) continue;
        throw Fault(
            fmt::format("the layer '{}' has {} cells, its grid {}", layer.name, layer.mean.size(), grid_.size()));
      }
    }
    direction_ = figure_.camera.direction();
    right_ = figure_.camera.right();
    up_ = figure_.camera.up();
    find_extent();
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
  struct Frame {
    Rect plot;
    double right = 0.0;  ///< of the panel's column
    std::vector<std::string> title;
    double area = 0.0;
    std::vector<double> sizes;
  };

  /// The box of the picture: the bounds, and what obstacles and robots are little beyond.
  void find_extent() {
    extent_ = world_;
    const double room = cut_beyond * world_.longest();
    Box most = world_;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      along(most.lo, axis) -= room;
      along(most.hi, axis) += room;
    }
    limit_ = most;
    const auto add = [&](const std::vector<Surface>& surfaces) {
      for (const Surface& surface : surfaces) {
        for (Point3 p : surface.vertices) {
          for (std::size_t axis = 0; axis < 3; ++axis) {
            along(p, axis) = std::clamp(along(p, axis), along(most.lo, axis), along(most.hi, axis));
          }
          extent_.add(p);
        }
      }
    };
    add(figure_.obstacles);
    add(figure_.start);
    add(figure_.goal);
    for (const auto& panel : figure_.panels) add(panel.poses);
    Extent2 flat;
    for (unsigned i = 0; i < 8; ++i) flat.add(flat_of(extent_.corner(i)));
    flat_ = flat;
  }

  [[nodiscard]] Point flat_of(const Point3& p) const { return {dot(right_, p), -dot(up_, p)}; }
  [[nodiscard]] Point place(const Rect& plot, const Point3& p) const {
    const Point at = flat_of(p);
    return {plot.x + (at.x - flat_.x0) * scale_, plot.y + (at.y - flat_.y0) * scale_};
  }

  [[nodiscard]] const std::vector<Surface>& start_of(const SpatialPanel& panel) const {
    return panel.start.empty() ? figure_.start : panel.start;
  }
  [[nodiscard]] const std::vector<Surface>& goal_of(const SpatialPanel& panel) const {
    return panel.goal.empty() ? figure_.goal : panel.goal;
  }

  [[nodiscard]] CircleLook look(const SpatialPanel& panel, const CircleLayer& layer) const {
    return circle_look(layer.role, figure_.colours, panel.layers.size() == 1);
  }

  void make_legend() {
    using Sign = Entry::Sign;
    const auto add = [&](Entry entry) {
      const bool known =
          std::any_of(legend_.begin(), legend_.end(), [&](const Entry& e) { return e.name == entry.name; });
      if (!entry.name.empty() && !known) legend_.push_back(std::move(entry));
    };
    auto by_layers = figure_.panels;
    std::stable_sort(by_layers.begin(), by_layers.end(),
                     [](const auto& a, const auto& b) { return a.layers.size() > b.layers.size(); });
    for (const auto& panel : by_layers) {
      for (const auto& layer : panel.layers) add({Sign::circles, layer.name, look(panel, layer)});
    }
    const auto any = [&](const auto& has) { return std::any_of(figure_.panels.begin(), figure_.panels.end(), has); };
    if (any([](const auto& panel) { return !panel.tree.empty(); })) add({Sign::tree, "tree", {}});
    if (any([](const auto& panel) { return !panel.failed.empty(); })) {
      add({Sign::failed, "proposals without a node", {}});
    }
    if (!figure_.start.empty()) add({Sign::start, "start", {}});
    if (!figure_.goal.empty()) add({Sign::goal, "goal", {}});
    const auto blocked = [](bool invalid) { return invalid; };
    const bool invalid =
        any([&](const auto& panel) { return std::any_of(panel.invalid.begin(), panel.invalid.end(), blocked); });
    if (any([](const auto& panel) { return !panel.poses.empty(); })) add({Sign::pose, "robot on its path", {}});
    if (invalid) add({Sign::invalid, "invalid there", {}});
    if (any([](const auto& panel) { return !panel.paths.empty(); })) add({Sign::path, "path", {}});
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
    // Numbers and names of the axes.
    constexpr double beside = 26.0;
    constexpr double below = 22.0;
    const double wide = flat_.x1 - flat_.x0;
    const double high = flat_.y1 - flat_.y0;
    const double room = std::max(20.0, column - 2.0 * beside);
    scale_ = std::min(room / wide, tallest * room / high);
    title_ = page::wrapped(figure_.title, text_width(), page::title_font, 3);
    caption_ = page::wrapped(figure_.caption, text_width(), page::caption_font, 40);
    legend_top_ = page::border + page::block_height(title_, page::title_font) + (title_.empty() ? 0.0 : 4.0);
    double y = legend_top_ + rows_.height;
    const std::size_t count = figure_.panels.size();
    frames_.resize(count);
    for (std::size_t begin = 0; begin < count; begin += figure_.columns) {
      const std::size_t end = std::min(begin + figure_.columns, count);
      double top = 4.0;
      double bottom = below;
      for (std::size_t p = begin; p < end; ++p) {
        const SpatialPanel& panel = figure_.panels[p];
        Frame& frame = frames_[p];
        frame.title = page::wrapped(panel.title, column, page::panel_font, 3);
        frame.area = area_per_sample(panel.layers, grid_.cell()) * scale_ * scale_;
        frame.sizes = visible_sizes(sizes_explained(panel.layers), frame.area);
        if (!frame.title.empty()) top = std::max(top, page::block_height(frame.title, page::panel_font) + 5.0);
        if (!frame.sizes.empty()) bottom = std::max(bottom, below + circle_sizes_height(frame.sizes, frame.area) + 3.0);
      }
      for (std::size_t p = begin; p < end; ++p) {
        const double left = page::border + static_cast<double>(p - begin) * (column + page::gap);
        frames_[p].right = left + column;
        frames_[p].plot = {left + 0.5 * (column - wide * scale_), y + top, wide * scale_, high * scale_};
      }
      y += top + high * scale_ + bottom + (end < count ? 0.5 * page::gap : 0.0);
    }
    height_ = y + (caption_.empty() ? 0.0 : 4.0 + page::block_height(caption_, page::caption_font)) + page::border;
  }

  /// Whether a surface is as large as the bounds, as that of a room with its contents.
  [[nodiscard]] bool encloses(const Surface& surface) const {
    if (surface.vertices.empty()) return false;
    Box box{surface.vertices[0], surface.vertices[0]};
    for (const Point3& p : surface.vertices) box.add(p);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      constexpr double covered = 0.6;
      const double from = std::max(along(box.lo, axis), along(world_.lo, axis));
      const double to = std::min(along(box.hi, axis), along(world_.hi, axis));
      if (to - from < covered * (along(world_.hi, axis) - along(world_.lo, axis))) return false;
    }
    return true;
  }

  /// Whether a face lies at or beyond a side of the bounds that faces the camera, along this side.
  [[nodiscard]] bool before_side(const std::vector<Point3>& corners, const Point3& normal) const {
    constexpr double depth = 0.03;  // of the bounds along the axis
    constexpr double facing = 0.05;
    constexpr double level = 0.95;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double towards = along(direction_, axis);
      if (std::abs(towards) < facing || std::abs(along(normal, axis)) < level) continue;
      const double room = depth * (along(world_.hi, axis) - along(world_.lo, axis));
      if (std::all_of(corners.begin(), corners.end(), [&](const Point3& p) {
            return towards > 0.0 ? along(p, axis) >= along(world_.hi, axis) - room
                                 : along(p, axis) <= along(world_.lo, axis) + room;
          })) {
        return true;
      }
    }
    return false;
  }

  /// Adds the faces of a surface that face the camera; of one without an inside, all. Of one that encloses the scene,
  /// leaves out the side before it.
  void add_faces(const Surface& surface, Part part, std::vector<SpatialItem>& items, std::vector<Style>& styles) const {
    const bool outside =
        part == Part::obstacle && std::any_of(surface.vertices.begin(), surface.vertices.end(), [&](const Point3& p) {
          for (std::size_t axis = 0; axis < 3; ++axis) {
            if (along(p, axis) < along(limit_.lo, axis) || along(p, axis) > along(limit_.hi, axis)) return true;
          }
          return false;
        });
    const bool opened = part == Part::obstacle && encloses(surface);
    const bool cut_open = outside || opened;
    const auto edges = feature_edges(surface);
    // Where a face that is seen meets one that is not, the form ends.
    std::vector<Ends> hidden;
    std::vector<Point3> normals;
    for (const auto& t : surface.triangles) {
      const auto& v = surface.vertices;
      normals.push_back(unit(cross(v[t[1]] - v[t[0]], v[t[2]] - v[t[0]])));
      if (!surface.closed || dot(normals.back(), direction_) > 0.0) continue;
      for (std::size_t k = 0; k < 3; ++k) hidden.emplace_back(std::minmax(t[k], t[(k + 1) % 3]));
    }
    std::sort(hidden.begin(), hidden.end());
    // From left above, in front of the scene.
    const Point3 light = unit(-0.35 * right_ + 0.55 * up_ + 0.75 * direction_);
    for (const std::vector<std::uint32_t>& polygon : polygons_of(surface, normals)) {
      const auto triangle = static_cast<std::size_t>(polygon.back());
      const std::vector<std::uint32_t> corners(polygon.begin(), polygon.end() - 1);
      Point3 normal = normals[triangle];
      const double facing = dot(normal, direction_);
      if (std::abs(facing) < 1e-9 || (surface.closed && !cut_open && facing < 0.0)) continue;
      SpatialItem face;
      for (std::size_t k = 0; k < corners.size(); ++k) {
        const Ends edge = std::minmax(corners[k], corners[(k + 1) % corners.size()]);
        face.points.push_back(surface.vertices[corners[k]]);
        face.edges.push_back(std::binary_search(edges.begin(), edges.end(), edge) ||
                             std::binary_search(hidden.begin(), hidden.end(), edge));
      }
      if (opened && before_side(face.points, normal)) continue;
      if (facing < 0.0) normal = -1.0 * normal;
      face.style = static_cast<std::uint32_t>(styles.size());
      if (outside) {
        for (std::size_t axis = 0; axis < 3; ++axis) {
          if (!face.points.empty()) cut(face, axis, along(limit_.hi, axis), 1.0);
          if (!face.points.empty()) cut(face, axis, along(limit_.lo, axis), -1.0);
        }
        if (face.points.size() < 3) continue;
      }
      const double bright = std::round(shades * std::max(0.0, dot(normal, light))) / shades;
      const Colour base = base_colour(part);
      const double factor = part == Part::goal ? 0.86 + 0.14 * bright : 0.74 + 0.42 * bright;
      styles.push_back(
          {part,
           0,
           0.0,
           {std::min(1.0, factor * base.r), std::min(1.0, factor * base.g), std::min(1.0, factor * base.b)}});
      items.push_back(std::move(face));
    }
  }

  void add_line(const std::vector<Point3>& points, std::uint32_t style, std::vector<SpatialItem>& items) const {
    for (std::size_t i = 0; i + 1 < points.size(); ++i) {
      items.push_back({SpatialItem::Kind::line, {points[i], points[i + 1]}, {}, style});
    }
  }

  [[nodiscard]] Pen line_pen(Part part) const {
    if (part == Part::tree) return {palette::tree.faded(0.7), 0.5, {}, Cap::round};
    if (figure_.strong_path) return {path_colour, 1.3, {}, Cap::round};
    return {palette::ink.faded(0.7), 0.7, {}, Cap::round};
  }

  void draw_panel(Canvas& canvas, std::size_t p) const {
    const SpatialPanel& panel = figure_.panels[p];
    const Frame& frame = frames_[p];
    const Rect& plot = frame.plot;
    if (!frame.title.empty()) {
      const auto columns = static_cast<double>(figure_.columns);
      const double column = (text_width() - page::gap * (columns - 1.0)) / columns;
      const double left = plot.x - 0.5 * (column - plot.width);
      page::block(canvas, frame.title, {left, plot.y - 5.0 - page::block_height(frame.title, page::panel_font)},
                  {page::panel_font, palette::ink});
    }
    draw_box(canvas, plot, false);
    draw_axes(canvas, plot);

    std::vector<SpatialItem> items;
    std::vector<Style> styles;
    for (const Surface& s : figure_.obstacles) {
      if (!closes_view(s, world_.lo, world_.hi, figure_.camera)) add_faces(s, Part::obstacle, items, styles);
    }
    for (std::size_t i = 0; i < panel.poses.size(); ++i) {
      const bool invalid = i < panel.invalid.size() && panel.invalid[i];
      add_faces(panel.poses[i], invalid ? Part::invalid : Part::pose, items, styles);
    }
    for (const Surface& s : start_of(panel)) add_faces(s, Part::start, items, styles);
    for (const Surface& s : goal_of(panel)) add_faces(s, Part::goal, items, styles);
    const auto path_style = static_cast<std::uint32_t>(styles.size());
    styles.push_back({Part::path, 0, 0.0, {}});
    for (const auto& path : panel.paths) add_line(path, path_style, items);
    const auto tree_style = static_cast<std::uint32_t>(styles.size());
    styles.push_back({Part::tree, 0, 0.0, {}});
    for (const auto& [from, to] : panel.tree) items.push_back({SpatialItem::Kind::line, {from, to}, {}, tree_style});
    const auto failed_style = static_cast<std::uint32_t>(styles.size());
    styles.push_back({Part::failed, 0, failed_radius, {}});
    for (const Point3& at : panel.failed) items.push_back({SpatialItem::Kind::dot, {at}, {}, failed_style});
    const std::vector<CircleLayer> layers = below_each_other(panel.layers);
    for (std::size_t l = 0; l < layers.size(); ++l) {
      for (std::size_t i = 0; i < layers[l].mean.size(); ++i) {
        const double radius = circle_radius(layers[l].mean[i] * frame.area);
        if (!(radius > 0.0)) continue;
        items.push_back({SpatialItem::Kind::dot, {grid_.centre(i)}, {}, static_cast<std::uint32_t>(styles.size())});
        styles.push_back({Part::layer, l, radius, {}});
      }
    }
    const double tolerance = 1e-7 * std::sqrt(dot(extent_.hi - extent_.lo, extent_.hi - extent_.lo));
    const std::size_t most = std::max(items.size() + items.size() / 2, most_items / figure_.panels.size());
    items = far_to_near(std::move(items), direction_, tolerance, most);
    {
      // Samples may lie far outside of the world.
      constexpr double rim = 14.0;
      const auto clip = canvas.clip(Path::rectangle(plot.grown(rim)));
      draw_items(canvas, plot, panel, layers, items, styles);
      draw_box(canvas, plot, true);
      draw_hidden(canvas, panel, frame);
    }
    if (!panel.note.empty()) draw_note(canvas, panel.note, plot);
    if (!frame.sizes.empty()) {
      const CircleLook grey{palette::muted, 0.3};
      draw_circle_sizes(canvas, frame.sizes, frame.area,
                        panel.layers.size() == 1 ? look(panel, panel.layers.front()) : grey,
                        {plot.x, plot.y, frame.right - plot.x, plot.height + 20.0});
    }
  }

  /// Returns the polygon on paper, in steps of a twentieth of a point: files are smaller.
  [[nodiscard]] std::vector<Point> outline_of(const Rect& plot, const SpatialItem& item) const {
    std::vector<Point> points;
    points.reserve(item.points.size());
    for (const Point3& p : item.points) points.push_back(step(place(plot, p)));
    return points;
  }

  void draw_items(Canvas& canvas, const Rect& plot, const SpatialPanel& panel, const std::vector<CircleLayer>& layers,
                  const std::vector<SpatialItem>& items, const std::vector<Style>& styles) const {
    SeenFaces raster(plot.grown(2.0));
    std::vector<std::vector<Point>> outlines;
    outlines.reserve(items.size());
    for (std::uint32_t i = 0; i < items.size(); ++i) {
      outlines.push_back(outline_of(plot, items[i]));
      if (items[i].kind == SpatialItem::Kind::face) raster.draw(outlines.back(), i);
    }
    const std::vector<bool> seen = raster.seen(items.size());
    Batches batches(plot.grown(2.0));
    std::vector<Path> covered(layers.size());
    Path failed;
    Path failed_behind;
    for (std::size_t i = 0; i < items.size(); ++i) {
      const Style& style = styles[items[i].style];
      const std::vector<Point>& outline = outlines[i];
      Extent2 extent;
      for (const Point& p : outline) extent.add(p);
      switch (items[i].kind) {
        case SpatialItem::Kind::face: {
          if (!seen[i]) break;
          // Edges of the smallest faces would be all that one sees.
          const bool large = std::max(extent.x1 - extent.x0, extent.y1 - extent.y0) >= edges_from;
          const bool edges =
              large && std::find(items[i].edges.begin(), items[i].edges.end(), true) != items[i].edges.end();
          add_face(batches.batch(style, extent, edges), items[i], outline, edges);
          break;
        }
        case SpatialItem::Kind::line: {
          Path& line = batches.batch(style, extent, false).shapes;
          // Lines in a row are one.
          if (line.points().empty() || !(line.points().back() == outline[0])) line.move_to(outline[0]);
          line.line_to(outline[1]);
          break;
        }
        case SpatialItem::Kind::dot: {
          const bool behind = raster.covered(outline[0], static_cast<std::uint32_t>(i));
          if (style.part == Part::failed) {
            append(behind ? failed_behind : failed, stepped(Path::circle(outline[0], style.radius)));
          } else if (behind) {
            append(covered[style.index], stepped(Path::circle(outline[0], style.radius)));
          } else {
            extent.add({outline[0].x - style.radius, outline[0].y - style.radius});
            extent.add({outline[0].x + style.radius, outline[0].y + style.radius});
            batches.batch(style, extent, false).circles.add(outline[0], style.radius);
          }
          break;
        }
      }
    }
    for (const Batch& batch : batches.all()) {
      switch (batch.part) {
        case Part::path:
        case Part::tree: canvas.stroke(batch.shapes, line_pen(batch.part)); break;
        case Part::layer: batch.circles.draw(canvas, look(panel, layers[batch.index])); break;
        default:
          canvas.fill(batch.shapes, batch.fill);
          canvas.stroke(batch.shapes, {batch.fill, seam});
          if (!batch.edges.verbs().empty()) canvas.stroke(batch.edges, edge_pen(batch.part));
      }
    }
    if (!failed.verbs().empty()) canvas.fill(failed, palette::orange.faded(0.7));
    if (!failed_behind.verbs().empty()) canvas.fill(failed_behind, palette::orange.faded(0.7 * faint));
    for (std::size_t l = 0; l < layers.size(); ++l) {
      if (!covered[l].verbs().empty()) canvas.fill(covered[l], look(panel, layers[l]).colour.faded(faint));
    }
  }

  /// Draws over everything, faintly, what obstacles may hide; and marks of robots that are too small to be seen.
  void draw_hidden(Canvas& canvas, const SpatialPanel& panel, const Frame& frame) const {
    const Rect& plot = frame.plot;
    Path paths;
    for (const auto& path : panel.paths) {
      std::vector<Point> points;
      points.reserve(path.size());
      for (const Point3& p : path) points.push_back(place(plot, p));
      append(paths, Path::polyline(points));
    }
    Pen pen = line_pen(Part::path);
    pen.colour = pen.colour.faded(faint * pen.colour.a * 1.4);
    if (!paths.verbs().empty()) canvas.stroke(paths, pen);
    Path tree;
    for (const auto& [from, to] : panel.tree) tree.move_to(step(place(plot, from))).line_to(step(place(plot, to)));
    if (!tree.verbs().empty()) canvas.stroke(tree, {palette::tree.faded(0.6 * faint), 0.5});
    Path poses;
    for (const Surface& surface : panel.poses) {
      for (const auto& [a, b] : drawn_edges(surface, direction_)) {
        poses.move_to(step(place(plot, surface.vertices[a]))).line_to(step(place(plot, surface.vertices[b])));
      }
    }
    if (!poses.verbs().empty()) canvas.stroke(poses, {palette::blue.faded(0.6 * faint), 0.35});
    for (const auto& [surfaces, at, colour] : {std::tuple{&start_of(panel), figure_.start_at, start_colour},
                                               std::tuple{&goal_of(panel), figure_.goal_at, goal_colour}}) {
      if (surfaces->empty()) continue;
      Extent2 size;
      Path outlines;
      for (const Surface& surface : *surfaces) {
        for (const Point3& p : surface.vertices) size.add(place(plot, p));
        for (const auto& [a, b] : drawn_edges(surface, direction_)) {
          outlines.move_to(place(plot, surface.vertices[a])).line_to(place(plot, surface.vertices[b]));
        }
      }
      if (!(size.x1 - size.x0 >= marked_below) && !(size.y1 - size.y0 >= marked_below)) {
        const Path mark = Path::circle(place(plot, at), mark_radius);
        canvas.fill(mark, colour);
        canvas.stroke(mark, {palette::ink, 0.8});
      } else if (!outlines.verbs().empty()) {
        canvas.stroke(outlines, {palette::ink.faded(faint), 0.5});
      }
    }
  }

  /// Draws the edges of the bounds: those behind the scene, or those before it.
  void draw_box(Canvas& canvas, const Rect& plot, bool before) const {
    // The corner that is farthest from the camera.
    unsigned far = 0;
    for (unsigned i = 1; i < 8; ++i) {
      if (dot(world_.corner(i), direction_) < dot(world_.corner(far), direction_)) far = i;
    }
    Path edges;
    for (unsigned i = 0; i < 8; ++i) {
      for (const unsigned bit : {1U, 2U, 4U}) {
        if ((i & bit) != 0) continue;
        const bool nearest = i == (far ^ 7U) || (i | bit) == (far ^ 7U);
        if (before ? nearest : !nearest) {
          edges.move_to(place(plot, world_.corner(i))).line_to(place(plot, world_.corner(i | bit)));
        }
      }
    }
    canvas.stroke(edges, before ? Pen{palette::frame.faded(0.35), 0.5} : Pen{palette::frame.faded(0.6), 0.5});
  }

  void draw_axes(Canvas& canvas, const Rect& plot) const {
    std::vector<Point> labelled;
    const Point middle = place(plot, world_.centre());
    const bool above = figure_.camera.elevation >= 0.0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      // Of the edges along the axis the one that is at the rim: below for x and y, at the left for z.
      unsigned best = 0;
      double least = std::numeric_limits<double>::infinity();
      const unsigned bit = 1U << axis;
      for (unsigned i = 0; i < 8; ++i) {
        if ((i & bit) != 0 || (axis < 2 && (((i & 4U) == 0) != above))) continue;
        const Point at = place(plot, 0.5 * (world_.corner(i) + world_.corner(i | bit)));
        const double rim = axis == 2 ? at.x : -at.y;
        if (rim < least - 1e-6) {
          least = rim;
          best = i;
        }
      }
      const Point3 from = world_.corner(best);
      const Point3 to = world_.corner(best | bit);
      const Point a = place(plot, from);
      const Point b = place(plot, to);
      const double length = std::hypot(b.x - a.x, b.y - a.y);
      constexpr double shortest = 14.0;
      if (length < shortest) continue;
      // Outwards: at a right angle to the edge, away from the middle.
      Point out{(b.y - a.y) / length, (a.x - b.x) / length};
      const Point half{0.5 * (a.x + b.x), 0.5 * (a.y + b.y)};
      if (out.x * (half.x - middle.x) + out.y * (half.y - middle.y) < 0.0) out = {-out.x, -out.y};
      constexpr double per_tick = 26.0;
      const auto most = static_cast<std::size_t>(std::clamp(length / per_tick, 2.0, 6.0));
      const double lo = along(from, axis);
      const double hi = along(to, axis);
      const Ticks ticks = linear_ticks({lo, hi}, most);
      const Align align = out.x < -0.3 ? Align::right : out.x > 0.3 ? Align::left : Align::centre;
      const Stand stand = out.y > 0.3 ? Stand::top : out.y < -0.3 ? Stand::bottom : Stand::middle;
      double widest = 0.0;
      for (std::size_t i = 0; i < ticks.at.size(); ++i) {
        const double share = (ticks.at[i] - lo) / (hi - lo);
        const Point at{a.x + share * (b.x - a.x), a.y + share * (b.y - a.y)};
        canvas.line(at, {at.x + 2.5 * out.x, at.y + 2.5 * out.y}, {palette::frame, 0.5});
        // At a corner two axes would write over each other.
        constexpr double apart = 9.0;
        if (std::any_of(labelled.begin(), labelled.end(),
                        [&](const Point& p) { return std::hypot(p.x - at.x, p.y - at.y) < apart; })) {
          continue;
        }
        labelled.push_back(at);
        canvas.text(ticks.labels[i], {at.x + 3.5 * out.x, at.y + 3.5 * out.y},
                    {page::tick_font, palette::muted, align, stand});
        widest = std::max(widest, text_extents(ticks.labels[i], page::tick_font).width);
      }
      std::string name = fmt::format("{}", "xyz"[axis]);
      name += ticks.exponent != 0 ? fmt::format(" ({} m)", power_text(ticks.exponent)) : " (m)";
      const double past = stand == Stand::middle ? widest + 6.0 : 6.0 + page::line_height(page::tick_font);
      if (axis == 2) {
        canvas.text(name, {std::min(a.x, b.x) + 2.0, std::min(a.y, b.y) - 5.0},
                    {page::tick_font, palette::muted, Align::right, Stand::bottom});
      } else {
        canvas.text(name, {half.x + past * out.x * 1.25, half.y + past * out.y},
                    {page::tick_font, palette::muted, align, Stand::top});
      }
    }
  }

  void draw_entry(Canvas& canvas, const Entry& entry, Point at) const {
    const Point middle{at.x + 0.5 * page::swatch, at.y + 0.5 * page::line_height(page::legend_font)};
    const Rect box{middle.x - 6.0, middle.y - 2.5, 12.0, 5.0};
    const auto solid = [&](Part part) {
      canvas.fill(Path::rectangle(box), base_colour(part));
      canvas.stroke(Path::rectangle(box), edge_pen(part));
    };
    switch (entry.sign) {
      case Entry::Sign::circles: {
        Circles circles;
        circles.add(middle, 4.0);
        circles.draw(canvas, entry.look);
        break;
      }
      case Entry::Sign::start: solid(Part::start); break;
      case Entry::Sign::goal: solid(Part::goal); break;
      case Entry::Sign::pose: solid(Part::pose); break;
      case Entry::Sign::invalid: solid(Part::invalid); break;
      case Entry::Sign::obstacle: solid(Part::obstacle); break;
      case Entry::Sign::tree:
        canvas.line({at.x, middle.y}, {at.x + page::swatch, middle.y}, line_pen(Part::tree));
        break;
      case Entry::Sign::failed:
        for (const double x : {-4.0, 0.0, 4.0}) {
          canvas.fill(Path::circle({middle.x + x, middle.y}, failed_radius), palette::orange);
        }
        break;
      case Entry::Sign::path:
        canvas.line({at.x, middle.y}, {at.x + page::swatch, middle.y}, line_pen(Part::path));
        break;
    }
    page::entry_name(canvas, entry.name, at);
  }

  SpatialFigure figure_;
  Grid3 grid_;
  Box world_;
  Box extent_{};  ///< of the picture
  Box limit_{};   ///< obstacles are cut off there
  Extent2 flat_{};
  Point3 direction_;
  Point3 right_;
  Point3 up_;
  std::vector<Frame> frames_;
  std::vector<Entry> legend_;
  page::LegendRows rows_;
  std::vector<std::string> title_;
  std::vector<std::string> caption_;
  double legend_top_ = 0.0;
  double scale_ = 1.0;  ///< points for each metre
  double height_ = 0.0;
};

double radians(double degrees) { return degrees * std::numbers::pi / 180.0; }

}  // namespace

Point3 Camera::direction() const {
  const double a = radians(azimuth);
  const double e = radians(elevation);
  return {std::cos(e) * std::cos(a), std::cos(e) * std::sin(a), std::sin(e)};
}

Point3 Camera::right() const { return {-std::sin(radians(azimuth)), std::cos(radians(azimuth)), 0.0}; }

Point3 Camera::up() const { return cross(direction(), right()); }

Camera camera_for(const Point3& lo, const Point3& hi) {
  constexpr double low = 30.0;
  constexpr double high = 58.0;
  constexpr double flat = 0.5;  // of the longer side
  const double height = (hi.z - lo.z) / std::max(hi.x - lo.x, hi.y - lo.y);
  return {.elevation = low + (high - low) * std::clamp(1.0 - height / flat, 0.0, 1.0)};
}

bool closes_view(const Surface& surface, const Point3& lo, const Point3& hi, const Camera& camera) {
  constexpr double depth = 0.05;   // of the longest side: so far inside it may reach
  constexpr double covered = 0.6;  // of the side, along both of its axes
  constexpr double facing = 0.05;
  if (surface.vertices.empty()) return false;
  Box box{surface.vertices[0], surface.vertices[0]};
  for (const Point3& p : surface.vertices) box.add(p);
  const double inside = depth * Box{lo, hi}.longest();
  const Point3 direction = camera.direction();
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double towards = along(direction, axis);
    const bool beyond = towards > facing    ? along(box.lo, axis) >= along(hi, axis) - inside
                        : towards < -facing ? along(box.hi, axis) <= along(lo, axis) + inside
                                            : false;
    if (!beyond) continue;
    double share = 1.0;
    for (std::size_t other = 0; other < 3; ++other) {
      if (other == axis) continue;
      const double from = std::max(along(box.lo, other), along(lo, other));
      const double to = std::min(along(box.hi, other), along(hi, other));
      share = std::min(share, (to - from) / (along(hi, other) - along(lo, other)));
    }
    if (share >= covered) return true;
  }
  return false;
}

Grid3::Grid3(const Point3& lo, const Point3& hi, double cell) : lo_(lo), hi_(hi), cell_(cell) {
  double all = 1.0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double length = along(hi, axis) - along(lo, axis);
    const double count = std::max(1.0, std::ceil(length / cell - 1e-9));
    all *= count;
    if (!(length > 0.0 && cell > 0.0 && std::isfinite(along(lo, axis)) && all <= most_cells)) {
      throw Fault(fmt::format("a grid of cells of {:g} in a world of {:g} x {:g} x {:g}", cell, hi.x - lo.x,
                              hi.y - lo.y, hi.z - lo.z));
    }
    counts_[axis] = static_cast<std::size_t>(count);
  }
}

bool Grid3::count(const Point3& p, double weight, std::vector<double>& counts) const {
  std::array<std::size_t, 3> at{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double x = along(p, axis) - along(lo_, axis);
    if (!(x >= 0.0 && along(p, axis) <= along(hi_, axis))) return false;
    at[axis] = std::min(counts_[axis] - 1, static_cast<std::size_t>(x / cell_));
  }
  counts[(at[2] * counts_[1] + at[1]) * counts_[0] + at[0]] += weight;
  return true;
}

Point3 Grid3::centre(std::size_t index) const {
  const auto middle = [&](std::size_t i, double from, double length) {
    const double lo = static_cast<double>(i) * cell_;
    return from + 0.5 * (lo + std::min(lo + cell_, length));
  };
  const std::size_t row = index / counts_[0];
  return {middle(index % counts_[0], lo_.x, hi_.x - lo_.x), middle(row % counts_[1], lo_.y, hi_.y - lo_.y),
          middle(row / counts_[1], lo_.z, hi_.z - lo_.z)};
}

Canvas plot(const SpatialFigure& figure) { return SpatialPlot(figure).draw(); }

}  // namespace trellis::draw
