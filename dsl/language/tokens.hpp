// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace trellis::dsl {

/// A piece of a text in Lua.
struct Token {
  enum class Kind { name, keyword, number, string, comment, symbol };

  Kind kind = Kind::symbol;
  std::string_view text;    ///< of the text that was given
  std::size_t begin = 0;    ///< in it
  bool unfinished = false;  ///< a string or comment that the text does not end
};

/// The pieces of a text, which need not be right: for completions and hints, not for running it.
std::vector<Token> tokens(std::string_view text);

/// The names that a text declares local outside of every block.
std::vector<std::string> locals_outside(std::string_view text);

}  // namespace trellis::dsl
