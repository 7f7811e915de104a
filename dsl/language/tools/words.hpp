// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include <dsl/language/core/word.hpp>

// The registry of the language: every name that Trellis provides to scripts, in one form, whether it comes from a
// component of the runtime, a construct, or a function of the standard library. Help, messages, stubs, the reference
// and completions use it.

namespace trellis::dsl {

/// Returns every word, by kind: planners, guides, targets, estimators, constructors, functions, modules. Loads the
/// standard library once per process for its functions; \throws Error if that fails.
const std::vector<Word>& words();

/// Returns the types of values, those of compositions first.
const std::vector<ObjectType>& object_types();

/// Returns the functions of the standard library from the descriptions in its modules; undocumented functions have no
/// summary. Loads every module in a separate interpreter.
std::vector<Construct> module_functions();

/// Returns Lua's own globals that scripts have, and the fields of its libraries as "math.sin"; sorted.
const std::vector<std::string>& lua_names();

}  // namespace trellis::dsl
