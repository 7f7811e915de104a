// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <dsl/language/core/construct.hpp>
#include <dsl/language/core/script_place.hpp>
#include <dsl/lua/stack.hpp>

namespace trellis::dsl {

/// Registers the specs and their operators, and a constructor for each planner and guide of the
/// registry. Files in their options are relative to the script's folder, and must lie there unless the
/// script is trusted.
/// \param warnings  receives what an operator leaves out, with its line
void open_algebra(lua::Stack& stack, const ScriptPlace& place,
                  const std::shared_ptr<std::vector<std::string>>& warnings);

/// Planners, guides and strategies, and the results of their operators.
struct ObjectType;
std::vector<ObjectType> algebra_types();

}  // namespace trellis::dsl
