// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <lua.hpp>

namespace trellis::lua {

// Functions of Lua's library made anew, so that none works without end, or holds on to a script that is to end. Each
// replaces those of its name in the table on top of the stack. For the sources of this folder only.

/// pcall, xpcall, load, next, pairs, setmetatable, collectgarbage.
void replace_base(lua_State* state);
/// create, wrap, resume, close.
void replace_coroutine(lua_State* state);
/// concat, insert, move, remove, sort.
void replace_table(lua_State* state);
/// find, match, gmatch, gsub, rep; dump goes.
void replace_string(lua_State* state);

}  // namespace trellis::lua
