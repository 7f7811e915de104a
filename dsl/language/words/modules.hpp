// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <dsl/language/core/construct.hpp>
#include <dsl/language/core/script_place.hpp>
#include <dsl/language/words/functions.hpp>
#include <dsl/lua/mistakes.hpp>
#include <dsl/lua/stack.hpp>

namespace trellis::dsl {

/// Registers `require`, for modules of the standard library and then of the script's folder. Makes each module of the
/// standard library a global that loads on the first access. Makes reading an unknown global an error that suggests the
/// nearest name. Call it last: the suggestions are the globals at that time.
/// \param warnings  receives what scenes.load finds in files
void open_modules(lua::Stack& stack, const ScriptPlace& place, std::shared_ptr<std::vector<std::string>> warnings,
                  Definitions definitions);

/// Returns the names of Lua's library that scripts do not have, sorted.
const std::vector<std::string>& left_out_names();

/// require "NAME".
const Construct& require_construct();

/// Returns a mistake for each name in a script that is no global: neither present nor set anywhere in the
/// script. Includes code that never runs. Call it after the script has run.
std::vector<lua::Mistake> unknown_names(lua::Stack& stack, const std::string& text, const std::string& script);

/// Returns a script's text without its shebang line; line numbers stay the same.
std::string without_shebang(std::string text);

}  // namespace trellis::dsl
