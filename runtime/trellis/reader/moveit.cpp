// SPDX-License-Identifier: GPL-3.0-or-later
// Planning scenes of MoveIt as YAML, and the requests beside them.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <map>
#include <memory>
#include <numbers>
#include <optional>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include <trellis/base/errors.hpp>
#include <trellis/instance/link_shapes.hpp>
#include <trellis/reader/formats.hpp>
#include <trellis/reader/moveit_scene.hpp>
#include <trellis/reader/moveit_yaml.hpp>
#include <trellis/reader/robot_files.hpp>
#include <trellis/reader/yaml_entry.hpp>

namespace trellis {

namespace {

MakeError fault_at(const YamlEntry& entry) {
  return [entry](const std::string& fault) { return entry.error(fault); };
}

/// The file of the request: "request0001.yaml" of "scene0001.yaml" and of "scene_vicon0001.yaml"; "" where there is
/// none.
std::string request_beside(const std::string& path) {
  const std::filesystem::path file(path);
  const std::string name = file.filename().string();
  const std::size_t at = name.rfind("scene");
  if (at == std::string::npos) return "";
  const std::string rest = name.substr(at + 5);
  const std::size_t digits = rest.find_first_of("0123456789");
  std::vector<std::string> rests = {rest};
  if (digits != std::string::npos && digits > 0) rests.push_back(rest.substr(digits));
  for (const std::string& end : rests) {
    std::error_code ignored;
    const std::filesystem::path request = file.parent_path() / (name.substr(0, at) + "request" + end);
    if (std::filesystem::exists(request, ignored)) return request.string();
  }
  return "";
}

/// The values of a robot's joints by name: of those that move, and of the others.
class JointValues {
 public:
  explicit JointValues(const Manipulator& robot) : robot_(robot), values_(robot.tree().joints().size()) {
    for (const std::size_t j : robot.moving()) {
      if (robot.tree().joints()[j].carries_robot()) root_ = j;
    }
  }

  void set(const std::string& name, double value) {
    const std::size_t slash = name.rfind('/');
    if (const auto coordinate = planar_coordinate(name, slash)) {
      if (values_[*root_].empty()) values_[*root_].assign(3, 0.0);
      values_[*root_][*coordinate] = value;
      return;
    }
    const auto j = robot_.tree().find_joint(name);
    constexpr double nothing = 1e-3;
    // The leader of a follower determines it.
    if (j && robot_.tree().joints()[*j].mimic) return;
    if (j && robot_.tree().joints()[*j].width() == 1) {
      values_[*j] = {value};
    } else if (!j || std::abs(value) > nothing) {
      unread_.insert(name);
    }
  }
  void set_pose(std::size_t joint, const Pose3& pose) {
    const auto& [x, y, z] = pose.position;
    const Quaternion& turn = pose.orientation;
    if (robot_.tree().joints()[joint].kind == Joint::Kind::floating) {
      values_[joint] = {x, y, z, turn.x, turn.y, turn.z, turn.w};
    } else {
      values_[joint] = {x, y, rotation_vector(turn).z};
    }
  }
  /// The joint by which a base moves.
  [[nodiscard]] std::optional<std::size_t> root() const { return root_; }
  /// The values of joints that do not move.
  [[nodiscard]] std::vector<std::vector<double>> others() const {
    std::vector<std::vector<double>> all = values_;
    for (const std::size_t j : robot_.moving()) all[j].clear();
    return all;
  }
  [[nodiscard]] const std::set<std::string>& unread() const { return unread_; }
  /// The first joint that moves and has no value; "" where there is none.
  [[nodiscard]] std::string missing() const {
    for (const std::size_t j : robot_.moving()) {
      if (values_[j].empty() && j != root_) return robot_.tree().joints()[j].name;
    }
    return "";
  }
  /// The coordinates of the joints that move, all of which have values.
  [[nodiscard]] Configuration coordinates() const {
    Configuration q;
    for (const std::size_t j : robot_.moving()) {
      const Joint& joint = robot_.tree().joints()[j];
      std::vector<double> value = values_[j];
      if (value.empty()) {
        value.assign(joint.width(), 0.0);
        if (joint.kind == Joint::Kind::floating) value.back() = 1.0;
      }
      // Files round values at the limits.
      constexpr double rounding = 1e-4;
      const bool limited = joint.kind == Joint::Kind::revolute || joint.kind == Joint::Kind::prismatic;
      if (limited && value[0] < joint.lo && value[0] > joint.lo - rounding) value[0] = joint.lo;
      if (limited && value[0] > joint.hi && value[0] < joint.hi + rounding) value[0] = joint.hi;
      q.insert(q.end(), value.begin(), value.end());
    }
    return q;
  }

 private:
  /// Variables of a planar joint are "NAME/x", "NAME/y" and "NAME/theta".
  [[nodiscard]] std::optional<std::size_t> planar_coordinate(const std::string& name, std::size_t slash) const {
    const bool planar = root_ && robot_.tree().joints()[*root_].kind == Joint::Kind::planar;
    if (!planar || slash == std::string::npos) return std::nullopt;
    const std::string end = name.substr(slash + 1);
    if (end == "x") return 0;
    if (end == "y") return 1;
    if (end == "theta") return 2;
    return std::nullopt;
  }

  const Manipulator& robot_;
  std::vector<std::vector<double>> values_;  ///< for each joint; empty where it has none
  std::set<std::string> unread_;
  std::optional<std::size_t> root_;
};

/// Constraints of a message of MoveIt, whose lists have these names.
bool has_constraints(const YamlEntry& constraints) {
  constexpr std::array<const char*, 4> kinds = {"joint_constraints", "position_constraints", "orientation_constraints",
                                                "visibility_constraints"};
  return std::any_of(kinds.begin(), kinds.end(), [&](const char* kind) { return !constraints.list(kind).empty(); });
}

/// Reads a scene and its request for a robot.
class SceneReader {
 public:
  SceneReader(const SourceText& text, const SphereModel& robot, const MoveitOptions& options)
      : text_(text),
        options_(options),
        scene_(YamlEntry::root(text, "a scene of MoveIt as a YAML map")),
        robot_(robot),
        values_(robot.robot()) {
    if (const std::string path = request_beside(text.path); !path.empty()) {
      request_text_ = SourceText::load(path);
      request_ = YamlEntry::root(request_text_, "a request of MoveIt as a YAML map");
    }
  }

  MoveitFile read() {
    scene_.know({"name", "robot_model_name", "is_diff", "object_colors"});
    read_states();
    MoveitObjects objects(&robot_, start_);
    read_frames(objects);
    read_attached(objects, true);
    read_world(objects);
    read_attached(objects, false);
    attach(objects);
    read_padding();
    read_permissions(objects);
    MoveitFile file{.world = moveit_world(objects, &robot_, text_.path), .robot = robot_, .start = start_};
    if (request_) read_request(objects, file);
    errors_.raise();
    for (std::string& warning : unused_warnings(text_, scene_.unused())) warnings_.push_back(std::move(warning));
    if (request_) {
      for (std::string& warning : unused_warnings(request_text_, request_->unused())) {
        warnings_.push_back(std::move(warning));
      }
    }
    file.warnings = std::move(warnings_);
    return file;
  }

 private:
  /// Refuses what changes which configurations are valid and is not read, unless the caller leaves it out.
  void refuse(const char* part, const YamlEntry& entry, const std::string& what) {
    const bool ignored = std::find(options_.ignore.begin(), options_.ignore.end(), part) != options_.ignore.end();
    if (ignored) {
      warnings_.push_back(entry.at_line(what + ": it is left out, as `ignore` says"));
      return;
    }
    errors_.add(entry.error(fmt::format("{}; ignore = {{ \"{}\" }} of scenes.load leaves it out", what, part)));
  }

  // The state of the robot.

  void read_states() {
    const Pose3 given_base = robot_.base();
    std::optional<Pose3> base;
    std::optional<YamlEntry> base_entry;
    const auto read = [&](const YamlEntry& state) {
      state.know({"is_diff"});
      if (state.has("joint_state") && !state.at("joint_state").empty()) read_joints(state.at("joint_state"));
      if (!state.has("multi_dof_joint_state") || state.at("multi_dof_joint_state").empty()) return;
      const YamlEntry entry = state.at("multi_dof_joint_state");
      entry.know({"twist", "wrench"});
      if (const std::string frame = frame_of(entry); !frame.empty()) own_frames_.push_back(frame);
      const auto names = entry.list("joint_names");
      const auto transforms = entry.list("transforms");
      if (names.size() != transforms.size()) throw entry.error("'joint_names' and 'transforms' differ in length");
      for (std::size_t i = 0; i < names.size(); ++i) {
        const Pose3 pose = transform_of(transforms[i]);
        const auto j = robot_.robot().tree().find_joint(names[i].word());
        if (j && robot_.robot().tree().joints()[*j].width() > 1) {
          values_.set_pose(*j, pose);
        } else {
          base = pose;
          base_entry = transforms[i];
        }
      }
    };
    if (scene_.has("robot_state") && !scene_.at("robot_state").empty()) {
      errors_.attempt([&] { read(scene_.at("robot_state")); });
    }
    if (request_ && request_->has("start_state") && !request_->at("start_state").empty()) {
      errors_.attempt([&] { read(request_->at("start_state")); });
    }
    errors_.raise();
    if (base && values_.root()) {
      place_mobile(*base, *base_entry);
    } else if (base && !(*base == Pose3{})) {
      if (given_base == Pose3{}) {
        robot_ = robot_.based_at(*base);
      } else {
        warnings_.push_back(base_entry->at_line("the place of the base is left out: robot.urdf has a `base`"));
      }
    }
    place_others();
    const std::string missing = values_.missing();
    if (!options_.start.empty()) {
      start_ = options_.start;
    } else if (missing.empty()) {
      start_ = values_.coordinates();
    } else if (request_ && request_->has("start_state")) {
      throw request_->at("start_state").error(fmt::format("the start lacks joint '{}'", missing));
    }
  }

  void read_joints(const YamlEntry& state) {
    state.know({"velocity", "effort"});
    if (const std::string frame = frame_of(state); !frame.empty()) own_frames_.push_back(frame);
    const auto names = state.list("name");
    const auto positions = state.list("position");
    if (names.size() != positions.size()) throw state.error("'name' and 'position' differ in length");
    for (std::size_t i = 0; i < names.size(); ++i) values_.set(names[i].word(), positions[i].number());
  }

  /// A base that moves is where the scene's virtual joint places it.
  void place_mobile(const Pose3& pose, const YamlEntry& entry) {
    const bool planar = robot_.robot().tree().joints()[*values_.root()].kind == Joint::Kind::planar;
    constexpr double rounding = 1e-3;
    const Vec3 turn = rotation_vector(pose.orientation);
    if (planar &&
        (std::abs(pose.position.z) > rounding || std::abs(turn.x) > rounding || std::abs(turn.y) > rounding)) {
      throw entry.error(
          fmt::format("the base is at z = {:g} m, turned by ({:g}, {:g}, {:g}); it moves in the plane z = 0",
                      pose.position.z, turn.x, turn.y, turn.z));
    }
    values_.set_pose(*values_.root(), pose);
  }

  /// Places the joints that do not move where the scene says.
  void place_others() {
    const Manipulator& arm = robot_.robot();
    std::vector<std::vector<double>> placed = arm.values();
    placed.resize(arm.tree().joints().size());
    const std::vector<std::vector<double>> others = values_.others();
    bool changed = false;
    for (std::size_t j = 0; j < others.size(); ++j) {
      if (others[j].empty()) continue;
      const Joint& joint = arm.tree().joints()[j];
      std::vector<double> value = others[j];
      constexpr double rounding = 1e-4;
      if (value.size() == 1 && joint.kind != Joint::Kind::continuous && value[0] > joint.lo - rounding &&
          value[0] < joint.hi + rounding) {
        value[0] = std::clamp(value[0], joint.lo, joint.hi);
      }
      if (!placed[j].empty()) {
        if (std::abs(placed[j][0] - value[0]) > rounding) {
          warnings_.push_back(
              fmt::format("joint '{}' is at {:g} in the scene, and stays at {:g}: `values` of robot.urdf", joint.name,
                          value[0], placed[j][0]));
        }
        continue;
      }
      const double rest = joint.kind == Joint::Kind::continuous ? 0.0 : std::clamp(0.0, joint.lo, joint.hi);
      if (value.size() == 1 && value[0] == rest) continue;
      placed[j] = std::move(value);
      changed = true;
    }
    std::vector<StandingContact> contacts;  // a start in contact names them
    if (changed) robot_ = with_standing_shapes(robot_.with_values(placed), contacts);
    if (!values_.unread().empty()) {
      warnings_.push_back(
          fmt::format("values of joints that robot '{}' does not have, or that its URDF file fixes, are "
                      "not read: {}",
                      arm.tree().name(), fmt::join(values_.unread(), ", ")));
    }
  }

  // Frames and objects.

  void read_frames(MoveitObjects& objects) {
    const KinematicTree& tree = robot_.robot().tree();
    const std::string root = tree.links()[tree.base()].name;
    std::set<std::string> own(own_frames_.begin(), own_frames_.end());
    own.insert(robot_.world_frame().empty() ? "world" : robot_.world_frame());
    for (const std::string& frame : own) {
      if (!tree.find_link(frame)) objects.name_world(frame);
    }
    // MoveIt writes a frame as the header's, and the frame of the robot's model as the child's; tf writes the reverse.
    // A chain may begin later in the file.
    std::vector<YamlEntry> open = scene_.list("fixed_frame_transforms");
    const auto is_own = [&](const std::string& frame) { return frame.empty() || frame == root || own.contains(frame); };
    for (bool more = true; more && !open.empty();) {
      more = false;
      std::vector<YamlEntry> later;
      for (const YamlEntry& entry : open) {
        errors_.attempt([&] {
          std::string parent = frame_of(entry);
          std::string child = entry.word("child_frame_id");
          const Pose3 pose = transform_of(entry.at("transform"));
          if (parent.starts_with('/')) parent.erase(0, 1);
          if (child.starts_with('/')) child.erase(0, 1);
          if (is_own(child)) std::swap(parent, child);
          const auto at = objects.find_frame(parent, fault_at(entry));
          if (!at) {
            later.push_back(entry);
            return;
          }
          if (!is_own(child)) objects.place_frame(child, *at * pose);
          more = true;
        });
      }
      open = std::move(later);
    }
    for (const YamlEntry& entry : open) {
      errors_.attempt([&] { static_cast<void>(objects.frame(frame_of(entry), fault_at(entry))); });
    }
  }

  void read_world(MoveitObjects& objects) {
    if (!scene_.has("world") || scene_.at("world").empty()) return;
    const YamlEntry world = scene_.at("world");
    for (const YamlEntry& entry : world.list("collision_objects")) {
      errors_.attempt([&] { apply(entry, objects); });
    }
    if (!world.has("octomap")) return;
    const YamlEntry octomap = world.at("octomap");
    octomap.know();
    const bool data =
        octomap.has("octomap") && octomap.at("octomap").has("data") && !octomap.at("octomap").at("data").empty();
    if (data) refuse("octomap", octomap, "an octomap is not read, and its cells are obstacles");
  }

  /// Applies a message about an object of the world.
  void apply(const YamlEntry& entry, MoveitObjects& objects) {
    using Operation = ObjectMessage::Operation;
    ObjectMessage message = object_message_of(entry, text_.path, warnings_);
    const std::string id = message.object.id;
    if (message.operation == Operation::remove) {
      if (id.empty()) {
        objects.remove_all();
      } else if (!objects.remove(id)) {
        warnings_.push_back(entry.at_line(fmt::format("object '{}' is removed and was not there", id)));
      }
      return;
    }
    const Pose3 frame = objects.frame(message.frame, fault_at(entry));
    if (message.operation == Operation::move) {
      MoveitObject* const object = objects.find(id);
      if (object == nullptr) throw entry.error(fmt::format("object '{}' moves and is not there", id));
      if (message.placed || !message.shaped) {
        object->pose = frame * message.object.pose;
      } else if (message.shape_poses.size() == object->parts.size()) {
        object->pose = frame;
        for (std::size_t i = 0; i < object->parts.size(); ++i) object->parts[i].pose = message.shape_poses[i];
        object->adopt_frame_of_shape();
      } else {
        throw entry.error(fmt::format("object '{}' has {} shapes and moves to {} poses", id, object->parts.size(),
                                      message.shape_poses.size()));
      }
      return;
    }
    if (message.object.parts.empty()) {
      warnings_.push_back(entry.at_line(fmt::format("object '{}' has no shape", id)));
      return;
    }
    message.object.adopt_frame_of_shape();
    message.object.pose = frame * message.object.pose;
    if (message.operation == Operation::append) {
      objects.append(message.object);
    } else {
      objects.add(std::move(message.object));
    }
  }

  /// Reads the attached objects: first those with shapes of their own, whose frames objects of the world may name, then
  /// those that are objects of the world.
  void read_attached(MoveitObjects& objects, bool shaped) {
    const auto read = [&](const YamlEntry& state) {
      for (const YamlEntry& entry : state.list("attached_collision_objects")) {
        errors_.attempt([&] { read_attached(entry, objects, shaped); });
      }
    };
    if (scene_.has("robot_state")) read(scene_.at("robot_state"));
    if (request_ && request_->has("start_state")) read(request_->at("start_state"));
  }

  void read_attached(const YamlEntry& entry, MoveitObjects& objects, bool shaped) {
    using Operation = ObjectMessage::Operation;
    entry.know({"detach_posture", "weight"});
    const YamlEntry of_object = entry.at("object");
    const bool has_shapes =
        !of_object.list("primitives").empty() || !of_object.list("meshes").empty() || !of_object.list("planes").empty();
    if (has_shapes != shaped) return;
    ObjectMessage message = object_message_of(of_object, text_.path, warnings_);
    const std::string id = message.object.id;
    if (message.operation == Operation::remove) {
      entry.know();
      std::erase_if(objects.attached, [&](const MoveitAttached& one) { return one.object.id == id; });
      return;
    }
    MoveitAttached attached{std::move(message.object), 0, {}, fault_at(entry)};
    const std::string link = entry.at("link_name").word();
    const KinematicTree& tree = robot_.robot().tree();
    const auto found = tree.find_link(link);
    if (!found) throw entry.at("link_name").error(unknown_link(link));
    attached.link = *found;
    for (const YamlEntry& touch : entry.list("touch_links")) {
      attached.touch.push_back(touch.word());
      const bool other = std::any_of(objects.attached.begin(), objects.attached.end(),
                                     [&](const auto& one) { return one.object.id == attached.touch.back(); });
      if (!tree.find_link(attached.touch.back()) && !other) throw touch.error(unknown_link(attached.touch.back()));
    }
    const auto in_link = [&](const Pose3& pose) { return objects.frame(link, fault_at(entry)).inverse() * pose; };
    if (!shaped) {
      const MoveitObject* const object = objects.find(id);
      if (object == nullptr) {
        throw of_object.error(fmt::format("object '{}' is attached and has no shape, here or in the world", id));
      }
      attached.object = *object;
      attached.object.pose = in_link(object->pose);
    } else {
      attached.object.adopt_frame_of_shape();
      if (!message.frame.empty() && message.frame != link) {
        attached.object.pose = in_link(objects.frame(message.frame, fault_at(of_object))) * attached.object.pose;
      }
    }
    // An object that a link carries is no obstacle.
    if (message.operation == Operation::add) {
      objects.remove(id);
      std::erase_if(objects.attached, [&](const MoveitAttached& one) { return one.object.id == id; });
    }
    objects.attached.push_back(std::move(attached));
  }

  [[nodiscard]] std::string unknown_link(const std::string& name) const {
    std::vector<std::string> known;
    for (const Link& link : robot_.robot().tree().links()) known.push_back(link.name);
    return fmt::format("no link is called '{}'{}", name, did_you_mean(name, known));
  }

  /// Attaches the objects to the robot: each of their shapes becomes a link.
  void attach(const MoveitObjects& objects) {
    for (const MoveitAttached& one : objects.attached) {
      errors_.attempt([&] {
        std::vector<std::size_t>& links = attached_links_[one.object.id];
        std::vector<std::size_t> touch;
        for (const std::string& name : one.touch) {
          if (const auto link = robot_.robot().tree().find_link(name)) touch.push_back(*link);
          const auto other = attached_links_.find(name);
          if (other != attached_links_.end()) touch.insert(touch.end(), other->second.begin(), other->second.end());
        }
        std::sort(touch.begin(), touch.end());
        for (const MoveitObject::Part& part : one.object.parts) {
          const auto* shape = std::get_if<Shape3>(&part.shape);
          if (shape == nullptr)
            throw one.fault(fmt::format("object '{}' is a plane: no link carries one", one.object.id));
          const Pose3 pose = one.object.pose * part.pose;
          const std::string name =
              links.empty() ? one.object.id : fmt::format("{} (shape {})", one.object.id, links.size() + 1);
          try {
            const Solid solid{*shape, {pose.position, normalised(pose.orientation)}};
            check_solid(solid, fmt::format("object '{}'", one.object.id));
            robot_ = robot_.attached(name, solid, one.link, touch);
          } catch (const Error& error) {
            throw one.fault(error.what());
          }
          links.push_back(robot_.robot().tree().links().size() - 1);
          carriers_[links.back()] = one.link;
        }
      });
    }
    errors_.raise();
  }

  // Padding and permissions.

  void read_padding() {
    const std::size_t links = robot_.robot().tree().links().size();
    std::vector<double> scale(links, 1.0);
    std::vector<double> padding(links, 0.0);
    bool any = false;
    const auto read = [&](const char* list, const char* key, double least, std::vector<double>& values) {
      for (const YamlEntry& entry : scene_.list(list)) {
        errors_.attempt([&] {
          const std::string name = entry.at("link_name").word();
          const double value = entry.at(key).number();
          if (value == least) return;
          const auto link = robot_.robot().tree().find_link(name);
          if (!link) throw entry.at("link_name").error(unknown_link(name));
          constexpr double most = 100.0;
          if (value > most)
            throw entry.at(key).error(fmt::format("'{}' is {:g}, at most {:g} is read", key, value, most));
          if (value < least) {
            warnings_.push_back(entry.at_line(
                fmt::format("the {} of link '{}' is {:g}: it is checked as it is, not smaller", key, name, value)));
            return;
          }
          values[*link] = value;
          any = true;
        });
      }
    };
    read("link_padding", "padding", 0.0, padding);
    read("link_scale", "scale", 1.0, scale);
    errors_.raise();
    if (!any) return;
    // An attached object has the padding of its link.
    for (const auto& [link, carrier] : carriers_) {
      scale[link] = scale[carrier];
      padding[link] = padding[carrier];
    }
    robot_ = robot_.padded(scale, padding);
  }

  /// The matrix of allowed collisions: which pairs of links may touch. It adds to those of the robot's files, which say
  /// more of this model of the robot: a pair that its SRDF file permits stays permitted.
  void read_permissions(const MoveitObjects& objects) {
    if (!scene_.has("allowed_collision_matrix") || scene_.at("allowed_collision_matrix").empty()) return;
    const YamlEntry matrix = scene_.at("allowed_collision_matrix");
    const std::vector<YamlEntry> names = matrix.list("entry_names");
    const std::vector<YamlEntry> rows = matrix.list("entry_values");
    if (names.size() != rows.size()) {
      throw matrix.error(fmt::format("{} 'entry_names' and {} rows of 'entry_values'", names.size(), rows.size()));
    }
    std::set<std::string> unknown;
    // What a name stands for: links, or an object of the world.
    struct Meaning {
      std::string name;
      std::vector<std::size_t> links;
      bool object = false;
    };
    const auto meaning_of = [&](const std::string& name) {
      Meaning meaning{name, {}, false};
      if (const auto found = attached_links_.find(name); found != attached_links_.end()) {
        meaning.links = found->second;
      } else if (const auto link = robot_.robot().tree().find_link(name)) {
        meaning.links = {*link};
      } else {
        meaning.object = std::any_of(objects.objects().begin(), objects.objects().end(),
                                     [&](const MoveitObject& object) { return object.id == name; });
        if (!meaning.object && name != "<octomap>") unknown.insert(name);
      }
      return meaning;
    };
    std::vector<Meaning> meanings;
    meanings.reserve(names.size());
    for (const YamlEntry& name : names) meanings.push_back(meaning_of(name.word()));
    using Pair = std::pair<std::size_t, std::size_t>;
    std::map<Pair, bool> named;  // pairs of links, and whether they may touch
    std::vector<std::string> with_objects;
    std::set<std::pair<std::size_t, std::string>> named_objects;
    const auto shaped = [&](std::size_t link) { return !robot_.robot().tree().links()[link].solids.empty(); };
    const auto set = [&](const Meaning& a, const Meaning& b, bool may) {
      for (const std::size_t i : a.links) {
        for (const std::size_t j : b.links) {
          if (i != j) named[{std::min(i, j), std::max(i, j)}] = may;
        }
      }
      const Meaning& links = a.object ? b : a;
      const Meaning& object = a.object ? a : b;
      if (!object.object) return;
      for (const std::size_t link : links.links) {
        if (!shaped(link) || !named_objects.emplace(link, object.name).second || !may) continue;
        with_objects.push_back(
            fmt::format("link '{}' and object '{}'", robot_.robot().tree().links()[link].name, object.name));
      }
    };
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const std::vector<YamlEntry> row = rows[i].is_map() ? rows[i].list("enabled") : rows[i].list();
      if (row.size() != names.size()) {
        throw rows[i].error(
            fmt::format("the row of '{}' has {} values, expected {}", meanings[i].name, row.size(), names.size()));
      }
      for (std::size_t j = i + 1; j < row.size(); ++j) set(meanings[i], meanings[j], truth_of(row[j]));
    }
    read_defaults(matrix, meaning_of, named, with_objects, named_objects);
    if (!with_objects.empty()) {
      refuse("allowed_collision_matrix", matrix,
             fmt::format("the matrix permits that {} touch{}, and links are checked against all objects",
                         with_objects.front(),
                         with_objects.size() == 1 ? "" : fmt::format(" ({} more pairs)", with_objects.size() - 1)));
    }
    if (!unknown.empty()) {
      warnings_.push_back(matrix.at_line(
          fmt::format("entries that are neither links nor objects are not read: {}", fmt::join(unknown, ", "))));
    }
    SphereModel::Pairs may_touch;
    std::vector<std::string> permitted;
    const std::vector<Link>& links = robot_.robot().tree().links();
    for (const auto& [pair, may] : named) {
      const auto [a, b] = pair;
      if (may) {
        may_touch.push_back(pair);
      } else if (shaped(a) && shaped(b) && !robot_.checked(a, b) && !robot_.always_touch(a, b) &&
                 !carriers_.contains(a) && !carriers_.contains(b)) {
        permitted.push_back(fmt::format("'{}' and '{}'", links[a].name, links[b].name));
      }
    }
    if (!permitted.empty()) {
      const std::size_t shown = std::min<std::size_t>(permitted.size(), 3);
      warnings_.push_back(matrix.at_line(
          fmt::format("the matrix forbids some pairs of links to touch; the robot's files permit it, so they may: {}{}",
                      fmt::join(permitted.begin(), permitted.begin() + static_cast<std::ptrdiff_t>(shown), ", "),
                      permitted.size() > shown ? fmt::format(" and {} more pairs", permitted.size() - shown) : "")));
    }
    if (!may_touch.empty()) robot_ = robot_.with_permissions(may_touch);
  }

  /// Adds the pairs that the defaults of the matrix decide: a pair without an entry is checked where one of its two
  /// defaults says so.
  template <class MeaningOf, class Named, class Pairs, class Objects>
  void read_defaults(const YamlEntry& matrix, const MeaningOf& meaning_of, Named& named, Pairs& with_objects,
                     const Objects& named_objects) {
    const std::vector<YamlEntry> names = matrix.list("default_entry_names");
    const std::vector<YamlEntry> values = matrix.list("default_entry_values");
    if (names.size() != values.size()) {
      throw matrix.error(
          fmt::format("{} 'default_entry_names' and {} 'default_entry_values'", names.size(), values.size()));
    }
    const std::vector<Link>& links = robot_.robot().tree().links();
    std::map<std::size_t, bool> of_link;
    std::map<std::string, bool> of_object;
    for (std::size_t i = 0; i < names.size(); ++i) {
      const auto meaning = meaning_of(names[i].word());
      for (const std::size_t link : meaning.links) of_link[link] = truth_of(values[i]);
      if (meaning.object) of_object[meaning.name] = truth_of(values[i]);
    }
    for (const auto& [a, may] : of_link) {
      for (std::size_t b = 0; b < links.size(); ++b) {
        // A padded copy is for obstacles alone.
        if (a == b || links[b].name.ends_with(" (padded)")) continue;
        const auto other = of_link.find(b);
        const bool both = may && (other == of_link.end() || other->second);
        named.emplace(std::pair(std::min(a, b), std::max(a, b)), both);
      }
    }
    for (std::size_t link = 0; link < links.size(); ++link) {
      if (links[link].solids.empty()) continue;
      const auto own = of_link.find(link);
      for (const auto& [object, may] : of_object) {
        if (!may || (own != of_link.end() && !own->second) || named_objects.contains({link, object})) continue;
        with_objects.push_back(fmt::format("link '{}' and object '{}'", links[link].name, object));
      }
    }
  }

  // The request.

  void read_request(const MoveitObjects& objects, MoveitFile& file) {
    request_->know({"planner_id", "pipeline_id", "group_name", "num_planning_attempts", "allowed_planning_time",
                    "workspace_parameters", "reference_trajectories", "start_state", "max_cartesian_speed",
                    "cartesian_speed_limited_link", "cartesian_speed_end_effector_link"});
    for (const char* key : {"max_velocity_scaling_factor", "max_acceleration_scaling_factor"}) {
      if (!request_->has(key)) continue;
      const double factor = request_->at(key).number();
      if (factor != 0.0 && factor != 1.0) {
        warnings_.push_back(request_->at(key).at_line(fmt::format("'{}' is not read: paths have no times", key)));
      }
    }
    if (request_->has("path_constraints")) {
      const YamlEntry path = request_->at("path_constraints");
      const bool any = has_constraints(path);
      path.know();
      if (any) refuse("path_constraints", path, "constraints of the path are not read, and fewer paths fulfil them");
    }
    if (request_->has("trajectory_constraints")) {
      const YamlEntry all = request_->at("trajectory_constraints");
      const bool any = !all.list("constraints").empty();
      all.know();
      if (any) {
        refuse("trajectory_constraints", all,
               "constraints of the trajectory are not read, and fewer paths fulfil them");
      }
    }
    if (!options_.goal) {
      request_->know({"goal_constraints"});
      return;
    }
    const auto goals = request_->at("goal_constraints").list();
    if (goals.empty()) throw request_->error("the request has no goal");
    for (const YamlEntry& goal : goals) errors_.attempt([&] { read_goal(goal, objects, file); });
  }

  void read_goal(const YamlEntry& goal, const MoveitObjects& objects, MoveitFile& file) {
    goal.know({"name"});
    const auto joints = goal.list("joint_constraints");
    const auto positions = goal.list("position_constraints");
    const auto orientations = goal.list("orientation_constraints");
    if (const auto others = goal.list("visibility_constraints"); !others.empty()) {
      throw others.front().error("a goal that constrains what a sensor sees is not read");
    }
    if (!joints.empty()) {
      if (!positions.empty() || !orientations.empty()) {
        throw goal.error("a goal of joints and of the pose of a link is not read: give one of them");
      }
      file.goals.push_back(joint_goal(goal, joints));
      return;
    }
    if (positions.empty()) {
      throw goal.error(orientations.empty() ? "the goal has no constraint"
                                            : "a goal of an orientation without a position is not read: reach { link = "
                                              "..., pose = ... } gives both");
    }
    if (positions.size() > 1 || orientations.size() > 1) {
      throw goal.error(
          "a goal of several positions or orientations is not read; inverse kinematics solves for one link");
    }
    file.link_goals.push_back(
        link_goal(positions.front(), orientations.empty() ? nullptr : &orientations.front(), objects));
  }

  Configuration joint_goal(const YamlEntry& goal, const std::vector<YamlEntry>& constraints) {
    JointValues values(robot_.robot());
    const KinematicTree& tree = robot_.robot().tree();
    for (const YamlEntry& one : constraints) {
      // The goal is where the tolerances are about.
      one.know({"tolerance_above", "tolerance_below", "weight"});
      const std::string name = one.at("joint_name").word();
      const double value = one.at("position").number();
      values.set(name, value);
      const auto j = tree.find_joint(name);
      if (!j) {
        if (!values.unread().contains(name)) continue;  // of a mobile base
        std::vector<std::string> known;
        for (const Joint& joint : tree.joints()) known.push_back(joint.name);
        throw one.at("joint_name").error(fmt::format("no joint is called '{}'{}", name, did_you_mean(name, known)));
      }
      check_fixed(one, *j, value);
    }
    if (const std::string missing = values.missing(); !missing.empty()) {
      throw goal.error(fmt::format("the goal lacks joint '{}'", missing));
    }
    return values.coordinates();
  }

  /// A joint that does not move must be where a goal places it.
  void check_fixed(const YamlEntry& constraint, std::size_t joint, double value) const {
    const Manipulator& arm = robot_.robot();
    const Joint& of = arm.tree().joints()[joint];
    if (of.width() != 1 || std::binary_search(arm.moving().begin(), arm.moving().end(), joint)) return;
    const std::vector<std::vector<double>>& values = arm.values();
    const double rest = of.kind == Joint::Kind::continuous ? 0.0 : std::clamp(0.0, of.lo, of.hi);
    const double at = joint < values.size() && !values[joint].empty() ? values[joint][0] : rest;
    const auto tolerance = [&](const char* key) { return constraint.has(key) ? constraint.at(key).number() : 0.0; };
    constexpr double rounding = 1e-3;
    if (value - at <= std::max(rounding, tolerance("tolerance_below")) &&
        at - value <= std::max(rounding, tolerance("tolerance_above"))) {
      return;
    }
    throw constraint.error(
        fmt::format("the goal has joint '{}' at {:g}, which is no joint of the robot's group and stays at {:g}: give "
                    "robot.urdf a group with it",
                    of.name, value, at));
  }

  MoveitFile::LinkGoal link_goal(const YamlEntry& position, const YamlEntry* orientation,
                                 const MoveitObjects& objects) {
    MoveitFile::LinkGoal goal;
    goal.file = request_text_.path;
    goal.line = position.line();
    position.know({"weight"});
    const std::string name = position.at("link_name").word();
    const auto link = robot_.robot().tree().find_link(name);
    if (!link) throw position.at("link_name").error(unknown_link(name));
    goal.link = *link;
    goal.point = vector_at(position, "target_point_offset");
    const YamlEntry region = position.at("constraint_region");
    const auto shapes = region.list("primitives");
    const auto poses = region.list("primitive_poses");
    if (!region.list("meshes").empty() || shapes.size() != 1 || poses.size() > 1) {
      throw region.error(
          "the region of a goal is one box, sphere or cylinder with its pose; reach { link = ..., pose = ... } gives a "
          "goal without a region");
    }
    const Pose3 frame = objects.frame(frame_of(position), fault_at(position));
    goal.position = frame(poses.empty() ? Vec3{} : pose_of(poses.front()).position);
    region.know({"mesh_poses", "primitive_poses"});
    // The goal lies in the ball within the region.
    const Shape3 shape = primitive_of(shapes.front());
    if (const auto* sphere = std::get_if<Sphere>(&shape)) goal.near = sphere->radius;
    if (const auto* box = std::get_if<Cuboid>(&shape)) {
      goal.near = 0.5 * std::min({box->size.x, box->size.y, box->size.z});
    }
    if (const auto* cylinder = std::get_if<Cylinder>(&shape)) {
      goal.near = std::min(cylinder->radius, 0.5 * cylinder->length);
    }
    constexpr double least = 1e-4;  // of goals without a tolerance
    goal.near = std::max(goal.near, least);
    if (orientation == nullptr) return goal;
    orientation->know({"weight"});
    const std::string other = orientation->at("link_name").word();
    if (other != name) {
      throw orientation->at("link_name")
          .error(
              fmt::format("the goal places '{}' and turns '{}': inverse kinematics solves for one link", name, other));
    }
    if (orientation->has("parameterization")) orientation->know({"parameterization"});
    goal.oriented = true;
    goal.orientation = objects.frame(frame_of(*orientation), fault_at(*orientation)).orientation *
                       quaternion_at(*orientation, "orientation");
    goal.turn = std::numbers::pi;
    for (const char* axis : {"absolute_x_axis_tolerance", "absolute_y_axis_tolerance", "absolute_z_axis_tolerance"}) {
      goal.turn = std::min(goal.turn, orientation->has(axis) ? orientation->at(axis).number() : 0.0);
    }
    goal.turn = std::max(goal.turn, least);
    return goal;
  }

  const SourceText& text_;
  const MoveitOptions& options_;
  YamlEntry scene_;
  SourceText request_text_;
  std::optional<YamlEntry> request_;
  SphereModel robot_;
  JointValues values_;
  Configuration start_;
  std::vector<std::string> own_frames_;  ///< that headers of states name
  std::map<std::string, std::vector<std::size_t>> attached_links_;
  std::map<std::size_t, std::size_t> carriers_;  ///< of links of attached objects
  std::vector<std::string> warnings_;
  ErrorList errors_;
};

}  // namespace

const std::vector<std::string>& moveit_ignorable() {
  static const std::vector<std::string> parts = {"octomap", "path_constraints", "trajectory_constraints",
                                                 "allowed_collision_matrix"};
  return parts;
}

MoveitFile read_moveit_yaml(const SourceText& text, const SphereModel& robot, const MoveitOptions& options) {
  return SceneReader(text, robot, options).read();
}

void describe_moveit_yaml(const SourceText& text, MoveitObjects& objects, std::vector<std::string>& notes,
                          std::vector<std::string>& warnings) {
  const YamlEntry scene = YamlEntry::root(text, "a scene of MoveIt as a YAML map");
  ErrorList errors;
  for (const YamlEntry& entry : scene.list("fixed_frame_transforms")) {
    errors.attempt([&] {
      const std::string parent = frame_of(entry);
      const std::string child = entry.word("child_frame_id");
      // Either may be the frame of the robot, which is not known here.
      for (const std::string& frame : {parent, child}) objects.place_frame(frame, transform_of(entry.at("transform")));
      objects.name_world(parent);
    });
  }
  const auto count = [&](const YamlEntry& entry, const char* key) { return entry.list(key).size(); };
  if (scene.has("world") && !scene.at("world").empty()) {
    for (const YamlEntry& entry : scene.at("world").list("collision_objects")) {
      errors.attempt([&] {
        ObjectMessage message = object_message_of(entry, text.path, warnings);
        using Operation = ObjectMessage::Operation;
        if (message.operation == Operation::remove) {
          if (message.object.id.empty()) objects.remove_all();
          objects.remove(message.object.id);
          return;
        }
        if (message.operation == Operation::move) return;
        message.object.adopt_frame_of_shape();
        message.object.pose = objects.frame(message.frame, fault_at(entry)) * message.object.pose;
        if (message.operation == Operation::append) {
          objects.append(message.object);
        } else {
          objects.add(std::move(message.object));
        }
      });
    }
    if (scene.at("world").has("octomap")) {
      const YamlEntry octomap = scene.at("world").at("octomap");
      if (octomap.has("octomap") && octomap.at("octomap").has("data") && !octomap.at("octomap").at("data").empty()) {
        warnings.push_back(octomap.at_line("an octomap is not read"));
      }
    }
  }
  errors.raise();
  if (scene.has("robot_state")) {
    for (const YamlEntry& entry : scene.at("robot_state").list("attached_collision_objects")) {
      notes.push_back(
          fmt::format("object '{}' is attached to link '{}'", entry.at("object").word("id"), entry.word("link_name")));
    }
  }
  if (scene.has("allowed_collision_matrix")) {
    const std::size_t names = count(scene.at("allowed_collision_matrix"), "entry_names");
    if (names > 0) notes.push_back(fmt::format("a matrix of allowed collisions of {} links and objects", names));
  }
  if (const std::size_t padded = count(scene, "link_padding") + count(scene, "link_scale"); padded > 0) {
    notes.push_back(fmt::format("{} links have a padding or a scale", padded));
  }
  if (const std::string path = request_beside(text.path); !path.empty()) {
    notes.push_back(fmt::format("start and goal are in the request beside it, {}",
                                std::filesystem::path(path).filename().string()));
  }
}

std::string moveit_robot(const SourceText& text) {
  try {
    return YamlEntry::root(text, "").word("robot_model_name");
  } catch (const Error&) {
    return "";
  }
}

bool is_moveit_scene(const SourceText& text) {
  return has_key(text, "collision_objects") || has_key(text, "fixed_frame_transforms") ||
         (has_key(text, "robot_model_name") && has_key(text, "world"));
}

}  // namespace trellis
