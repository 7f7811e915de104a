// SPDX-License-Identifier: GPL-3.0-or-later
#include <array>
#include <string_view>

#include <dsl/lua/guard.hpp>

namespace trellis::lua {

namespace {

/// Lua's `load` (upvalue 1) for texts only: bytecode that was tampered with can crash the interpreter.
int load_text(lua_State* state) {
  constexpr int mode = 3, arguments_without_environment = 3;
  const bool environment = lua_gettop(state) > arguments_without_environment;
  if (std::string_view(luaL_optstring(state, mode, "t")).find('t') == std::string_view::npos) {
    return luaL_error(state, "load: bytecode cannot be loaded here, only text");
  }
  lua_settop(state, environment ? 4 : arguments_without_environment);
  lua_pushliteral(state, "t");
  lua_replace(state, mode);
  lua_pushvalue(state, lua_upvalueindex(1));
  lua_insert(state, 1);
  lua_call(state, lua_gettop(state) - 1, LUA_MULTRET);
  return lua_gettop(state);
}

}  // namespace

void open_libraries(Stack& stack) {
  lua_State* state = stack.state();
  constexpr std::array<luaL_Reg, 6> libraries = {{{LUA_GNAME, luaopen_base},
                                                  {LUA_TABLIBNAME, luaopen_table},
                                                  {LUA_STRLIBNAME, luaopen_string},
                                                  {LUA_MATHLIBNAME, luaopen_math},
                                                  {LUA_UTF8LIBNAME, luaopen_utf8},
                                                  {LUA_COLIBNAME, luaopen_coroutine}}};
  for (const auto& library : libraries) {
    luaL_requiref(state, library.name, library.func, 1);
    lua_pop(state, 1);
  }
  for (const char* name : {"dofile", "loadfile"}) {
    lua_pushnil(state);
    stack.set_global(name);
  }
  stack.push_global("load");
  lua_pushcclosure(state, load_text, 1);
  stack.set_global("load");
  lua_pushnil(state);
  stack.push_global("string");
  lua_insert(state, -2);
  lua_setfield(state, -2, "dump");
  lua_pop(state, 1);
}

}  // namespace trellis::lua
