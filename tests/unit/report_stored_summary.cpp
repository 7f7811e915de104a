// SPDX-License-Identifier: GPL-3.0-or-later
// The document of results is enough for every report.
#include <algorithm>
#include <cstddef>
#include <fstream>
#include <iterator>
#include <string>
#include <utility>

#include <trellis/base/error.hpp>
#include <trellis/report/report.hpp>
#include <trellis/results/records.hpp>

#include "report_fixture.hpp"
#include "support/catch.hpp"
#include "support/golden.hpp"
#include "support/worlds.hpp"

using namespace trellis;

namespace {

/// Runs with ablations, a guide without a level, metrics, several estimators, an unsolved problem and other seeds.
Experiment experiment_of_all() {
  Experiment experiment;
  for (const auto& [name, wall] : {std::pair{"low", 6.0}, std::pair{"high", 10.0}}) {
    experiment.problems.push_back(
        test::make_problem(name, test::rectangle_world({{4.0, 0.0, 5.0, wall}}), Robot::point(), {1, 1}, {9, 1}));
  }
  const PlannerSpec planner = PlannerSpec::make("rrt", {{"step", 0.5}, {"proposals", 400.0}});
  const GuideSpec guides = GuideSpec::make("skeleton", {}) + GuideSpec::make("goal_bias", {{"share", 0.2}});
  experiment.strategies = {{"rrt", StrategySpec(planner)}, {"guided", StrategySpec(planner, guides)}};
  experiment.seeds = {1, 2, 3, 4, 5, 6};
  TubeSettings tube;
  tube.points = 64;
  tube.pool = 256;
  Measure measure{.target = tube, .cross = 2, .cross_levels = true, .metrics = true};
  measure.estimators = {EstimatorSpec::make("knn"), EstimatorSpec::make("exact"), EstimatorSpec::make("arc")};
  experiment.measure = measure;
  ablate(experiment, {"guided"});
  return experiment;
}

/// Returns the first difference of two documents with its surroundings, "" for none.
std::string difference(const std::string& a, const std::string& b) {
  const auto [at, there] = std::mismatch(a.begin(), a.end(), b.begin(), b.end());
  if (at == a.end() && there == b.end()) return "";
  const auto from = static_cast<std::size_t>(at - a.begin());
  const std::size_t begin = from - std::min<std::size_t>(from, 200);
  return a.substr(begin, 300) + "\nbut\n" + b.substr(begin, 300);
}

void check_same(const Experiment& experiment, const ExperimentResult& result) {
  const ExperimentFacts facts = facts_of(experiment, result, "a script.lua");
  const ExperimentSummary summary = summarise(facts);
  const std::string document = report_json(facts, summary);
  const ExperimentFacts read = read_results(document, "results.json");
  const ExperimentSummary stored = summarise(read);
  CHECK(difference(document, report_json(read, stored)) == "");
  CHECK(summary_text(stored, 120) == summary_text(summary, 120));
  for (const ReportKind kind : {ReportKind::overview, ReportKind::levels, ReportKind::efficiency, ReportKind::full}) {
    for (const int width : {60, 100, 200}) {
      CAPTURE(kind, width);
      CHECK(report_text(stored, width, kind) == report_text(summary, width, kind));
    }
  }
  CHECK(runs_csv(read) == runs_csv(facts));
}

}  // namespace

TEST_CASE("reports of a stored document are those of its run", "[report][json]") {
  SECTION("of scored runs") {
    const auto [experiment, result] = fixture::passage();
    check_same(experiment, result);
  }
  SECTION("of a hundred problems, which are reported together") {
    const auto [experiment, result] = fixture::queries();
    check_same(experiment, result);
  }
  SECTION("of runs with all that a report can state") {
    const Experiment experiment = experiment_of_all();
    const ExperimentResult result = run(experiment);
    const std::string text = report_text(summarise(facts_of(experiment, result)), 160, ReportKind::levels);
    for (const char* words : {"goal_bias(0.2)", "no run on high can succeed", "proposals rejected"}) {
      CAPTURE(words);
      const bool next = std::string(words).starts_with("no run");
      const std::string in =
          next ? report_text(summarise(facts_of(experiment, result)), 100, ReportKind::overview) : text;
      CHECK(in.find(words) != std::string::npos);
    }
    check_same(experiment, result);
  }
  SECTION("of runs that were not scored") {
    Experiment experiment = experiment_of_all();
    experiment.measure.reset();
    check_same(experiment, run(experiment));
  }
}

TEST_CASE("a document of runs alone has the reports of its runs", "[report][json]") {
  Experiment experiment = experiment_of_all();
  experiment.measure.reset();
  experiment.ablation = 0.0;
  const ExperimentFacts facts = facts_of(experiment, run(experiment));
  RunsDocument writer;
  std::string document = writer.begin("", facts.description, facts.scenery);
  for (const RunFacts& run : facts.runs) document += writer.add(read_run(run_line(run)));
  const ExperimentFacts read = read_results(document + writer.end(), "results.json");
  REQUIRE(read.runs.size() == facts.runs.size());
  CHECK(report_text(summarise(read), 100, ReportKind::levels) ==
        report_text(summarise(facts), 100, ReportKind::levels));
}

TEST_CASE("a document of another format has no reports", "[report][json]") {
  const auto [experiment, result] = fixture::passage();
  std::string document = fixture::report_json(experiment, result);
  const std::string format = ",\"format\":" + std::to_string(document_format);
  const auto at = document.find(format);
  REQUIRE(at != std::string::npos);
  CHECK_NOTHROW(require_format(read_results(document, "new.json"), "new.json"));
  for (const char* before : {",\"format\":3", ",\"format\":4"}) {
    document.replace(at, format.size(), before);
    CHECK_NOTHROW(require_format(read_results(document, "before.json"), "before.json"));
  }
  document.erase(at, format.size());
  const ExperimentFacts old = read_results(document, "old.json");
  CHECK(old.runs.size() == result.runs.size());
  CHECK_THROWS_WITH(require_format(old, "old.json"), Catch::Matchers::Contains("old.json: trellis"));
}

TEST_CASE("a document of format 4 has the report that its version printed", "[report][json]") {
  std::ifstream file(test::golden_folder() / "results_format_4.json");
  const std::string document(std::istreambuf_iterator<char>(file), {});
  const ExperimentFacts facts = read_results(document, "results_format_4.json");
  REQUIRE(facts.format == 4);
  test::check_golden("report_format_4.txt", report_text(summarise(facts), 100, ReportKind::full));
  // Written in today's format, it has the same report: the figures of the document as they are printed.
  const ExperimentFacts again = read_results(report_json(facts, summarise(facts)), "again.json");
  CHECK(report_text(summarise(again), 100, ReportKind::full) == report_text(summarise(facts), 100, ReportKind::full));
}

TEST_CASE("a damaged table is refused by the name of its file", "[report][json]") {
  const auto [experiment, result] = fixture::passage();
  const std::string document = fixture::report_json(experiment, result);
  const auto damaged = [&](const std::string& column, const std::string& other) {
    std::string text = document;
    const auto at = text.find("\"levels\": {");
    const auto found = text.find("\"" + column + "\": ", at);
    REQUIRE(found != std::string::npos);
    return text.replace(found, text.find('\n', found) - found, "\"" + column + "\": " + other);
  };
  CHECK_THROWS_WITH(read_results(damaged("run", "1000,"), "it.json"), Catch::Matchers::StartsWith("it.json: "));
  CHECK_THROWS_WITH(read_results(damaged("nodes", "[1],"), "it.json"),
                    Catch::Matchers::Contains("it.json: the column nodes has 1 values"));
  CHECK_THROWS_WITH(read_results(damaged("rows", "-1,"), "it.json"), Catch::Matchers::StartsWith("it.json: "));
}

TEST_CASE("another document is refused by its name", "[report][json]") {
  for (const char* text : {"", "{}", "[1, 2]", R"({"experiment": 3})", "nonsense"}) {
    CAPTURE(text);
    CHECK_THROWS_WITH(read_results(text, "other.json"),
                      "other.json: this is no document that trellis run --json writes");
  }
}
