// SPDX-License-Identifier: GPL-3.0-or-later
#include <dsl/lua/snapshot.hpp>

#include <bit>
#include <lua.hpp>
#include <memory>
#include <string_view>
#include <unordered_map>

#include <dsl/lua/collect.hpp>
#include <dsl/lua/state.hpp>

namespace trellis::lua {

/// Reads the containers of an interpreter. Every function of it leaves Lua's stack as it was.
class Snapshot::Walk {
 public:
  explicit Walk(lua_State* state) : state_(state) {}

  /// The value at a place of the stack.
  [[nodiscard]] Entry entry(int at) const {
    const int type = lua_type(state_, at);
    switch (type) {
      case LUA_TNIL: return {type, 0};
      case LUA_TBOOLEAN: return {type, lua_toboolean(state_, at) != 0 ? 1U : 0U};
      case LUA_TNUMBER:
        // -1: no type of Lua, for integers.
        return lua_isinteger(state_, at) != 0 ? Entry{-1, static_cast<std::uint64_t>(lua_tointeger(state_, at))}
                                              : Entry{type, std::bit_cast<std::uint64_t>(lua_tonumber(state_, at))};
      default: return {type, reinterpret_cast<std::uint64_t>(lua_topointer(state_, at))};  // NOLINT: an identity
    }
  }

  /// Calls `visit` with the place of each value in the container at a place: keys, values and the metatable of a table,
  /// upvalues of a function. Stops where it returns false, and returns that.
  template <class Visit>
  bool each(int at, const Visit& visit) const {
    const int before = lua_gettop(state_);
    bool going = true;
    if (lua_type(state_, at) == LUA_TTABLE) {
      if (lua_getmetatable(state_, at) == 0) lua_pushnil(state_);
      going = visit(before + 1);
      lua_settop(state_, before);
      lua_pushnil(state_);
      while (going && lua_next(state_, at) != 0) {
        going = visit(before + 1) && visit(before + 2);
        lua_settop(state_, before + 1);
      }
    } else {
      for (int i = 1; going && lua_getupvalue(state_, at, i) != nullptr; ++i) {
        going = visit(before + 1);
        lua_settop(state_, before);
      }
    }
    lua_settop(state_, before);
    return going;
  }

  /// Whether a value has content that a script can change. A callback has one upvalue, its object.
  [[nodiscard]] bool is_container(int at) const {
    const int type = lua_type(state_, at);
    if (type != LUA_TFUNCTION) return type == LUA_TTABLE;
    if (lua_tocfunction(state_, at) == call_back || lua_getupvalue(state_, at, 1) == nullptr) return false;
    lua_pop(state_, 1);
    return true;
  }

  /// Whether a value changes without an assignment.
  [[nodiscard]] bool is_volatile(int at) const {
    const int type = lua_type(state_, at);
    if (type == LUA_TTHREAD) return true;
    if (type != LUA_TTABLE || luaL_getmetafield(state_, at, "__mode") == LUA_TNIL) return false;
    lua_pop(state_, 1);
    return true;
  }

 private:
  lua_State* state_;
};

Snapshot::Snapshot(Stack& stack, const std::vector<const Reference*>& roots) {
  lua_State* state = stack.state();
  const int before = lua_gettop(state);
  constexpr int slots = 8;
  luaL_checkstack(state, slots, "too many values");
  const Walk walk(state);
  // Containers are visited in the order in which they are found; the list also has what they contain.
  lua_newtable(state);
  const int list = before + 1;
  lua_newtable(state);
  const int values = before + 2;
  std::unordered_map<const void*, bool> seen;
  lua_Integer found = 0;
  lua_Integer kept = 0;
  const auto add = [&](int at) {
    constant_ = constant_ && !walk.is_volatile(at);
    const void* address = lua_topointer(state, at);
    if (address == nullptr || lua_rawequal(state, at, list) != 0 || lua_rawequal(state, at, values) != 0 ||
        !seen.emplace(address, true).second) {
      return;
    }
    const bool container = walk.is_container(at);
    lua_pushvalue(state, at);
    lua_rawseti(state, container ? list : values, container ? ++found : ++kept);
  };
  const auto add_top = [&] {
    add(lua_gettop(state));
    lua_settop(state, values);
  };
  lua_pushglobaltable(state);
  add_top();
  stack.push_hidden("modules");
  add_top();
  lua_pushliteral(state, "");
  if (lua_getmetatable(state, -1) == 0) lua_pushnil(state);
  add_top();
  for (const Reference* root : roots) {
    root->push(stack);
    add_top();
  }
  for (lua_Integer i = 1; i <= found && constant_; ++i) {
    lua_rawgeti(state, list, i);
    walk.each(values + 1, [&](int at) {
      add(at);
      entries_.push_back(walk.entry(at));
      return true;
    });
    lua_settop(state, values);
  }
  count_ = static_cast<std::size_t>(found);
  lua_rawseti(state, list, found + 1);  // the list owns the values
  containers_ = std::make_unique<Reference>(stack, stack.top());
  lua_settop(state, before);
}

Snapshot::~Snapshot() = default;

bool Snapshot::unchanged(Stack& stack) const {
  if (!constant_) return false;
  lua_State* state = stack.state();
  const int before = lua_gettop(state);
  constexpr int slots = 8;
  luaL_checkstack(state, slots, "too many values");
  const Walk walk(state);
  containers_->push(stack);
  std::size_t next = 0;
  bool same = true;
  for (std::size_t i = 1; i <= count_ && same; ++i) {
    lua_rawgeti(state, before + 1, static_cast<lua_Integer>(i));
    same = walk.each(before + 2, [&](int at) { return next < entries_.size() && entries_[next++] == walk.entry(at); });
    lua_settop(state, before + 1);
  }
  lua_settop(state, before);
  return same && next == entries_.size();
}

}  // namespace trellis::lua
