// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <chrono>

namespace trellis {

/// Counts the time of its life as time that this thread spends in functions in Lua. Timers nest; the outermost counts.
class LuaTimer {
 public:
  LuaTimer();
  ~LuaTimer();
  LuaTimer(const LuaTimer&) = delete;
  LuaTimer& operator=(const LuaTimer&) = delete;

 private:
  std::chrono::steady_clock::time_point begin_;
};

/// Returns the wall-clock time that the LuaTimers of this thread have counted, in seconds. The difference of two calls
/// is the time in between; timers that have not ended do not count.
double lua_seconds();

/// Returns the number of LuaTimers of this thread: more than before where a function in Lua has been called since.
unsigned lua_depth();

}  // namespace trellis
