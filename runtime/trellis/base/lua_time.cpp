// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/base/lua_time.hpp>

namespace trellis {

namespace {

using Clock = std::chrono::steady_clock;

thread_local Clock::duration counted{};
thread_local unsigned timers = 0;

}  // namespace

// One reading of the clock takes about 20 ns, a tenth of the shortest call of a function in Lua; its CPU time would
// take ten times as long.
LuaTimer::LuaTimer() {
  if (timers++ == 0) begin_ = Clock::now();
}

LuaTimer::~LuaTimer() {
  if (--timers == 0) counted += Clock::now() - begin_;
}

unsigned lua_depth() { return timers; }

double lua_seconds() { return std::chrono::duration<double>(counted).count(); }

}  // namespace trellis
