// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

#include <dsl/lua/stack.hpp>

namespace trellis::dsl {

/// Puts math.random and math.randomseed on a stream of the run's: the same seed gives a script the same numbers on
/// every machine. math.random keeps Lua's meaning. math.randomseed(x) goes on as a run with seed x would from its
/// start; without x, as this run from its start.
void open_random(lua::Stack& stack, std::uint64_t seed);

}  // namespace trellis::dsl
