// SPDX-License-Identifier: GPL-3.0-or-later
#include <dsl/lua/value.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

#include <dsl/lua/collect.hpp>
#include <dsl/lua/mistakes.hpp>

namespace trellis::lua {

Type Value::type() const {
  switch (lua_type(state_, index_)) {
    case LUA_TNONE: return Type::none;
    case LUA_TNIL: return Type::nil;
    case LUA_TBOOLEAN: return Type::boolean;
    case LUA_TNUMBER: return Type::number;
    case LUA_TSTRING: return Type::string;
    case LUA_TTABLE: return Type::table;
    case LUA_TFUNCTION: return Type::function;
    case LUA_TUSERDATA: return Type::object;
    default: return Type::other;
  }
}

bool Value::given() const { return lua_type(state_, index_) > LUA_TNIL; }

bool Value::is_integer() const { return lua_isinteger(state_, index_) != 0; }

std::optional<bool> Value::boolean() const {
  if (type() != Type::boolean) return {};
  return lua_toboolean(state_, index_) != 0;
}

std::optional<double> Value::number() const {
  if (type() != Type::number) return {};
  const double x = lua_tonumber(state_, index_);
  return std::isnan(x) ? std::numeric_limits<double>::quiet_NaN() : x;
}

std::optional<std::int64_t> Value::integer() const {
  if (type() != Type::number) return {};
  int whole = 0;
  const lua_Integer x = lua_tointegerx(state_, index_, &whole);
  if (whole == 0) return {};
  return x;
}

std::optional<std::string> Value::string() const {
  if (type() != Type::string) return {};
  std::size_t size = 0;
  const char* text = lua_tolstring(state_, index_, &size);
  return std::string(text, size);
}

std::string Value::describe() const {
  constexpr std::size_t longest = 60;
  switch (type()) {
    case Type::none: return "nothing";
    case Type::nil: return "nil";
    case Type::boolean: return lua_toboolean(state_, index_) != 0 ? "true" : "false";
    case Type::number:
      return is_integer() ? fmt::format("{}", lua_tointeger(state_, index_)) : fmt::format("{:g}", *number());
    case Type::string: {
      std::string text = *string();
      if (text.size() > longest) {
        text.resize(longest);
        text += "...";
      }
      return fmt::format("\"{}\"", text);
    }
    default: break;
  }
  if (const auto* failed = get<FailedValue>()) {
    failed->insist();
    throw FailedValue();
  }
  const int top = lua_gettop(state_);
  std::string name = luaL_typename(state_, index_);
  if (luaL_getmetafield(state_, index_, "__name") == LUA_TSTRING) name = lua_tostring(state_, -1);
  lua_settop(state_, top);
  const bool vowel = std::string_view("aeiou").find(name.front()) != std::string_view::npos;
  return (vowel ? "an " : "a ") + name;
}

std::string Value::text() const {
  std::size_t size = 0;
  const char* text = luaL_tolstring(state_, index_, &size);
  std::string result(text, size);
  lua_pop(state_, 1);
  return result;
}

Keys Value::keys() const {
  Keys keys;
  lua_Integer last = 0;
  luaL_checkstack(state_, 2, "too many values");
  lua_pushnil(state_);
  while (lua_next(state_, index_) != 0) {
    lua_pop(state_, 1);
    if (lua_type(state_, -1) == LUA_TSTRING) {
      std::size_t size = 0;
      const char* text = lua_tolstring(state_, -1, &size);
      keys.names.emplace_back(text, size);
    } else if (lua_isinteger(state_, -1) != 0 && lua_tointeger(state_, -1) > 0) {
      ++keys.length;
      last = std::max(last, lua_tointeger(state_, -1));
    } else if (keys.odd.empty()) {
      keys.odd = "the key " + Value(state_, lua_gettop(state_)).describe();
    }
  }
  std::sort(keys.names.begin(), keys.names.end());
  if (keys.odd.empty() && static_cast<lua_Integer>(keys.length) != last) {
    keys.odd = fmt::format("a gap (nil) before element {}", last);
  }
  return keys;
}

Value Value::field(const std::string& name) const {
  luaL_checkstack(state_, 2, "too many values");
  lua_pushlstring(state_, name.data(), name.size());
  lua_rawget(state_, index_);
  return {state_, lua_gettop(state_)};
}

void Value::each(const std::function<void(std::size_t, Value)>& visit) const {
  luaL_checkstack(state_, 2, "too many values");
  const int top = lua_gettop(state_);
  const std::size_t length = keys().length;
  for (std::size_t i = 1; i <= length; ++i) {
    lua_rawgeti(state_, index_, static_cast<lua_Integer>(i));
    visit(i, Value(state_, lua_gettop(state_)));
    lua_settop(state_, top);
  }
}

void Value::each_pair(const std::function<void(Value, Value)>& visit) const {
  luaL_checkstack(state_, 3, "too many values");
  lua_pushnil(state_);
  while (lua_next(state_, index_) != 0) {
    const int value = lua_gettop(state_);
    visit(Value(state_, value - 1), Value(state_, value));
    lua_settop(state_, value - 1);
  }
}

const void* Value::identity() const { return lua_topointer(state_, index_); }

std::uint64_t Value::object_number() const {
  const Object* found = object();
  return found != nullptr ? found->number : 0;
}

const Object* Value::object() const {
  if (type() != Type::object) return nullptr;
  const int top = lua_gettop(state_);
  const bool ours =
      luaL_getmetafield(state_, index_, "__gc") == LUA_TFUNCTION && lua_tocfunction(state_, -1) == collect;
  lua_settop(state_, top);
  return ours ? static_cast<const std::unique_ptr<Object>*>(lua_touserdata(state_, index_))->get() : nullptr;
}

}  // namespace trellis::lua
