// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <trellis/scene/spatial/kinematic_tree.hpp>
#include <trellis/scene/spatial/manipulator_scene.hpp>
#include <trellis/scene/spatial/world.hpp>

namespace trellis {

/// How a URDF file is read.
struct UrdfOptions {
  std::map<std::string, std::string> packages = {};  ///< folders of the packages that the file names
  bool soft_limits = false;                          ///< joints stay within those of `<safety_controller>` too
  bool leave_out_missing = false;                    ///< links lack the meshes that are not found, by a warning each
};

/// A robot as its URDF file describes it.
struct UrdfFile {
  /// A mesh of a link's collision geometry.
  struct MeshUse {
    std::string uri;   ///< as the file names it
    std::string link;  ///< whose geometry it is
    std::size_t line = 1;
    std::string path = {};  ///< "" where it is not found
  };

  KinematicTree tree;
  std::vector<std::string> warnings;
  std::map<std::string, std::size_t> joint_lines;  ///< in the file, by the joint's name
  /// What is wrong with joints that are locked, by the joint's name, with file and line.
  std::map<std::string, std::string> faults;
  std::vector<MeshUse> meshes;
};

/// Reads the links, joints and collision geometry of a robot from a URDF file. Meshes of `package://NAME/PATH` are in
/// the folder of that package (RosPackages); others beside the file or in one of four folders above it.
///
/// A joint whose limits or leader are faulty is locked, by a warning; so no fault of a joint that does not move refuses
/// the robot. Shapes without an extent are left out, by a warning; shapes without an extent along some axes are 0.1 mm
/// thick there. Elements and attributes that were not read are named by warnings, but for those that planning does not
/// need: visual geometry, materials, masses, transmissions, sensors, dynamics, plug-ins of simulators.
/// \throws Error with file and line for all faults of the file together; missing meshes are listed at once
UrdfFile read_urdf(const std::string& path, const UrdfOptions& options = {});

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
    std::size_t line = 1;
  };
  std::vector<Group> groups;
  std::vector<State> states;
  std::string world_frame;  ///< the parent of the virtual joint; "" without one
  /// Pairs of links that may touch, the lesser one first, ascending: those of `disable_collisions`, and those of links
  /// with `disable_default_collisions` without those of `enable_collisions`, as srdfdom has them.
  std::vector<std::pair<std::size_t, std::size_t>> disabled;
  std::vector<std::pair<std::size_t, std::size_t>> passive;  ///< joints without a motor, each with its line
  std::map<std::string, std::string> faults;                 ///< of groups that were left out, by name, with the line
  std::vector<std::string> warnings;
};

/// Reads the groups, the named states and the disabled pairs of links of a robot from a SRDF file. A faulty group or
/// state, or value of a state, is left out, by a warning, as MoveIt does. Ends of arms, virtual joints and reasons are
/// not needed; other elements that were not read are named by warnings. \throws Error with file and line where the file
/// is no SRDF file
SrdfFile read_srdf(const std::string& path, const KinematicTree& tree);

/// A SRDF file by itself, without the robot whose links and joints it names.
struct SrdfOutline {
  /// A group, or a named state.
  struct Part {
    std::string name;
    std::vector<std::string> of;  ///< "chain base to hand", "joint lift", "group arm"; of a state "lift 0.5"
    std::string group;            ///< of a state
    std::size_t line = 1;
  };
  std::string robot;
  std::vector<Part> groups;
  std::vector<Part> states;
  std::size_t disabled = 0;                ///< elements `disable_collisions`
  std::vector<std::string> default_links;  ///< of `disable_default_collisions`
  std::size_t enabled = 0;                 ///< elements `enable_collisions`
};

/// \throws Error with file and line where the file is no SRDF file
SrdfOutline read_srdf_outline(const std::string& path);

/// What a robot is made of: its files, and the joints that move.
struct ManipulatorFiles {
  std::string urdf;
  std::string srdf;                      ///< "" for none
  std::string group;                     ///< of the SRDF file; "" for none
  std::vector<std::string> joints;       ///< that move, in place of a group; without both all that can move do
  std::map<std::string, double> values;  ///< of joints that do not move, radians or metres; others are at 0 or at the
                                         ///< nearest limit
  std::optional<Joint::Kind> base = {};  ///< planar or floating: the base moves by such a joint, named "base"
  bool self_collision = true;            ///< links must not touch each other
  std::optional<double> cover = {};      ///< how far the balls of links may protrude, in metres; none: as CoverOptions
                                         ///< has it, with more for links that need many balls
  UrdfOptions reading = {};
};

/// Reads a robot from its URDF file, and from its SRDF file if there is one. Joints that cannot plan (Joint::plans)
/// stay where they are, by a warning; named in `joints`, or faulty in the group, they are an error. The robot's named
/// states are those of the SRDF file that give a value for each joint that moves, and those of the base are 0; of
/// states with one name that of the group, else the first of a group of the same joints, else the first. Links that
/// touch in nearly every configuration may touch, by a warning that names them, with a SRDF file and without one. Balls
/// that cover links are kept in the folder of the user's covers.
/// \param warnings  receives those of the files, and how far the balls of links protrude
/// \throws Error with file and line; or with the nearest name where a group or a joint does not exist
SphereModel read_manipulator(const ManipulatorFiles& files, std::vector<std::string>& warnings);

/// A planning problem of MoveIt, as MotionBenchMaker writes it: a scene and a request.
struct MoveitFile {
  /// A goal that inverse kinematics resolves: a point of a link near a place, with or without an orientation.
  struct LinkGoal {
    std::size_t link = 0;
    Vec3 point = {};         ///< of the link, in its frame
    Vec3 position = {};      ///< of the point, in the world
    double near = 0.0;       ///< metres from it
    bool oriented = false;   ///< the link has an orientation
    Quaternion orientation;  ///< of the link, in the world
    double turn = 0.0;       ///< radians from it
    std::string file;        ///< of the constraint
    std::size_t line = 1;
  };
  World3 world;
  SphereModel robot;    ///< with the values, the base, the attached bodies, the padding and the permissions of the file
  Configuration start;  ///< of the robot's moving joints; empty where the file has none
  std::vector<Configuration> goals = {};
  std::vector<LinkGoal> link_goals = {};
  std::vector<std::string> warnings = {};
  std::vector<std::string> notes = {};
};

/// What a caller of the reader leaves out of a scene of MoveIt.
struct MoveitOptions {
  /// What the scene has, changes which configurations are valid, and is left out, by a warning: of
  /// `moveit_ignorable`.
  std::vector<std::string> ignore = {};
  Configuration start = {};  ///< in place of the request's
  bool goal = true;          ///< reads the request's goals
};

/// The parts of a scene that MoveitOptions::ignore may name: "octomap", "path_constraints", ...
const std::vector<std::string>& moveit_ignorable();

/// Reads a scene of MoveIt and the request beside it, in whose name "request" replaces "scene", or "scene" and all up
/// to the digits; without a request the start is that of the scene, if it places all joints, and there is no goal.
/// Reads also the text that RViz exports (.scene). The bounds of the world contain the robot's reach and all objects;
/// they limit nothing. A plane is a box with a face in the plane, on the side where the robot is not; the box covers
/// twice what the robot reaches and the other objects. \throws Error with file and line
MoveitFile read_moveit(const std::string& path, const SphereModel& model, const MoveitOptions& options = {});

}  // namespace trellis
