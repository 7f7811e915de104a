// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include <trellis/base/errors.hpp>
#include <trellis/reader/mesh_file.hpp>
#include <trellis/reader/robot_files.hpp>
#include <trellis/reader/robot_root.hpp>
#include <trellis/reader/ros_packages.hpp>
#include <trellis/reader/unused.hpp>
#include <trellis/reader/xml_entry.hpp>
#include <trellis/scene/spatial/ranges.hpp>

namespace trellis {

namespace {

/// Joints turn by at most so many radians, for which collision checking computes sines to full accuracy.
constexpr double largest_turn = 1e5;
/// Metres that a shape without an extent along an axis is thick there.
constexpr double thin = 1e-4;

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

/// Warnings of a file. Those of one kind are one warning, at the first line, which lists the other lines.
class Notices {
 public:
  explicit Notices(const SourceText& text) : text_(text) {}

  void add(std::size_t line, const std::string& text) { add(line, text, text); }
  void add(std::size_t line, const std::string& kind, const std::string& text) {
    const auto [at, fresh] = places_.emplace(kind, notices_.size());
    if (fresh) notices_.push_back({text, {}});
    Notice& notice = notices_[at->second];
    // The text is that of the first line.
    const bool first = notice.lines.empty() || line < notice.lines.front();
    if (first) notice.text = text;
    notice.lines.insert(first ? notice.lines.begin() : notice.lines.end(), line);
  }
  [[nodiscard]] std::vector<std::string> take() {
    std::stable_sort(notices_.begin(), notices_.end(),
                     [](const Notice& a, const Notice& b) { return a.lines.front() < b.lines.front(); });
    std::vector<std::string> warnings;
    warnings.reserve(notices_.size());
    for (const Notice& notice : notices_) {
      warnings.push_back(
          fmt::format("{}:{}: {}{}", text_.path, notice.lines.front(), notice.text, more_lines(notice.lines)));
    }
    return warnings;
  }

 private:
  struct Notice {
    std::string text;
    std::vector<std::size_t> lines;
  };
  const SourceText& text_;
  std::map<std::string, std::size_t> places_;  ///< in notices_, by kind
  std::vector<Notice> notices_;
};

class UrdfReader {
 public:
  UrdfReader(const SourceText& text, const UrdfOptions& options)
      : text_(text),
        options_(options),
        robot_(robot_root(text, "a URDF file")),
        packages_(text.path, options.packages),
        notices_(text) {}

  UrdfFile read() {
    const std::string name = robot_.has("name") ? robot_.word("name") : "robot";
    const std::vector<XmlEntry> links = robot_.children("link");
    if (links.empty() && robot_.child("group")) {
      throw robot_.error(R"(it is an SRDF file, which has no links: robot.urdf("FILE.urdf", { srdf = "FILE.srdf" }))");
    }
    // Planning needs no colours, motors or sensors, and nothing that is for a simulator.
    robot_.skip({"version", "material", "transmission", "gazebo", "sensor", "ros2_control"});
    for (const XmlEntry& entry : links) {
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
    report_missing();
    errors_.raise();
    lock_followers_of_fixed();
    std::map<std::string, std::size_t> lines;
    std::set<std::string> continuous;
    for (std::size_t j = 0; j < joints_.size(); ++j) {
      lines.emplace(joints_[j].name, joint_lines_[j]);
      if (joints_[j].kind == Joint::Kind::continuous) continuous.insert(joints_[j].name);
    }
    KinematicTree tree = [&] {
      try {
        return KinematicTree(name, std::move(links_), std::move(joints_));
      } catch (const TreeError& error) {
        const auto& of_part = error.part == TreeError::Part::link ? link_lines_ : joint_lines_;
        throw text_.error(of_part.at(error.number), error.what());
      } catch (const Error& error) {
        throw Error(fmt::format("{}: {}", text_.path, error.what()));
      }
    }();
    note_followers(tree, lines, continuous);
    std::vector<std::string> warnings = notices_.take();
    for (std::string& warning : unused_warnings(text_, robot_.unused())) warnings.push_back(std::move(warning));
    return {std::move(tree), std::move(warnings), std::move(lines), std::move(faults_), std::move(meshes_)};
  }

 private:
  void read_link(const XmlEntry& entry) {
    Link link{entry.word("name"), {}};
    if (!link_numbers_.emplace(link.name, links_.size()).second) {
      throw entry.error(fmt::format("a second link is called '{}'", link.name));
    }
    links_.push_back({link.name, {}});
    link_lines_.push_back(entry.line());
    // "type" is of old files, "contact" of PyBullet.
    entry.skip({"type", "visual", "contact", "self_collision_checking"});
    // Masses move nothing here; numbers that are none are a fault of the file all the same.
    for (const XmlEntry& inertial : entry.children("inertial")) {
      try {
        check_inertial(inertial);
      } catch (const Error& error) {
        faulty_inertial(inertial, error);
      }
      entry.skip({"inertial"});
    }
    const std::vector<XmlEntry> collisions = entry.children("collision");
    if (collisions.empty() && entry.child("visual")) {
      notices_.add(entry.line(), "visual",
                   fmt::format("link '{}' has visual geometry and no collision geometry: nothing of it is checked for "
                               "collision",
                               link.name));
    }
    std::vector<Solid>& solids = links_.back().solids;
    for (const XmlEntry& collision : collisions) {
      errors_.attempt([&] {
        collision.skip({"name", "material", "verbose", "contact_coefficients", "surface", "max_contacts"});
        const Pose3 pose = origin_of(collision);
        const XmlEntry geometry = collision.required("geometry");
        const auto shapes = geometry.children();
        if (shapes.size() != 1) throw geometry.error("a geometry has one shape");
        if (auto shape = read_shape(shapes.front(), link.name)) {
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

  void faulty_inertial(const XmlEntry& inertial, const Error& error) {
    notices_.add(inertial.line(), "inertial", fmt::format("{}; planning needs no masses", without_place(error)));
  }

  /// Returns the text of an error of this file without file and line.
  [[nodiscard]] std::string without_place(const Error& error) const {
    std::string text = error.what();
    const std::size_t colon = text.find(": ", text_.path.size());
    if (text.starts_with(text_.path + ":") && colon != std::string::npos) text.erase(0, colon + 2);
    return text;
  }

  /// Returns none for a mesh that is missing, and for a shape that is a point.
  std::optional<Shape3> read_shape(const XmlEntry& shape, const std::string& link) {
    const std::string kind = shape.name();
    const auto size = [&](const char* attribute) { return shape.number(attribute); };
    if (kind == "sphere") {
      const double radius = size("radius");
      if (radius == 0.0) return point(shape, link);
      return Sphere{radius};
    }
    if (kind == "box") {
      static_cast<void>(shape.word("size"));
      auto [x, y, z] = shape.triple("size", {});
      if (x == 0.0 && y == 0.0 && z == 0.0) return point(shape, link);
      for (double* side : {&x, &y, &z}) thicken(*side, thin, shape, link);
      return Cuboid{{x, y, z}};
    }
    if (kind == "cylinder" || kind == "capsule") {
      double radius = size("radius");
      double length = size("length");
      if (radius == 0.0 && length == 0.0) return point(shape, link);
      if (kind == "capsule" && length == 0.0) return Sphere{radius};
      thicken(radius, 0.5 * thin, shape, link);
      thicken(length, thin, shape, link);
      if (kind == "capsule") return Capsule{radius, length};
      return Cylinder{radius, length};
    }
    if (kind != "mesh") throw shape.error(fmt::format("no shape is called '{}'{}", kind, did_you_mean(kind, shapes())));
    const std::string uri = shape.word("filename");
    const auto found = packages_.find(uri);
    meshes_.push_back({uri, link, shape.line(), found.value_or("")});
    const auto [x, y, z] = shape.triple("scale", {1.0, 1.0, 1.0});
    if (!found) return std::nullopt;
    try {
      return read_mesh(*found, {.scale = {x, y, z}}).mesh;
    } catch (const Error& error) {
      throw shape.error(error.what());
    }
  }

  static std::vector<std::string> shapes() { return {"sphere", "box", "cylinder", "capsule", "mesh"}; }

  std::optional<Shape3> point(const XmlEntry& shape, const std::string& link) {
    notices_.add(shape.line(), "point",
                 fmt::format("the {} of link '{}' is a point: it is left out", shape.name(), link));
    return std::nullopt;
  }

  void thicken(double& extent, double to, const XmlEntry& shape, const std::string& link) {
    if (extent != 0.0) return;
    extent = to;
    notices_.add(
        shape.line(), "thin",
        fmt::format("the {} of link '{}' has an extent of 0: it is taken as {:g} m thick", shape.name(), link, thin));
  }

  void report_missing() {
    std::string list;
    std::size_t missing = 0;
    std::vector<std::string> advice;
    for (const UrdfFile::MeshUse& mesh : meshes_) {
      if (!mesh.path.empty()) continue;
      const std::string what = packages_.advice(mesh.uri);
      if (options_.leave_out_missing) {
        notices_.add(mesh.line, fmt::format("the mesh {} of link '{}' is not found: nothing of it is checked for "
                                            "collision",
                                            mesh.uri, mesh.link));
        notices_.add(mesh.line, what);
        continue;
      }
      ++missing;
      list += fmt::format("\n  line {}: {} of link '{}'", mesh.line, mesh.uri, mesh.link);
      if (std::find(advice.begin(), advice.end(), what) == advice.end()) advice.push_back(what);
    }
    if (missing == 0) return;
    constexpr std::size_t most = 5;
    for (std::size_t i = 0; i < std::min(most, advice.size()); ++i) list += "\n" + advice[i];
    errors_.add(
        Error(fmt::format("{}: {} mesh{} not found:{}\nmissing_meshes = \"leave_out\" reads the robot without {}",
                          text_.path, missing, missing == 1 ? " is" : "es are", list, missing == 1 ? "it" : "them")));
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
    entry.skip({"dynamics", "calibration"});
    const auto axis = entry.child("axis");
    const auto limit = entry.child("limit");
    // Times of paths are of velocities alone.
    if (limit) limit->skip({"effort", "acceleration", "deceleration", "jerk"});
    if (limit) {
      try {
        joint.velocity = std::max(0.0, limit->number("velocity", 0.0));
      } catch (const Error&) {
        // Times alone need it, so it refuses no robot.
        notices_.add(limit->line(), fmt::format("'velocity' of joint '{}' is no number", joint.name));
      }
    }
    if (joint.kind == Joint::Kind::fixed) entry.skip({"axis", "limit", "safety_controller"});
    if (joint.kind == Joint::Kind::planar || joint.kind == Joint::Kind::floating) entry.skip({"limit"});
    if (!joint.limited()) entry.skip({"safety_controller"});
    if (axis && joint.kind != Joint::Kind::fixed) {
      const auto [x, y, z] = axis->triple("xyz", {1.0, 0.0, 0.0});
      const Vec3 given{x, y, z};
      const double length = norm(given);
      if (length > 0.0 && std::isfinite(length)) {
        joint.axis = (1.0 / length) * given;
      } else {
        lock(joint, axis->error(fmt::format("the axis of joint '{}' has no direction", joint.name)), axis->line());
      }
    }
    if (joint.limited()) {
      try {
        read_limits(entry, limit, joint);
      } catch (const Error& error) {
        lock(joint, error, limit ? limit->line() : entry.line());
      }
    }
    if (const auto mimic = entry.child("mimic")) {
      if (joint.kind == Joint::Kind::fixed) {
        entry.skip({"mimic"});
        notices_.add(mimic->line(), fmt::format("joint '{}' is fixed: its 'mimic' is ignored", joint.name));
      } else {
        try {
          read_mimic(*mimic, joint, numbers);
        } catch (const Error& error) {
          lock(joint, error, mimic->line());
        }
      }
    }
    joints_.push_back(std::move(joint));
    joint_lines_.push_back(entry.line());
  }

  /// Makes a joint stay where it is, at 0 where its limits say nothing else, because of a fault of the file.
  void lock(Joint& joint, const Error& fault, std::size_t line) {
    joint.locked = true;
    joint.mimic.reset();
    if (joint.limited() && !(joint.lo <= joint.hi && std::isfinite(joint.lo) && std::isfinite(joint.hi))) {
      joint.lo = joint.kind == Joint::Kind::revolute ? -largest_turn : -most_distant;
      joint.hi = -joint.lo;
    }
    if (!faults_.emplace(joint.name, fault.what()).second) return;
    notices_.add(line, fmt::format("{}: the joint stays where it is", without_place(fault)));
  }

  /// \throws Error where the limits are faulty
  void read_limits(const XmlEntry& entry, const std::optional<XmlEntry>& limit, Joint& joint) {
    const auto safety = entry.child("safety_controller");
    if (safety) safety->skip({"k_position", "k_velocity"});
    if (!limit)
      throw entry.error(fmt::format("joint '{}' is {} and has no 'limit'", joint.name, to_string(joint.kind)));
    const double lo = limit->number("lower", 0.0);
    const double hi = limit->number("upper", 0.0);
    if (lo > hi) {
      throw limit->error(
          fmt::format("the lower limit of joint '{}', {:g}, is above the upper, {:g}", joint.name, lo, hi));
    }
    const bool turns = joint.kind == Joint::Kind::revolute;
    const double most = turns ? largest_turn : most_distant;
    if (turns && lo < -most && hi > most) {
      joint.kind = Joint::Kind::continuous;
      notices_.add(
          limit->line(), "continuous",
          fmt::format("joint '{}' has limits of {:g} and {:g} rad: it is taken as continuous", joint.name, lo, hi));
      return;
    }
    if (!(lo >= -most && hi <= most)) {
      throw limit->error(fmt::format("the limits of joint '{}' are not within {:g} {} of 0{}", joint.name, most,
                                     turns ? "rad" : "m", turns ? "; without limits it is continuous" : ""));
    }
    joint.lo = lo;
    joint.hi = hi;
    if (safety && safety->has("soft_lower_limit") && safety->has("soft_upper_limit")) {
      read_soft_limits(*safety, joint);
    }
  }

  void read_soft_limits(const XmlEntry& safety, Joint& joint) {
    const double lo = std::max(joint.lo, safety.number("soft_lower_limit"));
    const double hi = std::min(joint.hi, safety.number("soft_upper_limit"));
    if (lo == joint.lo && hi == joint.hi) return;
    if (!options_.soft_limits) {
      notices_.add(safety.line(), "soft limits",
                   fmt::format("the soft limits of joint '{}' are not used; soft_limits = true keeps joints within "
                               "them",
                               joint.name));
      return;
    }
    if (lo > hi) {
      throw safety.error(fmt::format("the soft limits of joint '{}' leave nothing of its limits", joint.name));
    }
    joint.lo = lo;
    joint.hi = hi;
  }

  static void read_mimic(const XmlEntry& mimic, Joint& joint, const std::map<std::string, std::size_t>& numbers) {
    const std::string leader = mimic.word("joint");
    const auto found = numbers.find(leader);
    if (found == numbers.end()) {
      std::vector<std::string> names;
      names.reserve(numbers.size());
      for (const auto& [name, number] : numbers) names.push_back(name);
      throw mimic.error(
          fmt::format("joint '{}' follows '{}', which is no joint{}", joint.name, leader, did_you_mean(leader, names)));
    }
    joint.mimic = Joint::Mimic{found->second, mimic.number("multiplier", 1.0), mimic.number("offset", 0.0)};
  }

  /// A joint that follows a fixed one stays at its offset, and its followers follow it.
  void lock_followers_of_fixed() {
    for (std::size_t j = 0; j < joints_.size(); ++j) {
      Joint& joint = joints_[j];
      if (!joint.mimic || joints_[joint.mimic->joint].kind != Joint::Kind::fixed) continue;
      notices_.add(joint_lines_[j], fmt::format("joint '{}' follows '{}', which is fixed: it stays at {:g}", joint.name,
                                                joints_[joint.mimic->joint].name, joint.mimic->offset));
      if (joint.kind == Joint::Kind::continuous) joint.kind = Joint::Kind::revolute;
      joint.lo = joint.hi = joint.mimic->offset;
      joint.mimic.reset();
    }
  }

  /// Warns of followers that leave their own limits, and of continuous joints that the tree gave limits.
  void note_followers(const KinematicTree& tree, const std::map<std::string, std::size_t>& lines,
                      const std::set<std::string>& continuous) {
    for (const Joint& joint : tree.joints()) {
      const std::size_t line = lines.at(joint.name);
      if (joint.kind == Joint::Kind::revolute && continuous.contains(joint.name)) {
        notices_.add(line, fmt::format("joint '{}' is continuous, and joints that follow it are elsewhere after a "
                                       "turn: it turns from -pi to pi, and not beyond",
                                       joint.name));
      }
      if (!joint.mimic || !joint.limited() || joint.locked) continue;
      const Joint& leader = tree.joints()[joint.mimic->joint];
      if (!leader.limited()) continue;
      const double first = joint.mimic->multiplier * leader.lo + joint.mimic->offset;
      const double last = joint.mimic->multiplier * leader.hi + joint.mimic->offset;
      constexpr double slack = 1e-3;
      if (std::min(first, last) >= joint.lo - slack && std::max(first, last) <= joint.hi + slack) continue;
      notices_.add(
          line, "follower",
          fmt::format("joint '{}' follows '{}' from {:g} to {:g}, beyond its own limits of {:g} and {:g}, "
                      "which bind no follower",
                      joint.name, leader.name, std::min(first, last), std::max(first, last), joint.lo, joint.hi));
    }
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
  const UrdfOptions& options_;
  XmlEntry robot_;
  RosPackages packages_;
  Notices notices_;
  std::vector<Link> links_;
  std::vector<Joint> joints_;
  std::vector<std::size_t> link_lines_;
  std::vector<std::size_t> joint_lines_;
  std::map<std::string, std::size_t> link_numbers_;
  std::map<std::string, std::string> faults_;  ///< of locked joints, by name
  std::vector<UrdfFile::MeshUse> meshes_;
  ErrorList errors_;
};

}  // namespace

UrdfFile read_urdf(const std::string& path, const UrdfOptions& options) {
  const SourceText text = SourceText::load(path);
  return UrdfReader(text, options).read();
}

}  // namespace trellis
