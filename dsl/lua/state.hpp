// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <sys/types.h>

#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <functional>
#include <limits>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include <dsl/lua/mistakes.hpp>
#include <dsl/lua/stack.hpp>

struct lua_Debug;

namespace trellis::lua {

/// The limits of one run of a script. The count of instructions is the same on every machine, and an instruction with
/// much work counts as many. The time limit applies to other slow work.
struct Limits {
  std::uint64_t instructions = std::numeric_limits<std::uint64_t>::max();
  double seconds = std::numeric_limits<double>::infinity();  ///< of the processor's time
  std::string subject = "the script";                        ///< the subject of the messages
  std::string advice;                                        ///< advice in the messages
};

/// A Lua interpreter with limits on its memory and its work. Only one thread may use it at a time. Must be in a shared
/// pointer if References to its values exist.
class State : public std::enable_shared_from_this<State> {
 public:
  struct Options {
    std::size_t memory = std::size_t{1} << 30U;          ///< limit of Lua's memory, bytes
    std::size_t longest_string = std::size_t{4} << 20U;  ///< bytes: many operations process a complete string
    std::function<void()> poll = {};                     ///< called regularly; an exception from it ends the script
    std::function<void(const std::string& message)> stuck = {};  ///< called from another thread: see `run`
  };
  explicit State(Options options);
  ~State();
  State(const State&) = delete;
  State& operator=(const State&) = delete;

  /// Runs `body`; a Lua error in it becomes an Error: unchanged if Trellis raised it, with a traceback if the script
  /// did. Exceptions of other types, from `body`, a callback or Options::poll, pass through. Ends a script that has
  /// reached its limits, even if it catches the error. If the script still does not stop, calls Options::stuck, which
  /// must not return. `body` may call run() again on the same thread: the inner run has its own counts and limits.
  /// \param limits    must outlive the call
  /// \param mistakes  receives the Errors of callbacks that a file of the user calls, except within pcall: such a call
  ///                  then raises nothing and returns a value that other calls accept (declare_failed_value)
  void run(const std::function<void(Stack&)>& body, const Limits& limits = {},
           std::vector<Mistake>* mistakes = nullptr);

 private:
  friend struct Guard;
  friend class Reference;
  using Clock = std::chrono::steady_clock;

  struct Budget {
    std::size_t used = 0;
    std::size_t limit = 0;
    std::size_t longest_string = 0;
    bool string_refused = false;  ///< the last refused block was a string that is too long
  };
  static void* allocate(void* budget, void* block, std::size_t old_size, std::size_t new_size);
  static State& of(lua_State* state);
  static void count(lua_State* state, lua_Debug* frame);

  void spend(lua_State* state, std::uint64_t instructions);
  void look_around(lua_State* state);
  [[nodiscard]] bool worked_too_long();
  void end(lua_State* state, const std::string& why);
  /// Records the faults of a callback. Returns false if they are to be raised.
  bool note(lua_State* state, const std::vector<std::string>& messages, bool located);
  [[noreturn]] static void unwind(lua_State* state);
  [[nodiscard]] std::string out_of_memory() const;
  void watch(const std::stop_token& stop);

  /// The state of one run.
  struct Work {
    const Limits* limits = nullptr;
    std::vector<Mistake>* mistakes = nullptr;
    unsigned catching = 0;     ///< calls of pcall and its like
    std::exception_ptr fault;  ///< an exception from a callback that is no Error; scripts cannot suppress it
    std::string raised;        ///< Trellis' last message; it needs no traceback
    std::uint64_t spent = 0;   ///< instructions, in whole intervals of the hook
    std::uint64_t last = std::numeric_limits<std::uint64_t>::max();  ///< a further limit of `spent`
    unsigned calls = 0;                                              ///< calls of `spend` since the last clock check
    int partial = 0;  ///< instructions of the interval that is not whole yet
    Clock::time_point begin;
    Clock::time_point looked;  ///< time of the last clock check
    bool was_slow = false;     ///< the interval before it took long
    bool ended = false;        ///< the script is being ended and cannot prevent it
    std::string ended_by;      ///< the message of that
    double begin_cpu = -1.0;   ///< processor time when the watchdog first saw this run; negative before
    std::uint64_t number = 0;  ///< of the run, for the watchdog
  };

  Options options_;
  Budget budget_;
  lua_State* state_ = nullptr;
  Work work_;             ///< the innermost run
  unsigned closing_ = 0;  ///< coroutines whose variables are being closed, one within the other
  // For the watchdog:
  std::uint64_t runs_ = 0;
  std::atomic<std::uint64_t> active_run_ = 0;  ///< the number of the active run; 0: none
  std::atomic<double> watched_seconds_ = 0.0;
  std::atomic<clockid_t> clock_ = 0;  ///< processor clock of its thread
  std::mutex watching_;               ///< the watchdog locks it except while it sleeps
  std::jthread watchdog_;
};

/// A reference to a Lua value that outlives the call. It does not keep the interpreter alive, because the interpreter
/// may own the owner of the reference.
class Reference {
 public:
  Reference(const Stack& stack, Value value);
  ~Reference();
  Reference(const Reference&) = delete;
  Reference& operator=(const Reference&) = delete;

  /// Pushes the value. Only in a call of the same interpreter.
  void push(Stack& stack) const;
  /// Returns nullptr after the interpreter's end.
  [[nodiscard]] std::shared_ptr<State> interpreter() const { return interpreter_.lock(); }

 private:
  std::weak_ptr<State> interpreter_;
  int key_ = -2;  // in Lua's registry; LUA_NOREF at first
};

/// The message of State::run for a script that has reached its limits or used up its memory.
class Exhausted : public Located {
 public:
  using Located::Located;
};

/// Opens the safe parts of Lua's library: base, table, string, math, utf8, coroutine; no files, processes, bytecode,
/// modules or debugging. Functions without a bound on their work in one call count it.
/// \param trust  opens io, os and debug too
void open_libraries(Stack& stack, bool trust = false);

}  // namespace trellis::lua
