// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/reader/readers.hpp>

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <numbers>

#include <trellis/reader/formats.hpp>
#include <trellis/reader/mesh_file.hpp>
#include <trellis/reader/raster_image.hpp>
#include <trellis/reader/spatial_formats.hpp>
#include <trellis/reader/unread.hpp>

namespace trellis {

namespace {

struct Format {
  bool (*is)(const SourceText&);
  SceneFile (*read)(const SourceText&, const ReadOptions&);
  bool has_robot;
};

/// In the order in which a file is tried; the last one explains what it expected.
constexpr std::array<Format, 14> formats = {{{is_moving_ai_map, read_moving_ai_map, false},
                                             {is_moving_ai_queries, read_moving_ai_queries, false},
                                             {is_barn, read_barn, false},
                                             {is_rl_plan, read_rl_plan, true},
                                             {is_svg, read_svg, false},
                                             {is_circle_world, read_circle_world, false},
                                             {is_ppl, read_ppl, true},
                                             {is_ompl_app, read_ompl_app, true},
                                             {is_sbpl_arm, read_sbpl_arm, true},
                                             {is_ros_map, read_ros_map, false},
                                             {is_moveit_scene, read_moveit_scene, true},
                                             {is_moveit_text, read_moveit_scene, true},
                                             {is_fibration_trees, read_fibration_trees, true},
                                             {[](const SourceText& text) {
                                                static_cast<void>(text);
                                                return true;
                                              },
                                              read_dynobench, true}}};

void check_options(const std::string& path, const ReadOptions& options) {
  if (!std::isfinite(options.weight) || options.weight < 0.0) {
    throw Error(
        fmt::format("reading {}: weight must be greater than 0 (or 0 for the default), got {}", path, options.weight));
  }
  if (!std::isfinite(options.resolution) || options.resolution <= 0.0) {
    throw Error(fmt::format("reading {}: resolution must be greater than 0, got {}", path, options.resolution));
  }
  if (!std::isfinite(options.goal_tolerance) || options.goal_tolerance <= 0.0) {
    throw Error(fmt::format("reading {}: goal_tolerance must be greater than 0, got {}", path, options.goal_tolerance));
  }
}

/// Refuses a file of a format that Trellis recognises and does not read, by a sentence that says what it is.
void refuse(const std::string& path, const std::string& sentence) {
  if (!sentence.empty()) throw Error(fmt::format("{}:1: no scene that can be read: {}", path, sentence));
}

SceneFile read_format(const std::string& path, const ReadOptions& options) {
  if (is_raster_image(path)) return read_image(path, options);
  refuse(path, unread_bytes(first_bytes(path)));
  if (has_mesh_ending(path)) refuse(path, "it is a mesh; world { bounds = ..., mesh \"FILE\" } places it in a world");
  const SourceText text = SourceText::load(path);
  if (!path.ends_with(".svg")) refuse(path, unread_xml(text));  // the reader of drawings says it of its own
  for (const Format& format : formats) {
    if (!format.is(text)) continue;
    if (format.read == read_dynobench && !is_dynobench(text)) refuse(path, unread_text(text));
    if (options.manipulator && format.read != read_moveit_scene) {
      throw Error(fmt::format("{}: a robot of a URDF file moves in scenes of MoveIt, and this is none", path));
    }
    if (!options.ignore.empty() && format.read != read_moveit_scene) {
      throw Error(fmt::format("{}: 'ignore' leaves parts of a scene of MoveIt out, and this is none", path));
    }
    if (format.read == read_moveit_scene && options.robot) {
      throw Error(fmt::format("{}: in a scene of MoveIt a robot of a URDF file moves: robot = robot.urdf(...)", path));
    }
    if (format.has_robot && options.robot) {
      throw Error(fmt::format("{}: the file has a robot of its own; leave out 'robot'", path));
    }
    return format.read(text, options);
  }
  throw Fault("no format reads the rest");
}

/// Returns an end that the caller gives as a pose, as a configuration of a body in space.
Configuration configuration_of(const std::string& path, const char* what, const Pose3& pose, const Problem& problem) {
  const auto& [x, y, z] = pose.position;
  const Quaternion& turn = pose.orientation;
  if (problem.scene->planar() != nullptr) {
    throw Error(
        fmt::format("{}: the {} is a pose, which places a body in space, and the file's world is the plane: give a "
                    "list of {} numbers ({})",
                    path, what, problem.space.dimension(), problem.space.name()));
  }
  if (!problem.space.flat()) return {x, y, z, turn.x, turn.y, turn.z, turn.w};
  if (turn == Quaternion{}) return {x, y, z};
  throw Error(fmt::format("{}: the {} is a pose with an orientation, and the robot does not turn ({}): leave it out",
                          path, what, problem.space.name()));
}

/// Puts the ends that the caller gives into the file's one problem.
void place_ends(const std::string& path, ReadOptions options, SceneFile& file) {
  const Problem& first = file.problems.front();
  if (options.start_pose) options.start = configuration_of(path, "start", *options.start_pose, first);
  if (options.goal_pose) options.goal = configuration_of(path, "goal", *options.goal_pose, first);
  const auto place = [&](const char* what, const Configuration& given, Configuration& end) {
    if (given.empty()) return;
    if (file.problems.size() > 1) {
      throw Error(fmt::format("{}: the file has {} problems with a {} each; leave out '{}'", path, file.problems.size(),
                              what, what));
    }
    const std::size_t dimension = file.problems.front().space.dimension();
    if (given.size() != dimension) {
      throw Error(fmt::format("{}: the {} has {} coordinates, expected {}", path, what, given.size(), dimension));
    }
    end = given;
  };
  Problem& problem = file.problems.front();
  place("start", options.start, problem.start);
  Configuration goal;
  place("goal", options.goal, goal);
  if (!goal.empty()) problem.goals = {std::move(goal)};
  if (!options.goal.empty()) problem.reach.reset();
  if (!options.start.empty() || !options.goal.empty()) file.lengths.clear();
}

}  // namespace

Problem problem_in(std::string name, std::shared_ptr<const Scene> scene, const ReadOptions& options) {
  Problem problem;
  problem.name = std::move(name);
  problem.space = scene->default_space(options.weight == 0.0 ? 1.0 / std::numbers::pi : options.weight);
  problem.scene = std::move(scene);
  problem.resolution = options.resolution;
  problem.collision = options.collision;
  return problem;
}

SceneFile read_scene(const std::string& path, const ReadOptions& options) {
  check_options(path, options);
  require_readable(path);
  SceneFile file = read_format(path, options);
  if (options.agents > 0 && file.format != "Moving AI queries") {
    throw Error(fmt::format("{}: it is a file of the format {}; agents are in queries of Moving AI (.scen)", path,
                            file.format));
  }
  place_ends(path, options, file);
  return file;
}

std::vector<Problem> read_problems(const std::string& path, const ReadOptions& options,
                                   std::vector<std::string>* warnings) {
  SceneFile file = read_scene(path, options);
  if (warnings != nullptr) *warnings = std::move(file.warnings);
  for (const Problem& problem : file.problems) {
    const bool no_start = problem.start.empty();
    const bool no_goal = problem.goals.empty() && !problem.reach;
    if (!no_start && !no_goal) continue;
    throw Error(fmt::format("{}: {} has no {}: give {}", path,
                            file.problems.size() > 1 ? "problem '" + problem.name + "'" : "the file",
                            no_start && no_goal ? "start and no goal"
                            : no_start          ? "start"
                                                : "goal",
                            no_start && no_goal ? "start = {...} and goal = {...}"
                            : no_start          ? "start = {...}"
                                                : "goal = {...}"));
  }
  return std::move(file.problems);
}

}  // namespace trellis
