// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace trellis::dsl {

/// A token of a Lua text.
struct Token {
  enum class Kind { name, keyword, number, string, comment, symbol };

  Kind kind = Kind::symbol;
  std::string_view text;    ///< a part of the given text
  std::size_t begin = 0;    ///< its offset
  bool unfinished = false;  ///< a string or comment without an end
};

/// Splits a text into tokens. The text may be invalid: for completions and hints, not for execution.
std::vector<Token> tokens(std::string_view text);

/// Returns the names of the local variables outside of every block.
std::vector<std::string> locals_outside(std::string_view text);

}  // namespace trellis::dsl
