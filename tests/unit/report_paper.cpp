// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>
#include <string>
#include <vector>

#include <trellis/report/report.hpp>
#include "report_fixture.hpp"
#include "support/catch.hpp"
#include "support/golden.hpp"

using namespace trellis;

namespace {

/// Two problems, three strategies, figures by two estimators, and what was published.
std::pair<Experiment, ExperimentResult> published() {
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
      plain.estimator = "legacy";
      plain.undefended = run.strategy == "rrt" ? 30.0 : run.strategy == "third" ? 40.0 : 7.0;
      level.root->tree.others = {plain};
      level.root_cross = level.root;
      level.root_cross->tree.value += 0.4;
    }
  }
  experiment.measure->estimators = {EstimatorSpec::make("knn"), EstimatorSpec::make("legacy")};
  Publication publication;
  publication.source = "Somebody 1999";
  publication.entries = {{"simple_passage", "rrt", 32.147, 18.671},
                         {"simple_passage", "nested", 11.395, {}},
                         {"simple_passage", "third", 20.0, 19.0}};
  publication.entries[1].expansion = std::numeric_limits<double>::quiet_NaN();
  using Role = Publication::Claim::Role;
  publication.claims = {
      {"nested does better", "simple_passage", "nested", true, {"rrt"}, {Role::tree, Role::expansion}},
      {"nested does no better", "simple_passage", "nested", false, {"rrt"}, {Role::tree}}};
  experiment.published = publication;
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
  const auto [experiment, result] = published();
  test::check_golden("table.md", report_markdown(experiment, result));
}

TEST_CASE("every row of a table has as many cells as its head, whatever things are called", "[report]") {
  const auto [experiment, result] = published();
  std::size_t columns = 0;
  std::size_t rows = 0;
  for (const std::string& line : lines_of(report_markdown(experiment, result))) {
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
  const auto [experiment, result] = published();
  const auto lines = lines_of(report_csv(experiment, result));
  CHECK(lines.front() == "problem,strategy,role,path,estimator,quantity,value,lo,hi,n,infinite");
  CHECK(std::count(lines.begin(), lines.end(), "simple_passage,rrt,tree,own,legacy,SE,30,30,30,14,0") == 1);
  // A name with a comma and quotes is quoted; the strategy that solved nothing has figures on others' paths at most.
  CHECK(std::any_of(lines.begin(), lines.end(), [](const auto& l) {
    return l.starts_with("\"a|b, \"\"c\"\"\",nested,tree,own,headline,SE,,,,0,0");
  }));
  CHECK(std::any_of(lines.begin(), lines.end(),
                    [](const auto& l) { return l.starts_with("\"a|b, \"\"c\"\"\",nested,,,,success,0,"); }));
}

TEST_CASE("what nobody published is not compared", "[report]") {
  auto [experiment, result] = published();
  experiment.published.reset();
  const std::string text = report_markdown(experiment, result);
  CHECK(text.find("published") == std::string::npos);
  CHECK(text.find("Spearman") == std::string::npos);
}

TEST_CASE("an experiment that measured nothing has tables of what it knows", "[report]") {
  auto [experiment, result] = published();
  experiment.measure.reset();
  for (RunResult& run : result.runs) {
    for (LevelResult& level : run.levels) level.own = level.root = level.own_cross = level.root_cross = std::nullopt;
  }
  CHECK(report_markdown(experiment, result).find("NA<br>NA") != std::string::npos);
}
