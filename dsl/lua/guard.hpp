// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <lua.hpp>

#include <dsl/lua/state.hpp>

namespace trellis::lua {

/// The boundary between C++ and Lua, for the sources of this folder only.
struct Guard {
  /// Runs `body`; converts its exceptions to Lua errors. Lua's own exceptions pass through unchanged.
  static int run(lua_State* state, const Callback& body);
  /// Converts the error value on top to the message that State::run throws.
  static int explain(lua_State* state);
  /// Counts work outside of Lua instructions: one unit is a few nanoseconds. Ends the script at its limit.
  static void spend(lua_State* state, std::uint64_t instructions) { State::of(state).spend(state, instructions); }
  /// Continues to end the script if it is being ended. Call it after catching an error in place of the script.
  static void pass_on(lua_State* state);
  /// A function that catches errors begins and ends: within it callbacks raise them (State::run, `mistakes`).
  static void begin_catching(lua_State* state) { ++State::of(state).work_.catching; }
  static void end_catching(lua_State* state) {
    if (State::of(state).work_.catching > 0) --State::of(state).work_.catching;
  }
  /// The coroutines whose variables are being closed, one within the other.
  static unsigned& closing(lua_State* state) { return State::of(state).closing_; }
  /// Removes a recorded mistake, which the script has dealt with.
  static void withdraw(lua_State* state, const Mistake& mistake);
  /// Pushes the value that a call with a mistake returns.
  static void push_failed_value(lua_State* state);
  [[nodiscard]] static bool ended(lua_State* state) { return State::of(state).work_.ended; }
  [[nodiscard]] static std::size_t longest_string(lua_State* state) { return State::of(state).budget_.longest_string; }
};

}  // namespace trellis::lua
