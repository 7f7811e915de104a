// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <string>
#include <vector>

#include <dsl/language/construct.hpp>
#include <dsl/language/script_place.hpp>
#include <dsl/lua/stack.hpp>

namespace trellis::dsl {

/// Makes `require` known, for modules of the standard library and then of the script's folder; makes each module of the
/// standard library a global that is loaded when first read; makes reading any other unknown global an error that
/// offers the nearest name. Call it last: what is a global by then is what is offered.
/// \param described  is told of every function that a module of the standard library defines, as it is loaded
void open_modules(lua::Stack& stack, const ScriptPlace& place, std::function<void(const Construct&)> described = {});

/// What Lua has and scripts do not find, sorted.
const std::vector<std::string>& left_out_names();

/// require "NAME".
const Construct& require_construct();

/// The functions of the standard library as its modules describe them; what is not described has no summary. Loads
/// every module in an interpreter of its own.
std::vector<Construct> module_functions();

/// The names in a script that no global has, neither one there is nor one that the script sets anywhere, each as a
/// message with its line. Of what is never run too. Call it once the script has run.
std::vector<std::string> unknown_names(lua::Stack& stack, const std::string& text, const std::string& script);

/// A script's text without the line that tells a shell how to run it, its lines counted as before.
std::string without_shebang(std::string text);

}  // namespace trellis::dsl
