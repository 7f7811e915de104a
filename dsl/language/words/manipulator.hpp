// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <string>
#include <vector>

#include <dsl/language/core/construct.hpp>
#include <dsl/language/core/script_place.hpp>
#include <dsl/lua/stack.hpp>
#include <trellis/space/rotation.hpp>

// Robots of URDF files as values of the language.

namespace trellis::dsl {

struct ObjectType;

/// A goal: a link at a pose of the world. `problem` turns it into configurations.
struct LinkGoal {
  std::string link;
  Pose3 pose;
  double near = 1e-3;  ///< metres
  double turn = 1e-2;  ///< radians
  std::string hint;    ///< what is probably a mistake in the pose, after a failure's message; "" for nothing
};

/// \throws Error for a table that has other fields than the construct, or lacks a required one
void check_fields(const Construct& construct, lua::Value table);

/// The fields of a pose that a link is to have: link, pose and within.
std::vector<Field> target_fields();

/// Registers `reach`, and adds `urdf` to the table of robots, which open_world made.
/// \param place  of the script, whose files it reads
/// \param warnings  receives those about the files
void open_manipulator(lua::Stack& stack, const ScriptPlace& place,
                      const std::shared_ptr<std::vector<std::string>>& warnings);

/// The constructs of this file, for help.
std::vector<const Construct*> manipulator_constructs();
/// Robots of URDF files and their readable members.
std::vector<ObjectType> manipulator_types();

}  // namespace trellis::dsl

namespace trellis::lua {

template <>
struct TypeName<dsl::LinkGoal> {
  static constexpr const char* value = "goal of a link";
};

}  // namespace trellis::lua
