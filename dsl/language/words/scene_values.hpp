// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <optional>
#include <variant>

#include <dsl/lua/stack.hpp>
#include <dsl/lua/value.hpp>
#include <trellis/scene/planar/robot.hpp>
#include <trellis/scene/planar/scene.hpp>
#include <trellis/scene/planar/world.hpp>
#include <trellis/scene/spatial/manipulator_scene.hpp>
#include <trellis/scene/spatial/robot.hpp>
#include <trellis/scene/spatial/world.hpp>

// Worlds and robots of the plane and of space as values of the language.

namespace trellis::dsl {

using AnyWorld = std::variant<World, World3>;
using AnyRobot = std::variant<Robot, Robot3, SphereModel>;

/// Returns the world, or the robot, that the value is; none for another value.
std::optional<AnyWorld> world_in(lua::Value value);
std::optional<AnyRobot> robot_in(lua::Value value);

AnyWorld world_of(const Scene& scene);
AnyRobot robot_of(const Scene& scene);
void push_world(lua::Stack& stack, const Scene& scene);
void push_robot(lua::Stack& stack, const Scene& scene);

/// \throws Error where one is of the plane and the other of space
std::shared_ptr<const Scene> make_scene(AnyWorld world, AnyRobot robot);

}  // namespace trellis::dsl
