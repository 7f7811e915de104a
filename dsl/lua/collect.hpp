// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <lua.hpp>

namespace trellis::lua {

/// The __gc of every userdata of Trellis, which also identifies these. For the sources of this folder only.
int collect(lua_State* state);

/// The function of Lua that calls a Callback, its only upvalue, which no script can change.
int call_back(lua_State* state);

}  // namespace trellis::lua
