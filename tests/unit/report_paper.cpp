// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include <trellis/measure/efficiency.hpp>
#include <trellis/report/report.hpp>
#include <trellis/report/summary.hpp>
#include <trellis/report/words.hpp>
#include <trellis/results/records.hpp>
#include "report_fixture.hpp"
#include "support/catch.hpp"
#include "support/golden.hpp"

using namespace trellis;

namespace {

/// Two problems, three strategies, and figures by two estimators.
std::pair<Experiment, ExperimentResult> three_strategies() {
  auto [experiment, result] = fixture::passage();
  experiment.problems.push_back(fixture::problem("a|b, \"c\""));
  for (const auto seed : experiment.seeds) result.runs.push_back(fixture::plain_run("a|b, \"c\"", seed, seed > 2));
  for (const auto seed : experiment.seeds) result.runs.push_back(fixture::nested_run("a|b, \"c\"", seed, false));
  // A third strategy, as ranks of two say nothing: between the others in its figures.
  experiment.strategies.emplace_back("third", fixture::plain());
  for (const Problem& problem : experiment.problems) {
    for (const auto seed : experiment.seeds) {
      RunResult run = fixture::plain_run(problem.name, seed, true);
      run.strategy = "third";
      for (LevelResult& level : run.levels) {
        if (level.root) level.root->tree.value -= 0.5;
      }
      result.runs.push_back(std::move(run));
    }
  }
  for (RunResult& run : result.runs) {
    for (LevelResult& level : run.levels) {
      if (!level.root) continue;
      Estimate plain = level.root->tree;
      plain.estimator = "arc";
      plain.value = run.strategy == "rrt" ? 30.0 : run.strategy == "third" ? 40.0 : 7.0;
      level.root->tree.others = {plain};
      level.root_cross = level.root;
      level.root_cross->tree.value += 0.4;
    }
  }
  experiment.measure->estimators = {EstimatorSpec::make("knn"), EstimatorSpec::make("arc")};
  return {std::move(experiment), std::move(result)};
}

std::vector<std::string> lines_of(const std::string& text) {
  std::istringstream stream(text);
  std::vector<std::string> lines;
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

/// Cells of a row of Markdown: bars that are not escaped, less the outer ones.
std::size_t cells_of(const std::string& row) {
  std::size_t bars = 0;
  for (std::size_t i = 0; i < row.size(); ++i) bars += row[i] == '|' && (i == 0 || row[i - 1] != '\\') ? 1 : 0;
  return bars - 1;
}

}  // namespace

TEST_CASE("the tables look as they should", "[report][golden]") {
  const auto [experiment, result] = three_strategies();
  test::check_golden("table.md", fixture::report_markdown(experiment, result));
}

TEST_CASE("every row of a table has as many cells as its head, whatever things are called", "[report]") {
  const auto [experiment, result] = three_strategies();
  std::size_t columns = 0;
  std::size_t rows = 0;
  for (const std::string& line : lines_of(fixture::report_markdown(experiment, result))) {
    if (!line.starts_with('|')) {
      columns = 0;
      continue;
    }
    if (columns == 0) columns = cells_of(line);
    INFO(line);
    CHECK(cells_of(line) == columns);
    ++rows;
  }
  CHECK(rows > 20);
}

TEST_CASE("the values are one to a line, and none is infinite without being counted", "[report]") {
  const auto [experiment, result] = three_strategies();
  const auto lines = lines_of(fixture::report_csv(experiment, result));
  CHECK(lines.front() == "problem,strategy,role,path,estimator,quantity,value,lo,hi,n,infinite");
  CHECK(std::count(lines.begin(), lines.end(), "simple_passage,rrt,tree,own,arc,SE,30,30,30,14,0") == 1);
  // A name with a comma and quotes is quoted; the strategy that solved nothing has figures on others' paths at most.
  CHECK(std::any_of(lines.begin(), lines.end(), [](const auto& l) {
    return l.starts_with("\"a|b, \"\"c\"\"\",nested,tree,own,headline,SE,,,,0,0");
  }));
  CHECK(std::any_of(lines.begin(), lines.end(),
                    [](const auto& l) { return l.starts_with("\"a|b, \"\"c\"\"\",nested,,,,success,0,"); }));
}

TEST_CASE("an experiment without a measure has tables of its other values", "[report]") {
  auto [experiment, result] = three_strategies();
  experiment.measure.reset();
  for (RunResult& run : result.runs) {
    for (LevelResult& level : run.levels) level.own = level.root = level.own_cross = level.root_cross = std::nullopt;
  }
  CHECK(fixture::report_markdown(experiment, result).find("NA<br>NA") != std::string::npos);
}

TEST_CASE("no table prints a divergence below what is possible, but its bound", "[report]") {
  auto [experiment, result] = fixture::passage();
  for (RunResult& run : result.runs) {
    LevelResult& root = run.levels.front();
    if (!root.root) continue;
    for (Efficiency* e : {&root.root->tree, &root.root->expansion}) {
      // Estimates below the mass bound, as nearest neighbours give them: SE is at least 0.3 in every run.
      e->estimator = "knn";
      e->value = -0.4;
      e->unregularised = -0.2;
      e->mass_lower95 = 0.35;
      e->perfect = 0.05;
      e->value_lo = least_value(*e);
      e->value_hi = 0.9;
      e->above_uniform = e->uniform - e->value;
      e->parts = {.mass = 0.6, .spread = -1.0};
    }
    root.own = root.root;
  }
  const double least = least_value(result.runs.front().levels.front().root->tree);
  REQUIRE(least > 0.0);
  const std::string text = fixture::report_markdown(experiment, result);
  CHECK(text.find("-0.40") == std::string::npos);
  CHECK(text.find("-1.00") == std::string::npos);
  char bound[32];
  std::snprintf(bound, sizeof bound, "%.2f to 0.90<br>%.2f to 0.90", least, least);
  CHECK(text.find(bound) != std::string::npos);
  CHECK(text.find("≥ 0.35<br>≥ 0.35") != std::string::npos);  // D
  for (const std::string& line : lines_of(fixture::report_csv(experiment, result))) {
    const bool divergence = line.find(",SE,") != std::string::npos || line.find(",D,") != std::string::npos ||
                            line.find(",SE_parts.spread,") != std::string::npos;
    if (divergence) CHECK(line.find(",-") == std::string::npos);
  }
}

TEST_CASE("solved runs, checks and times have their intervals in the tables", "[report]") {
  const auto [experiment, result] = three_strategies();
  const RunsSummary summary = fixture::summary_of(result, "simple_passage", "rrt");
  std::vector<std::string> cells;
  bool others = false;
  for (const std::string& line : lines_of(fixture::report_markdown(experiment, result))) {
    if (line.starts_with("## ")) others = line.starts_with("## Other measures, simple");
    if (!others || !line.starts_with("| rrt |")) continue;
    std::istringstream row(line);
    for (std::string cell; std::getline(row, cell, '|');) cells.push_back(cell);
  }
  REQUIRE(cells.size() > 5);
  CHECK(cells[2] == " 14/15<br>" + wilson_text(summary.success) + " % ");
  const Interval& checks = summary.validity_checks;
  REQUIRE(std::isfinite(checks.lo));
  CHECK(cells[3] ==
        " " + count_text(checks.value) + "<br>[" + count_text(checks.lo) + ", " + count_text(checks.hi) + "] ");
  CHECK(cells[4].find("<br>[") != std::string::npos);
}

TEST_CASE("the runs are a table in CSV with a row for each", "[report]") {
  auto [experiment, result] = fixture::passage();
  result.runs.front().problem = "a, \"b\"";
  const auto scored = std::find_if(result.runs.begin() + 1, result.runs.end(),
                                   [](const RunResult& run) { return run.levels.front().own.has_value(); });
  REQUIRE(scored != result.runs.end());
  Efficiency& measured_tree = scored->levels.front().own->tree;
  measured_tree.parts.mass = 0.25;
  measured_tree.value_lo = 0.5;
  measured_tree.value_hi = 1.5;
  const auto lines = lines_of(runs_csv(facts_of(experiment, result)));
  REQUIRE(lines.size() == result.runs.size() + 1);
  std::vector<std::string> names;
  std::istringstream header(lines.front());
  for (std::string name; std::getline(header, name, ',');) names.push_back(name);
  CHECK(lines[1].starts_with("\"a, \"\"b\"\"\","));
  for (std::size_t i = 1; i < result.runs.size(); ++i) {
    const RunResult& run = result.runs[i];
    std::istringstream row(lines[i + 1]);
    std::map<std::string, std::string> cells;
    std::string cell;
    std::size_t column = 0;
    for (; std::getline(row, cell, ','); ++column) {
      REQUIRE(column < names.size());
      cells[names[column]] = cell;
    }
    CHECK(column == names.size());
    CHECK(cells["problem"] == run.problem);
    CHECK(cells["strategy"] == run.strategy);
    CHECK(cells["seed"] == std::to_string(run.seed));
    CHECK(cells["solved"] == (run.run.solved ? "1" : "0"));
    CHECK(cells["validity_checks"] == std::to_string(run.run.validity_checks));
    CHECK(cells["length"].empty() == !run.run.solved);
    CHECK(cells["levels"] == std::to_string(run.levels.size()));
    const auto& root = run.levels.front().own;
    CHECK(cells["tree_SE"].empty() == (!root || std::isnan(root->tree.value)));
    if (cells["tree_SE"].empty()) continue;
    const Efficiency tree = rounded(root->tree);
    CHECK(std::stod(cells["tree_SE"]) == tree.value);
    CHECK(std::stod(cells["tree_D_uniform"]) == tree.uniform);
    const std::map<std::string, double> measured = {
        {"tree_SE_parts.mass", tree.parts.mass}, {"tree_SE_lo", tree.value_lo}, {"tree_SE_hi", tree.value_hi}};
    for (const auto& [name, value] : measured) {
      CHECK(cells[name].empty() == std::isnan(value));
      if (!cells[name].empty()) CHECK(std::stod(cells[name]) == value);
    }
  }
}
