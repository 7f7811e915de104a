// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <lua.hpp>

namespace trellis::lua {

// New implementations of functions of Lua's library that observe the limits: none runs without a bound, and none
// prevents the end of a script. Each replaces the function of its name in the table on top of the stack. For the
// sources of this folder only.

/// pcall, xpcall, load, next, pairs, setmetatable, collectgarbage.
void replace_base(lua_State* state);
/// create, wrap, resume, close.
void replace_coroutine(lua_State* state);
/// concat, insert, move, remove, sort.
void replace_table(lua_State* state);
/// find, match, gmatch, gsub, rep; dump goes.
void replace_string(lua_State* state);

}  // namespace trellis::lua
