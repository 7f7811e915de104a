// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include <trellis/scene/spatial/kinematic_tree.hpp>
#include <trellis/scene/spatial/manipulator_scene.hpp>
#include <trellis/scene/spatial/world.hpp>

namespace trellis {

/// A robot as its URDF file describes it.
struct UrdfFile {
  KinematicTree tree;
  std::vector<std::string> warnings;
  std::map<std::string, std::size_t> joint_lines;  ///< in the file, by the joint's name
};

/// Reads the links, joints and collision geometry of a robot from a URDF file. Meshes are read from beside the file: of
/// `package://NAME/PATH` the first of PATH, NAME/PATH that exists in the file's folder or a folder above it.
/// \throws Error with file and line for all faults of the file together; missing meshes are listed at once
UrdfFile read_urdf(const std::string& path);

/// What a SRDF file adds to a robot.
struct SrdfFile {
  struct Group {
    std::string name;
    std::vector<std::size_t> joints;  ///< that have coordinates, ascending
  };
  struct State {
    std::string name;
    std::string group;
    std::vector<std::pair<std::size_t, std::vector<double>>> values;  ///< of joints
  };
  std::vector<Group> groups;
  std::vector<State> states;
  std::vector<std::pair<std::size_t, std::size_t>> disabled;  ///< pairs of links that may touch, the lesser one first
  std::vector<std::string> warnings;
};

/// Reads the groups, the named states and the disabled pairs of links of a robot from a SRDF file.
/// \throws Error with file and line for all faults of the file together
SrdfFile read_srdf(const std::string& path, const KinematicTree& tree);

/// What a robot is made of: its files, and the joints that move.
struct ManipulatorFiles {
  std::string urdf;
  std::string srdf;                      ///< "" for none
  std::string group;                     ///< of the SRDF file; "" for none
  std::vector<std::string> joints;       ///< that move, in place of a group; without both all that can move do
  std::map<std::string, double> values;  ///< of joints that do not move, radians or metres; others are at 0 or at the
                                         ///< nearest limit
  bool mobile = false;                   ///< the base moves in the plane, as a planar joint named "base" says
  bool self_collision = true;            ///< links must not touch each other
};

/// Reads a robot from its URDF file, and from its SRDF file if there is one. Its named states are those of the SRDF
/// file that give a value for each joint that moves, and those of the base are 0. Links that touch in nearly every
/// configuration may touch, by a warning that names them, with a SRDF file and without one.
/// \param warnings  receives those of the files
/// \throws Error with file and line; or with the nearest name where a group or a joint does not exist
SphereModel read_manipulator(const ManipulatorFiles& files, std::vector<std::string>& warnings);

/// A planning problem of MoveIt, as MotionBenchMaker writes it: a scene and a request.
struct MoveitFile {
  World3 world;
  Configuration start;  ///< of the robot's moving joints
  Configuration goal;
  std::vector<std::string> warnings;
};

/// Reads a scene of MoveIt and the request beside it, in whose name "request" replaces "scene", or "scene" and all up
/// to the digits; without a request there are no start and goal. The bounds of the world contain the robot's reach and
/// all objects; they limit nothing. \throws Error with file and line
MoveitFile read_moveit(const std::string& path, const SphereModel& model);

}  // namespace trellis
