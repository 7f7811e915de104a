// SPDX-License-Identifier: GPL-3.0-or-later
#include <array>
#include <cstdint>
#include <initializer_list>
#include <limits>
#include <string>

#include <dsl/lua/guard.hpp>
#include <dsl/lua/libraries.hpp>

namespace trellis::lua {

namespace {

/// Checks for a table, or a value with these metamethods.
void check_table(lua_State* state, int argument, std::initializer_list<const char*> metamethods) {
  if (lua_type(state, argument) == LUA_TTABLE) return;
  for (const char* name : metamethods) {
    if (luaL_getmetafield(state, argument, name) == LUA_TNIL) luaL_checktype(state, argument, LUA_TTABLE);
    lua_pop(state, 1);
  }
}

/// Moves the element at `from` to `to`, in the tables at two stack positions.
void move_element(lua_State* state, int source, lua_Integer from, int target, lua_Integer to) {
  Guard::spend(state, 1);
  lua_geti(state, source, from);
  lua_seti(state, target, to);
}

int insert(lua_State* state) {
  check_table(state, 1, {"__index", "__newindex", "__len"});
  const int count = lua_gettop(state);
  const auto end = static_cast<lua_Integer>(static_cast<lua_Unsigned>(luaL_len(state, 1)) + 1U);
  if (count < 2 || count > 3) return luaL_error(state, "wrong number of arguments to 'insert'");
  lua_Integer place = end;
  if (count == 3) {
    place = luaL_checkinteger(state, 2);
    // Unsigned arithmetic makes one comparison of two.
    luaL_argcheck(state, static_cast<lua_Unsigned>(place) - 1U < static_cast<lua_Unsigned>(end), 2,
                  "position out of bounds");
    for (lua_Integer i = end; i > place; --i) move_element(state, 1, i - 1, 1, i);
  }
  lua_seti(state, 1, place);
  return 0;
}

int remove(lua_State* state) {
  check_table(state, 1, {"__index", "__newindex", "__len"});
  const lua_Integer size = luaL_len(state, 1);
  lua_Integer place = luaL_optinteger(state, 2, size);
  if (place != size) {
    luaL_argcheck(state, static_cast<lua_Unsigned>(place) - 1U <= static_cast<lua_Unsigned>(size), 2,
                  "position out of bounds");
  }
  lua_geti(state, 1, place);
  for (; place < size; ++place) move_element(state, 1, place + 1, 1, place);
  lua_pushnil(state);
  lua_seti(state, 1, place);
  return 1;
}

int move(lua_State* state) {
  const lua_Integer first = luaL_checkinteger(state, 2);
  const lua_Integer last = luaL_checkinteger(state, 3);
  check_table(state, 1, {"__index"});
  check_table(state, lua_isnoneornil(state, 5) ? 1 : 5, {"__newindex"});
  if (last >= first) Guard::spend(state, static_cast<std::uint64_t>(last) - static_cast<std::uint64_t>(first));
  return call_replaced(state);
}

int concat(lua_State* state) {
  check_table(state, 1, {"__index", "__len"});
  std::size_t between = 0;
  const char* separator = luaL_optlstring(state, 2, "", &between);
  const lua_Integer first = luaL_optinteger(state, 3, 1);
  const lua_Integer last = lua_isnoneornil(state, 4) ? luaL_len(state, 1) : luaL_checkinteger(state, 4);
  lua_settop(state, 4);
  std::string text;
  for (lua_Integer i = first; i <= last; ++i) {
    lua_geti(state, 1, i);
    if (lua_isstring(state, -1) == 0) {
      return luaL_error(state, "invalid value (at index %I) in table for 'concat'", static_cast<LUAI_UACINT>(i));
    }
    std::size_t size = 0;
    const char* element = lua_tolstring(state, -1, &size);
    if (text.size() + size + between > Guard::longest_string(state)) {
      return luaL_error(state, "table.concat: the result would have more than %d MiB",
                        static_cast<int>(Guard::longest_string(state) >> 20U));
    }
    text.append(element, size);
    if (i < last) text.append(separator, between);
    lua_pop(state, 1);
    constexpr std::size_t bytes = 16;  // copied in an instruction's time
    Guard::spend(state, 1 + (size + between) / bytes);
    if (i == std::numeric_limits<lua_Integer>::max()) break;
  }
  lua_pushlstring(state, text.data(), text.size());
  return 1;
}

/// Heap sort of the table at 1 by the function at 2, or by `<`: it terminates for every comparison function. Lua's own
/// sort takes pivots by the clock, so that the order of equal elements would differ from run to run.
class Sort {
 public:
  explicit Sort(lua_State* state) : state_(state), size_(luaL_len(state, 1)) {}

  void operator()() {
    luaL_argcheck(state_, size_ < std::numeric_limits<int>::max(), 1, "array too big");
    for (lua_Integer root = size_ / 2; root >= 1; --root) sink(root, size_);
    for (lua_Integer last = size_; last > 1; --last) {
      lua_geti(state_, 1, 1);
      lua_geti(state_, 1, last);
      lua_seti(state_, 1, 1);
      lua_seti(state_, 1, last);
      sink(1, last - 1);
    }
  }

 private:
  /// Whether the value at stack position `a` precedes that at `b`.
  bool less(int a, int b) {
    Guard::spend(state_, 1);
    if (lua_isnil(state_, 2)) return lua_compare(state_, a, b, LUA_OPLT) != 0;
    lua_pushvalue(state_, 2);
    lua_pushvalue(state_, a);
    lua_pushvalue(state_, b);
    lua_call(state_, 2, 1);
    const bool result = lua_toboolean(state_, -1) != 0;
    lua_pop(state_, 1);
    return result;
  }

  /// Sifts the element at `root` down among the first `count` elements, which form a heap below it.
  void sink(lua_Integer root, lua_Integer count) {
    const int top = lua_gettop(state_);
    const int sinking = top + 1, child_value = top + 2, other_value = top + 3;
    lua_geti(state_, 1, root);
    while (2 * root <= count) {
      lua_Integer child = 2 * root;
      lua_geti(state_, 1, child);
      if (child < count) {
        lua_geti(state_, 1, child + 1);
        if (less(child_value, other_value)) {
          lua_replace(state_, child_value);
          ++child;
        } else {
          lua_pop(state_, 1);
        }
      }
      if (!less(sinking, child_value)) {
        lua_pop(state_, 1);
        break;
      }
      lua_seti(state_, 1, root);
      root = child;
    }
    lua_seti(state_, 1, root);
  }

  lua_State* state_;
  lua_Integer size_;
};

int sort(lua_State* state) {
  check_table(state, 1, {"__index", "__newindex", "__len"});
  if (!lua_isnoneornil(state, 2)) luaL_checktype(state, 2, LUA_TFUNCTION);
  lua_settop(state, 2);
  luaL_checkstack(state, LUA_MINSTACK, nullptr);
  Sort sorting(state);
  sorting();
  return 0;
}

}  // namespace

void replace_table(lua_State* state) {
  constexpr std::array<luaL_Reg, 5> functions = {
      {{"insert", insert}, {"remove", remove}, {"concat", concat}, {"sort", sort}, {nullptr, nullptr}}};
  luaL_setfuncs(state, functions.data(), 0);
  wrap(state, "move", move);
}

}  // namespace trellis::lua
