// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <trellis/scene/planar/robot.hpp>
#include <trellis/scene/scene.hpp>
#include <trellis/space/rotation.hpp>

namespace trellis {

class SphereModel;

/// The program whose rules decide which pixels of a map of ROS are free.
enum class MapServer : unsigned char {
  nav2,  ///< luma; pixels that are not opaque are unknown; a pixel at a threshold is free or occupied
  ros1   ///< the mean of the channels, in the mode trinary with alpha as one of them; a pixel at a threshold is unknown
};

/// What replaces or completes the content of a scene file.
struct ReadOptions {
  double weight = 0.0;               ///< metres per radian of angular axes; 0: the default, 1/pi
  double resolution = 0.05;          ///< see Problem
  std::string collision = "planar";  ///< see Problem
  bool motion = true;            ///< problems have the motion models that the files name, where there is such a model
  double goal_tolerance = 0.25;  ///< of problems with a motion model: their files do not give one
  std::optional<Robot> robot = {};  ///< moves in a world whose file has no robot; none: the format's default
  std::shared_ptr<const SphereModel> manipulator = {};  ///< the robot of a scene of MoveIt
  Configuration start = {};                ///< replaces the start of the file's one problem; empty: as in the file
  Configuration goal = {};                 ///< replaces its goal
  MapServer map_server = MapServer::nav2;  ///< of maps of ROS
  std::size_t agents = 0;  ///< the first so many queries of Moving AI are one problem of a team; 0: each is a problem
  double agent_radius = 0.3;             ///< of the team's discs, metres, unless there is a `robot`
  std::optional<Pose3> start_pose = {};  ///< in place of `start`, of a body in space
  std::optional<Pose3> goal_pose = {};   ///< in place of `goal`, of a body in space
  std::vector<std::string> ignore = {};  ///< parts of a scene of MoveIt that are left out: "octomap", ...
  bool describe = false;                 ///< the file's content is shown: a scene of MoveIt is read without its robot
};

/// What a scene file of another project contains.
struct SceneFile {
  std::string format;             ///< "Moving AI grid map"
  std::string units;              ///< how its numbers become metres: "1 cell = 1 m"
  std::string frame;              ///< where the origin is, and where the axes lead
  std::vector<Problem> problems;  ///< at least one; start and goal are empty where neither file nor options have them
  std::vector<double> lengths = {};        ///< of the problems' shortest paths or reference paths, metres; or empty
  std::vector<std::string> warnings = {};  ///< what the file contains and the problems do not
  std::vector<std::string> notes = {};     ///< by which of several rules the file was read
  std::string robot = {};                  ///< the robot, where the file names it and does not contain it
};

/// Reads a scene file of another project. Its content selects the reader:
///  - `type octile`: a grid map of Moving AI (.map); `version 1`: its queries (.scen), with the map in their folder
///  - `world,x,y,radius`: the cylinder fields of BARN (obstacles.csv), with reference_path.csv in their folder
///  - SVG: the convex hull of each path is an obstacle; 1 mm of the drawing is 1 m
///  - YAML with `image` and `resolution`: a map of ROS, with its image (PNG or PGM), turned by the yaw of its origin
///  - PNG and PGM: pixels of 0.05 m; dark pixels and pixels that are not opaque are obstacles. The robot is a point
///    that moves from the lower left corner to the upper right one.
///  - the circle world of ompl_tests (two header lines, then "index x y r"). Its queries are in the file of the same
///    folder in whose name "queries" replaces "obstacles".
///  - .env or .query: an environment of PPL with its queries; XML with the root `rlplan`: a plan of the Robotics
///  Library;
///    a section [problem]: a configuration of OMPL.app. Their robots are rigid bodies in space, see docs/meshes.md.
///  - a planar arm of SBPL on a grid. Its goal is a cell for the end of the last link: `reach` is set and `goal` is
///    empty, see resolve_goal.
///  - YAML with `collision_objects`: a planning scene of MoveIt, with the request beside it, as MotionBenchMaker writes
///    them; or the text that RViz exports (.scene); the robot is `manipulator`.
///  - YAML with `robots` and `problem`: a scenario of FibrationTrees, of a team of discs.
///  - dynobench YAML (boxes). The models are in ../shared/models beside the scene's folder.
/// \param path  of the file; the other files of its format are sought as listed above
/// \param options  what the file does not state, and what replaces its content
/// \throws Error with file and line for malformed or missing content, for a file of another format, and for options
///     that are out of range or that the format does not take
SceneFile read_scene(const std::string& path, const ReadOptions& options);

/// Returns the problems of a scene file, as `read_scene` reads them.
/// \param path  as of read_scene
/// \param options  as of read_scene
/// \param warnings  receives those of the file, unless it is nullptr
/// \return at least one
/// \throws Error as read_scene, and where a problem has no start or no goal
std::vector<Problem> read_problems(const std::string& path, const ReadOptions& options,
                                   std::vector<std::string>* warnings = nullptr);

/// Reads a robot's outline from an SVG of one path: its convex hull, about the middle of its bounding box.
/// \param path  of the drawing, in which 1 mm is 1 m
/// \throws Error with file and line for malformed or missing content
Robot read_robot(const std::string& path);

}  // namespace trellis
