// SPDX-License-Identifier: GPL-3.0-or-later
#include <dsl/lua/interrupt.hpp>

#include <lua.hpp>

namespace trellis::lua {

namespace {

/// Its address is the place in the registry.
constexpr char place = 0;

struct Poll {
  bool (*asked)();
};

void poll(lua_State* state, lua_Debug*) {
  lua_rawgetp(state, LUA_REGISTRYINDEX, &place);
  const auto* asks = static_cast<const Poll*>(lua_touserdata(state, -1));
  lua_pop(state, 1);
  if (asks != nullptr && asks->asked()) luaL_error(state, "interrupted");
}

}  // namespace

void poll_interrupts(Stack& stack, bool (*asked)()) {
  constexpr int instructions = 10'000;
  lua_State* state = stack.state();
  luaL_checkstack(state, 1, "too many values");
  static_cast<Poll*>(lua_newuserdatauv(state, sizeof(Poll), 0))->asked = asked;
  lua_rawsetp(state, LUA_REGISTRYINDEX, &place);
  lua_sethook(state, poll, LUA_MASKCOUNT, instructions);
}

}  // namespace trellis::lua
