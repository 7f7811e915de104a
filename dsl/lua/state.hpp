// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <exception>
#include <functional>
#include <memory>
#include <string>

#include <dsl/lua/stack.hpp>

namespace trellis::lua {

/// A Lua interpreter with a limit on its memory. One thread at a time. Lives in a shared pointer where references to
/// its values are kept.
class State : public std::enable_shared_from_this<State> {
 public:
  /// \param memory  bytes that Lua may hold
  explicit State(std::size_t memory);
  ~State();
  State(const State&) = delete;
  State& operator=(const State&) = delete;

  /// Runs `body` so that a Lua error inside becomes an Error: as it is where Trellis raised it, with a traceback where
  /// the script did. Exceptions that are no Error, thrown by `body` or by a callback, come out as they are.
  void run(const std::function<void(Stack&)>& body);

 private:
  friend struct Guard;
  friend class Reference;

  struct Budget {
    std::size_t used = 0;
    std::size_t limit = 0;
  };
  static void* allocate(void* budget, void* block, std::size_t old_size, std::size_t new_size);
  static State& of(lua_State* state);

  Budget budget_;
  lua_State* state_ = nullptr;
  std::exception_ptr fault_;  ///< what a callback threw that is no Error; scripts cannot catch it for good
  std::string raised_;        ///< the last message of ours; it needs no traceback
};

/// A value that C++ keeps beyond the call that it came in. It does not keep the interpreter, which may well hold what
/// holds the reference.
class Reference {
 public:
  Reference(const Stack& stack, Value value);
  ~Reference();
  Reference(const Reference&) = delete;
  Reference& operator=(const Reference&) = delete;

  /// Pushes the value. Of a call of the same interpreter only.
  void push(Stack& stack) const;
  /// nullptr once it is gone.
  [[nodiscard]] std::shared_ptr<State> interpreter() const { return interpreter_.lock(); }

 private:
  std::weak_ptr<State> interpreter_;
  int key_ = -2;  // in Lua's registry; LUA_NOREF at first
};

/// Opens the parts of Lua's own library that can do no harm: base, table, string, math, utf8, coroutine; no files,
/// processes, bytecode, modules or debugging.
void open_libraries(Stack& stack);

}  // namespace trellis::lua
