// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <system_error>
#include <utility>

#include <trellis/base/errors.hpp>
#include <trellis/reader/mesh_file.hpp>
#include <trellis/reader/robot_files.hpp>
#include <trellis/reader/xml_entry.hpp>
#include <trellis/scene/limits.hpp>
#include <trellis/scene/spatial/ranges.hpp>

namespace trellis {

namespace {

namespace fs = std::filesystem;

/// Joints turn by at most so many radians, for which collision checking computes sines to full accuracy.
constexpr double largest_turn = 1e5;
/// A joint that follows another turns or slides by at most so many times as much.
constexpr double most_multiplier = 1e3;

/// The pose of an `<origin>` within an element: x, y, z and roll, pitch, yaw about the fixed axes.
Pose3 origin_of(const XmlEntry& entry) {
  const auto origin = entry.child("origin");
  if (!origin) return {};
  const auto [x, y, z] = origin->triple("xyz", {0.0, 0.0, 0.0});
  const auto [roll, pitch, yaw] = origin->triple("rpy", {0.0, 0.0, 0.0});
  const Quaternion turn =
      rotation_of({0.0, 0.0, yaw}) * (rotation_of({0.0, pitch, 0.0}) * rotation_of({roll, 0.0, 0.0}));
  return {{x, y, z}, normalised(turn)};
}

class UrdfReader {
 public:
  explicit UrdfReader(const SourceText& text) : text_(text), robot_(XmlEntry::root(text, "robot")) {}

  UrdfFile read() {
    const std::string name = robot_.has("name") ? robot_.word("name") : "robot";
    for (const XmlEntry& entry : robot_.children("link")) {
      if (links_.size() == KinematicTree::most_links) {
        throw entry.error(fmt::format("more than {} links", KinematicTree::most_links));
      }
      errors_.attempt([&] { read_link(entry); });
    }
    std::vector<XmlEntry> joints = robot_.children("joint");
    std::map<std::string, std::size_t> numbers;
    for (const XmlEntry& entry : joints) {
      errors_.attempt([&] {
        const std::string joint = entry.word("name");
        if (!numbers.emplace(joint, numbers.size()).second) {
          throw entry.error(fmt::format("a second joint is called '{}'", joint));
        }
      });
    }
    for (const XmlEntry& entry : joints) errors_.attempt([&] { read_joint(entry, numbers); });
    if (!missing_.empty()) {
      std::string list;
      for (const auto& [mesh, line] : missing_) list += fmt::format("\n  line {}: {}", line, mesh);
      errors_.add(Error(fmt::format("{}: {} mesh{} not found beside it or in a folder above:{}", text_.path,
                                    missing_.size(), missing_.size() == 1 ? " is" : "es are", list)));
    }
    errors_.raise();
    std::set<std::string> ignored;
    for (const XmlEntry& entry : robot_.children()) {
      const std::string kind = entry.name();
      if (kind != "link" && kind != "joint" && kind != "material") ignored.insert(kind);
    }
    for (const std::string& kind : ignored) warnings_.push_back(fmt::format("elements '{}' are ignored", kind));
    std::map<std::string, std::size_t> lines;
    for (std::size_t j = 0; j < joints_.size(); ++j) lines.emplace(joints_[j].name, joint_lines_[j]);
    try {
      return {KinematicTree(name, std::move(links_), std::move(joints_)), std::move(warnings_), std::move(lines)};
    } catch (const TreeError& error) {
      const auto& of_part = error.part == TreeError::Part::link ? link_lines_ : joint_lines_;
      throw text_.error(of_part.at(error.number), error.what());
    } catch (const Error& error) {
      throw Error(fmt::format("{}: {}", text_.path, error.what()));
    }
  }

 private:
  void read_link(const XmlEntry& entry) {
    Link link{entry.word("name"), {}};
    if (!link_numbers_.emplace(link.name, links_.size()).second) {
      throw entry.error(fmt::format("a second link is called '{}'", link.name));
    }
    links_.push_back({link.name, {}});
    link_lines_.push_back(entry.line());
    // Masses move nothing here; a file with numbers that are none is faulty all the same.
    for (const XmlEntry& inertial : entry.children("inertial")) errors_.attempt([&] { check_inertial(inertial); });
    std::vector<Solid>& solids = links_.back().solids;
    for (const XmlEntry& collision : entry.children("collision")) {
      errors_.attempt([&] {
        const Pose3 pose = origin_of(collision);
        const XmlEntry geometry = collision.required("geometry");
        const auto shapes = geometry.children();
        if (shapes.size() != 1) throw geometry.error("a geometry has one shape");
        if (auto shape = read_shape(shapes.front())) {
          const Solid solid{std::move(*shape), pose};
          try {
            check_solid(solid, fmt::format("a shape of link '{}'", link.name));
          } catch (const Error& error) {
            throw shapes.front().error(error.what());
          }
          solids.push_back(solid);
        }
      });
    }
  }

  static void check_inertial(const XmlEntry& inertial) {
    static_cast<void>(origin_of(inertial));
    if (const auto mass = inertial.child("mass")) static_cast<void>(mass->number("value"));
    const auto inertia = inertial.child("inertia");
    for (const char* moment : {"ixx", "ixy", "ixz", "iyy", "iyz", "izz"}) {
      if (inertia) static_cast<void>(inertia->number(moment, 0.0));
    }
  }

  /// Returns none for a mesh that is missing.
  std::optional<Shape3> read_shape(const XmlEntry& shape) {
    const std::string kind = shape.name();
    if (kind == "sphere") return Sphere{shape.number("radius")};
    if (kind == "box") {
      const auto [x, y, z] = shape.triple("size", {0.0, 0.0, 0.0});
      return Cuboid{{x, y, z}};
    }
    if (kind == "cylinder") return Cylinder{shape.number("radius"), shape.number("length")};
    if (kind == "capsule") return Capsule{shape.number("radius"), shape.number("length")};
    if (kind != "mesh") throw shape.error(fmt::format("no shape is called '{}'{}", kind, did_you_mean(kind, shapes())));
    const std::string file = shape.word("filename");
    const auto found = find_mesh(file);
    if (!found) {
      missing_.emplace_back(file, shape.line());
      return std::nullopt;
    }
    const auto scale = shape.triple("scale", {1.0, 1.0, 1.0});
    if (scale[0] != scale[1] || scale[0] != scale[2])
      throw shape.error("'scale' of a mesh must be the same along all axes");
    try {
      return read_mesh(*found, {.unit = fmt::format("{}", scale[0])}).mesh;
    } catch (const Error& error) {
      throw shape.error(error.what());
    }
  }

  static std::vector<std::string> shapes() { return {"sphere", "box", "cylinder", "capsule", "mesh"}; }

  /// Returns the path of a mesh's file.
  [[nodiscard]] std::optional<std::string> find_mesh(const std::string& name) const {
    std::string file = name;
    std::vector<fs::path> parts;
    if (file.starts_with("file://")) {
      file.erase(0, 7);
    } else if (file.starts_with("package://")) {
      file.erase(0, 10);
      // The first folder may be the name of a package, which need not be a folder's.
      if (const std::size_t slash = file.find('/'); slash != std::string::npos)
        parts.emplace_back(file.substr(slash + 1));
    }
    parts.insert(parts.begin(), fs::path(file));
    std::error_code fault;
    for (const fs::path& part : parts) {
      if (part.is_absolute()) {
        if (fs::is_regular_file(part, fault)) return part.string();
        continue;
      }
      fs::path folder = fs::absolute(fs::path(text_.path), fault).parent_path();
      constexpr int most_above = 4;
      for (int above = 0; above <= most_above && !folder.empty(); ++above, folder = folder.parent_path()) {
        const fs::path at = folder / part;
        if (fs::is_regular_file(at, fault)) return at.lexically_normal().string();
      }
    }
    return std::nullopt;
  }

  [[nodiscard]] std::size_t link_of(const XmlEntry& joint, const char* end) const {
    const XmlEntry entry = joint.required(end);
    const std::string name = entry.word("link");
    const auto found = link_numbers_.find(name);
    if (found != link_numbers_.end()) return found->second;
    std::vector<std::string> names;
    names.reserve(links_.size());
    for (const Link& link : links_) names.push_back(link.name);
    throw entry.error(fmt::format("no link is called '{}'{}", name, did_you_mean(name, names)));
  }

  void read_joint(const XmlEntry& entry, const std::map<std::string, std::size_t>& numbers) {
    Joint joint;
    joint.name = entry.word("name");
    joint.kind = kind_of(entry);
    joint.parent = link_of(entry, "parent");
    joint.child = link_of(entry, "child");
    joint.origin = origin_of(entry);
    if (!in_range(joint.origin.position)) {
      throw entry.required("origin").error(
          fmt::format("the origin of joint '{}' is not within {:g} m of its link", joint.name, most_distant));
    }
    const bool limited = joint.kind == Joint::Kind::revolute || joint.kind == Joint::Kind::prismatic;
    if (const auto axis = entry.child("axis"); axis && joint.kind != Joint::Kind::fixed) {
      const auto [x, y, z] = axis->triple("xyz", {1.0, 0.0, 0.0});
      const Vec3 given{x, y, z};
      const double length = norm(given);
      if (!(length > 0.0) || !std::isfinite(length)) throw axis->error("the axis has no direction");
      joint.axis = (1.0 / length) * given;
    }
    if (limited) {
      const auto limit = entry.child("limit");
      if (!limit)
        throw entry.error(fmt::format("joint '{}' is {} and has no 'limit'", joint.name, to_string(joint.kind)));
      joint.lo = limit->number("lower", 0.0);
      joint.hi = limit->number("upper", 0.0);
      if (joint.lo > joint.hi) {
        throw limit->error(fmt::format("the lower limit of joint '{}', {:g}, is above the upper, {:g}", joint.name,
                                       joint.lo, joint.hi));
      }
      const double most = joint.kind == Joint::Kind::revolute ? largest_turn : most_distant;
      if (!(joint.lo >= -most && joint.hi <= most)) {
        throw limit->error(fmt::format("the limits of joint '{}' are not within {:g} {} of 0{}", joint.name, most,
                                       joint.kind == Joint::Kind::revolute ? "rad" : "m",
                                       joint.kind == Joint::Kind::revolute ? "; without limits it is continuous" : ""));
      }
    }
    if (const auto mimic = entry.child("mimic"); mimic) {
      if (joint.kind == Joint::Kind::fixed) {
        warnings_.push_back(fmt::format("joint '{}' is fixed: its 'mimic' is ignored", joint.name));
      } else {
        const std::string leader = mimic->word("joint");
        const auto found = numbers.find(leader);
        if (found == numbers.end()) {
          std::vector<std::string> names;
          names.reserve(numbers.size());
          for (const auto& [name, number] : numbers) names.push_back(name);
          throw mimic->error(fmt::format("no joint is called '{}'{}", leader, did_you_mean(leader, names)));
        }
        joint.mimic = Joint::Mimic{found->second, mimic->number("multiplier", 1.0), mimic->number("offset", 0.0)};
        if (!(std::abs(joint.mimic->multiplier) <= most_multiplier && std::abs(joint.mimic->offset) <= largest_turn)) {
          throw mimic->error(fmt::format("joint '{}' follows '{}' by more than {:g} times, or from beyond {:g}",
                                         joint.name, leader, most_multiplier, largest_turn));
        }
      }
    }
    joints_.push_back(std::move(joint));
    joint_lines_.push_back(entry.line());
  }

  static Joint::Kind kind_of(const XmlEntry& entry) {
    using Kind = Joint::Kind;
    const std::string type = entry.word("type");
    std::vector<std::string> names;
    for (const Kind kind :
         {Kind::fixed, Kind::revolute, Kind::continuous, Kind::prismatic, Kind::planar, Kind::floating}) {
      if (type == to_string(kind)) return kind;
      names.emplace_back(to_string(kind));
    }
    throw entry.error(fmt::format("no joint is '{}'{}", type, did_you_mean(type, names)));
  }

  const SourceText& text_;
  XmlEntry robot_;
  std::vector<Link> links_;
  std::vector<Joint> joints_;
  std::vector<std::size_t> link_lines_;
  std::vector<std::size_t> joint_lines_;
  std::map<std::string, std::size_t> link_numbers_;
  std::vector<std::pair<std::string, std::size_t>> missing_;  ///< meshes and their lines
  std::vector<std::string> warnings_;
  ErrorList errors_;
};

}  // namespace

UrdfFile read_urdf(const std::string& path) {
  const SourceText text = SourceText::load(path);
  return UrdfReader(text).read();
}

}  // namespace trellis
