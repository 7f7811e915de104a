// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <string>

#include <dsl/language/construct.hpp>
#include <dsl/lua/stack.hpp>

namespace trellis::dsl {

/// Makes `help` known. \param print  receives its text; the standard output where it is empty
void open_help(lua::Stack& stack, std::function<void(const std::string&)> print);

/// What help tells about a word or a value. Throws Error where nothing is known about it.
std::string help_text_of(lua::Stack& stack, lua::Value value);

/// help(x), help "shrink".
const Construct& help_construct();

}  // namespace trellis::dsl
