// SPDX-License-Identifier: GPL-3.0-or-later
// Successive halving: the winner is the known best, the budget holds, and the winner is evaluated on other seeds.
#include <algorithm>
#include <set>
#include <string>

#include "support/catch.hpp"
#include "support/worlds.hpp"

#include <trellis/experiment/tuning.hpp>

using namespace trellis;
using Catch::Matchers::Contains;

namespace {

/// Plain RRTs; the one with the longest step is by far the cheapest in the cup.
Experiment steps_of(const std::vector<double>& steps) {
  Experiment e;
  e.problems = {test::cup_problem()};
  for (const double step : steps) {
    e.strategies.emplace_back(std::to_string(step), PlannerSpec::make("rrt", {{"step", step}, {"proposals", 4000.0}}));
  }
  return e;
}

}  // namespace

SCENARIO("tuning finds the step that is known to be the best", "[experiment][tuning]") {
  GIVEN("five steps, the best one in the middle of the list") {
    const Experiment e = steps_of({0.02, 0.03, 0.6, 0.04, 0.05});
    WHEN("they are tuned with a budget of 100 runs") {
      const TuneResult result = tune(e, {.budget = 100});
      THEN("it wins, and each round removes half of the others") {
        CHECK(result.winner == 2);
        CHECK(result.strategies[2].end == TunedStrategy::End::best);
        CHECK(result.strategies[2].to_winner.equal == result.strategies[2].runs);
        CHECK(std::count_if(result.strategies.begin(), result.strategies.end(),
                            [](const TunedStrategy& s) { return s.rounds == 1; }) >= 2);
        for (const TunedStrategy& s : result.strategies) {
          CHECK(s.runs == s.seeds);
          CHECK(s.seeds <= result.seeds.size());
          CHECK(s.to_start.pairs == std::min(s.runs, result.strategies[0].runs));
        }
      }
      THEN("the budget holds, and the winner is evaluated on seeds that nothing was selected on") {
        CHECK(result.runs <= 100);
        CHECK(result.held_out.size() >= 10);
        CHECK(result.held_out.front() == result.seeds.back() + 1);
        CHECK(result.evaluation.pairs == result.held_out.size());
        CHECK(result.evaluation.less == result.held_out.size());
        CHECK(result.evaluation.ratio.hi < 0.5);
      }
    }
    WHEN("they are tuned by two threads, from another seed") {
      const TuneResult one = tune(e, {.budget = 90, .seed = 7}, {.jobs = 1});
      const TuneResult two = tune(e, {.budget = 90, .seed = 7}, {.jobs = 2});
      THEN("the result is the same") {
        CHECK(one.seeds.front() == 7);
        CHECK(one.winner == two.winner);
        for (std::size_t i = 0; i < one.strategies.size(); ++i) {
          CHECK(one.strategies[i].to_winner.ratio.value == two.strategies[i].to_winner.ratio.value);
          CHECK(one.strategies[i].end == two.strategies[i].end);
        }
      }
    }
  }
  GIVEN("a start that is the best") {
    const Experiment e = steps_of({0.6, 0.02, 0.03});
    WHEN("it is tuned") {
      const TuneResult result = tune(e, {.budget = least_tune_budget(3, 1)});
      THEN("it wins, and nothing is run on other seeds") {
        CHECK(result.winner == 0);
        CHECK(result.held_out.empty());
      }
    }
  }
}

TEST_CASE("a strategy that gives up early does not win a tuning", "[experiment][tuning]") {
  Experiment e;
  e.problems = {test::cup_problem()};
  e.strategies = {{"gives up", PlannerSpec::make("rrt", {{"step", 0.6}, {"proposals", 3.0}})},
                  {"solves", PlannerSpec::make("rrt", {{"step", 0.05}})}};
  for (const TuneBy by : {TuneBy::checks, TuneBy::length}) {
    const TuneResult result = tune(e, {.by = by, .budget = 60});
    CHECK(result.winner == 1);
    CHECK(result.strategies[0].solved == 0);
    CHECK(result.evaluation.reference_solved == 0);
  }
}

TEST_CASE("the least budget of a tuning suffices, and one run less is refused", "[experiment][tuning]") {
  for (const std::size_t n : {2U, 3U, 5U}) {
    std::vector<double> steps;
    for (std::size_t i = 0; i < n; ++i) steps.push_back(0.6 - 0.1 * static_cast<double>(i));
    Experiment e = steps_of(steps);
    e.problems.push_back(e.problems.front());
    e.problems.back().name = "again";
    const std::uint64_t least = least_tune_budget(n, 2);
    const TuneResult result = tune(e, {.budget = least});
    INFO(n << " strategies, " << least << " runs");
    CHECK(result.runs <= least);
    CHECK(result.strategies[result.winner].solved > 0);
    CHECK_THROWS_WITH(tune(e, {.budget = least - 1}),
                      Contains("is too small: ") && Contains("require at least " + std::to_string(least)));
  }
  CHECK_THROWS_WITH(tune(steps_of({0.5}), {.budget = 100}), Contains("two strategies at least, got 1"));
}
