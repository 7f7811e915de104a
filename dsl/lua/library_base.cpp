// SPDX-License-Identifier: GPL-3.0-or-later
#include <array>
#include <string_view>

#include <dsl/lua/guard.hpp>
#include <dsl/lua/libraries.hpp>

namespace trellis::lua {

namespace {

// Protected calls ------------------------------------------------------------------------------------------------

/// Returns the results of pcall and xpcall: whether the call succeeded, and its results or error. The `first` values
/// below stay.
int finish_protected(lua_State* state, int status, lua_KContext first) {
  Guard::pass_on(state);
  if (status != LUA_OK && status != LUA_YIELD) {
    // A failed call may have done much work in few instructions.
    constexpr std::uint64_t failure = 1000;
    Guard::spend(state, failure);
    lua_pushboolean(state, 0);
    lua_pushvalue(state, -2);
    return 2;
  }
  return lua_gettop(state) - static_cast<int>(first);
}

int protected_call(lua_State* state) {
  luaL_checkany(state, 1);
  lua_pushboolean(state, 1);
  lua_insert(state, 1);
  const int status = lua_pcallk(state, lua_gettop(state) - 2, LUA_MULTRET, 0, 0, finish_protected);
  return finish_protected(state, status, 0);
}

/// A script's message handler (upvalue 1). It does not run at the end of the script, because handlers run without
/// instruction counts.
int handle(lua_State* state) {
  if (Guard::ended(state)) return 1;
  lua_settop(state, 1);
  lua_pushvalue(state, lua_upvalueindex(1));
  lua_insert(state, 1);
  lua_call(state, 1, 1);
  return 1;
}

int protected_call_with_handler(lua_State* state) {
  const int count = lua_gettop(state);
  luaL_checktype(state, 2, LUA_TFUNCTION);
  lua_pushvalue(state, 2);
  lua_pushcclosure(state, handle, 1);
  lua_replace(state, 2);
  lua_pushboolean(state, 1);
  lua_pushvalue(state, 1);
  lua_rotate(state, 3, 2);
  const int status = lua_pcallk(state, count - 2, LUA_MULTRET, 2, 2, finish_protected);
  return finish_protected(state, status, 2);
}

// Tables -----------------------------------------------------------------------------------------------------------

int next(lua_State* state) {
  // A search through an emptied table takes long.
  Guard::spend(state, 1);
  luaL_checktype(state, 1, LUA_TTABLE);
  lua_settop(state, 2);
  if (lua_next(state, 1) != 0) return 2;
  lua_pushnil(state);
  return 1;
}

int finish_pairs(lua_State* state, int status, lua_KContext context) {
  static_cast<void>(state), static_cast<void>(status), static_cast<void>(context);
  return 3;
}

int pairs(lua_State* state) {
  luaL_checkany(state, 1);
  if (luaL_getmetafield(state, 1, "__pairs") == LUA_TNIL) {
    lua_pushcfunction(state, next);
    lua_pushvalue(state, 1);
    lua_pushnil(state);
  } else {
    lua_pushvalue(state, 1);
    lua_callk(state, 1, 3, 0, finish_pairs);
  }
  return 3;
}

int set_metatable(lua_State* state) {
  const int type = lua_type(state, 2);
  luaL_checktype(state, 1, LUA_TTABLE);
  luaL_argexpected(state, type == LUA_TNIL || type == LUA_TTABLE, 2, "nil or table");
  if (luaL_getmetafield(state, 1, "__metatable") != LUA_TNIL) {
    return luaL_error(state, "cannot change a protected metatable");
  }
  if (type == LUA_TTABLE) {
    lua_pushliteral(state, "__gc");
    // Finalisers run without instruction counts or limits, so scripts may not set them.
    if (lua_rawget(state, 2) != LUA_TNIL) {
      return luaL_error(state,
                        "setmetatable: there are no finalisers (__gc) here; a variable that is to be closed, "
                        "as in 'local x <close> = ...', does without");
    }
  }
  lua_settop(state, 2);
  lua_setmetatable(state, 1);
  return 1;
}

// The rest -----------------------------------------------------------------------------------------------------------

int collect_garbage(lua_State* state) {
  constexpr double kibibyte = 1024.0;
  constexpr std::uint64_t each = 16;  // instructions for collecting a kibibyte
  const std::string_view what = luaL_optstring(state, 1, "collect");
  const auto used = static_cast<std::uint64_t>(lua_gc(state, LUA_GCCOUNT, 0));
  if (what == "count") {
    lua_pushnumber(state, static_cast<double>(used) + lua_gc(state, LUA_GCCOUNTB, 0) / kibibyte);
    return 1;
  }
  if (what != "collect") {
    return luaL_error(state, "collectgarbage: there are 'collect' and 'count' here, got '%s'", what.data());
  }
  Guard::spend(state, each * used);
  lua_pushinteger(state, lua_gc(state, LUA_GCCOLLECT, 0));
  return 1;
}

/// Lua's `load` (upvalue 1) for texts only: modified bytecode can crash the interpreter.
int load_text(lua_State* state) {
  constexpr int mode = 3, arguments_without_environment = 3;
  const bool environment = lua_gettop(state) > arguments_without_environment;
  if (std::string_view(luaL_optstring(state, mode, "t")).find('t') == std::string_view::npos) {
    return luaL_error(state, "load: bytecode cannot be loaded here, only text");
  }
  if (lua_type(state, 1) == LUA_TSTRING) Guard::spend(state, lua_rawlen(state, 1));
  lua_settop(state, environment ? 4 : arguments_without_environment);
  lua_pushliteral(state, "t");
  lua_replace(state, mode);
  lua_pushvalue(state, lua_upvalueindex(1));
  lua_insert(state, 1);
  lua_call(state, lua_gettop(state) - 1, LUA_MULTRET);
  Guard::pass_on(state);  // it catches errors of its reader
  return lua_gettop(state);
}

}  // namespace

void replace_base(lua_State* state) {
  constexpr std::array<luaL_Reg, 7> functions = {{{"pcall", protected_call},
                                                  {"xpcall", protected_call_with_handler},
                                                  {"next", next},
                                                  {"pairs", pairs},
                                                  {"setmetatable", set_metatable},
                                                  {"collectgarbage", collect_garbage},
                                                  {nullptr, nullptr}}};
  luaL_setfuncs(state, functions.data(), 0);
  lua_getfield(state, -1, "load");
  lua_pushcclosure(state, load_text, 1);
  lua_setfield(state, -2, "load");
}

// Coroutines ---------------------------------------------------------------------------------------------------------

namespace {

lua_State* coroutine_argument(lua_State* state) {
  lua_State* coroutine = lua_tothread(state, 1);
  luaL_argexpected(state, coroutine != nullptr, 1, "coroutine");
  return coroutine;
}

/// Resumes a coroutine with the top `count` values; leaves its results, or its error, on top. \return the number of
/// results, -1 for an error
int resume(lua_State* state, lua_State* coroutine, int count) {
  if (lua_checkstack(coroutine, count) == 0) {
    lua_pushliteral(state, "too many arguments to resume");
    return -1;
  }
  lua_xmove(state, coroutine, count);
  int results = 0;
  const int status = lua_resume(coroutine, state, count, &results);
  Guard::pass_on(state);
  Guard::spend(state, 1);
  if (status != LUA_OK && status != LUA_YIELD) {
    constexpr std::uint64_t failure = 1000;
    Guard::spend(state, failure);
    lua_xmove(coroutine, state, 1);
    return -1;
  }
  if (lua_checkstack(state, results + 1) == 0) {
    lua_pop(coroutine, results);
    lua_pushliteral(state, "too many results to resume");
    return -1;
  }
  lua_xmove(coroutine, state, results);
  return results;
}

int coroutine_resume(lua_State* state) {
  lua_State* coroutine = coroutine_argument(state);
  const int results = resume(state, coroutine, lua_gettop(state) - 1);
  lua_pushboolean(state, results < 0 ? 0 : 1);
  if (results < 0) {
    lua_insert(state, -2);
    return 2;
  }
  lua_insert(state, -(results + 1));
  return results + 1;
}

int wrapped(lua_State* state) {
  lua_State* coroutine = lua_tothread(state, lua_upvalueindex(1));
  const int results = resume(state, coroutine, lua_gettop(state));
  if (results >= 0) return results;
  int status = lua_status(coroutine);
  if (status != LUA_OK && status != LUA_YIELD) {
    status = lua_resetthread(coroutine);  // closes its variables, which may fail too
    Guard::pass_on(state);
    lua_xmove(coroutine, state, 1);
  }
  if (status != LUA_ERRMEM && lua_type(state, -1) == LUA_TSTRING) {
    luaL_where(state, 1);
    lua_insert(state, -2);
    // Add the position once if nested coroutines fail.
    const std::string_view where = lua_tostring(state, -2);
    if (std::string_view(lua_tostring(state, -1)).starts_with(where)) {
      lua_remove(state, -2);
    } else {
      lua_concat(state, 2);
    }
  }
  return lua_error(state);
}

int coroutine_create(lua_State* state) {
  luaL_checktype(state, 1, LUA_TFUNCTION);
  lua_State* coroutine = lua_newthread(state);
  lua_pushvalue(state, 1);
  lua_xmove(state, coroutine, 1);
  return 1;
}

int coroutine_wrap(lua_State* state) {
  coroutine_create(state);
  lua_pushcclosure(state, wrapped, 1);
  return 1;
}

int coroutine_close(lua_State* state) {
  lua_State* coroutine = coroutine_argument(state);
  lua_Debug frame{};
  const bool works = coroutine == state || (lua_status(coroutine) == LUA_OK && lua_getstack(coroutine, 0, &frame) != 0);
  if (works) {
    return luaL_error(state, "cannot close a %s coroutine", coroutine == state ? "running" : "normal");
  }
  const int status = lua_resetthread(coroutine);
  Guard::pass_on(state);
  lua_pushboolean(state, status == LUA_OK ? 1 : 0);
  if (status == LUA_OK) return 1;
  lua_xmove(coroutine, state, 1);
  return 2;
}

}  // namespace

void replace_coroutine(lua_State* state) {
  constexpr std::array<luaL_Reg, 5> functions = {{{"create", coroutine_create},
                                                  {"wrap", coroutine_wrap},
                                                  {"resume", coroutine_resume},
                                                  {"close", coroutine_close},
                                                  {nullptr, nullptr}}};
  luaL_setfuncs(state, functions.data(), 0);
}

}  // namespace trellis::lua
