// SPDX-License-Identifier: GPL-3.0-or-later
#include <dsl/lua/digest.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <lua.hpp>
#include <map>
#include <utility>
#include <vector>

#include <trellis/base/random.hpp>

namespace trellis::lua {

namespace {

/// Serialises a value, and the values that it contains, into a text.
class Reader {
 public:
  Reader(lua_State* state, const std::function<std::string(Value)>& text) : state_(state), text_(text) {}

  /// Serialises the value on top of the stack.
  std::string read() {
    constexpr int slots = 6;
    if (++values_ > most_values || lua_checkstack(state_, slots) == 0) return "...";
    const int at = lua_gettop(state_);
    switch (lua_type(state_, at)) {
      case LUA_TNIL: return "nil";
      case LUA_TBOOLEAN: return lua_toboolean(state_, at) != 0 ? "true" : "false";
      case LUA_TNUMBER:
        return lua_isinteger(state_, at) != 0 ? fmt::format("{}", lua_tointeger(state_, at))
                                              : fmt::format("{:a}", lua_tonumber(state_, at));
      case LUA_TSTRING: {
        std::size_t size = 0;
        const char* text = lua_tolstring(state_, at, &size);
        return fmt::format("\"{}\"", std::string_view(text, size));
      }
      case LUA_TTABLE:
      case LUA_TFUNCTION: return composed(at);
      default: return text_(Value(state_, at));
    }
  }

 private:
  static constexpr std::size_t most_values = 100'000;
  static constexpr int deepest = 100;

  std::string composed(int at) {
    const auto [known, fresh] = known_.try_emplace(lua_topointer(state_, at), known_.size());
    if (!fresh) return fmt::format("#{}", known->second);
    if (depth_ >= deepest) return "...";
    ++depth_;
    std::string text = lua_type(state_, at) == LUA_TTABLE ? table(at) : function(at);
    --depth_;
    return text;
  }

  std::string table(int at) {
    lua_pushglobaltable(state_);
    const bool globals = lua_rawequal(state_, at, -1) != 0;
    lua_pop(state_, 1);
    if (globals) return "globals";
    // Sort by the keys' texts, because Lua's order differs between runs.
    lua_newtable(state_);
    const int keys = lua_gettop(state_);
    std::vector<std::pair<std::string, lua_Integer>> order;
    lua_pushnil(state_);
    while (lua_next(state_, at) != 0) {
      lua_pop(state_, 1);
      const int type = lua_type(state_, -1);
      const bool plain = type == LUA_TSTRING || type == LUA_TNUMBER || type == LUA_TBOOLEAN;
      order.emplace_back(plain ? read() : lua_typename(state_, type), static_cast<lua_Integer>(order.size()) + 1);
      lua_pushvalue(state_, -1);
      lua_rawseti(state_, keys, order.back().second);
    }
    std::sort(order.begin(), order.end());
    std::string text = "{";
    for (const auto& [key, i] : order) {
      lua_rawgeti(state_, keys, i);
      lua_rawget(state_, at);
      text += key + "=" + read() + ",";
      lua_pop(state_, 1);
    }
    lua_settop(state_, keys - 1);
    return text + "}";
  }

  std::string function(int at) {
    if (lua_iscfunction(state_, at) != 0) return "built in";
    std::string code;
    lua_pushvalue(state_, at);
    lua_dump(
        state_,
        [](lua_State*, const void* block, std::size_t size, void* into) {
          static_cast<std::string*>(into)->append(static_cast<const char*>(block), size);
          return 0;
        },
        &code, 1);
    lua_pop(state_, 1);
    std::string text = fmt::format("function {:016x}(", stable_hash(code));
    for (int i = 1; lua_getupvalue(state_, at, i) != nullptr; ++i) {
      text += read() + ",";
      lua_pop(state_, 1);
    }
    return text + ")";
  }

  lua_State* state_;
  const std::function<std::string(Value)>& text_;
  std::map<const void*, std::size_t> known_;
  std::size_t values_ = 0;
  int depth_ = 0;
};

}  // namespace

std::uint64_t digest(Value value, const std::function<std::string(Value)>& text) {
  lua_State* state = value.state();
  const int before = lua_gettop(state);
  luaL_checkstack(state, 1, "too many values");
  lua_pushvalue(state, value.index());
  const std::string read = Reader(state, text).read();
  lua_settop(state, before);
  return stable_hash(read);
}

}  // namespace trellis::lua
