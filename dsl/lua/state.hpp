// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <exception>
#include <functional>
#include <string>

#include <dsl/lua/stack.hpp>

namespace trellis::lua {

/// A Lua interpreter with a limit on its memory. One thread at a time.
class State {
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

/// Opens the parts of Lua's own library that can do no harm: base, table, string, math, utf8, coroutine; no files,
/// processes, bytecode, modules or debugging.
void open_libraries(Stack& stack);

}  // namespace trellis::lua
