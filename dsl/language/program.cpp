// SPDX-License-Identifier: GPL-3.0-or-later
#include <dsl/language/program.hpp>

#include <fmt/format.h>

#include <limits>
#include <numeric>

#include <trellis/base/error.hpp>

namespace trellis::dsl {

std::vector<std::uint64_t> consecutive_seeds(std::uint64_t first, std::uint64_t count) {
  constexpr std::uint64_t largest = std::numeric_limits<std::int64_t>::max();
  if (count == 0 || count > most_seeds) {
    throw Error(fmt::format("the number of seeds must be an integer in [1, {}], got {}", most_seeds, count));
  }
  if (first > largest - (count - 1)) {
    throw Error(fmt::format("{} consecutive seeds from {} go beyond the largest one, {}", count, first, largest));
  }
  std::vector<std::uint64_t> seeds(count);
  std::iota(seeds.begin(), seeds.end(), first);
  return seeds;
}

void override_seeds(Program& program, std::optional<std::uint64_t> count, std::optional<std::uint64_t> first) {
  if (!count && !first) return;
  program.seed = first.value_or(program.seed);
  program.experiment.seeds = consecutive_seeds(program.seed, count.value_or(program.experiment.seeds.size()));
}

}  // namespace trellis::dsl
