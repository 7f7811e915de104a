// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include <dsl/language/construct.hpp>
#include <dsl/lua/stack.hpp>

namespace trellis::dsl {

/// Registers box, disc, polygon, world and the robots.
void open_world(lua::Stack& stack);

/// The constructs of this file, for help.
std::vector<const Construct*> world_constructs();

/// Shapes, worlds and robots, and their readable members.
struct ObjectType;
std::vector<ObjectType> world_types();

}  // namespace trellis::dsl
