// SPDX-License-Identifier: GPL-3.0-or-later
// Problems of planning scenes of MoveIt.
#include <trellis/reader/moveit_scene.hpp>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <utility>

#include <trellis/base/errors.hpp>
#include <trellis/instance/resolve_goal.hpp>
#include <trellis/scene/spatial/scene.hpp>

namespace trellis {

namespace {

MoveitFile read_text(const SourceText& text, const SphereModel& robot, const MoveitOptions& options) {
  if (!is_moveit_text(text)) return read_moveit_yaml(text, robot, options);
  MoveitObjects objects(&robot, options.start);
  std::vector<std::string> warnings;
  read_moveit_text(text, objects, warnings);
  MoveitFile file{.world = moveit_world(objects, &robot, text.path), .robot = robot, .start = {}};
  file.warnings = std::move(warnings);
  return file;
}

void check_ignored(const std::string& path, const std::vector<std::string>& ignore) {
  const std::vector<std::string>& known = moveit_ignorable();
  for (const std::string& part : ignore) {
    if (std::find(known.begin(), known.end(), part) != known.end()) continue;
    throw Error(fmt::format("{}: 'ignore' names '{}', which it cannot leave out{}; it can: {}", path, part,
                            did_you_mean(part, known), fmt::join(known, ", ")));
  }
}

/// Describes a scene without its robot.
SceneFile described(const SourceText& text, const ReadOptions& options) {
  SceneFile file{"planning scene of MoveIt", "1 = 1 m", "the frame of the scene: z up", {}};
  MoveitObjects objects(nullptr, {});
  objects.name_world("world");
  const bool plain = is_moveit_text(text);
  if (plain) {
    read_moveit_text(text, objects, file.warnings);
  } else {
    describe_moveit_yaml(text, objects, file.notes, file.warnings);
  }
  const std::string name = plain ? "" : moveit_robot(text);
  file.robot = fmt::format("{}not in the file", name.empty() ? "" : name + ", ");
  if (!objects.unknown_frames().empty()) {
    file.notes.push_back(
        fmt::format("frames of the robot, drawn at the origin: {}", fmt::join(objects.unknown_frames(), ", ")));
  }
  file.notes.push_back(fmt::format(
      "scenes.load(\"{}\", {{ robot = robot.urdf(\"FILE.urdf\", {{ srdf = \"FILE.srdf\", group = \"GROUP\" }}){} }}) "
      "plans in it",
      std::filesystem::path(text.path).filename().string(), plain ? ", start = {...}, goal = {...}" : ""));
  Problem problem;
  problem.name = stem_of(text.path);
  problem.scene = std::make_shared<const SpatialScene>(moveit_world(objects, nullptr, text.path), Robot3::point());
  problem.space = problem.scene->default_space(1.0);
  problem.resolution = options.resolution;
  problem.collision = "fcl";
  file.problems.push_back(std::move(problem));
  return file;
}

/// Adds the goals that inverse kinematics finds.
void resolve_goals(const std::vector<MoveitFile::LinkGoal>& goals, Problem& problem) {
  for (const MoveitFile::LinkGoal& goal : goals) {
    const auto solve = [&] {
      if (!goal.oriented) return configurations_near(problem, goal.link, goal.point, goal.position, goal.near);
      const Pose3 pose{goal.position - goal.orientation(goal.point), goal.orientation};
      // A turn moves a point beside the link's origin: half of the tolerance is for the turn.
      const double lever = norm(goal.point);
      const double turn = lever > 0.0 ? std::min(goal.turn, 0.5 * goal.near / lever) : goal.turn;
      return configurations_at(problem, goal.link, pose, lever > 0.0 ? 0.5 * goal.near : goal.near, turn);
    };
    try {
      for (Configuration& q : solve()) problem.goals.push_back(std::move(q));
    } catch (const Error& error) {
      throw Error(fmt::format("{}:{}: {}", goal.file, goal.line, error.what()));
    }
  }
}

}  // namespace

World3 moveit_world(const MoveitObjects& objects, const SphereModel* robot, const std::string& path) {
  try {
    return objects.world(robot);
  } catch (const Error& error) {
    throw Error(fmt::format("{}: {}", path, error.what()));
  }
}

MoveitFile read_moveit(const std::string& path, const SphereModel& model, const MoveitOptions& options) {
  check_ignored(path, options.ignore);
  return read_text(SourceText::load(path), model, options);
}

SceneFile read_moveit_scene(const SourceText& text, const ReadOptions& options) {
  if (!options.manipulator && options.describe) return described(text, options);
  if (!options.manipulator) {
    throw Error(
        fmt::format("{}: a scene of MoveIt names its robot and does not contain it: give "
                    "robot = robot.urdf(\"FILE.urdf\", {{ srdf = \"FILE.srdf\", group = \"GROUP\" }})",
                    text.path));
  }
  check_ignored(text.path, options.ignore);
  const MoveitOptions given{
      .ignore = options.ignore,
      .start = options.start.size() == options.manipulator->robot().dimension() ? options.start : Configuration{},
      .goal = options.goal.empty() && !options.goal_pose};
  MoveitFile moveit = read_text(text, *options.manipulator, given);
  SceneFile file{"planning scene of MoveIt", "1 = 1 m", "the frame of the scene: z up", {}};
  Problem problem;
  problem.name = stem_of(text.path);
  problem.scene = std::make_shared<const ManipulatorScene>(std::move(moveit.world), std::move(moveit.robot));
  problem.space = problem.scene->default_space(options.weight == 0.0 ? 1.0 : options.weight);
  problem.start = std::move(moveit.start);
  problem.goals = std::move(moveit.goals);
  problem.resolution = options.resolution;
  problem.collision = "spheres";
  resolve_goals(moveit.link_goals, problem);
  file.problems.push_back(std::move(problem));
  file.warnings = std::move(moveit.warnings);
  return file;
}

}  // namespace trellis
