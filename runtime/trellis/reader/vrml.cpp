// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/reader/vrml.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <map>
#include <numbers>
#include <string_view>
#include <utility>

#include <trellis/reader/formats.hpp>
#include <trellis/reader/mesh_formats.hpp>
#include <trellis/reader/spatial_formats.hpp>
#include <trellis/scene/limits.hpp>

namespace trellis {

namespace {

constexpr std::size_t most_depth = 100;
constexpr std::size_t most_inlined = 10;  ///< files within files
constexpr std::size_t most_files = 1000;  ///< that a scene includes, the same one each time

/// Nodes that only say how a scene is seen.
constexpr std::array<std::string_view, 12> unseen = {"Appearance", "Material",     "WorldInfo",  "NavigationInfo",
                                                     "Viewpoint",  "Background",   "PointLight", "DirectionalLight",
                                                     "SpotLight",  "ImageTexture", "Fog",        "TextureTransform"};

/// Where a shape lies.
struct Place {
  Pose3 pose;
  std::vector<std::string> groups;
  std::vector<Pose3> frames;
};

class VrmlReader {
 public:
  VrmlReader(const std::string& path, std::size_t inlined, std::size_t& files, std::vector<VrmlShape>& shapes)
      : source_(SourceText::load(path)), inlined_(inlined), files_(files), shapes_(shapes) {
    if (source_.lines.empty() || !source_.lines.front().starts_with("#VRML V2.0")) {
      throw source_.error(1, "expected '#VRML V2.0 utf8'");
    }
  }

  void read(const Place& place) {
    while (!peek().empty()) node(place, 0);
  }

 private:
  [[nodiscard]] Error fault(const std::string& what) const {
    return source_.error(std::max<std::size_t>(line_, 1), what);
  }
  /// Finds the next word; "" at the end of the file.
  std::string_view peek() {
    while (true) {
      const std::size_t begin = rest_.find_first_not_of(" \t,");
      if (begin != std::string_view::npos && rest_[begin] != '#') {
        rest_.remove_prefix(begin);
        break;
      }
      if (line_ == source_.lines.size()) {
        rest_ = {};
        return {};
      }
      rest_ = source_.lines[line_++];
    }
    constexpr std::string_view marks = "{}[]";
    if (marks.find(rest_.front()) != std::string_view::npos) return rest_.substr(0, 1);
    if (rest_.front() == '"') {
      const std::size_t end = rest_.find('"', 1);
      if (end == std::string_view::npos) throw fault("a text without its second '\"'");
      return rest_.substr(0, end + 1);
    }
    return rest_.substr(0, rest_.find_first_of(" \t,{}[]\"#"));
  }
  std::string_view take() {
    const std::string_view word = peek();
    rest_.remove_prefix(word.size());
    return word;
  }
  [[nodiscard]] static std::string shown(std::string_view word) {
    return word.empty() ? "the end of the file" : in_quotes(word);
  }
  void expect(std::string_view wanted) {
    if (const std::string_view word = take(); word != wanted) {
      throw fault(fmt::format("expected '{}', got {}", wanted, shown(word)));
    }
  }
  double number() {
    const std::string_view word = take();
    const auto value = number_in(word);
    if (!value || !std::isfinite(*value)) throw fault(fmt::format("expected a number, got {}", shown(word)));
    return *value;
  }
  Vec3 vector() {
    const double x = number(), y = number();
    return {x, y, number()};
  }
  /// Skips `{ ... }` with all that is in it.
  void skip_block() {
    expect("{");
    for (std::size_t open = 1; open > 0;) {
      const std::string_view word = take();
      if (word.empty()) throw fault("the file ends before '}'");
      if (word == "{") ++open;
      if (word == "}") --open;
    }
  }

  void node(const Place& place, std::size_t depth) {
    if (depth > most_depth) throw fault(fmt::format("nodes within more than {} others", most_depth));
    std::string name;
    std::string_view type = take();
    if (type == "DEF") {
      name = std::string(take());
      type = take();
    }
    if (type == "Transform" || type == "Group") {
      group(place, std::move(name), depth);
    } else if (type == "Shape") {
      shape(place);
    } else if (type == "Inline") {
      file(place, std::move(name));
    } else if (std::find(unseen.begin(), unseen.end(), type) != unseen.end()) {
      skip_block();
    } else {
      throw fault(fmt::format("{} is not read; expected Transform, Group, Shape or Inline", shown(type)));
    }
  }
  static Place within(const Place& place, std::string name, const Pose3& pose) {
    Place inner = place;
    inner.pose = place.pose * pose;
    if (!name.empty()) {
      inner.groups.push_back(std::move(name));
      inner.frames.push_back(inner.pose);
    }
    return inner;
  }
  /// A node's pose may follow its children, so they are read afterwards.
  void group(const Place& place, std::string name, std::size_t depth) {
    expect("{");
    Pose3 pose;
    std::vector<std::pair<std::string_view, std::size_t>> children;
    const auto here = [&] { return std::pair(rest_, line_); };
    while (true) {
      const std::string_view field = take();
      if (field == "}") break;
      if (field == "translation") {
        pose.position = vector();
      } else if (field == "rotation") {
        const Vec3 axis = vector();
        const double angle = number(), length = norm(axis);
        if (length == 0.0) throw fault("the axis of a rotation has length 0");
        pose.orientation = rotation_of(angle / length * axis);
      } else if (field == "children") {
        peek();
        children.push_back(here());
        skip_children();
      } else if (field == "scale" || field == "center" || field == "scaleOrientation") {
        throw fault(fmt::format("'{}' of a Transform is not read", field));
      } else {
        throw fault(fmt::format("expected translation, rotation, children or '}}', got {}", shown(field)));
      }
    }
    const auto after = here();
    const Place inner = within(place, std::move(name), pose);
    for (const auto& [rest, line] : children) {
      rest_ = rest;
      line_ = line;
      if (peek() != "[") {
        node(inner, depth + 1);
        continue;
      }
      take();
      while (peek() != "]") node(inner, depth + 1);
    }
    rest_ = after.first;
    line_ = after.second;
  }
  /// Skips a node, or a list of nodes in brackets.
  void skip_children() {
    if (peek() != "[") {
      while (peek() != "{" && !peek().empty()) take();
      skip_block();
      return;
    }
    take();
    for (std::size_t open = 1; open > 0;) {
      const std::string_view word = take();
      if (word.empty()) throw fault("the file ends before ']'");
      if (word == "[") ++open;
      if (word == "]") --open;
    }
  }
  void shape(const Place& place) {
    expect("{");
    while (true) {
      const std::string_view field = take();
      if (field == "}") return;
      if (field == "appearance") {
        if (take() == "DEF") {
          take();
          take();
        }
        skip_block();
      } else if (field == "geometry") {
        geometry(place);
      } else {
        throw fault(fmt::format("expected appearance, geometry or '}}', got {}", shown(field)));
      }
    }
  }
  void geometry(const Place& place) {
    const std::string type(take());
    // The fields have defaults.
    Vec3 size{2, 2, 2};
    double radius = 1.0, height = 2.0;
    const bool known = type == "Box" || type == "Sphere" || type == "Cylinder";
    if (!known) throw fault(fmt::format("the shape {} is not read; expected Box, Sphere or Cylinder", shown(type)));
    expect("{");
    for (std::string_view field = take(); field != "}"; field = take()) {
      if (field == "size" && type == "Box") {
        size = vector();
      } else if (field == "radius" && type != "Box") {
        radius = number();
      } else if (field == "height" && type == "Cylinder") {
        height = number();
      } else {
        throw fault(fmt::format("{} of a {} is not read", shown(field), type));
      }
    }
    Pose3 pose = place.pose;
    Shape3 made = Sphere{radius};
    if (type == "Box") made = Cuboid{size};
    if (type == "Cylinder") {
      made = Cylinder{radius, height};
      // Along y there, along z here.
      pose = pose * Pose3{{}, rotation_of({-0.5 * std::numbers::pi, 0.0, 0.0})};
    }
    if (shapes_.size() == most_obstacles) throw fault(fmt::format("more than {} shapes", most_obstacles));
    try {
      check_solid({made, pose}, "a shape");
    } catch (const Error& e) {
      throw fault(e.what());
    }
    shapes_.push_back({std::move(made), pose, place.groups, place.frames});
  }
  void file(const Place& place, std::string name) {
    expect("{");
    expect("url");
    const bool list = peek() == "[";
    if (list) take();
    const std::string_view url = take();
    if (url.size() < 2 || url.front() != '"')
      throw fault(fmt::format("expected the name of a file, got {}", shown(url)));
    const std::string path = beside(source_.path, std::string(url.substr(1, url.size() - 2)));
    if (list) expect("]");
    if (++files_ > most_files) throw fault(fmt::format("more than {} included files", most_files));
    if (inlined_ == most_inlined) throw fault(fmt::format("files within more than {} others", most_inlined));
    const std::size_t line = line_;
    expect("}");
    try {
      VrmlReader(path, inlined_ + 1, files_, shapes_).read(within(place, std::move(name), {}));
    } catch (const Error& e) {
      throw source_.error(line, fmt::format("in the file that it includes: {}", e.what()));
    }
  }

  SourceText source_;
  std::size_t inlined_;
  std::size_t& files_;
  std::vector<VrmlShape>& shapes_;
  std::string_view rest_;
  std::size_t line_ = 0;  // counted from 1, of rest_
};

}  // namespace

std::vector<VrmlShape> read_vrml(const std::string& path) {
  std::vector<VrmlShape> shapes;
  std::size_t files = 0;
  VrmlReader(path, 0, files, shapes).read({});
  return shapes;
}

}  // namespace trellis
