// SPDX-License-Identifier: GPL-3.0-or-later
// Drawings of polygons, as bench-mr has them. The only source that includes tinyxml2.
#include <tinyxml2.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <map>
#include <numbers>
#include <optional>
#include <utility>

#include <trellis/reader/formats.hpp>
#include <trellis/reader/svg_path.hpp>
#include <trellis/reader/unread.hpp>
#include <trellis/reader/xml_entry.hpp>
#include <trellis/scene/limits.hpp>
#include <trellis/scene/planar/aggregate.hpp>
#include <trellis/scene/planar/scene.hpp>

namespace trellis {

namespace {

using tinyxml2::XMLElement;

/// The name without its namespace.
std::string name_of(const XMLElement& element) {
  const std::string name = element.Name();
  return name.starts_with("svg:") ? name.substr(4) : name;
}

std::string attribute(const XMLElement& element, const char* name) {
  const char* value = element.Attribute(name);
  return value != nullptr ? value : "";
}

/// What is drawn: convex hulls and discs, in metres, y up.
class Drawing {
 public:
  explicit Drawing(const SourceText& text) : text_(text) {
    const std::string all = text.joined();
    tinyxml2::XMLDocument document;
    if (document.Parse(all.data(), all.size()) != tinyxml2::XML_SUCCESS) {
      const auto line = static_cast<std::size_t>(std::max(document.ErrorLineNum(), 1));
      throw text.error(line, fmt::format("no SVG that can be read: {}", xml_fault(document)));
    }
    const XMLElement* root = document.RootElement();
    if (root == nullptr || name_of(*root) != "svg") {
      const std::string known = unread_xml(text);
      throw text.error(1, fmt::format("the outermost element is no 'svg'{}{}", known.empty() ? "" : ": ", known));
    }
    read_page(*root);
    visit(*root, page_);
    errors_.raise();
    for (const auto& [name, count] : ignored_) {
      warnings_.push_back(fmt::format("{} element{} '{}' ignored", count, count == 1 ? "" : "s", name));
    }
  }

  [[nodiscard]] std::vector<Obstacle>& shapes() { return shapes_; }
  [[nodiscard]] std::vector<std::string>& warnings() { return warnings_; }
  [[nodiscard]] const std::string& units() const { return units_; }
  /// The page, if the drawing has one, and all that is drawn.
  [[nodiscard]] Box2 bounds() const {
    std::optional<Box2> all = sheet_;
    for (const Obstacle& shape : shapes_) {
      const auto* disc = std::get_if<Disc>(&shape.shape);
      const Box2 box = disc != nullptr ? bounding_box(*disc) : bounding_box(std::get<Polygon>(shape.shape));
      all = all ? united(*all, box) : box;
    }
    return *all;
  }

 private:
  [[nodiscard]] Error error(const XMLElement& element, const std::string& fault) const {
    return text_.error(static_cast<std::size_t>(std::max(element.GetLineNum(), 1)), fault);
  }

  /// Reads an attribute; \throws Error with file and line
  template <class Read>
  auto read(const XMLElement& element, const char* name, const Read& reader) const {
    const std::string value = attribute(element, name);
    try {
      return reader(value);
    } catch (const Error& fault) {
      throw error(element, fmt::format("'{}': {}", name, fault.what()));
    }
  }

  /// A length in user units; `otherwise` where the attribute is missing.
  [[nodiscard]] double length(const XMLElement& element, const char* name, double otherwise) const {
    if (attribute(element, name).empty()) return otherwise;
    return read(element, name, [](const std::string& value) {
      const auto numbers = svg_numbers(value.ends_with("px") ? value.substr(0, value.size() - 2) : value);
      if (numbers.size() != 1) throw Error(fmt::format("'{}', expected one number", value));
      return numbers[0];
    });
  }

  /// Reads the page's units: a width in millimetres and the viewBox say how many user units a millimetre has.
  void read_page(const XMLElement& root) {
    double scale = 1.0;
    Vec2 corner;
    std::optional<Vec2> size;
    if (!attribute(root, "viewBox").empty()) {
      const auto box = read(root, "viewBox", svg_numbers);
      if (box.size() != 4 || box[2] <= 0.0 || box[3] <= 0.0) {
        throw error(root, "'viewBox' must be x, y, and a width and a height greater than 0");
      }
      corner = {box[0], box[1]};
      size = {box[2], box[3]};
    }
    units_ = "1 user unit = 1 m";
    constexpr std::array<std::pair<const char*, double>, 4> units = {
        {{"mm", 1.0}, {"cm", 10.0}, {"in", 25.4}, {"pt", 25.4 / 72.0}}};
    const std::string width = attribute(root, "width");
    for (const auto& [name, millimetres] : units) {
      if (!width.ends_with(name) || !size) continue;
      const auto numbers = read(root, "width", [&](const std::string& value) {
        return svg_numbers(std::string_view(value).substr(0, value.size() - 2));
      });
      if (numbers.size() != 1 || numbers[0] <= 0.0) throw error(root, fmt::format("the width is '{}'", width));
      scale = numbers[0] * millimetres / size->x;
      // A viewBox in millimetres, up to its last digits.
      constexpr double same = 1e-6;
      if (std::abs(scale - 1.0) < same) scale = 1.0;
      units_ = "1 mm of the drawing = 1 m";
    }
    if (size) sheet_ = Box2{{0.0, -scale * size->y}, {scale * size->x, 0.0}};
    page_ = {scale, 0.0, 0.0, -scale, -scale * corner.x, scale * corner.y};
  }

  void visit(const XMLElement& parent, const SvgTransform& outer) {
    for (const XMLElement* child = parent.FirstChildElement(); child != nullptr; child = child->NextSiblingElement()) {
      errors_.attempt([&] { element(*child, outer); });
    }
  }

  void element(const XMLElement& element, const SvgTransform& outer) {
    const std::string name = name_of(element);
    constexpr std::array<const char*, 12> silent = {"defs",   "metadata",       "title",    "desc",
                                                    "style",  "symbol",         "pattern",  "marker",
                                                    "script", "linearGradient", "clipPath", "mask"};
    if (std::find(silent.begin(), silent.end(), name) != silent.end()) return;
    if (name.find(':') != std::string::npos) return;  // of an editor
    if (hidden(element)) {
      ++ignored_[name + " (hidden)"];
      return;
    }
    const SvgTransform map = outer.after(read(element, "transform", svg_transform));
    if (name == "g" || name == "a" || name == "svg") return visit(element, map);
    if (shapes_.size() > most_obstacles) throw error(element, fmt::format("more than {} shapes", most_obstacles));
    if (name == "path") {
      add(element, read(element, "d", svg_path), map);
    } else if (name == "polygon" || name == "polyline") {
      add(element, points_of(element), map);
    } else if (name == "rect") {
      add(element, rectangle_of(element), map);
    } else if (name == "circle" || name == "ellipse") {
      add_round(element, name == "circle", map);
    } else {
      ++ignored_[name];
    }
  }

  static bool hidden(const XMLElement& element) {
    const std::string style = attribute(element, "style");
    return attribute(element, "display") == "none" || style.find("display:none") != std::string::npos;
  }

  [[nodiscard]] std::vector<Vec2> points_of(const XMLElement& element) const {
    const auto numbers = read(element, "points", svg_numbers);
    if (numbers.size() % 2 != 0) throw error(element, "'points' has a coordinate too many");
    std::vector<Vec2> points;
    for (std::size_t i = 0; i < numbers.size(); i += 2) points.push_back({numbers[i], numbers[i + 1]});
    return points;
  }

  [[nodiscard]] std::vector<Vec2> rectangle_of(const XMLElement& element) const {
    const Vec2 lo{length(element, "x", 0.0), length(element, "y", 0.0)};
    const Vec2 size{length(element, "width", 0.0), length(element, "height", 0.0)};
    if (size.x < 0.0 || size.y < 0.0) throw error(element, "a rectangle's width or height is less than 0");
    return rectangle_vertices({lo, lo + size});
  }

  void add_round(const XMLElement& element, bool circle, const SvgTransform& map) {
    const Vec2 centre{length(element, "cx", 0.0), length(element, "cy", 0.0)};
    const double rx = length(element, circle ? "r" : "rx", 0.0);
    const double ry = circle ? rx : length(element, "ry", 0.0);
    if (rx < 0.0 || ry < 0.0) throw error(element, "a radius is less than 0");
    const double scale = std::hypot(map.a, map.b);
    constexpr double same = 1e-9;
    const bool similar = std::abs(map.a + map.d) + std::abs(map.b - map.c) <= same * scale ||
                         std::abs(map.a - map.d) + std::abs(map.b + map.c) <= same * scale;
    if (rx == ry && similar && rx * scale > 0.0) {
      const Disc disc{map(centre), rx * scale};
      if (!in_range(disc.centre) || disc.radius > most_distant) throw error(element, "a circle too far or too large");
      shapes_.push_back({label(element), disc});
      return;
    }
    std::vector<Vec2> points;
    constexpr int corners = 64;
    for (int i = 0; i < corners; ++i) {
      const double angle = 2.0 * std::numbers::pi * i / corners;
      points.push_back(centre + Vec2{rx * std::cos(angle), ry * std::sin(angle)});
    }
    add(element, std::move(points), map);
  }

  [[nodiscard]] std::string label(const XMLElement& element) const {
    const std::string id = attribute(element, "id");
    return id.empty() ? fmt::format("{} on line {}", name_of(element), element.GetLineNum()) : id;
  }

  void add(const XMLElement& element, std::vector<Vec2> points, const SvgTransform& map) {
    for (Vec2& p : points) {
      p = map(p);
      if (!in_range(p)) throw error(element, fmt::format("a point farther than {:g} m from the origin", most_distant));
    }
    Polygon hull;
    if (points.size() >= 3) hull = convex_hull(std::move(points));
    double area = 0.0;
    for (std::size_t i = 2; i < hull.vertices.size(); ++i) {
      area += cross(hull.vertices[i - 1] - hull.vertices[0], hull.vertices[i] - hull.vertices[0]);
    }
    constexpr double least = 1e-12;
    if (hull.vertices.size() < 3 || !(area > least)) {
      ++ignored_[name_of(element) + " (without area)"];
      return;
    }
    shapes_.push_back({label(element), std::move(hull)});
  }

  const SourceText& text_;
  SvgTransform page_;
  std::optional<Box2> sheet_;
  std::string units_;
  std::vector<Obstacle> shapes_;
  std::map<std::string, std::size_t> ignored_;
  std::vector<std::string> warnings_;
  RowErrors errors_;
};

}  // namespace

bool is_svg(const SourceText& text) {
  constexpr std::size_t head = 100;
  const std::size_t end = std::min(text.lines.size(), head);
  return std::any_of(text.lines.begin(), text.lines.begin() + static_cast<std::ptrdiff_t>(end), [](const auto& line) {
    return line.find("<svg") != std::string::npos || line.find("<?xml") != std::string::npos;
  });
}

SceneFile read_svg(const SourceText& text, const ReadOptions& options) {
  Drawing drawing(text);
  if (drawing.shapes().empty()) throw text.error(text.last(), "nothing is drawn, expected at least one path with area");
  const Box2 bounds = drawing.bounds();
  World world;
  try {
    world = World(bounds, std::move(drawing.shapes()));
  } catch (const Error& fault) {
    throw Error(fmt::format("{}: {}", text.path, fault.what()));
  }
  auto scene = std::make_shared<const PlanarScene>(std::move(world), options.robot.value_or(Robot::point()));
  SceneFile file{"SVG, each path's convex hull is an obstacle",
                 drawing.units(),
                 "the origin is the drawing's upper left corner, y up: y is negative on the page",
                 {problem_in(stem_of(text.path), std::move(scene), options)}};
  file.warnings = std::move(drawing.warnings());
  return file;
}

Robot read_robot(const std::string& path) {
  const SourceText text = SourceText::load(path);
  if (!is_svg(text)) {
    std::string known = unread_xml(text);
    if (known.empty()) known = unread_bytes(first_bytes(path));
    if (known.empty()) known = unread_text(text);
    throw text.error(1, fmt::format("no SVG, expected a robot's outline as one{}{}", known.empty() ? "" : "; ", known));
  }
  Drawing drawing(text);
  if (drawing.shapes().size() != 1) {
    throw text.error(text.last(), fmt::format("{} shapes, expected one: the robot's outline", drawing.shapes().size()));
  }
  Shape shape = drawing.shapes().front().shape;
  if (const auto* disc = std::get_if<Disc>(&shape)) return Robot::disc(disc->radius);
  auto& outline = std::get<Polygon>(shape);
  const Box2 box = bounding_box(outline);
  const Vec2 middle = 0.5 * (box.lo + box.hi);
  for (Vec2& p : outline.vertices) p = p - middle;
  return Robot::rigid({std::move(outline)});
}

}  // namespace trellis
