// SPDX-License-Identifier: GPL-3.0-or-later
// The law of bounded loss, for one run.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include <trellis/strategy/executor.hpp>

#include "support/catch.hpp"

namespace trellis::test {

/// The planner without the sub-goals of a split.
inline PlannerSpec undivided(const PlannerSpec& planner) {
  return planner.dividing() != nullptr ? undivided(planner.undivided()) : planner;
}

/// Checks the law against the planner alone on the same seed.
/// \param most  of a step; more where one call of a function of a script spends more
inline void check_law(const StrategySpec& strategy, const Problem& problem, std::uint64_t seed,
                      const RunCost& most = companion_step) {
  CAPTURE(strategy.text(), problem.name, seed);
  const RunRecord guided = execute(strategy, problem, seed);
  const RunRecord alone = execute(undivided(strategy.planner()), problem, seed);
  const BoundedLoss& law = guided.bounded;
  REQUIRE(law.bound > 1.0);
  for (const RunCost& cost : {law.guided, law.unguided, law.largest_step}) {
    REQUIRE(std::isfinite(cost.work));
    // More than any run of a test can do: a difference of unsigned counts that has wrapped.
    REQUIRE((cost.checks >= 0.0 && cost.checks < 1e12));
    REQUIRE((cost.work >= 0.0 && cost.work < 1e12));
  }
  // A search that ended within a step has a complete record.
  for (const LevelRecord& level : guided.levels) {
    const Search& search = level.search;
    const std::size_t proposals = search.proposals.size();
    REQUIRE((search.fates.size() == proposals && search.near.size() == proposals && search.added.size() == proposals));
    REQUIRE(search.proposal_sources.size() == proposals);
    REQUIRE(search.parents.size() == search.nodes.size());
    REQUIRE((search.validated.empty() || search.validated.size() == search.nodes.size()));
  }
  const auto checks = [](const RunRecord& run) { return static_cast<double>(run.validity_checks); };
  CHECK(guided.work == law.guided.work + law.unguided.work);
  CHECK(checks(guided) == law.guided.checks + law.unguided.checks);
  CHECK(law.largest_step.checks <= most.checks);
  CHECK(law.largest_step.work <= most.work);
  CHECK(guided.work <= law.bound * alone.work + law.constant.work + law.largest_step.work);
  CHECK(checks(guided) <= law.bound * checks(alone) + law.constant.checks + law.largest_step.checks);
  CHECK(law.unguided.work <= alone.work);
  CHECK(law.unguided.checks <= checks(alone));
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
    CHECK(law.unguided.work == alone.work);
    CHECK(law.unguided.checks == checks(alone));
  }
}

/// Checks that a run that was stopped has drawn the first proposals of the whole run, at every level and beside the
/// guided search.
/// \return number of proposals of the stopped run
inline std::uint64_t check_part(const RunRecord& part, const RunRecord& whole) {
  // A split adds levels while it searches.
  REQUIRE(part.levels.size() <= whole.levels.size());
  std::uint64_t drawn = 0;
  for (std::size_t i = 0; i < part.levels.size(); ++i) {
    const Search& some = part.levels[i].search;
    const Search& all = whole.levels[i].search;
    CHECK(some.fates.size() == some.proposals.size());
    drawn += some.proposals.size();
    // The last proposals of level 0 are those of the planner beside it.
    const std::uint64_t some_beside = i == 0 ? part.bounded.unguided_proposals : 0;
    const std::uint64_t all_beside = i == 0 ? whole.bounded.unguided_proposals : 0;
    const auto begins = [](const Search& search, std::size_t from, std::size_t size, const Search& longer,
                           std::size_t longer_from, std::size_t longer_size) {
      REQUIRE(size <= longer_size);
      for (std::size_t k = 0; k < size; ++k) {
        if (!std::ranges::equal(search.proposals[from + k], longer.proposals[longer_from + k])) return false;
      }
      return true;
    };
    const std::size_t own = some.proposals.size() - some_beside, all_own = all.proposals.size() - all_beside;
    CHECK(begins(some, 0, own, all, 0, all_own));
    CHECK(begins(some, own, some_beside, all, all_own, all_beside));
  }
  return drawn;
}

}  // namespace trellis::test
