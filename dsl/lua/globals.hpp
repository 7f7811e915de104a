// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <dsl/lua/stack.hpp>

namespace trellis::lua {

/// A position in a text that reads or sets a global by its name.
struct GlobalUse {
  std::string name;
  int line = 0;
  bool set = false;  ///< else it is read
};

/// Returns the uses of globals in a Lua text, also in functions that are never called, in the order of the functions.
/// Omits names beyond the first 255 constants of a function. \throws Located for a syntax error.
std::vector<GlobalUse> global_uses(Stack& stack, std::string_view text, const std::string& chunk);

}  // namespace trellis::lua
