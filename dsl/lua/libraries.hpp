// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <lua.hpp>

namespace trellis::lua {

// Functions of Lua's library that observe the limits: none runs without a bound, and none prevents the end of a script.
// Where the work of Lua's own function has a bound that is known before the call, the replacement counts that and calls
// it (`wrap`). Each replaces the function of its name in the table on top of the stack. For the sources of this folder
// only.

/// Replaces a function by another with the replaced one as its upvalue.
void wrap(lua_State* state, const char* name, lua_CFunction by);
/// Calls the replaced function with the arguments on the stack.
int call_replaced(lua_State* state);

/// pcall, xpcall, load, setmetatable, collectgarbage, print.
void replace_base(lua_State* state);
/// wrap, resume, close.
void replace_coroutine(lua_State* state);
/// concat, insert, move, remove, sort.
void replace_table(lua_State* state);
/// find, match, gmatch, gsub, rep; dump goes.
void replace_string(lua_State* state);

}  // namespace trellis::lua
