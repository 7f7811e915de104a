// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <lua.hpp>

#include <dsl/lua/state.hpp>

namespace trellis::lua {

/// The border between C++ and Lua, for the sources of this folder only.
struct Guard {
  /// Runs `body`; turns what it throws into a Lua error. Lua's own exceptions pass through untouched.
  static int run(lua_State* state, const Callback& body);
  /// Turns the error value on top into the message that State::run throws.
  static int explain(lua_State* state);
  /// Counts work that is no instruction of Lua's: one is a few nanoseconds. Ends the script where that is too much.
  static void spend(lua_State* state, std::uint64_t instructions) { State::of(state).spend(state, instructions); }
  /// Goes on ending the script where it is being ended. For whatever has caught an error on a script's behalf.
  static void pass_on(lua_State* state);
  [[nodiscard]] static bool ended(lua_State* state) { return State::of(state).work_.ended; }
  [[nodiscard]] static std::size_t longest_string(lua_State* state) { return State::of(state).budget_.longest_string; }
};

}  // namespace trellis::lua
