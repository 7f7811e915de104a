// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <lua.hpp>

#include <dsl/lua/state.hpp>

namespace trellis::lua {

/// The border between C++ and Lua, for the sources of this folder only.
struct Guard {
  /// Runs `body`; turns what it throws into a Lua error. Lua's own exceptions pass through untouched.
  static int run(lua_State* state, const Callback& body);
  /// Turns the error value on top into the message that State::run throws.
  static int explain(lua_State* state);
};

}  // namespace trellis::lua
