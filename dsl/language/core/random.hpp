// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include <dsl/lua/stack.hpp>
#include <trellis/base/random.hpp>

namespace trellis::dsl {

/// A stream for functions that draw numbers; another stream may replace it temporarily.
struct RandomSource {
  explicit RandomSource(Stream stream) : own(stream), now(&own) {}
  RandomSource(const RandomSource&) = delete;
  RandomSource& operator=(const RandomSource&) = delete;

  Stream own;
  Stream* now;  ///< nullptr: drawing is not allowed now
};

/// Connects math.random and math.randomseed to a stream of the run: the same seed gives a script the same numbers on
/// every machine. math.random has Lua's semantics. math.randomseed(x) continues as a run with seed x from its start;
/// without x, as this run from its start.
std::shared_ptr<RandomSource> open_random(lua::Stack& stack, std::uint64_t seed);

/// Returns a function that draws from a stream as math.random does. Messages call it `name`.
lua::Callback random_function(std::shared_ptr<RandomSource> source, const std::string& name);
/// Returns a function that draws standard normal numbers.
lua::Callback normal_function(std::shared_ptr<RandomSource> source);

}  // namespace trellis::dsl
