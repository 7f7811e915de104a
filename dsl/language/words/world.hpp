// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include <dsl/language/core/construct.hpp>
#include <dsl/lua/stack.hpp>
#include <trellis/base/error.hpp>
#include <trellis/scene/scene.hpp>

namespace trellis::dsl {

/// Registers box, disc, polygon, world and the robots.
void open_world(lua::Stack& stack);

/// The constructs of this file, for help.
std::vector<const Construct*> world_constructs();

/// Returns the error for a key that is no member of a value. \param what  the value: "a shape"
Error no_member(lua::Value key, const std::vector<Field>& members, const char* what);

/// Returns the name that the script gave an obstacle, or what the obstacle is: "left wall", "box 4 0 6 4.75".
std::string obstacle_name(const Scene& scene, std::size_t obstacle);
/// Pushes an obstacle as a shape.
/// \throws Error for a number that the scene does not have
void push_obstacle(lua::Stack& stack, const Scene& scene, std::size_t obstacle);

/// Shapes, worlds and robots, and their readable members.
struct ObjectType;
std::vector<ObjectType> world_types();

}  // namespace trellis::dsl
