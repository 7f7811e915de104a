// SPDX-License-Identifier: GPL-3.0-or-later
#include <pthread.h>

#include <array>
#include <cstddef>
#include <cstdio>
#include <string>
#include <string_view>

#include <dsl/lua/guard.hpp>
#include <dsl/lua/libraries.hpp>
#include <trellis/base/printable.hpp>

namespace trellis::lua {

namespace {

// Functions that catch errors ----------------------------------------------------------------------------------------

/// Ends a call of Lua's own function: the end of a script, which the function may have caught, continues.
int pass_on(lua_State* state, int status, lua_KContext context) {
  static_cast<void>(status), static_cast<void>(context);
  Guard::end_catching(state);
  Guard::pass_on(state);
  // A failed call may have done much work in few instructions.
  constexpr std::uint64_t failure = 1000;
  Guard::spend(state, lua_toboolean(state, 1) != 0 ? 1 : failure);
  return lua_gettop(state);
}

/// Calls Lua's own function (upvalue 1) with the arguments on the stack.
int catching(lua_State* state) {
  lua_pushvalue(state, lua_upvalueindex(1));
  lua_insert(state, 1);
  Guard::begin_catching(state);
  lua_callk(state, lua_gettop(state) - 1, LUA_MULTRET, 0, pass_on);
  return pass_on(state, LUA_OK, 0);
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

int protected_call(lua_State* state) {
  luaL_checkany(state, 1);
  return catching(state);
}

int protected_call_with_handler(lua_State* state) {
  luaL_checktype(state, 2, LUA_TFUNCTION);
  lua_pushvalue(state, 2);
  lua_pushcclosure(state, handle, 1);
  lua_replace(state, 2);
  return catching(state);
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

/// Lua's `print`, for a terminal that obeys nothing in it.
int print(lua_State* state) {
  constexpr std::uint64_t each = 2;  // bytes for an instruction
  const int count = lua_gettop(state);
  std::string line;
  for (int i = 1; i <= count; ++i) {
    std::size_t size = 0;
    const char* text = luaL_tolstring(state, i, &size);
    Guard::spend(state, size / each);
    if (i > 1) line += '\t';
    line += printable({text, size});
    lua_pop(state, 1);
  }
  line += '\n';
  std::fwrite(line.data(), 1, line.size(), stdout);
  std::fflush(stdout);
  return 0;
}

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
  constexpr int mode = 3, environment = 4;
  if (std::string_view(luaL_optstring(state, mode, "t")).find('t') == std::string_view::npos) {
    return luaL_error(state, "load: bytecode cannot be loaded here, only text");
  }
  if (lua_type(state, 1) == LUA_TSTRING) Guard::spend(state, lua_rawlen(state, 1));
  lua_settop(state, lua_gettop(state) >= environment ? environment : mode);
  lua_pushliteral(state, "t");
  lua_replace(state, mode);
  return catching(state);  // it catches errors of its reader
}

}  // namespace

void replace_base(lua_State* state) {
  constexpr std::array<luaL_Reg, 4> functions = {
      {{"setmetatable", set_metatable}, {"collectgarbage", collect_garbage}, {"print", print}, {nullptr, nullptr}}};
  luaL_setfuncs(state, functions.data(), 0);
  wrap(state, "pcall", protected_call);
  wrap(state, "xpcall", protected_call_with_handler);
  wrap(state, "load", load_text);
}

// Coroutines ---------------------------------------------------------------------------------------------------------

namespace {

int with_coroutine(lua_State* state) {
  luaL_argexpected(state, lua_isthread(state, 1), 1, "coroutine");
  return catching(state);
}

/// The lowest address of this thread's C stack; nullptr if the system does not say.
const char* lowest_of_stack() {
  thread_local const char* const lowest = [] {
    pthread_attr_t attributes;
    if (::pthread_getattr_np(::pthread_self(), &attributes) != 0) return static_cast<const char*>(nullptr);
    void* address = nullptr;
    std::size_t size = 0;
    ::pthread_attr_getstack(&attributes, &address, &size);
    ::pthread_attr_destroy(&attributes);
    return static_cast<const char*>(address);
  }();
  return lowest;
}

/// A coroutine whose variables are being closed, until the destruction. Lua counts the calls of C within each other,
/// and begins to count again at each coroutine that is closed: where the functions that close variables close further
/// coroutines, its count does not protect the C stack.
class Closing {
 public:
  explicit Closing(lua_State* state) : count_(Guard::closing(state)) {
    constexpr unsigned most = 100;
    constexpr std::ptrdiff_t reserve = std::ptrdiff_t{1} << 20U;  // bytes: 200 calls of C, Lua's own limit, take less
    const char* const lowest = lowest_of_stack();
    const auto* here = static_cast<const char*>(__builtin_frame_address(0));
    if (count_ >= most || (count_ > 0 && lowest != nullptr && here - lowest < reserve)) {
      luaL_error(state, "coroutines close each other, more than %d deep", static_cast<int>(count_));
    }
    ++count_;
  }
  ~Closing() { --count_; }
  Closing(const Closing&) = delete;
  Closing& operator=(const Closing&) = delete;

 private:
  unsigned& count_;
};

int close_coroutine(lua_State* state) {
  luaL_argexpected(state, lua_isthread(state, 1), 1, "coroutine");
  const Closing closing(state);
  return catching(state);
}

/// Resumes a coroutine (upvalue 1) with the arguments on the stack, and raises its error.
int wrapped(lua_State* state) {
  lua_State* coroutine = lua_tothread(state, lua_upvalueindex(1));
  const int count = lua_gettop(state);
  int results = 0;
  if (lua_checkstack(coroutine, count) == 0) return luaL_error(state, "too many arguments to resume");
  lua_xmove(state, coroutine, count);
  Guard::begin_catching(state);  // its errors are raised where it is resumed
  int status = lua_resume(coroutine, state, count, &results);
  Guard::end_catching(state);
  Guard::pass_on(state);
  Guard::spend(state, 1);
  if (status == LUA_OK || status == LUA_YIELD) {
    luaL_checkstack(state, results, "too many results to resume");
    lua_xmove(coroutine, state, results);
    return results;
  }
  if (lua_status(coroutine) == status) {
    const Closing closing(state);
    status = lua_resetthread(coroutine);  // closes its variables, which may fail too
  }
  Guard::pass_on(state);
  lua_xmove(coroutine, state, 1);
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

int coroutine_wrap(lua_State* state) {
  luaL_checktype(state, 1, LUA_TFUNCTION);
  lua_State* coroutine = lua_newthread(state);
  lua_pushvalue(state, 1);
  lua_xmove(state, coroutine, 1);
  lua_pushcclosure(state, wrapped, 1);
  return 1;
}

}  // namespace

void replace_coroutine(lua_State* state) {
  wrap(state, "resume", with_coroutine);
  wrap(state, "close", close_coroutine);
  lua_pushcfunction(state, coroutine_wrap);
  lua_setfield(state, -2, "wrap");
}

}  // namespace trellis::lua
