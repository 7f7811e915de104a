// SPDX-License-Identifier: GPL-3.0-or-later
#include <limits>
#include <nlohmann/json.hpp>

#include <trellis/base/version.hpp>
#include <trellis/report/report.hpp>
#include "report_fixture.hpp"
#include "support/catch.hpp"
#include "support/results.hpp"

using namespace trellis;
using nlohmann::json;

namespace {

json parsed() {
  const auto [experiment, result] = fixture::passage();
  return test::with_levels(json::parse(fixture::report_json(experiment, result, "examples/nested.lua")));
}

}  // namespace

TEST_CASE("JSON says what was run", "[report][json]") {
  const json document = parsed();
  CHECK(document.at("trellis").at("version") == version());
  CHECK(document.at("script") == "examples/nested.lua");
  const json& experiment = document.at("experiment");
  CHECK(experiment.at("measure").at("delta") == 0.5);
  CHECK(experiment.at("measure").at("distance") == "planar");
  CHECK(experiment.at("seeds").size() == 15);
  CHECK(experiment.at("problems").at(0).at("name") == "simple_passage");
  CHECK(experiment.at("problems").at(0).at("goal") == json({9.0, 1.5, 0.0}));
  REQUIRE(experiment.at("strategies").size() == 2);
  const json& nested = experiment.at("strategies").at(1);
  CHECK(nested.at("name") == "nested");
  CHECK(nested.at("text") == fixture::nested().text());
  CHECK(json::parse(fixture::nested().json()) == nested.at("spec"));
  CHECK(nested.at("hash").get<std::string>().size() == 16);
}

TEST_CASE("JSON holds every run and level", "[report][json]") {
  const auto [experiment, result] = fixture::passage();
  const json document = parsed();
  REQUIRE(document.at("runs").size() == result.runs.size());
  for (std::size_t i = 0; i < result.runs.size(); ++i) {
    const RunResult& run = result.runs[i];
    const json& out = document.at("runs").at(i);
    CAPTURE(i);
    CHECK(out.at("problem") == run.problem);
    CHECK(out.at("strategy") == run.strategy);
    CHECK(out.at("seed") == run.seed);
    CHECK(out.at("status") == (run.run.solved ? "solved" : "budget_spent"));
    CHECK(out.at("solved") == run.run.solved);
    CHECK(out.at("time_s").get<double>() == run.run.seconds);  // to the last bit
    CHECK(out.at("lua_s").get<double>() == run.run.lua_seconds);
    CHECK(out.at("validity_checks") == run.run.validity_checks);
    CHECK(out.at("motion_checks") == run.run.motion_checks);
    if (run.run.solved) {
      CHECK(out.at("length").get<double>() == run.run.length);
      REQUIRE(out.at("path").size() == run.run.path.size());
      for (std::size_t k = 0; k < run.run.path.size(); ++k) {
        CHECK(out.at("path").at(k).get<std::vector<double>>() ==
              std::vector<double>(run.run.path[k].begin(), run.run.path[k].end()));
      }
    } else {
      CHECK(out.at("length").is_null());
      CHECK(out.at("path") == json::array());
    }
    REQUIRE(out.at("levels").size() == run.levels.size());
    for (std::size_t l = 0; l < run.levels.size(); ++l) {
      const LevelRecord& record = run.levels[l].record;
      const json& level = out.at("levels").at(l);
      CHECK(level.at("level") == record.level);
      CHECK(level.at("name") == record.name);
      CHECK(level.at("space") == record.space.name());
      CHECK(level.at("dimension") == record.space.dimension());
      CHECK(level.at("planner") == record.planner);
      CHECK(level.at("solves") == record.solves);
      CHECK(level.at("proposals") == record.search.proposals.size());
      CHECK(level.at("accepted") == record.search.proposals.size() / 2);
      CHECK(level.at("nodes") == record.search.nodes.size());
      CHECK(level.at("validity_checks") == record.search.checks.validity);
      CHECK(level.at("motion_checks") == record.search.checks.motion);
      CHECK(level.at("spent").at("guided").at("validity_checks").is_null() != record.guided);
      if (record.guided) {
        const json& spent = level.at("spent");
        CHECK(spent.at("guided").at("validity_checks") == record.guided_checks);
        CHECK(spent.at("guided").at("proposals") == record.guided_proposals);
        CHECK(spent.at("unguided").at("validity_checks") == record.unguided_checks);
        CHECK(spent.at("unguided").at("proposals") == record.search.proposals.size() - record.guided_proposals);
        CHECK(spent.at("below").at("validity_checks") == record.checks_below);
        CHECK(spent.at("below").at("proposals") == record.proposals_below);
      }
      CHECK(level.at("time_s").get<double>() == record.search.seconds);
      CHECK(level.at("solved") == record.solution.solved());
      if (record.level == 0) {
        CHECK(level.at("parent").is_null());
      } else {
        CHECK(level.at("parent") == record.parent);
      }
    }
  }
}

TEST_CASE("JSON figures", "[report][json]") {
  const auto [experiment, result] = fixture::passage();
  const json document = parsed();
  const json& run = document.at("runs").at(17);  // nested, seed 3
  REQUIRE(run.at("seed") == 3);

  const Efficiency tree = rounded(result.runs[17].levels[0].own->tree);
  const json& out = run.at("levels").at(0).at("measure").at("tree").at("self");
  CHECK(out.at("SE").get<double>() == tree.value);
  CHECK(out.at("D").get<double>() == tree.unregularised);
  CHECK(out.at("D_uniform").get<double>() == tree.uniform);
  CHECK(out.at("above_uniform").get<double>() == tree.above_uniform);
  CHECK(out.at("estimator") == "knn");
  CHECK(out.at("N") == tree.samples);
  CHECK(out.at("flags") == json::array());
  CHECK(out.at("coverage") == 0.8);

  // A graph search draws no proposals: no figure, never 0.
  const json& skeleton = run.at("levels").at(3);
  CHECK(skeleton.at("proposals") == 0);
  const json& none = skeleton.at("measure").at("expansion").at("self");
  for (const char* name : {"D", "SE", "above_uniform", "coverage", "estimator"}) CHECK(none.at(name).is_null());
  CHECK(none.at("N") == 0);
  const json& censored = skeleton.at("measure").at("root").at("tree").at("self");
  CHECK(censored.at("D") == "inf");
  CHECK(censored.at("flags") == json({"censored"}));

  // An unsolved run has no target.
  const json& unsolved = document.at("runs").at(6);
  REQUIRE(unsolved.at("solved") == false);
  CHECK(unsolved.at("levels").at(0).at("measure").is_null());
}

TEST_CASE("JSON summary", "[report][json]") {
  const json document = parsed();
  REQUIRE(document.at("summary").size() == 2);
  const json& plain = document.at("summary").at(0);
  CHECK(plain.at("problem") == "simple_passage");
  CHECK(plain.at("strategy") == "rrt");
  CHECK(plain.at("runs") == 15);
  CHECK(plain.at("solved") == 14);
  CHECK(plain.at("success").at("value").get<double>() == Approx(14.0 / 15.0));
  CHECK(plain.at("length").contains("lo"));
  // What runs and the table of the measure have stands there alone, but for the means that figures correlate.
  for (const json& entry : document.at("summary")) {
    for (const json& level : entry.at("levels")) CHECK_FALSE(level.contains("measure"));
  }
  const RunsSummary nested =
      summarise(facts_of(fixture::passage().first, fixture::passage().second), "simple_passage", "nested");
  const json& means = document.at("summary").at(1).at("means").at("tree").at("self");
  CHECK(means.at("runs") == nested.levels.front().own.tree.scored);
  CHECK(means.at("D_uniform").get<double>() == nested.levels.front().own.tree["D_uniform"].value);

  // Several problems: one more entry per strategy, over all of them.
  const auto [experiment, result] = fixture::queries();
  const json many = json::parse(fixture::report_json(experiment, result, ""));
  REQUIRE(many.at("summary").size() == 101);
  CHECK(many.at("summary").at(100).at("problem").is_null());
  CHECK(many.at("summary").at(100).at("runs") == 100);
  CHECK(many.at("summary").at(100).at("solved") == 95);
}

TEST_CASE("JSON stays valid whatever the names and figures", "[report][json]") {
  auto [experiment, result] = fixture::passage();
  experiment.measure.reset();
  result.runs[0].run.seconds = std::numeric_limits<double>::quiet_NaN();
  result.runs[0].run.length = std::numeric_limits<double>::infinity();
  const json document = json::parse(fixture::report_json(experiment, result, "\xff\"\n.lua"));
  CHECK(document.at("experiment").at("measure").is_null());
  CHECK(document.at("runs").at(0).at("time_s").is_null());
  CHECK(document.at("runs").at(0).at("length") == "inf");
  CHECK(document.at("script") == "\xEF\xBF\xBD\"\n.lua");
}

TEST_CASE("JSON has the verdicts and warnings of the printed report", "[report][json]") {
  auto [experiment, result] = fixture::passage();
  // A guide that costs more than none, and fails.
  for (RunResult& run : result.runs) {
    if (run.strategy == "nested") run.run.validity_checks *= 100;
  }
  result.runs[20].run.solved = false;
  result.runs[20].run.status = Status::budget_spent;
  Resolves& resolves = result.runs[16].levels[2].record.resolves;
  resolves.rejections = 2;
  resolves.invalid_path = 1;
  resolves.exhausted = true;
  result.runs[16].run.improvements = {{120, 0.5, 14.0}, {300, 0.75, 12.5}};
  const json document = test::with_levels(json::parse(fixture::report_json(experiment, result, "")));
  const std::string printed = report_text(summarise(facts_of(experiment, result)), 160, ReportKind::levels);
  const auto one_line = [](std::string text) {
    std::string out;
    for (const char c : text) {
      if (c == '\n' || c == ' ') {
        if (!out.ends_with(' ')) out += ' ';
      } else {
        out += c;
      }
    }
    return out;
  };

  REQUIRE(document.at("warnings").size() == 1);
  CHECK(document.at("warnings").at(0).at("problem") == "simple_passage");
  const auto warning = document.at("warnings").at(0).at("text").get<std::string>();
  CHECK(warning.find("nested costs more validity checks than rrt") == 0);
  CHECK(one_line(printed).find("warning: " + warning) != std::string::npos);

  const json& nested = document.at("summary").at(1);
  REQUIRE(nested.at("strategy") == "nested");
  const auto unsolved = nested.at("unsolved_reasons").get<std::string>();
  CHECK(one_line(printed).find("nested: " + unsolved) != std::string::npos);
  CHECK(nested.at("levels").at(0).at("verdict").is_null());
  for (std::size_t i = 1; i < 4; ++i) {
    const json& verdict = nested.at("levels").at(i).at("verdict");
    const std::string word = verdict.at("verdict");
    CAPTURE(i, word);
    const std::string level = nested.at("levels").at(i).at("name");
    const std::size_t row = printed.find("└ " + level);
    REQUIRE(row != std::string::npos);
    const std::string line = printed.substr(row, printed.find('\n', row) - row);
    CHECK(line.find(word) != std::string::npos);
    CHECK((!verdict.contains("pairs_needed") || word == "not shown"));
    CHECK(verdict.at("pairs") == 15);
    if (verdict.contains("explained_by")) {
      CHECK(line.ends_with("; " + verdict.at("explained_by").get<std::string>() + ")"));
    }
  }
  CHECK(document.at("summary").at(0).at("unsolved_reasons").is_string());

  const json& level = document.at("runs").at(16).at("levels").at(2);
  CHECK(level.at("resolved_for").at("rejections") == 2);
  CHECK(level.at("resolved_for").at("invalid_path") == 1);
  CHECK(level.at("resolved_for").at("changed_world") == 0);
  CHECK(level.at("exhausted") == true);
  CHECK(level.at("limit_reached") == false);
  const json& improvements = document.at("runs").at(16).at("improvements");
  REQUIRE(improvements.size() == 2);
  CHECK(improvements.at(1) == json({{"checks", 300}, {"cpu_s", 0.75}, {"length", 12.5}}));
}
