// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/experiment/unused.hpp>

#include "support/catch.hpp"
#include "support/worlds.hpp"

using namespace trellis;
using Catch::Matchers::Contains;

namespace {

GuideSpec written(const std::string& name, int line) { return GuideSpec::make(name, {}, {}, {"script.lua", line}); }

Experiment experiment(const StrategySpec& strategy) {
  Experiment e;
  e.problems = {test::cup_problem()};
  e.strategies = {{"guided", strategy}, {"plain", PlannerSpec::make("rrt", {{"step", 0.5}})}};
  e.seeds = {1, 2};
  e.measure.reset();
  return e;
}

/// Removes all proposals of a guide from the tree of a level.
void turn_away(ExperimentResult& result, const std::string& key) {
  for (RunResult& run : result.runs) {
    for (LevelResult& level : run.levels) {
      Search& search = level.record.search;
      if (level.record.key != key) continue;
      for (std::size_t i = 0; i < search.added.size(); ++i) {
        if (search.proposal_sources[i] >= 3) search.added[i] = no_node;
      }
    }
  }
}

}  // namespace

TEST_CASE("a guide whose proposals never entered a tree is reported, with its line and level", "[experiment][unused]") {
  const auto e =
      experiment(written("skeleton", 3) >> written("shrink", 4) >> PlannerSpec::make("rrt", {{"step", 0.2}}));
  auto result = run(e);
  CHECK(unused_guides(e, result).empty());
  turn_away(result, "0");
  const auto sentences = unused_guides(e, result);
  REQUIRE(sentences.size() == 1);
  CHECK_THAT(sentences[0], Contains("script.lua:4: strategy 'guided', rrt, level 0: shrink(0.5) drew "));
  CHECK_THAT(sentences[0], Contains(" proposals in 2 runs, and none of them entered the tree"));
}

TEST_CASE("a guide that never drew is reported where no path was found", "[experiment][unused]") {
  const auto unheard = written("shrink", 7) >> PlannerSpec::make("rrt", {{"uniform", 1.0}, {"proposals", 40.0}});
  const auto e = experiment(unheard);
  const auto result = run(e);
  REQUIRE_FALSE(result.runs.front().run.solved);
  CHECK(unused_guides(e, result) ==
        std::vector<std::string>{
            "script.lua:7: strategy 'guided', rrt, level 0: shrink(0.5) drew none of the 80 proposals in 2 runs"});
  // A guide whose strategy found a path is not reported.
  const auto quick = experiment(sequence({written("lazy", 1), written("shrink", 2)}, 50'000) >>
                                PlannerSpec::make("rrt", {{"step", 0.5}}));
  CHECK(unused_guides(quick, run(quick)).empty());
}
