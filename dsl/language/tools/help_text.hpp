// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <string>

#include <dsl/language/tools/vocabulary.hpp>
#include <dsl/lua/stack.hpp>

namespace trellis::dsl {

/// Returns the help on a word or a value, in lines of a width. \throws Error for an unknown one.
std::string help_text_of(lua::Stack& call, lua::Value value, std::size_t width = help_width);

/// The text of `help` for the arguments of a call: on the first one, or the vocabulary without one.
std::string help_of(lua::Stack& call);

}  // namespace trellis::dsl
