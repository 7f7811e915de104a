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

#include <dsl/lua/stack.hpp>

struct lua_Debug;

namespace trellis::lua {

/// What one run of a script may spend. Instructions are counted alike on every machine, and what takes long in one
/// instruction counts as many; the time is there for what is slow all the same.
struct Limits {
  std::uint64_t instructions = std::numeric_limits<std::uint64_t>::max();
  double seconds = std::numeric_limits<double>::infinity();  ///< of the processor's time
  std::string subject = "the script";                        ///< what messages say has spent them
  std::string advice;                                        ///< what to do about it
};

/// A Lua interpreter with limits on its memory and its work. One thread at a time. Lives in a shared pointer where
/// references to its values are kept.
class State : public std::enable_shared_from_this<State> {
 public:
  struct Options {
    std::size_t memory = std::size_t{1} << 30U;                  ///< bytes that Lua may hold
    std::size_t longest_string = std::size_t{4} << 20U;          ///< bytes: many operations go through all of one
    std::function<void()> poll = {};                             ///< asked now and then; what it throws ends the script
    std::function<void(const std::string& message)> stuck = {};  ///< called from another thread: see `run`
  };
  explicit State(Options options);
  ~State();
  State(const State&) = delete;
  State& operator=(const State&) = delete;

  /// Runs `body` so that a Lua error inside becomes an Error: as it is where Trellis raised it, with a traceback where
  /// the script did. Exceptions that are no Error, thrown by `body`, by a callback or by Options::poll, come out as
  /// they are. A script that has spent its limits is ended, whatever it catches. Where even that does not stop it,
  /// Options::stuck is called, which must not return to it. May be called within a call of itself, on the same thread:
  /// what the inner run spends is counted by itself, against its own limits.
  /// \param limits  outlive the call
  void run(const std::function<void(Stack&)>& body, const Limits& limits = {});

 private:
  friend struct Guard;
  friend class Reference;
  using Clock = std::chrono::steady_clock;

  struct Budget {
    std::size_t used = 0;
    std::size_t limit = 0;
    std::size_t longest_string = 0;
    bool string_refused = false;  ///< what was refused last was a string too long
  };
  static void* allocate(void* budget, void* block, std::size_t old_size, std::size_t new_size);
  static State& of(lua_State* state);
  static void count(lua_State* state, lua_Debug* frame);

  void spend(lua_State* state, std::uint64_t instructions);
  void look_around(lua_State* state);
  [[nodiscard]] bool worked_too_long();
  void end(lua_State* state, const std::string& why);
  [[noreturn]] static void unwind(lua_State* state);
  [[nodiscard]] std::string out_of_memory() const;
  void watch(const std::stop_token& stop);

  /// One run.
  struct Work {
    const Limits* limits = nullptr;
    std::exception_ptr fault;  ///< what a callback threw that is no Error; scripts cannot catch it for good
    std::string raised;        ///< the last message of ours; it needs no traceback
    std::uint64_t spent = 0;   ///< instructions
    unsigned calls = 0;        ///< of `spend` since the clock was looked at
    Clock::time_point begin;
    Clock::time_point looked;  ///< when the clock was looked at last
    bool ended = false;        ///< the script is being ended: nothing it does stops that
    std::string ended_by;      ///< the message of that
    double begin_cpu = -1.0;   ///< processor time when this run was seen to last; negative before
    std::uint64_t number = 0;  ///< of the run, for the watchdog
  };

  Options options_;
  Budget budget_;
  lua_State* state_ = nullptr;
  Work work_;  ///< the innermost run
  // For the watchdog:
  std::uint64_t runs_ = 0;
  std::atomic<std::uint64_t> at_work_ = 0;  ///< the run that is at work; 0: none
  std::atomic<double> watched_seconds_ = 0.0;
  std::atomic<clockid_t> clock_ = 0;  ///< of the processor time of the thread that runs it
  std::mutex watching_;               ///< held by the watchdog but while it sleeps
  std::jthread watchdog_;
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
/// processes, bytecode, modules or debugging. What could work without end in one call counts its work.
/// \param trust  io, os and debug too
void open_libraries(Stack& stack, bool trust = false);

}  // namespace trellis::lua
