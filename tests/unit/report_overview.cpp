// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <limits>
#include <memory>
#include <optional>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include <trellis/experiment/cell.hpp>
#include <trellis/experiment/rejections.hpp>
#include <trellis/report/experiment_summary.hpp>
#include <trellis/report/report.hpp>
#include <trellis/report/verdict.hpp>
#include <trellis/report/views/glossary.hpp>
#include <trellis/report/views/table.hpp>
#include <trellis/scene/planar/scene.hpp>
#include "report_fixture.hpp"
#include "support/catch.hpp"
#include "support/golden.hpp"
#include "support/worlds.hpp"

using namespace trellis;

namespace {

std::string overview(const Experiment& experiment, const ExperimentResult& result, int width = 100) {
  return report_text(summarise(facts_of(experiment, result)), width, ReportKind::overview);
}

bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

/// Ratios of pairs, the first `less` of which are a half and the others `ratio`.
std::vector<RatioBracket> ratios(std::size_t n, std::size_t less, double ratio = 2.0) {
  std::vector<RatioBracket> all(n, {ratio, ratio});
  std::fill_n(all.begin(), less, RatioBracket{0.5, 0.5});
  return all;
}

Verdict decide_alone(const std::vector<RatioBracket>& of) {
  return verdict_of(decide_in_rounds(std::vector<std::vector<RatioBracket>>{of})[0], of, 1, 1);
}

std::string decided(const std::vector<RatioBracket>& of) { return verdict_text(decide_alone(of)); }

}  // namespace

TEST_CASE("the overview looks as it should and fits 100 columns", "[report][golden]") {
  const auto [experiment, result] = fixture::passage();
  const std::string text = overview(experiment, result);
  test::check_golden("report_overview.txt", text);
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) CHECK(display_width(line) <= 100);
}

TEST_CASE("costs with and without a guide decide whether it pays", "[report][verdict]") {
  CHECK(decided(ratios(12, 12)) == "pays ×0.5 [0.5, 0.5] (12 seeds)");
  CHECK(decided(ratios(12, 0, 3.0)) == "costs ×3 [3, 3] (12 seeds)");
  CHECK(decided(ratios(12, 0, 250.0)) == "costs ×250 [250, 250] (12 seeds)");
  CHECK(decided(ratios(12, 0, 1.125)) == "costs ×1.1 [1.1, 1.1] (12 seeds)");
  CHECK(decided(ratios(12, 0, 1.03125)) == "costs ×1.03 [1.03, 1.03] (12 seeds)");
  CHECK(decided(ratios(12, 0, 1.0)) == "changes nothing: the same cost on 12 seeds");
  std::vector<RatioBracket> near(12, {0.95, 0.95});
  for (std::size_t i = 0; i < near.size(); i += 2) near[i] = {1.1, 1.1};
  CHECK(decided(near) == "no difference above ×1.25 [0.95, 1.1] (12 seeds)");
  CHECK(decided(ratios(12, 6)) == "not shown [0.5, 2] (12 seeds)");
  CHECK(decided(ratios(6, 6)) == "not shown (6 seeds); ~8 seeds would probably show it");
  CHECK(decided({}) == "not tested");
  // Runs that were cut off bound the ratio; a strategy that finds no path without the guide pays.
  CHECK(decided(std::vector<RatioBracket>(8, {0.0, 0.05})) == "pays ×0.05 or less [0, 0.05] (8 seeds)");
  CHECK(decided(std::vector<RatioBracket>(8, {0.0, 0.0})) == "pays ×0 [0, 0] (8 seeds)");
  const double infinity = std::numeric_limits<double>::infinity();
  CHECK(decided(std::vector<RatioBracket>(8, {infinity, infinity})) == "costs ×inf [inf, inf] (8 seeds)");

  Verdict verdict = verdict_of(SequentialDecision::open, ratios(12, 6), 1, 1);
  verdict.more_ablation = 4.0;
  CHECK(verdict_text(verdict) == "not shown [0.5, 2] (12 seeds); budget spent: --ablation 4");
  verdict = decide_alone(ratios(12, 0, 1.0));
  verdict.unsolved = true;
  CHECK(verdict_text(verdict) == "changes nothing: no path on 12 seeds");
  verdict = {};
  verdict.kind = Verdict::Kind::never_set_up;
  verdict.runs = 20;
  CHECK(verdict_text(verdict) == "never set up (20 runs)");
}

TEST_CASE("a row that is the strategy without a guide has the inverse ratio", "[report][verdict]") {
  const auto without = [](const std::vector<RatioBracket>& of) { return verdict_text_without(decide_alone(of)); };
  CHECK(without(ratios(12, 12)) == "2 [2, 2] keep it");
  CHECK(without(ratios(12, 0, 4.0)) == "0.25 [0.25, 0.25] drop it");
  CHECK(without(std::vector<RatioBracket>(8, {0.0, 0.05})) == "20 or more [20, inf] keep it");
  CHECK(without(ratios(12, 0, 1.0)) == "changes nothing: the same cost on 12 seeds");
}

TEST_CASE("all guides together are compared with the planner alone", "[report][verdict]") {
  auto [experiment, result] = fixture::passage();
  const auto whole = whole_verdict(facts_of(experiment, result), "simple_passage", "nested");
  REQUIRE(whole.has_value());
  CHECK(whole->reference == "rrt");
  CHECK(whole->verdict.kind == Verdict::Kind::pays);
  // It is the comparison of the strategy's row.
  CHECK_FALSE(has(overview(experiment, result), "all guides"));
  CHECK(
      has(report_text(summarise(facts_of(experiment, result)), 100, ReportKind::levels), "all guides together: pays"));
  CHECK_FALSE(whole_verdict(facts_of(experiment, result), "simple_passage", "rrt").has_value());
}

TEST_CASE("the guides of a strategy are a family of tests", "[report][verdict]") {
  const auto [experiment, result] = fixture::passage();
  const std::vector<GuideVerdict> found = guide_verdicts(facts_of(experiment, result), false);
  REQUIRE(found.size() == 3);
  for (const GuideVerdict& one : found) {
    CHECK(one.problem == "simple_passage");
    CHECK(one.strategy == "nested");
    CHECK(one.verdict.counts.pairs == 15);
    CHECK(one.verdict.tests == 3);
  }
  CHECK(found[0].verdict.kind == Verdict::Kind::not_shown);
  CHECK(found[1].verdict.kind == Verdict::Kind::costs);
  CHECK(found[2].verdict.kind == Verdict::Kind::pays);
  CHECK(found[1].verdict.ratio.median.lo == 2.0);

  // The verdict does not depend on the samples; they explain it.
  const auto summary = fixture::summary_of(result, "simple_passage", "nested");
  const auto levels = level_verdicts(found, "simple_passage", "nested", summary);
  REQUIRE(levels.size() == 4);
  CHECK(levels[0].kind == Verdict::Kind::none);
  for (std::size_t i = 1; i < 4; ++i) CHECK(levels[i].kind == found[i - 1].verdict.kind);
  auto [same, unscored] = fixture::passage();
  same.measure.reset();
  for (RunResult& run : unscored.runs) {
    for (LevelResult& level : run.levels) level.root = level.own = {};
  }
  const auto without = level_verdicts(guide_verdicts(facts_of(same, unscored), false), "simple_passage", "nested",
                                      fixture::summary_of(unscored, "simple_passage", "nested"));
  for (std::size_t i = 0; i < 4; ++i) {
    CHECK(without[i].kind == levels[i].kind);
    CHECK(without[i].reason.empty());
  }
  CHECK(level_verdicts(found, "simple_passage", "rrt", summary).empty());
}

TEST_CASE("a level that was not left out is not tested, whatever its samples are", "[report][verdict]") {
  auto [experiment, result] = fixture::passage();
  result.left_out.erase(result.left_out.begin());
  result.left_out.front().pairs.clear();
  const std::string text = overview(experiment, result);
  CHECK(has(text, "not tested"));
  CHECK_FALSE(has(text, "drop it"));
  CHECK_FALSE(has(text, "leave out"));
  CHECK(has(text, "trellis run --ablation 2, or trellis sweep --ablate, tests which levels pay"));
}

TEST_CASE("a verdict that is not shown says that the budget is spent", "[report][verdict]") {
  auto [experiment, result] = fixture::passage();
  experiment.ablation = 2.0;
  result.left_out[1].pairs.resize(5);
  const std::string text = overview(experiment, result);
  CHECK(has(text, "budget spent: --ablation 4"));
  CHECK(has(text, "--ablation 4 allows more work"));
}

TEST_CASE("advice to leave a level out comes from runs without it", "[report][verdict]") {
  const auto [experiment, result] = fixture::passage();
  CHECK(has(overview(experiment, result),
            "leave out shrink(0.5) of nested: without it the strategy takes 0.50 times the validity checks"));
}

TEST_CASE("an anytime planner is compared by its first path", "[report][verdict]") {
  auto [experiment, result] = fixture::passage();
  for (RunResult& run : result.runs) {
    if (run.strategy != "nested") continue;
    run.levels.front().record.planner = "rrt_star";
    run.run.improvement_checks = 100 * run.run.validity_checks;
    run.run.validity_checks += run.run.improvement_checks;
  }
  const std::string text = overview(experiment, result);
  CHECK(has(text, "after the first path, for shorter ones, medians: nested 627,000 checks\n"));
  CHECK_FALSE(has(text, "warning"));
  const auto [before, unchanged] = fixture::passage();
  const auto compared = whole_verdict(facts_of(experiment, result), "simple_passage", "nested");
  CHECK(compared->verdict.ratio.median.lo ==
        whole_verdict(facts_of(before, unchanged), "simple_passage", "nested")->verdict.ratio.median.lo);
  CHECK_FALSE(has(overview(before, unchanged), "after the first path"));
}

TEST_CASE("the set-up of guides is listed where it is more than a tenth of the work", "[report]") {
  for (const double set_up : {0.0, 5.0, 4000.0}) {
    auto [experiment, result] = fixture::passage();
    for (RunResult& run : result.runs) {
      run.run.work = static_cast<double>(run.run.validity_checks);
      if (run.strategy != "nested") continue;
      run.run.set_up = set_up;
      run.run.queries = 1000.0;
    }
    CHECK(has(overview(experiment, result), "set-up") == (set_up > 100.0));
  }
}

TEST_CASE("the report names the assumption by which runs share a set-up", "[report]") {
  for (const double queries : {1000.0, 1.0, std::numeric_limits<double>::quiet_NaN()}) {
    auto [experiment, result] = fixture::passage();
    for (RunResult& run : result.runs) {
      run.run.work = static_cast<double>(run.run.validity_checks);
      if (run.strategy != "nested") continue;
      run.run.set_up = 4000.0;
      run.run.queries = queries;
      run.run.set_up_seconds = run.seed == 1 ? 0.017 : 0.001;
    }
    const std::string full = report_text(summarise(facts_of(experiment, result)));
    CHECK(has(full, "set-up: 4000 units of work, 17 ms, once per world; shared by 1000 queries, by assumption\n") ==
          (queries > 1.0));
    CHECK(has(full, "set-up: 4000 units of work, 17 ms, in each run (queries = 1)\n") == (queries == 1.0));
    const std::string text = overview(experiment, result, 160);
    CHECK(has(text,
              "set-up, once per world, beside ms: nested 17 ms (4,000 units of work)\n  shared by 1000 queries, "
              "by assumption\n") == (queries > 1.0));
    CHECK(has(text, "set-up, in each run (queries = 1), in ms: nested 17 ms (4,000 units of work)\n") ==
          (queries == 1.0));
  }
}

TEST_CASE("the share of functions in Lua is listed where a strategy has such functions", "[report]") {
  for (const double share : {0.0, 0.25}) {
    auto [experiment, result] = fixture::passage();
    for (RunResult& run : result.runs) {
      run.cpu_seconds = 2.0;
      if (run.strategy == "nested") run.run.lua_seconds = share * run.cpu_seconds;
    }
    const std::string text = overview(experiment, result);
    CHECK(has(text, "functions in Lua, of the CPU time: nested 25 %\n") == (share > 0.0));
    CHECK(summarise(facts_of(experiment, result), "simple_passage", "nested").lua_share == share);
    CHECK(summarise(facts_of(experiment, result), "simple_passage", "rrt").lua_share == 0.0);
  }
}

TEST_CASE("of two guides that are called the same each has its own ablation", "[report][verdict]") {
  const StrategySpec twice =
      GuideSpec::make("shrink", {}) >> GuideSpec::make("lazy", {}) >> GuideSpec::make("shrink", {}) >> fixture::plain();
  Experiment experiment;
  experiment.problems = {fixture::problem("passage")};
  experiment.strategies = {{"twice", twice}};
  experiment.seeds = {1};
  ablate(experiment, {"twice"});
  // The one nearest to the root comes first. It is removed or skipped; nothing guides the other one.
  std::vector<std::pair<std::string, std::string>> links;
  for (const AblationLink& link : experiment.ablations) {
    CHECK(link.of == "twice");
    links.emplace_back(link.text, link.key);
  }
  const std::string shrink = GuideSpec::make("shrink", {}).text_alone();
  REQUIRE(links.size() == 5);
  CHECK(links[0] == std::pair<std::string, std::string>("without " + shrink + " #1", "0/0"));
  CHECK(links[1] == std::pair<std::string, std::string>("skipping " + shrink + " #1", "0/0"));
  CHECK(links[4] == std::pair<std::string, std::string>("without " + shrink + " #2", "0/0/0/0"));
}

TEST_CASE("a strategy of the experiment without a level is its ablation", "[report][verdict]") {
  auto [experiment, result] = fixture::passage();
  result.left_out.clear();
  for (const GuideVerdict& one : guide_verdicts(facts_of(experiment, result), false)) {
    CHECK(one.verdict.kind == Verdict::Kind::not_tested);
  }
  // The skeleton guides the smaller robot: without the latter it guides the lazy level.
  experiment.strategies.emplace_back("coarse", GuideSpec::make("skeleton", {}) >> GuideSpec::make("lazy", {}) >>
                                                   PlannerSpec::make("rrt", {{"step", 0.4}}));
  for (const auto seed : experiment.seeds) {
    RunResult run = fixture::nested_run("simple_passage", seed, true);
    run.strategy = "coarse";
    run.run.validity_checks *= 2;
    result.runs.push_back(std::move(run));
  }
  const auto found = guide_verdicts(facts_of(experiment, result), false);
  REQUIRE(found.size() == 5);
  CHECK(found[1].key == "0/0/0");
  CHECK(found[1].verdict.kind == Verdict::Kind::pays);
  CHECK(found[1].verdict.ratio.median.lo == 0.5);
  for (const std::size_t i : {0U, 2U, 3U, 4U}) CHECK(found[i].verdict.kind == Verdict::Kind::not_tested);
  const std::string text = overview(experiment, result);
  CHECK(has(text.substr(text.find("without shrink")), "2.0  [2.0, 2.0]"));
  CHECK(has(text.substr(text.find("without shrink")), "keep it"));

  // A planner without a guide is what its only guide is compared with.
  Experiment single;
  single.problems = {fixture::problem("simple_passage")};
  single.strategies = {{"rrt", fixture::plain()}, {"nested", GuideSpec::make("lazy", {}) >> fixture::plain()}};
  single.seeds = experiment.seeds;
  const auto alone = guide_verdicts(facts_of(single, result), false);
  REQUIRE(alone.size() == 1);
  CHECK(alone[0].verdict.counts.pairs == 15);
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
  const auto text_of = [&](std::vector<RunResult> of) {
    ExperimentFacts facts;
    for (RunResult& run : of) {
      run.reasons = unsolved_reasons(run, strategy);
      facts.runs.push_back(facts_of(run));
    }
    return unsolved_text(facts.select("wall", "guided"));
  };
  const std::string text = text_of(runs);
  CHECK(has(text, "2 unsolved: 40 proposals spent at level 0; shrink"));
  CHECK(has(text, "reached its limit of 3 re-solves (in 1)"));
  CHECK(text_of({runs[2]}).empty());
  runs[0].run.status = Status::no_path;
  CHECK(has(text_of({runs[0]}), "1 unsolved: no path"));
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
  // The space of a projection that drops an axis of the robot.
  level.scene = std::make_shared<PlanarScene>(world, test::rectangle_robot(0.2, 0.1));
  CHECK(rejections(level, 0.05).rejected == 0);
  level.scene = std::make_shared<PlanarScene>(world, Robot::point());
  level.presumed = true;
  CHECK(rejections(level, 0.05).rejected == 0);
}

TEST_CASE("the ends of an interval do not cross where only some runs have samples", "[report]") {
  Figure figure;
  figure.scored = 1;
  figure.estimators = {"exact"};
  figure["D_perfect"].value = 0.05;
  figure["D_uniform"].value = 1.9;  // of all runs; of the one with samples it is 2
  figure["SE_lo"].value = figure["SE_hi"].value = 4.95;
  const AboveUniform above = above_uniform(figure);
  CHECK(above.lo <= above.hi);
  CHECK(above.hi == Approx(std::log(uniform_mix)));
}

TEST_CASE("nats are what the samples support, and exact for proposals of a recorded density", "[report]") {
  auto [experiment, result] = fixture::passage();
  for (RunResult& run : result.runs) {
    if (run.strategy != "nested") continue;
    Efficiency& proposals = run.levels.front().root->expansion;
    proposals.estimator = "exact";
    proposals.value = proposals.value_lo = proposals.value_hi = 4.76;
    proposals.above_uniform = proposals.uniform - proposals.value;
    proposals.in_target = 3;
    proposals.flags = {"underpowered"};
    Efficiency& nodes = run.levels.front().root->tree;
    nodes.value_lo = 0.05;
    nodes.value_hi = 5.0;
  }
  const std::string text = report_text(summarise(facts_of(experiment, result)), 100, ReportKind::levels);
  CHECK(has(text, "-2.35"));
  CHECK(has(text, "blank: too few samples"));
  const RunsSummary summary = fixture::summary_of(result, "", "nested");
  const FigurePair& root = summary.levels.front().root;
  const AboveUniform exact = above_uniform(root.expansion);
  CHECK(exact.exact);
  CHECK(exact.blank.empty());
  CHECK(exact.lo == Approx(-2.35));
  CHECK(exact.hi == Approx(-2.35));
  const AboveUniform nodes = above_uniform(root.tree);
  CHECK_FALSE(nodes.exact);
  CHECK_FALSE(nodes.blank.empty());
  CHECK(nodes.lo < -2.5);
  CHECK(nodes.hi > 2.3);
  // Each end has Student's interval of the runs' ends.
  const AboveUniform shrunk = above_uniform(summary.levels[2].root.tree);
  CHECK(shrunk.hi > 2.41 - 1.48 + 0.2);
  CHECK(shrunk.lo < 2.41 - 1.48 - 0.3);
  CHECK(shrunk.blank.empty());
}

TEST_CASE("every word of the overview is explained", "[report]") {
  std::vector<std::string> known;
  for (const ReportTerm& term : report_terms()) {
    CHECK(!term.meaning.empty());
    CHECK(std::count(known.begin(), known.end(), term.name) == 0);
    known.push_back(term.name);
  }
  for (const char* word : {"baseline",
                           "solved",
                           "validity checks",
                           "p",
                           "ms",
                           "path",
                           "share",
                           "nats",
                           "above uniform",
                           "mass",
                           "spread",
                           "set-up",
                           "blank",
                           "proposals, nodes",
                           "verdict",
                           "pays",
                           "costs",
                           "not tested",
                           "not shown",
                           "(mass), (spread)",
                           "SE",
                           "tree",
                           "expansion",
                           "re-solves",
                           "oracle"}) {
    CAPTURE(word);
    CHECK(std::count(known.begin(), known.end(), word) == 1);
  }
}

TEST_CASE("the report of levels says why a level was solved again", "[report]") {
  auto [experiment, result] = fixture::passage();
  const auto levels = [&, &experiment = experiment, &result = result] {
    return report_text(summarise(facts_of(experiment, result)), 200, ReportKind::levels);
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
