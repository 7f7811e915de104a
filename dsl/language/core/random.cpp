// SPDX-License-Identifier: GPL-3.0-or-later
#include <dsl/language/core/random.hpp>

#include <fmt/format.h>

#include <bit>
#include <utility>

namespace trellis::dsl {

namespace {

using lua::Stack;
using lua::Value;

Stream stream_of(std::uint64_t seed) { return {seed, "script", "math.random"}; }

std::int64_t integer_argument(Stack& call, int i, const std::string& name) {
  const auto value = call[i].integer();
  if (!value) throw Error(fmt::format("{}: argument {} must be an integer, got {}", name, i, call[i].describe()));
  return *value;
}

int draw(Stack& call, Stream& stream, const std::string& name) {
  if (call.count() == 0) return call.result(stream.uniform());
  if (call.count() > 2) throw Error(fmt::format("{}: takes at most 2 arguments, got {}", name, call.count()));
  std::int64_t lo = 1;
  std::int64_t hi = integer_argument(call, call.count(), name);
  if (call.count() == 2) {
    lo = integer_argument(call, 1, name);
  } else if (hi == 0) {
    return call.result(static_cast<std::int64_t>(stream.bits()));  // all bits random, as in Lua
  }
  if (lo > hi) throw Error(fmt::format("{}: the interval from {} to {} is empty", name, lo, hi));
  // Unsigned arithmetic wraps, so that the widest intervals are correct too.
  const std::uint64_t size = static_cast<std::uint64_t>(hi) - static_cast<std::uint64_t>(lo) + 1;
  const std::uint64_t offset = size == 0 ? stream.bits() : stream.below(size);
  return call.result(static_cast<std::int64_t>(static_cast<std::uint64_t>(lo) + offset));
}

/// Integers and equal floats give one seed, as in Lua; any other number gives its bits.
std::uint64_t seed_argument(Stack& call) {
  if (const auto whole = call[1].integer()) return static_cast<std::uint64_t>(*whole);
  if (const auto number = call[1].number()) return std::bit_cast<std::uint64_t>(*number);
  throw Error(fmt::format("math.randomseed: the seed must be a number, got {}", call[1].describe()));
}

Stream& stream_now(const RandomSource& source, const std::string& name) {
  if (source.now != nullptr) return *source.now;
  throw Error(
      fmt::format("{}: draws only while the function that it was given to is called; math.random draws always", name));
}

}  // namespace

lua::Callback random_function(std::shared_ptr<RandomSource> source, const std::string& name) {
  return [source = std::move(source), name](Stack& call) { return draw(call, stream_now(*source, name), name); };
}

lua::Callback normal_function(std::shared_ptr<RandomSource> source) {
  return [source = std::move(source)](Stack& call) { return call.result(stream_now(*source, "normal").normal()); };
}

std::shared_ptr<RandomSource> open_random(Stack& stack, std::uint64_t seed) {
  auto source = std::make_shared<RandomSource>(stream_of(seed));
  const int before = stack.size();
  const Value math = stack.push_global("math");
  stack.push_function(random_function(source, "math.random"));
  stack.set_field(math, "random");
  stack.push_function([source, seed](Stack& call) {
    const std::uint64_t key = call.count() == 0 ? seed : seed_argument(call);
    *source->now = stream_of(key);
    return call.result(static_cast<std::int64_t>(key));
  });
  stack.set_field(math, "randomseed");
  stack.resize(before);
  return source;
}

}  // namespace trellis::dsl
