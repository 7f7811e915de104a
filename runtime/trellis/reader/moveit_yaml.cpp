// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/reader/moveit_yaml.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <memory>
#include <utility>

#include <trellis/reader/mesh_file.hpp>
#include <trellis/reader/mesh_formats.hpp>

namespace trellis {

namespace {

std::string lower(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return std::tolower(c); });
  return text;
}

/// Returns numbers that are a list, or a map with these keys.
std::vector<double> numbers_of(const YamlEntry& entry, const std::vector<std::string>& keys, std::string_view what) {
  if (!entry.is_map()) return entry.numbers(keys.size(), what);
  std::vector<double> values;
  values.reserve(keys.size());
  for (const std::string& key : keys) values.push_back(entry.at(key).number());
  return values;
}

/// A message whose enumeration may be a word, a number or a byte.
ObjectMessage::Operation operation_of(const YamlEntry& entry) {
  using Operation = ObjectMessage::Operation;
  const std::string word = lower(entry.word());
  // A byte is a number, a character, or, in `!!binary`, its base64.
  constexpr std::array<std::array<std::string_view, 4>, 4> spellings = {{
      {"add", "0", std::string_view("\0", 1), "aa=="},
      {"remove", "1", "\1", "aq=="},
      {"append", "2", "\2", "ag=="},
      {"move", "3", "\3", "aw=="},
  }};
  for (std::size_t i = 0; i < spellings.size(); ++i) {
    for (const std::string_view spelling : spellings.at(i)) {
      if (word == spelling) return static_cast<Operation>(i);
    }
  }
  throw entry.error(fmt::format("the operation '{}' is not known{}: expected add, remove, append or move", entry.word(),
                                did_you_mean(word, std::vector<std::string>{"add", "remove", "append", "move"})));
}

/// Reads a mesh: its vertices and triangles, or the file that it names.
std::shared_ptr<const Mesh> mesh_of(const YamlEntry& entry, const std::string& scene,
                                    std::vector<std::string>& warnings) {
  if (entry.has("resource")) {
    const YamlEntry resource = entry.at("resource");
    std::string name = resource.word();
    if (name.starts_with("file://")) name.erase(0, 7);
    const std::filesystem::path path(name);
    if (name.find("://") != std::string::npos || path.is_absolute() || *path.lexically_normal().begin() == "..") {
      throw resource.error(
          fmt::format("the mesh is '{}', expected a file beside the scene or in a folder below", resource.word()));
    }
    std::string unit = "m";
    if (entry.has("dimensions")) {
      const auto scale = entry.at("dimensions").numbers(3, "the scale along x, y, z");
      if (scale[0] != scale[1] || scale[0] != scale[2] || !(scale[0] > 0.0)) {
        throw entry.at("dimensions").error("the scale of a mesh must be the same along all axes, and greater than 0");
      }
      unit = fmt::format("{}", scale[0]);
    }
    try {
      const MeshFile file = read_mesh((std::filesystem::path(scene).parent_path() / path).string(), {.unit = unit});
      warnings.insert(warnings.end(), file.warnings.begin(), file.warnings.end());
      return file.mesh;
    } catch (const Error& error) {
      throw resource.error(error.what());
    }
  }
  const MeshSource source{scene, {}};
  Polygons polygons(source);
  for (const YamlEntry& vertex : entry.at("vertices").list()) {
    const auto v = numbers_of(vertex, {"x", "y", "z"}, "x, y, z");
    polygons.add_vertex({v[0], v[1], v[2]}, vertex.line());
  }
  for (const YamlEntry& triangle : entry.at("triangles").list()) {
    const YamlEntry corners = triangle.is_map() ? triangle.at("vertex_indices") : triangle;
    std::array<std::uint32_t, 3> indices{};
    const auto given = corners.numbers(3, "numbers of vertices, from 0");
    for (std::size_t k = 0; k < 3; ++k) {
      if (given[k] != std::floor(given[k]) || std::abs(given[k]) > 1e9) {
        throw corners.error(fmt::format("{:g} is no number of a vertex", given[k]));
      }
      indices.at(k) = polygons.vertex(static_cast<std::int64_t>(given[k]), 0, corners.line());
    }
    polygons.add(indices, corners.line());
  }
  std::size_t without_area = 0;
  std::vector<Triangle> triangles = polygons.triangles(without_area);
  if (triangles.empty()) throw entry.error("the mesh has no triangle with an area");
  if (without_area > 0) {
    warnings.push_back(entry.at_line(fmt::format("{} triangles without area are left out", without_area)));
  }
  try {
    return std::make_shared<const Mesh>(std::move(polygons.vertices), std::move(triangles), "the mesh");
  } catch (const Error& error) {
    throw entry.error(error.what());
  }
}

MoveitPlane plane_of(const YamlEntry& entry) {
  const auto c = entry.at("coef").numbers(4, "a, b, c, d of the plane ax + by + cz + d = 0");
  const Vec3 normal{c[0], c[1], c[2]};
  const double length = norm(normal);
  if (!(length > 0.0) || !std::isfinite(length)) throw entry.error("the plane has no direction: a, b and c are 0");
  return {normal, c[3]};
}

}  // namespace

Vec3 vector_at(const YamlEntry& entry, const std::string& key) {
  if (!entry.has(key) || entry.at(key).empty()) return {};
  const auto v = numbers_of(entry.at(key), {"x", "y", "z"}, "x, y, z");
  return {v[0], v[1], v[2]};
}

Quaternion quaternion_at(const YamlEntry& entry, const std::string& key) {
  if (!entry.has(key) || entry.at(key).empty()) return {};
  const auto turn = numbers_of(entry.at(key), {"x", "y", "z", "w"}, "x, y, z, w");
  const Quaternion q{turn[0], turn[1], turn[2], turn[3]};
  const double length = std::sqrt(q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w);
  if (length == 0.0) return {};  // a message that was not filled in
  constexpr double rounding = 1e-3;
  if (!(std::abs(length - 1.0) < rounding)) throw entry.at(key).error("the quaternion is not of length 1");
  return normalised(q);
}

Pose3 pose_of(const YamlEntry& entry) { return {vector_at(entry, "position"), quaternion_at(entry, "orientation")}; }

Pose3 transform_of(const YamlEntry& entry) {
  return {vector_at(entry, "translation"), quaternion_at(entry, "rotation")};
}

std::string frame_of(const YamlEntry& entry) {
  if (!entry.has("header") || entry.at("header").empty()) return "";
  const YamlEntry header = entry.at("header");
  header.know({"seq", "stamp"});
  return header.word("frame_id");
}

bool truth_of(const YamlEntry& entry) {
  const std::string word = lower(entry.word());
  if (word == "true" || word == "1" || word == "yes" || word == "on") return true;
  if (word == "false" || word == "0" || word == "no" || word == "off") return false;
  throw entry.error(fmt::format("'{}' is neither true nor false", entry.word()));
}

Shape3 primitive_of(const YamlEntry& entry) {
  const YamlEntry type = entry.at("type");
  const YamlEntry sizes = entry.at("dimensions");
  entry.know({"polygon"});  // of prisms
  constexpr std::array<std::string_view, 6> numbered = {"", "box", "sphere", "cylinder", "cone", "prism"};
  std::string word = lower(type.word());
  for (std::size_t i = 1; i < numbered.size(); ++i) {
    if (word == std::to_string(i)) word = numbered.at(i);
  }
  if (word == "box") {
    const auto n = sizes.numbers(3, "x, y, z");
    return Cuboid{{n[0], n[1], n[2]}};
  }
  if (word == "sphere") return Sphere{sizes.numbers(1, "radius")[0]};
  if (word == "cylinder") {
    const auto n = sizes.numbers(2, "height, radius");
    return Cylinder{n[1], n[0]};
  }
  throw type.error(fmt::format("a primitive '{}' is not read{}", word,
                               did_you_mean(word, std::vector<std::string>{"box", "sphere", "cylinder"})));
}

ObjectMessage object_message_of(const YamlEntry& entry, const std::string& scene, std::vector<std::string>& warnings) {
  ObjectMessage message;
  message.object.id = entry.word("id");
  if (entry.has("operation")) message.operation = operation_of(entry.at("operation"));
  message.frame = frame_of(entry);
  message.placed = entry.has("pose") && !entry.at("pose").empty();
  if (message.placed) message.object.pose = pose_of(entry.at("pose"));
  // The key of a database of objects, which a scene need not have.
  entry.know({"type"});
  const auto read = [&](const char* kind, const char* poses_key, const auto& shape_of) {
    const std::vector<YamlEntry> shapes = entry.list(kind);
    const std::vector<YamlEntry> poses = entry.list(poses_key);
    const bool moves = message.operation == ObjectMessage::Operation::move;
    // Without any pose the shapes are at the object's own.
    if (!moves && !poses.empty() && shapes.size() != poses.size()) {
      throw entry.error(
          fmt::format("object '{}' has {} {} and {} poses", message.object.id, shapes.size(), kind, poses.size()));
    }
    for (const YamlEntry& pose : poses) message.shape_poses.push_back(pose_of(pose));
    message.shaped = message.shaped || !poses.empty();
    for (std::size_t i = 0; i < shapes.size(); ++i) {
      message.object.parts.push_back({shape_of(shapes[i]), poses.empty() ? Pose3{} : pose_of(poses[i])});
    }
  };
  if (message.operation == ObjectMessage::Operation::remove) {
    entry.know();
    return message;
  }
  using Part = std::variant<Shape3, MoveitPlane>;
  read("primitives", "primitive_poses", [&](const YamlEntry& entry_of) -> Part {
    Shape3 shape = primitive_of(entry_of);
    try {
      check_solid({shape, {}}, fmt::format("object '{}'", message.object.id));
    } catch (const Error& error) {
      throw entry_of.error(error.what());
    }
    return shape;
  });
  read("meshes", "mesh_poses", [&](const YamlEntry& shape) -> Part { return Shape3(mesh_of(shape, scene, warnings)); });
  read("planes", "plane_poses", [](const YamlEntry& shape) -> Part { return plane_of(shape); });
  const std::vector<YamlEntry> names = entry.list("subframe_names");
  const std::vector<YamlEntry> poses = entry.list("subframe_poses");
  if (names.size() != poses.size()) {
    throw entry.error(fmt::format("object '{}' has {} names of subframes and {} poses", message.object.id, names.size(),
                                  poses.size()));
  }
  for (std::size_t i = 0; i < names.size(); ++i) message.object.subframes[names[i].word()] = pose_of(poses[i]);
  return message;
}

}  // namespace trellis
