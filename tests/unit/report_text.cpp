// SPDX-License-Identifier: GPL-3.0-or-later
#include <limits>
#include <sstream>

#include <trellis/report/report.hpp>
#include <trellis/report/summary.hpp>
#include <trellis/report/views/table.hpp>
#include "report_fixture.hpp"
#include "support/catch.hpp"
#include "support/golden.hpp"

using namespace trellis;

namespace {

std::size_t widest_line(const std::string& text) {
  std::size_t widest = 0;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) widest = std::max(widest, display_width(line));
  return widest;
}

}  // namespace

TEST_CASE("the report looks as it should", "[report][golden]") {
  const auto [experiment, result] = fixture::passage();
  test::check_golden("report.txt", report_text(summarise(facts_of(experiment, result))));
}

TEST_CASE("the report of many problems takes them together", "[report][golden]") {
  const auto [experiment, result] = fixture::queries();
  test::check_golden("report_queries.txt", report_text(summarise(facts_of(experiment, result))));
}

TEST_CASE("a narrow report splits its tables", "[report][golden]") {
  const auto [experiment, result] = fixture::passage();
  test::check_golden("report_narrow.txt", report_text(summarise(facts_of(experiment, result)), 100));
}

TEST_CASE("the report keeps to the width", "[report]") {
  const auto [experiment, result] = fixture::passage();
  for (const int width : {160, 140, 120, 100, 80}) {
    CAPTURE(width);
    CHECK(widest_line(report_text(summarise(facts_of(experiment, result)), width)) <= static_cast<std::size_t>(width));
  }
}

TEST_CASE("parts of the report are what the report has of them", "[report]") {
  const auto [experiment, result] = fixture::passage();
  const std::string whole = report_text(summarise(facts_of(experiment, result)));
  const std::string summary = summary_text(summarise(facts_of(experiment, result)));
  CHECK(summary.find("summary of") != std::string::npos);
  CHECK(summary.find("compared with") != std::string::npos);
  CHECK(whole.find(summary) != std::string::npos);
  const RunResult& run = result.runs.back();
  CHECK(levels_text(summarise(facts_of(run))).find("all levels") != std::string::npos);
  CHECK(levels_text(summarise(facts_of(run))).find("nats") == std::string::npos);
  CHECK(efficiency_text(summarise(facts_of(run))).find("nats") != std::string::npos);
  RunResult unsolved = fixture::plain_run("wall", 1, false);
  CHECK(efficiency_text(summarise(facts_of(unsolved))) == "no path, so no target to score against\n");
  CHECK(levels_text(summarise(facts_of(unsolved))).find("0/1") != std::string::npos);
}

TEST_CASE("the report says what guides spent, where there are any", "[report]") {
  const auto [experiment, result] = fixture::passage();
  const std::string guided = levels_text(summarise(facts_of(result.runs.back())));
  CHECK(guided.find("validity checks by") != std::string::npos);
  const std::string alone = levels_text(summarise(facts_of(result.runs.front())));
  CHECK(alone.find("validity checks by") == std::string::npos);
  CHECK(alone.find("guided") == std::string::npos);
}

TEST_CASE("without a measure the report has no efficiency", "[report]") {
  auto [experiment, result] = fixture::passage();
  experiment.measure.reset();
  for (auto& run : result.runs) {
    for (auto& level : run.levels) level.own = level.root = std::nullopt;
  }
  const std::string text = report_text(summarise(facts_of(experiment, result)));
  CHECK(text.find("nats") == std::string::npos);
  CHECK(text.find("nan") == std::string::npos);
  CHECK(text.find("proposals") != std::string::npos);
}

TEST_CASE("a strategy that never succeeds costs infinitely much, and has dashes for what it lacks", "[report]") {
  Experiment experiment;
  experiment.problems = {fixture::problem("wall")};
  experiment.strategies = {{"rrt", fixture::plain()}};
  experiment.seeds = {1, 2};
  ExperimentResult result;
  for (const auto seed : experiment.seeds) result.runs.push_back(fixture::plain_run("wall", seed, false));
  const std::string text = report_text(summarise(facts_of(experiment, result)));
  CHECK(text.find("solved 0/2") != std::string::npos);
  CHECK(text.find("nan") == std::string::npos);
  const std::string summary = text.substr(text.find("summary of wall"));
  const std::string last = summary.substr(summary.rfind("rrt "));
  std::istringstream cells(last);
  std::vector<std::string> words;
  for (std::string word; cells >> word;) words.push_back(word);
  // No interval of two runs; three medians of costs, path length, the runs that were scored, tree, expansion.
  CHECK(words == std::vector<std::string>{"rrt", "0/2", "-", "inf", "inf", "inf", "-", "0", "-", "-"});
}

TEST_CASE("levels of a mixture are drawn as a tree, by their keys", "[report]") {
  Experiment experiment;
  experiment.problems = {fixture::problem("passage")};
  experiment.strategies = {{"rrt", fixture::plain()}};
  experiment.seeds = {1};
  experiment.measure.reset();
  RunResult run{"passage", "rrt", 1, {}, {}, {}};
  const Space plane = Space::euclidean({{0, 1}, {0, 1}});
  for (const auto& [key, name] : std::vector<std::pair<std::string, std::string>>{
           {"0", "root"}, {"0/0", "first"}, {"0/0/0", "deep"}, {"0/1", "second"}, {"0/1/0", "deeper"}}) {
    const auto index = static_cast<int>(run.levels.size());
    run.levels.push_back({.record = fixture::level(index, key, name, plane, "rrt", 10, true)});
  }
  const std::string text = report_text(summarise(facts_of(experiment, {.runs = {run}, .pooled = {}})));
  for (const char* label : {"0 root ", "1 ├ first ", "2 │ └ deep ", "3 └ second ", "4   └ deeper "}) {
    CAPTURE(label);
    CHECK(text.find(label) != std::string::npos);
  }
}

TEST_CASE("a summary counts only what was scored", "[report]") {
  const auto [experiment, result] = fixture::passage();
  const RunsSummary plain = fixture::summary_of(result, "simple_passage", "rrt");
  CHECK(plain.runs == 15);
  CHECK(plain.solved == 14);
  REQUIRE(plain.levels.size() == 1);
  CHECK(plain.levels[0].root.tree.scored == 14);
  CHECK(plain.levels[0].root.tree["SE"].n == 14);
  CHECK(plain.length.n == 14);

  const RunsSummary nested = fixture::summary_of(result, "", "nested");
  REQUIRE(nested.levels.size() == 4);
  CHECK(nested.levels[3].parent == 2);
  CHECK(nested.levels[1].own.expansion["SE"].infinite == 1);
  CHECK(nested.levels[3].own.expansion.scored == 0);
  CHECK(std::isnan(nested.levels[3].own.expansion["SE"].value));
  CHECK(nested.levels[3].own.expansion["D_uniform"].value == Approx(2.39));
  REQUIRE(nested.levels[2].own.tree.flags.size() == 2);
  CHECK(nested.levels[2].own.tree.flags[0].second == 2);
}

TEST_CASE("text wraps at spaces", "[report]") {
  CHECK(wrap("one two three", 7, "", "  ") == "one two\n  three\n");
  CHECK(wrap("a-very-long-word short", 6, "> ", "  ") == "> a-very-long-word\n  short\n");
  CHECK(wrap(std::string("a") + no_break + "b c", 3) == "a b\nc\n");
  CHECK(display_width("±0.1 └ é") == 8);
  CHECK(shortened("道を探す", 5) == "道を…");
}

TEST_CASE("the report warns of a guide that does worse than none, and of no other", "[report]") {
  auto [experiment, result] = fixture::passage();
  experiment.baseline = "rrt";
  CHECK(summarise(facts_of(experiment, result)).problems.front().warnings.empty());
  CHECK(report_text(summarise(facts_of(experiment, result))).find("warning") == std::string::npos);
  for (RunResult& run : result.runs) {
    if (run.strategy == "nested") run.run.validity_checks *= 100;
  }
  const auto costly = summarise(facts_of(experiment, result)).problems.front().warnings;
  REQUIRE(costly.size() == 1);
  CHECK(costly.front().starts_with("nested costs more validity checks than rrt, which has no guide: "));
  CHECK(report_text(summarise(facts_of(experiment, result))).find("\nwarning: nested costs more") != std::string::npos);
  // Guides that leave most runs unsolved cost more, however early they gave up.
  for (RunResult& run : result.runs) {
    if (run.strategy != "nested") continue;
    run.run.validity_checks = 1;
    run.run.solved = run.seed <= 2;
  }
  const auto failing = summarise(facts_of(experiment, result)).problems.front().warnings;
  REQUIRE_FALSE(failing.empty());
  CHECK(failing.front() == "nested solves fewer runs than rrt, which has no guide: 2 of 15 against 14");
}

TEST_CASE("samples of all seeds together come first, and single runs that differ are named", "[report]") {
  auto [experiment, result] = fixture::passage();
  for (RunResult& run : result.runs) {
    for (LevelResult& level : run.levels) level.root_cross = level.root;
  }
  PooledScores pooled{.problem = "simple_passage", .strategy = "nested", .key = "0", .seeds = 14, .targets = 2};
  pooled.scores.tree = fixture::efficiency(2.41, 2.75, 700);
  pooled.scores.tree.value_lo = 2.6;
  pooled.scores.tree.value_hi = 3.0;
  pooled.scores.tree.perfect = 0.05;
  pooled.scores.expansion = fixture::efficiency(2.41, 1.2, 700);
  result.pooled = {pooled};
  const RunsSummary summary = summarise(facts_of(experiment, result), "simple_passage", "nested");
  const LevelSummary& root = summary.levels.front();
  REQUIRE(root.pooled);
  const Headline nodes = headline(root, SampleRole::tree);
  CHECK(nodes.seeds == 15);
  CHECK(nodes.above.lo == Approx(2.41 - 3.0));
  CHECK(nodes.above.hi == Approx(2.41 - 2.6));
  CHECK(disagree(nodes.above, over_runs(root, SampleRole::tree).above));
  CHECK_FALSE(disagree(headline(root, SampleRole::expansion).above, over_runs(root, SampleRole::expansion).above));
  // Levels without such samples are averaged over the runs.
  CHECK(headline(summary.levels[1], SampleRole::tree).seeds == 0);
  CHECK(summary.tree_waterfall.steps.back().after.value == Approx(2.41 - 2.8));
  const std::string text = report_text(summarise(facts_of(experiment, result)), 100, ReportKind::levels);
  for (const char* words :
       {"-0.59…-0.19", "the samples of all 15 seeds together", "single runs differ: root nodes +"}) {
    CAPTURE(words);
    CHECK(text.find(words) != std::string::npos);
  }
  // Fewer than five seeds are not enough.
  result.pooled.front().seeds = 3;
  CHECK(headline(summarise(facts_of(experiment, result), "simple_passage", "nested").levels.front(), SampleRole::tree)
            .seeds == 0);
}
