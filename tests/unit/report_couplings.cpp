// SPDX-License-Identifier: GPL-3.0-or-later
// Who needs coordination: teams of which it is known, and the runs in which robots pass through each other.
#include <algorithm>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include <trellis/collision/checker.hpp>
#include <trellis/experiment/uncoupled_runs.hpp>
#include <trellis/guide/team.hpp>
#include <trellis/report/couplings.hpp>
#include <trellis/report/experiment_summary.hpp>
#include <trellis/report/report.hpp>
#include <trellis/results/records.hpp>
#include <trellis/scene/planar/scene.hpp>
#include <trellis/scene/uncoupled.hpp>

#include "support/catch.hpp"
#include "support/worlds.hpp"

using namespace trellis;
using Catch::Matchers::Contains;

namespace {

using Robots = std::vector<std::size_t>;

/// A corridor that is too narrow for two discs to pass, with a bay half-way, and a room beside it. Discs 1 and 2 change
/// places in the corridor, disc 3 moves in the room.
Problem corridor() {
  return test::make_problem(
      "corridor", test::rectangle_world({{0, 0, 10, 0.5}, {0, 1.5, 4.4, 3}, {5.6, 1.5, 10, 3}, {4.4, 2.6, 5.6, 3}}),
      Robot::team({Robot::disc(0.4), Robot::disc(0.4), Robot::disc(0.4)}), {1, 1, 9, 1, 2, 7}, {9, 1, 1, 1, 8, 7});
}

/// Discs that move side by side, far from each other.
Problem lanes() {
  return test::make_problem("lanes", test::rectangle_world({{0, 3, 10, 3.5}, {0, 6, 10, 6.5}}),
                            Robot::team(std::vector(3, Robot::disc(0.4))), {1, 1, 1, 5, 1, 9}, {9, 1, 9, 5, 9, 9});
}

Experiment experiment_of(std::vector<Problem> problems,
                         const std::vector<std::pair<std::string, std::vector<Options::Entry>>>& guides) {
  Experiment experiment;
  experiment.problems = std::move(problems);
  for (const auto& [guide, options] : guides) {
    experiment.strategies.emplace_back(
        options.empty() ? guide : guide + " path",
        GuideSpec::make(guide, options) >> PlannerSpec::make("rrt_connect", {{"bound", 0.0}}));
  }
  for (std::uint64_t seed = 1; seed <= 8; ++seed) experiment.seeds.push_back(seed);
  experiment.measure.reset();
  experiment.ablation = 100.0;
  return experiment;
}

const CouplingSummary* find(const std::vector<CouplingSummary>& all, const Robots& robots) {
  const auto found = std::find_if(all.begin(), all.end(), [&](const auto& one) { return one.robots == robots; });
  return found == all.end() ? nullptr : &*found;
}

}  // namespace

TEST_CASE("robots that are uncoupled pass through each other, and through nothing else", "[teams]") {
  const Robot team = Robot::team({Robot::disc(0.5), test::rectangle_robot(1.0, 0.4), Robot::disc(0.5)});
  const auto scene = std::make_shared<PlanarScene>(test::rectangle_world({{7, 0, 10, 10}}), team);
  const Space space = scene->default_space(1.0);
  const std::shared_ptr<const Scene> apart = uncoupled(*scene, {{1, 3}});
  REQUIRE(apart);
  const Configuration on_one_place = {3, 3, 3, 6, 0, 3, 3};
  const Configuration with_bar = {3, 3, 3, 3, 0, 3, 8};
  const Configuration in_obstacle = {3, 3, 3, 6, 0, 8, 3};
  for (const char* backend : {"planar", "fcl"}) {
    CAPTURE(backend);
    CHECK_FALSE(make_checker(backend, scene, space, 0.05)->valid(on_one_place));
    CHECK(make_checker(backend, apart, space, 0.05)->valid(on_one_place));
    CHECK_FALSE(make_checker(backend, apart, space, 0.05)->valid(with_bar));
    CHECK_FALSE(make_checker(backend, apart, space, 0.05)->valid(in_obstacle));
    // Scenes of guiding spaces keep it: of robots 1 and 3 alone, and of smaller robots.
    const auto part = apart->reduced({0, 1, 5, 6});
    REQUIRE(part);
    const Space both("both", {space.axes()[0], space.axes()[1], space.axes()[5], space.axes()[6]});
    CHECK(make_checker(backend, part, both, 0.05)->valid(Configuration{3, 3, 3, 3}));
    CHECK_FALSE(make_checker(backend, scene->reduced({0, 1, 5, 6}), both, 0.05)->valid(Configuration{3, 3, 3, 3}));
    CHECK(make_checker(backend, apart->shrunken(0.5), space, 0.05)->valid(on_one_place));
    CHECK_FALSE(make_checker(backend, apart->shrunken(0.5), space, 0.05)->valid(with_bar));
  }
}

TEST_CASE("of two discs that change places in a corridor and one far away, the two need coordination", "[teams]") {
  const Experiment experiment =
      experiment_of({corridor()}, {{"couple", {}}, {"prioritise", {}}, {"couple", {{"where", std::string("path")}}}});
  const ExperimentResult result = run(experiment);
  const ExperimentFacts facts = facts_of(experiment, result);
  for (const auto& [strategy, spec] : experiment.strategies) {
    CAPTURE(strategy);
    const std::vector<CouplingSummary> couplings = couplings_of(facts, "corridor", strategy);
    for (const Robots& robots : {Robots{}, Robots{1}, Robots{2}, Robots{1, 2}}) {
      const CouplingSummary* one = find(couplings, robots);
      REQUIRE(one != nullptr);
      CAPTURE(one->name());
      CHECK(coupling_text(*one) == "needed");
      CHECK(one->needed.value == 1.0);
      CHECK(one->needed.n >= 7);
      CHECK(one->check_ratio.median.hi == 0.0);
    }
    const CouplingSummary* third = find(couplings, {3});
    REQUIRE(third != nullptr);
    CHECK(coupling_text(*third) == "not needed");
    CHECK(third->needed.value == 0.0);
    CHECK(third->conflicts == 0);
    CHECK(find(couplings, {1, 2})->conflicts == find(couplings, {1, 2})->runs);
    // Its pairs are not tested.
    CHECK(find(couplings, {1, 3}) == nullptr);
    CHECK(find(couplings, {2, 3}) == nullptr);
    if (strategy == "prioritise") continue;
    const CouplingSummary* pair = find(couplings, {1, 2});
    const auto by = [&](TeamConflict::Resolved how) { return pair->resolved[static_cast<std::size_t>(how)]; };
    CHECK(by(TeamConflict::Resolved::one_by_one) + by(TeamConflict::Resolved::together) >= 8);
    CHECK(by(TeamConflict::Resolved::none) == 0);
    CHECK(by(TeamConflict::Resolved::schedule) == 0);
    CHECK(pair->checks > 0);
  }
  // The document has it all, and reads back to the same report.
  const ExperimentSummary summary = summarise(facts);
  const std::string document = report_json(facts, summary);
  const ExperimentFacts stored = read_results(document, "results.json");
  CHECK(report_json(stored, summarise(stored)) == document);
  const std::string text = report_text(summary, 120, ReportKind::overview);
  CHECK_THAT(text, Contains("Who needs coordination? couple"));
  const std::string csv = couplings_csv(summary);
  CHECK_THAT(csv, Contains("corridor,couple,1 2,7,7,"));
  CHECK_THAT(csv, Contains("corridor,couple,3,7,0,"));
  // The same on any number of threads.
  CHECK(couplings_csv(summarise(facts_of(experiment, run(experiment, {.jobs = 4})))) == csv);
}

TEST_CASE("robots that never meet need no coordination", "[teams]") {
  const Experiment experiment = experiment_of({lanes()}, {{"couple", {}}, {"prioritise", {}}, {"decouple", {}}});
  const ExperimentFacts facts = facts_of(experiment, run(experiment));
  for (const auto& [strategy, spec] : experiment.strategies) {
    CAPTURE(strategy);
    const std::vector<CouplingSummary> couplings = couplings_of(facts, "lanes", strategy);
    // One test decides: all robots pass through each other, and no path touches.
    REQUIRE(couplings.size() == 1);
    CHECK(couplings.front().robots.empty());
    CHECK(coupling_text(couplings.front()) == "not needed");
    CHECK(couplings.front().conflicts == 0);
    CHECK(couplings.front().needed.hi < 0.4);
  }
}

TEST_CASE("a strategy without a division of the team, and a budget of none, test no coupling", "[teams]") {
  Experiment experiment = experiment_of({lanes()}, {{"couple", {}}});
  experiment.strategies.front().second = StrategySpec(PlannerSpec::make("drrt", {}));
  CHECK(run(experiment).uncoupled.empty());
  experiment = experiment_of({lanes()}, {{"couple", {}}});
  experiment.ablation = 0.0;
  CHECK(run(experiment).uncoupled.empty());
}

TEST_CASE("discs that cross are resolved by waiting", "[teams]") {
  // Paths alone meet in the middle; the schedule lets one wait.
  const Problem crossing = test::make_problem(
      "crossing", test::rectangle_world({{0, 0, 4, 4}, {6, 0, 10, 4}, {0, 6, 4, 10}, {6, 6, 10, 10}}),
      Robot::team({Robot::disc(0.6), Robot::disc(0.6)}), {1, 5, 5, 1}, {9, 5, 5, 9});
  Experiment experiment = experiment_of({crossing}, {{"decouple", {}}});
  const ExperimentFacts facts = facts_of(experiment, run(experiment));
  const std::vector<CouplingSummary> couplings = couplings_of(facts, "crossing", "decouple");
  REQUIRE(couplings.size() == 1);
  CHECK(coupling_text(couplings.front()) == "needed");
  CHECK(couplings.front().resolved[static_cast<std::size_t>(TeamConflict::Resolved::schedule)] == 8);
}
