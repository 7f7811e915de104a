// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <memory>
#include <optional>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include <trellis/experiment/rejections.hpp>
#include <trellis/report/glossary.hpp>
#include <trellis/report/report.hpp>
#include <trellis/report/table.hpp>
#include <trellis/report/unsolved.hpp>
#include <trellis/report/verdict.hpp>
#include <trellis/scene/planar/scene.hpp>
#include "report_fixture.hpp"
#include "support/catch.hpp"
#include "support/golden.hpp"
#include "support/worlds.hpp"

using namespace trellis;

namespace {

std::string overview(const Experiment& experiment, const ExperimentResult& result, int width = 100) {
  return report_text(experiment, result, width, ReportKind::overview);
}

bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

/// Costs of `n` pairs, `less` of which are lower than the reference's, all others higher.
PairedCosts costs(std::size_t n, std::size_t less, double ratio) {
  std::vector<CensoredCost> mine;
  std::vector<CensoredCost> reference;
  for (std::size_t i = 0; i < n; ++i) {
    reference.push_back({100.0, true});
    mine.push_back({i < less ? 50.0 : 100.0 * ratio, true});
  }
  PairedCosts result = paired_costs(mine, reference);
  result.holm_p = result.sign_p;
  return result;
}

/// A hierarchy of a root and one guide.
struct OneGuide {
  RunsSummary summary;
  std::vector<std::optional<PairedCosts>> without;
  std::optional<PairedCosts> whole;

  OneGuide() : without(2) {
    LevelSummary root;
    root.name = "root";
    root.runs = 12;
    LevelSummary guide = root;
    guide.name = "lazy()";
    guide.parent = 0;
    summary.levels = {root, guide};
  }
  void ablate(const PairedCosts& left_out) { without[1] = left_out; }
  /// Beside the baseline.
  void cost(const PairedCosts& costs) { whole = costs; }
  /// The guide's samples: mass and what it added to uniform sampling, each with an interval of ±0.1.
  void sampled(double mass, double added, std::size_t runs) {
    const auto around = [&](double value) { return Interval{value, value - 0.1, value + 0.1, runs, 0}; };
    Figure& figure = summary.levels[1].root.tree;
    figure.scored = runs;
    figure.uniform = around(2.0);
    figure.mass_part = around(mass);
    figure.spread_part = around(2.0 - added - mass);
    summary.tree_waterfall.uniform = around(2.0);
    summary.tree_waterfall.steps = {{1, -1, around(0.0), around(added), around(added)}};
  }
  [[nodiscard]] std::string verdict() const {
    const auto found = verdicts(summary, without, whole ? &*whole : nullptr);
    REQUIRE(found.size() == 2);
    CHECK(verdict_text(found[0]).empty());
    return verdict_text(found[1]);
  }
};

}  // namespace

TEST_CASE("the overview looks as it should and fits 100 columns", "[report][golden]") {
  const auto [experiment, result] = fixture::passage();
  const std::string text = overview(experiment, result);
  test::check_golden("report_overview.txt", text);
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) CHECK(display_width(line) <= 100);
}

TEST_CASE("the strategy without a level decides whether the level pays", "[report][verdict]") {
  OneGuide dearer;
  dearer.ablate(costs(12, 0, 3.0));
  CHECK(dearer.verdict() == "pays (checks)");
  OneGuide cheaper;
  cheaper.ablate(costs(12, 12, 1.0));
  CHECK(cheaper.verdict() == "costs (checks)");
  OneGuide even;
  even.ablate(costs(12, 6, 2.0));
  CHECK(even.verdict() == "not shown");
  OneGuide few;
  few.ablate(costs(4, 0, 3.0));
  CHECK(few.verdict() == "too few runs to say");
  // What its samples would say does not count against a comparison of costs.
  cheaper.sampled(0.5, 1.0, 12);
  cheaper.cost(costs(12, 12, 1.0));
  CHECK(cheaper.verdict() == "costs (checks)");
}

TEST_CASE("without an ablation the samples and the whole strategy decide", "[report][verdict]") {
  OneGuide good;
  good.sampled(0.5, 1.2, 12);
  CHECK(good.verdict() == "not shown");
  good.cost(costs(12, 12, 1.0));
  CHECK(good.verdict() == "pays (mass)");
  OneGuide dear;
  dear.sampled(1.9, 0.05, 12);
  dear.cost(costs(12, 0, 3.0));
  CHECK(dear.verdict() == "costs (checks)");
  OneGuide misleading;
  misleading.sampled(2.5, -0.6, 12);
  misleading.cost(costs(12, 12, 1.0));
  CHECK(misleading.verdict() == "misleads (mass)");
  OneGuide few;
  few.sampled(0.5, 1.2, 4);
  few.cost(costs(12, 12, 1.0));
  CHECK(few.verdict() == "too few runs to say");
  // Where the estimate is known to be wrong, the mass alone counts, and here it has not changed.
  OneGuide doubtful;
  doubtful.sampled(2.0, 1.2, 12);
  doubtful.cost(costs(12, 12, 1.0));
  CHECK(doubtful.verdict() == "pays (spread)");
  doubtful.summary.levels[1].root.tree.flags = {{"underpowered", 12}};
  CHECK(doubtful.verdict() == "not shown");
}

TEST_CASE("of two guides that are called the same each has its own ablation", "[report][verdict]") {
  const StrategySpec twice =
      GuideSpec::make("shrink", {}) >> GuideSpec::make("lazy", {}) >> GuideSpec::make("shrink", {}) >> fixture::plain();
  Experiment experiment;
  experiment.problems = {fixture::problem("passage")};
  experiment.strategies = {{"twice", twice}};
  experiment.seeds = {1};
  ablate(experiment, {"twice"});
  const std::string shrink = GuideSpec::make("shrink", {}).text_alone();
  std::vector<std::pair<std::string, std::size_t>> levels;
  for (const AblationLink& link : experiment.ablations) {
    CHECK(link.of == "twice");
    if (link.level == shrink) levels.emplace_back(link.text, link.among);
  }
  // The one nearest to the root comes first. It is replaced or skipped; nothing guides the other one.
  REQUIRE(levels.size() == 3);
  CHECK(levels[0] == std::pair<std::string, std::size_t>("without " + shrink + " #1", 0));
  CHECK(levels[1] == std::pair<std::string, std::size_t>("skipping " + shrink + " #1", 0));
  CHECK(levels[2] == std::pair<std::string, std::size_t>("without " + shrink + " #2", 1));
}

TEST_CASE("a strategy of the experiment without a level is its ablation", "[report][verdict]") {
  auto [experiment, result] = fixture::passage();
  const auto levels = [&] { return summarise(select_runs(result, "simple_passage", "nested")).levels; };
  const auto found = [&] { return costs_without_levels(experiment, result, "simple_passage", "nested", levels()); };
  for (const auto& none : found()) CHECK(!none);
  // The skeleton guides the smaller robot: without the latter it guides the lazy level.
  experiment.strategies.emplace_back("coarse", GuideSpec::make("skeleton", {}) >> GuideSpec::make("lazy", {}) >>
                                                   PlannerSpec::make("rrt", {{"step", 0.4}}));
  for (const auto seed : experiment.seeds) {
    RunResult run = fixture::nested_run("simple_passage", seed, true);
    run.strategy = "coarse";
    run.run.validity_checks *= 2;
    result.runs.push_back(std::move(run));
  }
  const auto costs = found();
  REQUIRE(costs.size() == 4);
  CHECK((!costs[0] && !costs[1] && costs[2].has_value() && !costs[3]));
  CHECK(costs[2]->ratio.value == 2.0);
  CHECK(costs[2]->holm_p < 0.001);
  CHECK(has(overview(experiment, result), "pays (checks)"));

  // A planner without a guide is what its only guide is compared with.
  Experiment single;
  single.problems = {fixture::problem("simple_passage")};
  single.strategies = {{"rrt", fixture::plain()}, {"nested", GuideSpec::make("lazy", {}) >> fixture::plain()}};
  single.seeds = experiment.seeds;
  std::vector<LevelSummary> two(2);
  two[0].name = "root";
  two[1].name = "lazy()";
  two[1].parent = 0;
  const auto alone = costs_without_levels(single, result, "simple_passage", "nested", two);
  REQUIRE(alone.size() == 2);
  REQUIRE(alone[1].has_value());
  CHECK(alone[1]->pairs == 15);
}

TEST_CASE("the baseline is the one that is named, else the first without a guide, else the first", "[report]") {
  Experiment experiment;
  experiment.problems = {fixture::problem("passage")};
  experiment.seeds = {1};
  experiment.strategies = {{"nested", fixture::nested()}};
  CHECK(baseline_of(experiment).empty());
  ablate(experiment, {"nested"});
  CHECK(baseline_of(experiment).empty());
  experiment.strategies.emplace_back("other", fixture::nested());
  CHECK(baseline_of(experiment) == "nested");
  experiment.strategies.emplace_back("rrt", fixture::plain());
  CHECK(baseline_of(experiment) == "rrt");
  experiment.baseline = "other";
  CHECK(baseline_of(experiment) == "other");
}

TEST_CASE("a run without a path says what it spent and which level stopped", "[report]") {
  const StrategySpec strategy = GuideSpec::make("shrink", {{"scale", 0.5}, {"resolves", std::int64_t{3}}}) >>
                                PlannerSpec::make("rrt", {{"proposals", 40.0}});
  std::vector<RunResult> runs;
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    RunResult run{"wall", "guided", seed, {}, {}, {}};
    const Space se2 = Space::se2({0, 10}, {0, 10});
    const bool solved = seed == 3;
    run.levels.push_back({.record = fixture::level(0, "0", "root", se2, "rrt", 20, solved)});
    const std::string name = GuideSpec::make("shrink", {{"scale", 0.5}, {"resolves", std::int64_t{3}}}).text_alone();
    run.levels.push_back({.record = fixture::level(1, "0/0", name, se2, "rrt", 20, true)});
    if (seed == 2) run.levels[1].record.solves = 2;
    fixture::total(run, solved);
    runs.push_back(std::move(run));
  }
  const std::vector<const RunResult*> all = {&runs[0], &runs[1], &runs[2]};
  const std::string text = unsolved_text(all, strategy);
  CHECK(has(text, "2 unsolved: 40 proposals spent at level 0; shrink"));
  CHECK(has(text, "reached its limit of 3 re-solves (in 1)"));
  CHECK(unsolved_text({&runs[2]}, strategy).empty());
  runs[0].run.status = Status::no_path;
  CHECK(has(unsolved_text({&runs[0]}, strategy), "1 unsolved: no path"));
}

TEST_CASE("a guide that does worse than none is said", "[report]") {
  auto [experiment, result] = fixture::passage();
  for (RunResult& run : result.runs) {
    if (run.strategy == "nested") run.run.validity_checks *= 1000;
  }
  experiment.baseline = "rrt";
  const std::string text = overview(experiment, result);
  CHECK(has(text, "warning: nested costs more validity checks than rrt, which has no guide"));
  auto [same, unchanged] = fixture::passage();
  same.baseline = "rrt";
  CHECK(!has(overview(same, unchanged), "warning"));
}

TEST_CASE("what rejects most proposals is found", "[report]") {
  const World world = test::rectangle_world({{4, 0, 5, 9}, {6, 9, 7, 10}});
  LevelRecord level = fixture::level(0, "0", "root", Space::euclidean({{0, 10}, {0, 10}}), "rrt", 1, false);
  level.scene = std::make_shared<PlanarScene>(world, Robot::point());
  level.search.nodes = Configurations(2);
  level.search.nodes.push(Configuration{1.0, 1.0});
  level.search.nodes.push(Configuration{1.0, 9.5});
  level.search.proposals = Configurations(2);
  level.search.fates.clear();
  level.search.near.clear();
  const auto propose = [&](double x, double y, std::uint32_t near, Fate fate) {
    level.search.proposals.push(Configuration{x, y});
    level.search.fates.push_back(fate);
    level.search.near.push_back(near);
  };
  for (int i = 0; i < 3; ++i) propose(9.0, 1.0 + i, 0, Fate::rejected);
  propose(9.0, 9.5, 1, Fate::rejected);
  propose(2.0, 2.0, 0, Fate::reached);
  const Rejections found = rejections(level, 0.05);
  CHECK(found.rejected == 4);
  CHECK(found.examined == 4);
  REQUIRE(found.by.size() == 2);
  CHECK(found.by[0].second == 3);
  CHECK(found.by[0].first == "obstacle 1");
  CHECK(found.by[1].first == "obstacle 2");
  CHECK(found.by[1].second == 1);
  level.presumed = true;
  CHECK(rejections(level, 0.05).rejected == 0);
}

TEST_CASE("every word of the overview is explained", "[report]") {
  std::vector<std::string> known;
  for (const ReportTerm& term : report_terms()) {
    CHECK(!term.meaning.empty());
    CHECK(std::count(known.begin(), known.end(), term.name) == 0);
    known.push_back(term.name);
  }
  for (const char* word : {"baseline", "solved", "validity checks", "p",         "ms",        "path",
                           "share",    "nats",   "above uniform",   "mass",      "spread",    "left out",
                           "verdict",  "pays",   "costs",           "misleads",  "not shown", "too few runs to say",
                           "SE",       "tree",   "expansion",       "re-solves", "oracle"}) {
    CAPTURE(word);
    CHECK(std::count(known.begin(), known.end(), word) == 1);
  }
}

TEST_CASE("the report of levels says why a level was solved again", "[report]") {
  auto [experiment, result] = fixture::passage();
  const auto levels = [&, &experiment = experiment, &result = result] {
    return report_text(experiment, result, 200, ReportKind::levels);
  };
  CHECK_FALSE(has(levels(), "solved again"));
  std::size_t runs = 0;
  for (RunResult& run : result.runs) {
    if (run.strategy != "nested") continue;
    run.levels[2].record.resolves.invalid_path = 1;
    if (++runs <= 3) run.levels[2].record.resolves.rejections = 2;
    run.levels[2].record.resolves.exhausted = runs == 1;
    run.levels[3].record.resolves.limit_reached = runs <= 2;
  }
  CHECK(has(levels(),
            "shrink(0.5): solved again 21 times: its path proved invalid in C (15), C rejected guided proposals (6); "
            "the search found no other path in 1 run"));
  CHECK(has(levels(), "skeleton(): its path was refuted and its limit of re-solves was reached in 2 runs"));
}
