// SPDX-License-Identifier: GPL-3.0-or-later
#include <dsl/lua/state.hpp>

#include <fmt/format.h>

#include <cstdlib>
#include <new>
#include <string_view>
#include <utility>

#include <dsl/lua/guard.hpp>

namespace trellis::lua {

namespace {

int run_body(lua_State* state) {
  const auto* body = static_cast<const std::function<void(Stack&)>*>(lua_touserdata(state, 1));
  lua_settop(state, 0);
  return Guard::run(state, [body](Stack& stack) {
    (*body)(stack);
    return 0;
  });
}

}  // namespace

int Guard::run(lua_State* state, const Callback& body) {
  // Raising is left until the handlers are done: Lua raises by an exception of its own, and the message is destroyed
  // as it passes. That exception is no std::exception and meets no handler here.
  std::string message;
  try {
    Stack stack(state);
    return body(stack);
  } catch (const Located& error) {
    message = error.what();
  } catch (const Error& error) {
    const auto position = Stack(state).where();
    message = (position ? position->prefix() : "") + error.what();
  } catch (const std::exception& error) {
    State::of(state).fault_ = std::current_exception();
    message = error.what();
  }
  State::of(state).raised_ = message;
  lua_settop(state, 0);
  lua_pushlstring(state, message.data(), message.size());
  return lua_error(state);
}

int Guard::explain(lua_State* state) {
  const int type = lua_type(state, 1);
  if (type == LUA_TSTRING) {
    std::size_t size = 0;
    const char* text = lua_tolstring(state, 1, &size);
    if (std::string_view(text, size) == State::of(state).raised_) return 1;
  } else if (luaL_callmeta(state, 1, "__tostring") != 0 && lua_type(state, -1) == LUA_TSTRING) {
    lua_replace(state, 1);
  } else if (type != LUA_TNUMBER) {
    lua_pushfstring(state, "an error was thrown that is no text but a %s", luaL_typename(state, 1));
    lua_replace(state, 1);
  }
  lua_settop(state, 1);
  luaL_traceback(state, state, lua_tostring(state, 1), 1);
  return 1;
}

State::State(std::size_t memory) : budget_{.limit = memory} {
  state_ = lua_newstate(&State::allocate, &budget_);
  if (state_ == nullptr) throw std::bad_alloc();
  *static_cast<State**>(lua_getextraspace(state_)) = this;
}

State::~State() { lua_close(state_); }

State& State::of(lua_State* state) { return **static_cast<State**>(lua_getextraspace(state)); }

void* State::allocate(void* budget, void* block, std::size_t old_size, std::size_t new_size) {
  auto& [used, limit] = *static_cast<Budget*>(budget);
  if (block == nullptr) old_size = 0;  // Lua says there what the block is for
  if (new_size == 0) {
    std::free(block);  // NOLINT(cppcoreguidelines-no-malloc): Lua's allocator is realloc by contract
    used -= old_size;
    return nullptr;
  }
  if (new_size > old_size && new_size - old_size > limit - used) return nullptr;
  void* grown = std::realloc(block, new_size);  // NOLINT(cppcoreguidelines-no-malloc)
  if (grown != nullptr) used += new_size - old_size;
  return grown;
}

void State::run(const std::function<void(Stack&)>& body) {
  fault_ = nullptr;
  raised_.clear();
  const int before = lua_gettop(state_);
  // None of these three allocates, so none can fail outside of protection.
  lua_pushcfunction(state_, Guard::explain);
  lua_pushcfunction(state_, run_body);
  lua_pushlightuserdata(state_, const_cast<std::function<void(Stack&)>*>(&body));  // NOLINT: only called
  const int status = lua_pcall(state_, 1, 0, before + 1);
  std::string message;
  if (status == LUA_ERRMEM) {
    message = fmt::format("the script needs more memory than the {} MiB it may use", budget_.limit >> 20U);
  } else if (status != LUA_OK) {
    std::size_t size = 0;
    const char* text = lua_tolstring(state_, -1, &size);
    message = text != nullptr ? std::string(text, size) : "an error was thrown that cannot be shown";
    // The frame of this very function tells a reader nothing.
    constexpr std::string_view own = "\n\t[C]: in ?";
    if (message.ends_with(own)) message.resize(message.size() - own.size());
  }
  lua_settop(state_, before);
  if (fault_) std::rethrow_exception(std::exchange(fault_, nullptr));
  if (status != LUA_OK) throw Located(message);
}

Reference::Reference(const Stack& stack, Value value) : interpreter_(State::of(stack.state()).weak_from_this()) {
  luaL_checkstack(stack.state(), 2, "too many values");
  lua_pushvalue(stack.state(), value.index());
  key_ = luaL_ref(stack.state(), LUA_REGISTRYINDEX);
}

Reference::~Reference() {
  // Frees a place of the registry, which allocates nothing and so cannot fail. Where the interpreter is on its way out
  // already, so is the registry.
  if (const auto interpreter = interpreter_.lock()) luaL_unref(interpreter->state_, LUA_REGISTRYINDEX, key_);
}

void Reference::push(Stack& stack) const {
  luaL_checkstack(stack.state(), 1, "too many values");
  lua_rawgeti(stack.state(), LUA_REGISTRYINDEX, key_);
}

}  // namespace trellis::lua
