// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <string>

#include <dsl/language/construct.hpp>
#include <dsl/language/vocabulary.hpp>
#include <dsl/lua/stack.hpp>

namespace trellis::dsl {

/// Registers `help`. \param print  receives its text; empty: the standard output
void open_help(lua::Stack& stack, std::function<void(const std::string&)> print);

/// Returns the help on a word or a value, in lines of a width. \throws Error for an unknown one.
std::string help_text_of(lua::Stack& call, lua::Value value, std::size_t width = help_width);

/// help(x), help "shrink".
const Construct& help_construct();

}  // namespace trellis::dsl
