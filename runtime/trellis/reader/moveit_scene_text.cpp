// SPDX-License-Identifier: GPL-3.0-or-later
// Planning scenes of MoveIt as the text that RViz exports and imports (.scene).
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <trellis/reader/formats.hpp>
#include <trellis/reader/mesh_formats.hpp>
#include <trellis/reader/moveit_scene.hpp>

namespace trellis {

namespace {

std::string trimmed(const std::string& line) {
  constexpr const char* space = " \t\r";
  const std::size_t begin = line.find_first_not_of(space);
  return begin == std::string::npos ? "" : line.substr(begin, line.find_last_not_of(space) + 1 - begin);
}

bool starred(const std::string& line) { return trimmed(line) == "*" || trimmed(line).starts_with("* "); }

class TextReader {
 public:
  TextReader(const SourceText& text, MoveitObjects& objects, std::vector<std::string>& warnings)
      : text_(text), objects_(objects), warnings_(warnings) {}

  void read() {
    line_ = 1;  // the first line is the scene's name
    // The newer format gives the pose of each object in the line below its star, the older one the number of shapes.
    const auto first = std::find_if(text_.lines.begin(), text_.lines.end(), starred);
    if (first != text_.lines.end()) {
      const auto below =
          std::find_if(first + 1, text_.lines.end(), [](const auto& one) { return !trimmed(one).empty(); });
      placed_ = below != text_.lines.end() && words_of(*below).size() > 1;
    }
    bool ended = false;
    while (!ended) {
      while (line_ < text_.lines.size() && trimmed(text_.lines[line_]).empty()) ++line_;
      if (line_ == text_.lines.size()) break;
      const std::string line = trimmed(text_.lines[line_]);
      if (line == ".") {
        ended = true;
      } else if (starred(line)) {
        read_object(trimmed(line.substr(1)));
      } else {
        throw text_.error(
            line_ + 1, fmt::format("'{}' is here, expected an object, '* NAME', or the end, '.'", line.substr(0, 40)));
      }
    }
    if (!ended) warnings_.push_back(fmt::format("{}:{}: the scene does not end with '.'", text_.path, text_.last()));
    const auto rest =
        std::find_if(text_.lines.begin() + static_cast<std::ptrdiff_t>(std::min(line_ + 1, text_.lines.size())),
                     text_.lines.end(), [](const auto& one) { return !trimmed(one).empty(); });
    if (ended && rest != text_.lines.end()) {
      warnings_.push_back(fmt::format("{}:{}: what follows the end of the scene, '.', is not read", text_.path,
                                      rest - text_.lines.begin() + 1));
    }
  }

 private:
  void read_object(const std::string& id) {
    MoveitObject object{.id = id};
    object_ = id;
    ++line_;
    words_.clear();
    if (placed_) object.pose = pose();
    const std::size_t shapes = count("the number of shapes");
    for (std::size_t i = 0; i < shapes; ++i) {
      auto shape = read_shape();
      const Pose3 at = pose();
      for (const char* colour : {"red", "green", "blue", "alpha"}) static_cast<void>(number(colour));
      object.parts.push_back({std::move(shape), at});
    }
    if (placed_) {
      const std::size_t subframes = count("the number of subframes");
      for (std::size_t i = 0; i < subframes; ++i) {
        const std::string name = word("the name of a subframe");
        object.subframes[name] = pose();
      }
    }
    if (!words_.empty()) {
      throw text_.error(line_, fmt::format("'{}' is left over at the end of object '{}'", words_.front(), id));
    }
    if (object.parts.empty()) {
      warnings_.push_back(fmt::format("{}:{}: object '{}' has no shape", text_.path, line_, id));
      return;
    }
    object.adopt_frame_of_shape();
    objects_.add(std::move(object));
  }

  std::variant<Shape3, MoveitPlane> read_shape() {
    const std::string kind = word("a shape");
    const std::size_t line = line_;
    if (kind == "plane") {
      const Vec3 normal = vector();
      const double offset = number("the offset of a plane");
      if (!(norm(normal) > 0.0)) throw text_.error(line, "the plane has no direction: its first three numbers are 0");
      return MoveitPlane{normal, offset};
    }
    Shape3 shape;
    if (kind == "box") {
      shape = Cuboid{vector()};
    } else if (kind == "sphere") {
      shape = Sphere{number("a radius")};
    } else if (kind == "cylinder") {
      const double radius = number("a radius");
      shape = Cylinder{radius, number("a length")};
    } else if (kind == "mesh") {
      return Shape3(mesh(line));
    } else {
      throw text_.error(line, fmt::format("a shape '{}' is not read{}", kind, did_you_mean(kind, shapes())));
    }
    try {
      check_solid({shape, {}}, fmt::format("object '{}'", object_));
    } catch (const Error& error) {
      throw text_.error(line, error.what());
    }
    return shape;
  }

  static std::vector<std::string> shapes() { return {"box", "sphere", "cylinder", "mesh", "plane"}; }

  std::shared_ptr<const Mesh> mesh(std::size_t line) {
    const MeshSource source{text_.path, {}};
    Polygons polygons(source);
    const std::size_t vertices = count("the number of vertices");
    const std::size_t triangles = count("the number of triangles");
    polygons.check_limits(static_cast<double>(vertices), static_cast<double>(triangles), line);
    for (std::size_t i = 0; i < vertices; ++i) {
      const Vec3 v = vector();
      polygons.add_vertex(v, line_);
    }
    for (std::size_t i = 0; i < triangles; ++i) {
      std::array<std::uint32_t, 3> corners{};
      for (std::uint32_t& corner : corners) {
        corner = polygons.vertex(static_cast<std::int64_t>(count("the number of a vertex")), 0, line_);
      }
      polygons.add(corners, line_);
    }
    std::size_t without_area = 0;
    std::vector<Triangle> all = polygons.triangles(without_area);
    if (all.empty()) throw text_.error(line, "the mesh has no triangle with an area");
    if (without_area > 0) {
      warnings_.push_back(fmt::format("{}:{}: {} triangles without area are left out", text_.path, line, without_area));
    }
    try {
      return std::make_shared<const Mesh>(std::move(polygons.vertices), std::move(all), "the mesh");
    } catch (const Error& error) {
      throw text_.error(line, error.what());
    }
  }

  /// Returns the next word, which may be in a later line; `line_` counts its line from 1.
  std::string word(const char* what) {
    while (words_.empty()) {
      if (line_ >= text_.lines.size() || starred(text_.lines[line_]) || trimmed(text_.lines[line_]) == ".") {
        throw text_.error(std::min(line_ + 1, text_.last()),
                          fmt::format("object '{}' ends here, expected {}", object_, what));
      }
      words_ = words_of(text_.lines[line_++]);
      std::reverse(words_.begin(), words_.end());
    }
    std::string next = std::move(words_.back());
    words_.pop_back();
    return next;
  }

  double number(const char* what) {
    const std::string next = word(what);
    return number_in(text_, line_, next, what);
  }

  std::size_t count(const char* what) {
    const std::string next = word(what);
    return count_in(text_, line_, next, what);
  }

  Vec3 vector() {
    const double x = number("x");
    const double y = number("y");
    return {x, y, number("z")};
  }

  Pose3 pose() {
    const Vec3 position = vector();
    const double x = number("x of a quaternion");
    const double y = number("y of a quaternion");
    const double z = number("z of a quaternion");
    const Quaternion q{x, y, z, number("w of a quaternion")};
    const double length = std::sqrt(q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w);
    // The text rounds to six digits.
    constexpr double rounding = 1e-3;
    if (!(std::abs(length - 1.0) < rounding)) throw text_.error(line_, "the quaternion is not of length 1");
    return {position, normalised(q)};
  }

  const SourceText& text_;
  MoveitObjects& objects_;
  std::vector<std::string>& warnings_;
  bool placed_ = false;             ///< objects have poses and subframes
  std::size_t line_ = 0;            ///< the next line, counted from 0
  std::vector<std::string> words_;  ///< that are left of the line before it, the last one first
  std::string object_;              ///< that is being read
};

}  // namespace

bool is_moveit_text(const SourceText& text) {
  const bool named = text.path.ends_with(".scene");
  const bool begins = text.lines.size() > 1 && starred(text.lines[1]);
  const auto is_shape = [](const std::string& line) {
    const std::string word = trimmed(line);
    return word == "box" || word == "sphere" || word == "cylinder" || word == "cone" || word == "mesh" ||
           word == "plane";
  };
  return (named && !has_key(text, "world") && !has_key(text, "robot_model_name")) ||
         (begins && std::any_of(text.lines.begin(), text.lines.end(), is_shape));
}

void read_moveit_text(const SourceText& text, MoveitObjects& objects, std::vector<std::string>& warnings) {
  TextReader(text, objects, warnings).read();
}

}  // namespace trellis
