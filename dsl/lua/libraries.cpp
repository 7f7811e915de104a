// SPDX-License-Identifier: GPL-3.0-or-later
#include <dsl/lua/libraries.hpp>

#include <array>

#include <dsl/lua/guard.hpp>

namespace trellis::lua {

namespace {

struct Library {
  const char* name;
  lua_CFunction open;
  void (*replace)(lua_State*);
};

}  // namespace

void wrap(lua_State* state, const char* name, lua_CFunction by) {
  lua_getfield(state, -1, name);
  lua_pushcclosure(state, by, 1);
  lua_setfield(state, -2, name);
}

int call_replaced(lua_State* state) {
  lua_pushvalue(state, lua_upvalueindex(1));
  lua_insert(state, 1);
  lua_call(state, lua_gettop(state) - 1, LUA_MULTRET);
  return lua_gettop(state);
}

void open_libraries(Stack& stack, bool trust) {
  lua_State* state = stack.state();
  constexpr std::array<Library, 6> harmless = {{{LUA_GNAME, luaopen_base, replace_base},
                                                {LUA_TABLIBNAME, luaopen_table, replace_table},
                                                {LUA_STRLIBNAME, luaopen_string, replace_string},
                                                {LUA_MATHLIBNAME, luaopen_math, nullptr},
                                                {LUA_UTF8LIBNAME, luaopen_utf8, nullptr},
                                                {LUA_COLIBNAME, luaopen_coroutine, replace_coroutine}}};
  constexpr std::array<Library, 3> trusted = {{{LUA_IOLIBNAME, luaopen_io, nullptr},
                                               {LUA_OSLIBNAME, luaopen_os, nullptr},
                                               {LUA_DBLIBNAME, luaopen_debug, nullptr}}};
  const auto open = [state](const Library& library) {
    luaL_requiref(state, library.name, library.open, 1);
    if (library.replace != nullptr) library.replace(state);
    lua_pop(state, 1);
  };
  for (const auto& library : harmless) open(library);
  if (trust) {
    for (const auto& library : trusted) open(library);
  }
  for (const char* name : {"dofile", "loadfile"}) {
    lua_pushnil(state);
    stack.set_global(name);
  }
}

}  // namespace trellis::lua
