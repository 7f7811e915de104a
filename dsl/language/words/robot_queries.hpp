// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <string>
#include <vector>

#include <dsl/language/core/construct.hpp>
#include <dsl/lua/stack.hpp>
#include <trellis/scene/scene.hpp>
#include <trellis/scene/spatial/manipulator_scene.hpp>

// What a script asks of a robot without a problem: robot:valid(q, world), robot:ik { ... }, robot:joints().

namespace trellis::dsl {

/// The worlds that a script's robots were asked about last, with their collision checkers. Of one interpreter.
class RobotChecks;
std::shared_ptr<RobotChecks> make_robot_checks();

/// Pushes robot:valid(q, world), which returns whether the configuration is valid, and why not.
void push_valid(lua::Stack& stack, const std::shared_ptr<RobotChecks>& checks);
/// The member `valid` of a robot. \param type  of the robot: "trellis.Robot"
Field valid_member_of(const std::string& type);

/// Pushes robot:ik { ... }, which returns configurations of a robot of a URDF file, and why there are none.
void push_ik(lua::Stack& stack);
const Construct& ik_construct();

/// A coordinate of a robot of a URDF file.
struct JointInfo {
  std::string name;
  std::string kind;  ///< of its joint, as URDF calls it
  bool limited = true;
  double lower = 0.0;
  double upper = 0.0;
  double velocity = 0.0;  ///< a second; 0: the file states none
};
/// Returns the robot's coordinates, in order. A base that moves has its three, without limits.
std::vector<JointInfo> joint_infos(const SphereModel& robot);
/// Pushes a list of the names of a robot's coordinates that is a function too: robot:joints() returns their limits.
void push_joints(lua::Stack& stack, const SphereModel& robot);

/// Returns a problem without start and goal: the robot of a problem in its world, or in no world.
/// \param world  none: of robots with a fixed base alone
/// \throws Error where the robot's coordinates have no bounds without a world
Problem problem_of(lua::Value robot, lua::Value world, const std::string& what);

}  // namespace trellis::dsl
