// SPDX-License-Identifier: GPL-3.0-or-later
#include <dsl/lua/stack.hpp>

#include <fmt/format.h>

#include <new>
#include <string>
#include <string_view>

#include <dsl/lua/collect.hpp>
#include <dsl/lua/guard.hpp>
#include <dsl/lua/syntax_hint.hpp>

namespace trellis::lua {

template <>
struct TypeName<Callback> {
  static constexpr const char* value = "function";
};

int collect(lua_State* state) {
  // Reset, not destroy: a finaliser of the script may still access the object.
  static_cast<std::unique_ptr<Object>*>(lua_touserdata(state, 1))->reset();
  return 0;
}

int call_back(lua_State* state) {
  const auto& object = *static_cast<const std::unique_ptr<Object>*>(lua_touserdata(state, lua_upvalueindex(1)));
  if (!object) return luaL_error(state, "the interpreter is closing");
  return Guard::run(state, static_cast<const Boxed<Callback>&>(*object).value);
}

namespace {

/// The default of __newindex.
int refuse_assignment(Stack& call) {
  throw Error(fmt::format("{} cannot be changed, so its field {} cannot be set; make another one", call[1].describe(),
                          call[2].describe()));
}

void room(lua_State* state, int slots = 2) { luaL_checkstack(state, slots, "too many values"); }

}  // namespace

std::string Position::prefix() const { return fmt::format("{}:{}: ", script, line); }

Stack::Stack(lua_State* state) : state_(state), count_(lua_gettop(state)) {}

Value Stack::operator[](int i) const { return {state_, i}; }
Value Stack::top() const { return {state_, lua_gettop(state_)}; }
int Stack::size() const { return lua_gettop(state_); }
void Stack::resize(int size) { lua_settop(state_, size); }

std::optional<Position> Stack::where() const {
  lua_Debug frame{};
  for (int level = 0; lua_getstack(state_, level, &frame) != 0; ++level) {
    lua_getinfo(state_, "Sl", &frame);
    if (frame.currentline > 0 && frame.source[0] == '@') return Position{frame.source + 1, frame.currentline};
  }
  return {};
}

std::optional<Definition> Stack::definition(Value function) {
  if (function.type() != Type::function) return {};
  room(state_);
  lua_pushvalue(state_, function.index());
  lua_Debug about{};
  lua_getinfo(state_, ">Su", &about);
  if (std::string_view(about.what) == "C") return {};
  const bool marked = about.source[0] == '@' || about.source[0] == '=';
  return Definition{marked ? about.source + 1 : about.source,
                    about.source[0] == '@',
                    about.linedefined,
                    about.lastlinedefined,
                    about.nparams,
                    about.isvararg != 0};
}

void Stack::push_nil() {
  room(state_);
  lua_pushnil(state_);
}
void Stack::push(bool value) {
  room(state_);
  lua_pushboolean(state_, value ? 1 : 0);
}
void Stack::push(std::int64_t value) {
  room(state_);
  lua_pushinteger(state_, value);
}
void Stack::push(double value) {
  room(state_);
  lua_pushnumber(state_, value);
}
void Stack::push(std::string_view value) {
  room(state_);
  lua_pushlstring(state_, value.data(), value.size());
}
void Stack::push(Value value) {
  room(state_);
  lua_pushvalue(state_, value.index());
}

void Stack::push_function(Callback callback) {
  push_object(std::move(callback));
  lua_pushcclosure(state_, call_back, 1);
}

Value Stack::push_table() {
  room(state_);
  lua_newtable(state_);
  return top();
}

void Stack::append(Value table) {
  lua_rawseti(state_, table.index(), static_cast<lua_Integer>(lua_rawlen(state_, table.index())) + 1);
}

void Stack::set_field(Value table, const std::string& name) {
  room(state_);
  lua_pushlstring(state_, name.data(), name.size());
  lua_insert(state_, -2);
  lua_rawset(state_, table.index());
}

void Stack::set_index(Value table, std::size_t i) { lua_rawseti(state_, table.index(), static_cast<lua_Integer>(i)); }

void Stack::set_index(Value table, std::size_t i, double value) {
  room(state_);
  lua_pushnumber(state_, value);
  lua_rawseti(state_, table.index(), static_cast<lua_Integer>(i));
}

void Stack::set_global(const std::string& name) {
  room(state_, 3);
  const int value = lua_gettop(state_);
  const Value globals = push_globals();
  lua_pushvalue(state_, value);
  set_field(globals, name);
  lua_settop(state_, value - 1);
}

Value Stack::push_global(const std::string& name) {
  room(state_);
  lua_pushglobaltable(state_);
  lua_pushlstring(state_, name.data(), name.size());
  lua_rawget(state_, -2);
  lua_remove(state_, -2);
  return top();
}

Value Stack::push_globals() {
  room(state_);
  lua_pushglobaltable(state_);
  return top();
}

Value Stack::get(Value table, Value key) {
  room(state_);
  lua_pushvalue(state_, key.index());
  lua_gettable(state_, table.index());
  return top();
}

void Stack::set(Value table, Value key, Value value) {
  room(state_);
  lua_pushvalue(state_, key.index());
  lua_pushvalue(state_, value.index());
  lua_settable(state_, table.index());
}

Value Stack::push_hidden(const std::string& name) {
  room(state_);
  luaL_getsubtable(state_, LUA_REGISTRYINDEX, ("hidden." + name).c_str());
  return top();
}

void Stack::load(std::string_view text, const std::string& chunk) {
  room(state_);
  if (luaL_loadbufferx(state_, text.data(), text.size(), chunk.c_str(), "t") == LUA_OK) return;
  const std::string message = top().text();
  lua_pop(state_, 1);
  throw Located(message + syntax_hint(message, text, !chunk.ends_with(".lua")));
}

void Stack::load_within(const std::string& hidden, std::string_view text, const std::string& chunk) {
  load(text, chunk);
  push_hidden(hidden);
  lua_setupvalue(state_, -2, 1);  // a chunk has one upvalue, _ENV
}

void Stack::call(int arguments) { lua_call(state_, arguments, LUA_MULTRET); }

void Stack::call_protected(int arguments) {
  const int handler = lua_gettop(state_) - arguments;
  lua_pushcfunction(state_, [](lua_State* state) { return Guard::explain(state); });
  lua_insert(state_, handler);
  const int status = lua_pcall(state_, arguments, LUA_MULTRET, handler);
  lua_remove(state_, handler);
  if (status == LUA_OK) return;
  Guard::pass_on(state_);
  if (status == LUA_ERRMEM) lua_error(state_);
  std::size_t size = 0;
  const char* text = lua_tolstring(state_, -1, &size);
  throw Located(text != nullptr ? std::string(text, size) : "an error was thrown that cannot be shown");
}

void Stack::push_object(std::unique_ptr<Object> object, const char* type) {
  room(state_, 3);
  static std::atomic<std::uint64_t> made = 0;
  object->number = ++made;
  // The object's size counts in the script's memory as if Lua had allocated it, so that Lua collects garbage in time.
  void* block = lua_newuserdatauv(state_, sizeof object + object->weight(), 0);
  new (block) std::unique_ptr<Object>(std::move(object));
  if (luaL_newmetatable(state_, type) != 0) {
    lua_pushcfunction(state_, collect);
    lua_setfield(state_, -2, "__gc");
  }
  lua_setmetatable(state_, -2);
}

void Stack::declare(const char* type, const Metamethods& metamethods) {
  room(state_, 3);
  if (luaL_newmetatable(state_, type) == 0) throw Fault(fmt::format("type '{}' declared twice", type));
  const Value table = top();
  lua_pushcfunction(state_, collect);
  set_field(table, "__gc");
  // The result of getmetatable; scripts cannot access the metatable itself.
  push(type);
  set_field(table, "__metatable");
  push_function(refuse_assignment);
  set_field(table, "__newindex");
  for (const auto& [name, callback] : metamethods) {
    push_function(callback);
    set_field(table, name);
  }
  lua_pop(state_, 1);
}

void Stack::on_missing(Value table, Callback missing, Callback assigned) {
  const int before = lua_gettop(state_);
  const Value meta = push_table();
  push_function(std::move(missing));
  set_field(meta, "__index");
  if (assigned) {
    push_function(std::move(assigned));
    set_field(meta, "__newindex");
  }
  push(false);
  set_field(meta, "__metatable");
  lua_setmetatable(state_, table.index());
  lua_settop(state_, before);
}

void Stack::on_call(Value table, Callback called) {
  const int before = lua_gettop(state_);
  const Value meta = push_table();
  push_function(std::move(called));
  set_field(meta, "__call");
  push(false);
  set_field(meta, "__metatable");
  lua_setmetatable(state_, table.index());
  lua_settop(state_, before);
}

}  // namespace trellis::lua
