// SPDX-License-Identifier: GPL-3.0-or-later
// The law of bounded loss, for one run.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include <trellis/strategy/executor.hpp>

#include "support/catch.hpp"

namespace trellis::test {

/// Checks the law against the planner alone on the same seed.
inline void check_law(const StrategySpec& strategy, const Problem& problem, std::uint64_t seed) {
  CAPTURE(strategy.text(), problem.name, seed);
  const RunRecord guided = execute(strategy, problem, seed);
  const RunRecord alone = execute(strategy.planner(), problem, seed);
  const BoundedLoss& law = guided.bounded;
  REQUIRE(law.bound > 1.0);
  CHECK(guided.work == law.guided + law.unguided);
  CHECK(guided.work <= law.bound * alone.work + law.constant + law.largest_step);
  CHECK(law.unguided <= alone.work);
  // A run that the unguided planner solves is solved.
  if (alone.solved) CHECK(guided.solved);
  // The unguided planner beside the guided search does what it does alone.
  const Search& all = guided.levels.front().search;
  const Search& search = alone.levels.front().search;
  REQUIRE(law.unguided_proposals <= search.proposals.size());
  const std::size_t begin = all.proposals.size() - law.unguided_proposals;
  for (std::size_t i = 0; i < law.unguided_proposals; ++i) {
    REQUIRE(std::ranges::equal(all.proposals[begin + i], search.proposals[i]));
    REQUIRE(all.fates[begin + i] == search.fates[i]);
  }
  if (law.unguided_won) {
    CHECK(std::ranges::equal(guided.path.values(), alone.path.values()));
    CHECK(law.unguided == alone.work);
  }
}

}  // namespace trellis::test
