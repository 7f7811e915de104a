// SPDX-License-Identifier: GPL-3.0-or-later
// What a stopped experiment stores is restored bit by bit.
#include <cstddef>
#include <map>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include <trellis/base/error.hpp>
#include <trellis/experiment/store.hpp>
#include <trellis/experiment/stored_runs.hpp>
#include <trellis/report/report.hpp>
#include <trellis/results/records.hpp>

#include "report_fixture.hpp"
#include "support/catch.hpp"
#include "support/worlds.hpp"

using namespace trellis;

namespace {

Problem problem(const std::string& name, double wall) {
  return test::make_problem(name, test::rectangle_world({{4.0, 0.0, 5.0, wall}}), Robot::point(), {1, 1}, {9, 1});
}

/// Every field of a score has a value in one of the runs: all estimators, metrics, other seeds, unequal numbers.
Experiment experiment_of_all() {
  Experiment experiment;
  experiment.problems = {problem("low", 6.0), problem("high", 10.0)};  // the second has no path
  const PlannerSpec fine = PlannerSpec::make("rrt", {{"step", 0.2}, {"proposals", 1500.0}});
  const PlannerSpec coarse = PlannerSpec::make("rrt", {{"step", 1.5}, {"proposals", 300.0}});
  experiment.strategies = {{"fine", StrategySpec(fine)},
                           {"guided", StrategySpec(coarse, GuideSpec::make("skeleton", {}))}};
  experiment.seeds = {1, 2, 3};
  TubeSettings tube;
  tube.points = 64;
  tube.pool = 256;
  Measure measure{.target = tube, .cross = 2, .cross_levels = true, .metrics = true};
  measure.estimators = {EstimatorSpec::make("knn"), EstimatorSpec::make("exact"), EstimatorSpec::make("arc")};
  experiment.measure = measure;
  return experiment;
}

class Memory : public RunStore {
 public:
  void planned(RunResult& run) override {
    const std::scoped_lock lock(mutex_);
    const auto [at, added] = runs.emplace(key(run), run_line(facts_of(run)));
    if (added) return;
    restore_times(run, at->second);
    CHECK(at->second == run_line(facts_of(run)));
  }
  bool restore_scores(RunResult& run) override {
    const auto at = scores.find(key(run));
    if (at == scores.end()) return false;
    trellis::restore_scores(run, at->second);
    ++restored;
    return true;
  }
  void scored(const RunResult& run) override {
    const std::scoped_lock lock(mutex_);
    CHECK(scores.emplace(key(run), scores_line(run)).second);
  }
  bool restore_pooled(const std::string& problem, std::vector<PooledScores>& all) override {
    const auto at = pools.find(problem);
    if (at == pools.end()) return false;
    trellis::restore_pooled(all, at->second);
    return true;
  }
  void pooled(const std::string& problem, const std::vector<PooledScores>& all) override {
    CHECK(pools.emplace(problem, pooled_line(problem, all)).second);
  }

  using Key = std::pair<std::string, std::uint64_t>;
  static Key key(const RunResult& run) { return {run.problem + "/" + run.strategy, run.seed}; }
  std::map<Key, std::string> runs;
  std::map<Key, std::string> scores;
  std::map<std::string, std::string> pools;
  std::size_t restored = 0;

 private:
  std::mutex mutex_;
};

}  // namespace

TEST_CASE("an experiment that continues from any stored part equals one that does not", "[report]") {
  const Experiment experiment = experiment_of_all();
  Memory whole;
  const ExperimentResult first = run(experiment, {}, whole);
  REQUIRE(whole.runs.size() == 12);
  REQUIRE(whole.scores.size() == 12);
  REQUIRE(whole.pools.size() == 2);
  const std::string expected = fixture::report_json(experiment, first, "it.lua");
  // Fields that would go unnoticed if no run had them.
  const std::string stored = scores_line(first.runs.front());
  for (const char* field : {"\"others\":{\"", "\"metrics\":{", "\"along\":{", "\"oracle\":{", "\"points\":["}) {
    CAPTURE(field);
    CHECK(stored.find(field) != std::string::npos);
  }
  CHECK_FALSE(first.pooled.empty());

  for (std::size_t kept = 0; kept <= 12; kept += 4) {
    CAPTURE(kept);
    Memory part;
    part.runs = whole.runs;
    for (const auto& entry : whole.scores) {
      if (part.scores.size() < kept) part.scores.insert(entry);
    }
    if (kept == 12) part.pools = whole.pools;
    const ExperimentResult again = run(experiment, {.jobs = 2}, part);
    CHECK(part.restored == kept);
    CHECK(fixture::report_json(experiment, again, "it.lua") == expected);
    CHECK(part.scores == whole.scores);
    CHECK(part.pools == whole.pools);
    for (std::size_t i = 0; i < again.runs.size(); ++i) {
      CHECK(scores_line(again.runs[i]) == scores_line(first.runs[i]));
    }
  }
}

TEST_CASE("records of other runs and damaged ones are refused", "[report]") {
  Experiment experiment = experiment_of_all();
  experiment.problems.resize(1);
  experiment.seeds = {1};
  const ExperimentResult result = run(experiment, {});
  RunResult run = result.runs.front();
  const std::string of_two_levels = scores_line(result.runs.back());
  CHECK_THROWS_AS(restore_scores(run, of_two_levels), Error);
  CHECK_THROWS_AS(restore_scores(run, "{}"), Error);
  CHECK_THROWS_AS(restore_scores(run, "{\"levels\":"), Error);
  const auto changed = [&](const std::string& part, const std::string& by) {
    std::string line = scores_line(run);
    const auto at = line.find(part);
    REQUIRE(at != std::string::npos);
    return line.replace(at, part.size(), by);
  };
  CHECK_THROWS_WITH(restore_scores(run, changed("\"dimension\":2", "\"dimension\":3")),
                    Catch::Matchers::Contains("have 3 coordinates"));
  CHECK_THROWS_WITH(restore_scores(run, changed("\"classes\":[", "\"classes\":[77,")),
                    Catch::Matchers::Contains("a node has class 77"));
  CHECK_THROWS_AS(restore_times(run, "{}"), Error);
  std::vector<PooledScores> pooled;
  CHECK_THROWS_AS(restore_pooled(pooled, "[]"), Error);

  const std::string scored = run_line(facts_of(run));
  RunResult bare = run;
  for (LevelResult& level : bare.levels) level = LevelResult{.record = level.record, .rejections = level.rejections};
  CHECK(scored != run_line(facts_of(bare)));
  CHECK(equal_but_for_scores(scored, run_line(facts_of(bare))));
  ++bare.run.validity_checks;
  CHECK_FALSE(equal_but_for_scores(scored, run_line(facts_of(bare))));
}
