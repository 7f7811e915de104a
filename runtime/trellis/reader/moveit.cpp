// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include <trellis/base/errors.hpp>
#include <trellis/reader/formats.hpp>
#include <trellis/reader/robot_files.hpp>
#include <trellis/reader/yaml_entry.hpp>

namespace trellis {

namespace {

Pose3 pose_of(const YamlEntry& entry) {
  const auto position = entry.at("position").numbers(3, "x, y, z");
  const auto turn = entry.at("orientation").numbers(4, "x, y, z, w");
  const Quaternion q{turn[0], turn[1], turn[2], turn[3]};
  if (!(std::abs(std::sqrt(q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w) - 1.0) < 1e-3)) {
    throw entry.at("orientation").error("the quaternion is not of length 1");
  }
  return {{position[0], position[1], position[2]}, normalised(q)};
}

Shape3 shape_of(const YamlEntry& entry) {
  const YamlEntry type = entry.at("type");
  const YamlEntry sizes = entry.at("dimensions");
  const std::string word = type.word();
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

std::vector<Obstacle3> obstacles_of(const YamlEntry& scene, std::vector<std::string>& warnings) {
  std::vector<Obstacle3> obstacles;
  ErrorList errors;
  if (!scene.has("world") || !scene.at("world").has("collision_objects")) return obstacles;
  for (const YamlEntry& object : scene.at("world").at("collision_objects").list()) {
    errors.attempt([&] {
      const std::string id = object.at("id").word();
      const Pose3 frame = object.has("pose") ? pose_of(object.at("pose")) : Pose3{};
      if (object.has("meshes")) warnings.push_back(fmt::format("the meshes of object '{}' are ignored", id));
      if (!object.has("primitives")) return;
      const auto shapes = object.at("primitives").list();
      const auto poses = object.at("primitive_poses").list();
      if (shapes.size() != poses.size()) {
        throw object.error(fmt::format("object '{}' has {} primitives and {} poses", id, shapes.size(), poses.size()));
      }
      for (std::size_t i = 0; i < shapes.size(); ++i) {
        const Solid solid{shape_of(shapes[i]), frame * pose_of(poses[i])};
        check_solid(solid, fmt::format("object '{}'", id));
        obstacles.push_back({fmt::format("obstacle {} ({})", obstacles.size() + 1, id), solid});
      }
    });
  }
  errors.raise();
  return obstacles;
}

/// The values of joints by name, in the order of the robot's coordinates.
class Values {
 public:
  explicit Values(const Manipulator& robot) : robot_(robot), values_(robot.moving().size()) {}
  void set(const std::string& name, double value) {
    for (std::size_t k = 0; k < robot_.moving().size(); ++k) {
      if (robot_.tree().joints()[robot_.moving()[k]].name == name) values_[k] = value;
    }
  }
  [[nodiscard]] Configuration all(const YamlEntry& entry, const char* what) const {
    Configuration q;
    for (std::size_t k = 0; k < values_.size(); ++k) {
      if (!values_[k]) {
        throw entry.error(
            fmt::format("the {} lacks joint '{}'", what, robot_.tree().joints()[robot_.moving()[k]].name));
      }
      // Files round values at the limits.
      constexpr double rounding = 1e-4;
      const Joint& joint = robot_.tree().joints()[robot_.moving()[k]];
      const bool limited = joint.kind == Joint::Kind::revolute || joint.kind == Joint::Kind::prismatic;
      double value = *values_[k];
      if (limited && value < joint.lo && value > joint.lo - rounding) value = joint.lo;
      if (limited && value > joint.hi && value < joint.hi + rounding) value = joint.hi;
      q.push_back(value);
    }
    return q;
  }

 private:
  const Manipulator& robot_;
  std::vector<std::optional<double>> values_;
};

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

/// Reads the start and the goal.
void read_request(const std::string& path, const Manipulator& robot, MoveitFile& file) {
  const SourceText request_text = SourceText::load(path);
  const YamlEntry request = YamlEntry::root(request_text, "a request of MoveIt as a YAML map");
  Values start(robot);
  const YamlEntry state = request.at("start_state").at("joint_state");
  const auto names = state.at("name").list();
  const auto positions = state.at("position").list();
  if (names.size() != positions.size()) throw state.error("'name' and 'position' differ in length");
  for (std::size_t i = 0; i < names.size(); ++i) start.set(names[i].word(), positions[i].number());
  file.start = start.all(state, "start");
  Values goal(robot);
  const auto goals = request.at("goal_constraints").list();
  if (goals.empty()) throw request.error("the request has no goal");
  if (goals.size() > 1) file.warnings.emplace_back("the first of several goals is read");
  for (const YamlEntry& one : goals.front().at("joint_constraints").list()) {
    goal.set(one.at("joint_name").word(), one.at("position").number());
  }
  file.goal = goal.all(goals.front(), "goal");
}

}  // namespace

bool is_moveit_scene(const SourceText& text) {
  const std::string all = text.joined();
  return all.find("collision_objects:") != std::string::npos && all.find("robot_state:") != std::string::npos;
}

SceneFile read_moveit_scene(const SourceText& text, const ReadOptions& options) {
  const std::string& path = text.path;
  if (!options.manipulator) {
    throw Error(
        fmt::format("{}: a scene of MoveIt names its robot and does not contain it: give "
                    "robot = robot.urdf(\"FILE.urdf\", {{ srdf = \"FILE.srdf\", group = \"GROUP\" }})",
                    path));
  }
  const SphereModel& robot = *options.manipulator;
  MoveitFile moveit = read_moveit(path, robot);
  SceneFile file{"planning scene of MoveIt", "1 = 1 m", "the frame of the scene: z up", {}};
  Problem problem;
  problem.name = std::filesystem::path(path).stem().string();
  problem.scene = std::make_shared<const ManipulatorScene>(std::move(moveit.world), robot);
  problem.space = problem.scene->default_space(options.weight == 0.0 ? 1.0 : options.weight);
  problem.start = std::move(moveit.start);
  if (!moveit.goal.empty()) problem.goals = {std::move(moveit.goal)};
  problem.resolution = options.resolution;
  problem.collision = "spheres";
  file.problems.push_back(std::move(problem));
  file.warnings = std::move(moveit.warnings);
  return file;
}

MoveitFile read_moveit(const std::string& path, const SphereModel& model) {
  const Manipulator& robot = model.robot();
  const double reach = model.bounding_radius();
  const Pose3& base = model.base();
  MoveitFile file;
  const SourceText scene_text = SourceText::load(path);
  const YamlEntry scene = YamlEntry::root(scene_text, "a scene of MoveIt as a YAML map");
  std::vector<Obstacle3> obstacles = obstacles_of(scene, file.warnings);
  if (scene.has("robot_state") && scene.at("robot_state").has("attached_collision_objects") &&
      !scene.at("robot_state").at("attached_collision_objects").list().empty()) {
    file.warnings.emplace_back(
        "objects attached to the robot are ignored; robot:attach(shape, { link = ... }) adds them");
  }

  if (const std::string request = request_beside(path); !request.empty()) read_request(request, robot, file);

  Vec3 lo = base.position - Vec3{reach, reach, reach};
  Vec3 hi = base.position + Vec3{reach, reach, reach};
  for (const Obstacle3& obstacle : obstacles) {
    const Box3 box = bounding_box(obstacle.solid);
    lo = {std::min(lo.x, box.lo.x), std::min(lo.y, box.lo.y), std::min(lo.z, box.lo.z)};
    hi = {std::max(hi.x, box.hi.x), std::max(hi.y, box.hi.y), std::max(hi.z, box.hi.z)};
  }
  file.world = World3({lo, hi}, std::move(obstacles), Contain::none);
  return file;
}

}  // namespace trellis
