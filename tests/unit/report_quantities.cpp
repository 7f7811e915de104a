// SPDX-License-Identifier: GPL-3.0-or-later
// The table of quantities, and what follows from it.
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <set>
#include <string>

#include <trellis/base/error.hpp>
#include <trellis/results/quantities.hpp>
#include <trellis/results/records.hpp>

#include "report_fixture.hpp"
#include "support/catch.hpp"
#include "support/results.hpp"

using namespace trellis;
using Json = nlohmann::json;

namespace {

/// Whether an object has a quantity, under its name.
bool has(const Json& object, const Quantity& quantity) {
  if (*quantity.group == '\0') return object.contains(quantity.key);
  return object.contains(quantity.group) && object.at(quantity.group).contains(quantity.key);
}

}  // namespace

TEST_CASE("each quantity has one name, a meaning, and a place in documents", "[report]") {
  std::set<std::string> names;
  for (const Quantity& one : quantities()) {
    CAPTURE(one.name());
    CHECK(names.insert(one.name()).second);
    CHECK(quantity(one.name()).meaning == std::string(one.meaning));
    CHECK(std::string(one.meaning).size() > 10);
  }
  CHECK_THROWS_AS(quantity("undefended"), Fault);

  const auto [experiment, result] = fixture::passage();
  const Json document = test::with_levels(Json::parse(fixture::report_json(experiment, result)));
  const Json& run = document.at("runs").at(0);
  const Json& set = run.at("levels").at(0).at("measure").at("tree").at("self");
  const Json measured = Json::parse(measured_set(fixture::efficiency(2.4, 0.1, 100)));
  for (const RunQuantity& one : run_quantities()) CHECK(has(run, one));
  for (const MeasureQuantity& one : measure_quantities) {
    CAPTURE(one.name());
    // A column of a group that no set has is not there.
    const bool valued = !std::isnan(one.of_run(result.runs.front().levels.front().own->tree));
    if (valued || !one.in_runs) CHECK(has(set, one) == one.in_runs);
    CHECK(has(measured, one));
  }
  const std::string header = runs_csv_header();
  for (const RunQuantity& one : run_quantities()) CHECK(header.find("," + one.name() + ",") != std::string::npos);
}

TEST_CASE("a measured set keeps the estimates that bounds replace", "[report]") {
  Efficiency scored = fixture::efficiency(2.4, 0.1, 100);
  scored.perfect = 0.05;
  scored.mass = 1.2;
  scored.mass_lower95 = 1.0;
  scored.unregularised = 0.4;
  scored.others.push_back(Estimate{.estimator = "arc", .value = -0.2, .unregularised = -0.3, .above_uniform = 2.6});
  RunResult run = fixture::plain_run("p", 1, true);
  run.levels.front().own = Scores{scored, scored};
  const std::string line = run_line(facts_of(run));
  const Json set = Json::parse(line).at("levels").at(0).at("measure").at("tree").at("self");
  CHECK(set.at("D") == 1.0);
  CHECK(set.at("estimates").at("D") == 0.4);
  CHECK(set.at("others").at("arc").at("SE") == least_value(scored));

  const Efficiency* read = read_run(line).levels.front().score(&LevelScores::own, &Scores::tree);
  REQUIRE(read != nullptr);
  CHECK(read->unregularised == 0.4);
  CHECK(read->value == scored.value);
  CHECK(read->others.front().value == -0.2);
  CHECK(std::isnan(read->along.divergence));
}
