// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <dsl/lua/stack.hpp>

namespace trellis::lua {

/// A place in a text where a global is read or set by its name.
struct GlobalUse {
  std::string name;
  int line = 0;
  bool set = false;  ///< not read
};

/// The uses of globals in a text in Lua, in functions that may never be called too, in order of their functions. Throws
/// Located for a syntax error. Names beyond the first 255 constants of a function are left out.
std::vector<GlobalUse> global_uses(Stack& stack, std::string_view text, const std::string& chunk);

}  // namespace trellis::lua
