// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <dsl/language/construct.hpp>
#include <dsl/language/script_place.hpp>
#include <dsl/lua/stack.hpp>

namespace trellis::dsl {

/// Makes the specs and their operators known, a constructor of each planner and guide of the registry, and what is made
/// of whole strategies. The files that their options name are looked for in the script's folder, and lie there unless
/// the script is trusted.
void open_algebra(lua::Stack& stack, const ScriptPlace& place);

/// ablations(strategy).
const Construct& ablations_construct();

/// Planners, guides and strategies, and what the operators make of them.
struct ObjectType;
std::vector<ObjectType> algebra_types();

/// A planner or strategy as a strategy, none for anything else.
std::optional<StrategySpec> as_strategy(lua::Value value);

}  // namespace trellis::dsl
