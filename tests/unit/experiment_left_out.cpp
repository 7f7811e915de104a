// SPDX-License-Identifier: GPL-3.0-or-later
// Strategies without each of their guides: which runs are made, within which budget.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include <trellis/experiment/left_out.hpp>

#include "support/catch.hpp"
#include "support/worlds.hpp"

using namespace trellis;

namespace {

GuideSpec guide(const std::string& name) { return GuideSpec::make(name, {}); }
PlannerSpec rrt() { return PlannerSpec::make("rrt", {{"step", 0.5}, {"proposals", 2000.0}}); }

Experiment nested(std::size_t seeds) {
  Experiment experiment;
  experiment.problems = {test::cup_problem()};
  experiment.strategies = {{"nested", guide("skeleton") >> guide("shrink") >> rrt()}};
  for (std::size_t i = 0; i < seeds; ++i) experiment.seeds.push_back(i + 1);
  experiment.measure.reset();
  experiment.ablation = 4.0;
  return experiment;
}

}  // namespace

TEST_CASE("each guide is left out on the same seeds, unless a strategy of the experiment searches so", "[ablation]") {
  Experiment experiment = nested(6);
  const ExperimentResult result = run(experiment);
  REQUIRE(result.left_out.size() == 2);
  CHECK(result.left_out[0].key == "0/0");
  CHECK(result.left_out[1].key == "0/0/0");
  const StrategySpec without_shrink = guide("skeleton") >> rrt();
  const StrategySpec without_skeleton = guide("shrink") >> rrt();
  CHECK(result.runs.size() == 6);
  for (const auto& [left_out, strategy] :
       {std::pair{&result.left_out[0], &without_shrink}, {&result.left_out[1], &without_skeleton}}) {
    // A test takes at most 20 seeds, those after the experiment's too, and no decision takes fewer than seven.
    CHECK(left_out->pairs.size() >= 7);
    CHECK(left_out->pairs.size() <= 20);
    CHECK(left_out->work > 0.0);
    for (std::size_t i = 0; i < left_out->pairs.size(); ++i) {
      const TestedPair& pair = left_out->pairs[i];
      CAPTURE(left_out->key, i);
      CHECK(pair.seed == i + 1);
      const RunRecord with = execute(experiment.strategies.front().second, experiment.problems.front(), pair.seed);
      CHECK(pair.with.solved == with.solved);
      CHECK(pair.with.spent == static_cast<double>(with.validity_checks));
      const RunRecord own = execute(*strategy, experiment.problems.front(), pair.seed);
      if (pair.without.cut_off) {
        CHECK_FALSE(pair.without.solved);
        CHECK(pair.without.spent >= 2.0 * pair.with.spent);
        CHECK(static_cast<double>(own.validity_checks) >= pair.without.spent);
      } else {
        CHECK(pair.without.solved == own.solved);
        CHECK(pair.without.spent == static_cast<double>(own.validity_checks));
      }
    }
  }
  // The same on any number of threads.
  const ExperimentResult four = run(experiment, {.jobs = 4});
  for (std::size_t k = 0; k < 2; ++k) {
    REQUIRE(four.left_out[k].pairs.size() == result.left_out[k].pairs.size());
    CHECK(four.left_out[k].work == result.left_out[k].work);
    for (std::size_t i = 0; i < result.left_out[k].pairs.size(); ++i) {
      CHECK(four.left_out[k].pairs[i].without.spent == result.left_out[k].pairs[i].without.spent);
      CHECK(four.left_out[k].pairs[i].without.cut_off == result.left_out[k].pairs[i].without.cut_off);
    }
  }
  experiment.strategies.emplace_back("skeleton", without_shrink);
  const ExperimentResult beside = run(experiment);
  // Of the shrunken robot the experiment has both runs; without its skeleton the second strategy is the planner alone.
  for (const LeftOut& one : beside.left_out) {
    const bool free = one.strategy == "nested" && one.key == "0/0";
    REQUIRE_FALSE(one.pairs.empty());
    CHECK(one.pairs.front().seed == (free ? 7U : 1U));
  }
  CHECK(beside.left_out.back().strategy == "skeleton");
  CHECK(equal_strategy(experiment, "nested", without_shrink)->first == "skeleton");
  CHECK(equal_strategy(experiment, "skeleton", without_shrink) == nullptr);
}

TEST_CASE("runs without a guide stay within a budget of work", "[ablation]") {
  Experiment experiment = nested(8);
  SECTION("none is asked for") {
    experiment.ablation = 0.0;
    CHECK(run(experiment).left_out.empty());
  }
  SECTION("one seed is followed by the next ones") {
    experiment.seeds = {5};
    const ExperimentResult result = run(experiment);
    REQUIRE(result.left_out.size() == 2);
    for (const LeftOut& one : result.left_out) {
      REQUIRE(one.pairs.size() >= 7);
      for (std::size_t i = 0; i < one.pairs.size(); ++i) CHECK(one.pairs[i].seed == 5 + i);
    }
  }
  SECTION("no seed follows the last one") {
    experiment.seeds = {3, std::numeric_limits<std::uint64_t>::max() - 1};
    for (const LeftOut& one : run(experiment).left_out) CHECK(one.pairs.size() == 3);
  }
  SECTION("it ends after the first round that spends it") {
    experiment.ablation = 1e-6;
    const ExperimentResult result = run(experiment);
    REQUIRE(result.left_out.size() == 2);
    for (const LeftOut& one : result.left_out) CHECK(one.pairs.size() == 1);
  }
  SECTION("its size") {
    const ExperimentResult result = run(experiment);
    double work = 0.0;
    for (const RunResult& one : result.runs) work += one.run.work;
    const std::string problem = experiment.problems.front().name;
    CHECK(work < 200'000.0);
    CHECK(ablation_budget(experiment, result, problem) == 4.0 * 200'000.0);
    experiment.measure = Measure{};
    CHECK(ablation_budget(experiment, result, problem) == 4.0 * std::max(200'000.0, work + 8 * 20'000.0));
  }
}

TEST_CASE("an anytime planner is compared by its first path, cut off or not", "[ablation]") {
  Experiment experiment = nested(2);
  experiment.strategies = {{"star", guide("skeleton") >> PlannerSpec::make("rrt_star", {{"proposals", 1500.0}})}};
  const ExperimentResult result = run(experiment);
  REQUIRE(result.left_out.size() == 1);
  const auto first_path = [](const RunRecord& one) {
    return static_cast<double>(one.validity_checks - one.improvement_checks);
  };
  const StrategySpec alone{PlannerSpec::make("rrt_star", {{"proposals", 1500.0}})};
  for (const TestedPair& pair : result.left_out.front().pairs) {
    const RunRecord with = execute(experiment.strategies.front().second, experiment.problems.front(), pair.seed);
    CHECK(pair.with.spent == first_path(with));
    if (!pair.without.solved) continue;
    CHECK(pair.without.spent == first_path(execute(alone, experiment.problems.front(), pair.seed)));
  }
}

TEST_CASE("guides that no run sets up are not tested", "[ablation]") {
  Experiment experiment = nested(3);
  // The set-up is for one query alone, and the planner finds the path before it.
  const PlannerSpec planner = PlannerSpec::make("rrt", {{"queries", std::int64_t{1}}});
  experiment.strategies = {{"nested", guide("skeleton") >> guide("shrink") >> planner}};
  experiment.problems.front().goals = {experiment.problems.front().start};
  const ExperimentResult result = run(experiment);
  REQUIRE(never_set_up(experiment, result, 0, 0));
  CHECK(result.left_out.empty());
}
