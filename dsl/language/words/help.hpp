// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <string>

#include <dsl/language/core/construct.hpp>
#include <dsl/lua/stack.hpp>

namespace trellis::dsl {

/// Registers `help`.
/// \param text_of  the text for the arguments of a call
/// \param print  receives the text; empty: the standard output
void open_help(lua::Stack& stack, std::function<std::string(lua::Stack&)> text_of,
               std::function<void(const std::string&)> print);

/// help(x), help "shrink".
const Construct& help_construct();

}  // namespace trellis::dsl
