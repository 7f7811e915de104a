// SPDX-License-Identifier: GPL-3.0-or-later
// Strategies without each of their guides: which runs are made, within which budget.
#include <algorithm>
#include <cstddef>
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
  for (std::size_t i = 0; i < 6; ++i) {
    CHECK(result.runs.size() == 6);
    for (const auto& [left_out, strategy] :
         {std::pair{&result.left_out[0], &without_shrink}, {&result.left_out[1], &without_skeleton}}) {
      REQUIRE(left_out->costs.size() == 6);
      const RunRecord own = execute(*strategy, experiment.problems.front(), experiment.seeds[i]);
      const double limit = most_left_out_work * result.runs[i].run.work + companion_constant.work;
      if (own.work >= limit) {
        CHECK_FALSE(left_out->costs[i].solved);
      } else {
        CHECK(left_out->costs[i].solved == own.solved);
        CHECK(left_out->costs[i].spent == static_cast<double>(own.validity_checks));
      }
    }
  }
  // The same on any number of threads.
  const ExperimentResult four = run(experiment, {.jobs = 4});
  for (std::size_t k = 0; k < 2; ++k) {
    for (std::size_t i = 0; i < 6; ++i) CHECK(four.left_out[k].costs[i].spent == result.left_out[k].costs[i].spent);
  }
  experiment.strategies.emplace_back("skeleton", without_shrink);
  const ExperimentResult beside = run(experiment);
  // Without its skeleton the second strategy is the planner alone.
  REQUIRE(beside.left_out.size() == 2);
  CHECK(beside.left_out[0].key == "0/0/0");
  CHECK(beside.left_out[1].strategy == "skeleton");
  CHECK(equal_strategy(experiment, "nested", without_shrink)->first == "skeleton");
  CHECK(equal_strategy(experiment, "skeleton", without_shrink) == nullptr);
}

TEST_CASE("runs without a guide stay within a budget of work", "[ablation]") {
  Experiment experiment = nested(8);
  SECTION("none is asked for") {
    experiment.ablation = 0.0;
    CHECK(run(experiment).left_out.empty());
  }
  SECTION("too few seeds can show nothing") {
    experiment.seeds = {1, 2, 3, 4, 5};
    CHECK(run(experiment).left_out.empty());
  }
  SECTION("less than six seeds take") {
    experiment.ablation = 1e-6;
    const ExperimentResult result = run(experiment);
    REQUIRE(result.left_out.size() == 2);
    for (const LeftOut& one : result.left_out) CHECK(one.costs.empty());
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
