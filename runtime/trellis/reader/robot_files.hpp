// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include <trellis/scene/spatial/kinematic_tree.hpp>
#include <trellis/scene/spatial/world.hpp>

namespace trellis {

/// A robot as its URDF file describes it.
struct UrdfFile {
  KinematicTree tree;
  std::vector<std::string> warnings;
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

/// A planning problem of MoveIt, as MotionBenchMaker writes it: a scene and a request.
struct MoveitFile {
  World3 world;
  Configuration start;  ///< of the robot's moving joints
  Configuration goal;
  std::string group;    ///< that the request names; "" without one
  std::vector<std::string> warnings;
};

/// Reads a scene of MoveIt and the request beside it, in whose name "request" replaces "scene". The bounds of the world
/// contain the robot's reach and all objects; they limit nothing.
/// \param base  of the robot in the world
/// \throws Error with file and line
MoveitFile read_moveit(const std::string& path, const Manipulator& robot, double reach, const Pose3& base = {});

}  // namespace trellis
