// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include <dsl/lua/stack.hpp>
#include <trellis/base/random.hpp>

namespace trellis::dsl {

/// A stream that functions draw from; others may take its place for a while.
struct RandomSource {
  explicit RandomSource(Stream stream) : own(stream), now(&own) {}
  RandomSource(const RandomSource&) = delete;
  RandomSource& operator=(const RandomSource&) = delete;

  Stream own;
  Stream* now;  ///< nullptr: nothing is to be drawn now
};

/// Puts math.random and math.randomseed on a stream of the run's: the same seed gives a script the same numbers on
/// every machine. math.random keeps Lua's meaning. math.randomseed(x) goes on as a run with seed x would from its
/// start; without x, as this run from its start.
std::shared_ptr<RandomSource> open_random(lua::Stack& stack, std::uint64_t seed);

/// A function that draws from a stream as math.random does. `name` stands in messages.
lua::Callback random_function(std::shared_ptr<RandomSource> source, const std::string& name);
/// A function that draws standard normal numbers.
lua::Callback normal_function(std::shared_ptr<RandomSource> source);

}  // namespace trellis::dsl
