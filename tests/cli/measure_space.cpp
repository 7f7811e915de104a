// SPDX-License-Identifier: GPL-3.0-or-later
// The measure of bodies in space, as the report shows it.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string>

#include "support/catch.hpp"
#include "support/process.hpp"
#include "support/results.hpp"

using Json = nlohmann::ordered_json;
using Catch::Matchers::Contains;
using trellis::test::content;
using trellis::test::Place;

namespace {

/// A bar between a sill and a lintel.
std::string script(const std::string& measure) {
  return "local w = world { bounds = {0, 0, 0, 10, 10, 4}, box {4, 0, 0, 6, 10, 1.5}, box {4, 0, 2.5, 6, 10, 4} }\n"
         "local bar = robot.rigid { box {-1, -.1, -.1, 1, .1, .1} }\n"
         "return experiment { seeds = 5, strategies = { rrt = rrt { step = 1 } }, " +
         measure +
         ",\n  problems = problem { name = 'slot', world = w, robot = bar, start = pose {1.5, 5, 3}, goal = pose {8, "
         "5, "
         "3} } }\n";
}

}  // namespace

TEST_CASE("samples of a body in space have a bound as their headline, and the report says so", "[slow]") {
  const Place place;
  for (const std::string distance : {"planar", "full"}) {
    CAPTURE(distance);
    place.script("slot.lua", script("measure = tube { delta = 0.5, distance = '" + distance + "' }"));
    const auto outcome = place.run({"run", "slot.lua", "--report", "full", "--json", "out.json"});
    INFO(outcome.err);
    REQUIRE(outcome.status == 0);
    CHECK_THAT(
        outcome.out,
        Contains("SE(3) 6") && Contains("l  at most: from mass and arc length alone, which do not show losses across"));
    const Json document = trellis::test::with_levels(Json::parse(content(place / "out.json")));
    std::size_t scored = 0;
    for (const Json& run : document["runs"]) {
      const Json& tree = run["levels"][0]["measure"]["tree"]["self"];
      if (tree["SE"].is_null()) continue;
      ++scored;
      CHECK(tree["estimator"] == "arc");
      const auto flagged = [&](const char* flag) {
        return std::find(tree["flags"].begin(), tree["flags"].end(), flag) != tree["flags"].end();
      };
      CHECK(flagged("lower bound"));
      CHECK_FALSE(flagged("underpowered"));
      CHECK(tree["SE"].get<double>() >= 0.0);
      // Proposals of RRT have a density: uniform, and the goal.
      const Json& expansion = run["levels"][0]["measure"]["expansion"]["self"];
      CHECK(expansion["estimator"] == "exact");
      CHECK(expansion["SE"].get<double>() == Approx(expansion["D_uniform"].get<double>()).margin(0.06));
    }
    CHECK(scored > 0);
  }
}

TEST_CASE("a target that a space does not have is named before the run") {
  const Place place;
  place.script("slot.lua", script("measure = near_optimal { epsilon = 0.2 }, estimators = arc()"));
  for (const char* verb : {"check", "run"}) {
    const auto outcome = place.run({verb, "slot.lua"});
    INFO(verb << "\n" << outcome.err);
    CHECK(outcome.status == 0);
    CHECK_THAT(
        outcome.err,
        Contains("experiment on problem 'slot': near_optimal has no target in SE(3): from 5 degrees of freedom on"));
  }
}

TEST_CASE("samples of a body in space, of any program: the columns of its quaternion are named") {
  const Place place;
  const double w = 0.5;
  Json c = {{"dim", 7},
            {"coords", {"x", "y", "z", "qx", "qy", "qz", "qw"}},
            {"weights", {1, 1, 1, w, w, w, w}},
            {"lo", {0, 0, 0, -1, -1, -1, -1}},
            {"hi", {10, 10, 10, 1, 1, 1, 1}},
            {"periodic", {false, false, false, false, false, false, false}},
            {"rotations", {{"qx", "qy", "qz", "qw"}}},
            {"path", {{2, 5, 5, 0, 0, 0, 1}, {8, 5, 5, 0, 0, 0.70711, 0.70711}}},
            {"distance", "planar"},
            {"delta", 0.5},
            {"samples", "samples.csv"}};
  // Half of the samples on the path, with quaternions of few decimals; half far from it.
  std::string rows = "x,y,z,qx,qy,qz,qw\n";
  for (int i = 0; i < 1000; ++i) {
    const double angle = 0.003 * i;
    rows += fmt::format("{:.4f},{},5,0,0,{:.5f},{:.5f}\n", 2.0 + 0.006 * i, i % 2 == 0 ? 5.0 : 8.0, std::sin(angle),
                        std::cos(angle));
  }
  place.script("samples.csv", rows);
  const auto measured = [&](const Json& document) {
    place.script("case.json", document.dump());
    return place.run({"measure", "case.json", "--json", "-"});
  };
  const auto outcome = measured(c);
  INFO(outcome.err);
  REQUIRE(outcome.status == 0);
  const Json figures = Json::parse(outcome.out);
  CHECK(figures["estimator"] == "arc");
  CHECK(figures["n"] == 500);
  CHECK(figures["outside"] == 0);
  // All rotations belong to the target: |A| is that of a capsule times 8 pi^2 w^3.
  const double pi = 3.14159265358979;
  const double capsule = pi * 0.25 * 6.0 + 4.0 / 3.0 * pi * 0.125;
  CHECK(figures["vol_T"].get<double>() == Approx(capsule * 8.0 * pi * pi * w * w * w).epsilon(0.03));
  CHECK(figures["D_uniform"].get<double>() == Approx(std::log(1000.0 / capsule)).margin(0.03));
  CHECK(figures["D_mass"].get<double>() == Approx(std::log(2.0)));
  CHECK(figures["D"].get<double>() == Approx(std::log(2.0)).margin(0.1));

  c["rotations"] = {{"qx", "qy", "qw", "qz"}};
  CHECK_THAT(measured(c).err, Contains("must be four neighbouring coordinates of coords, in their order"));
  c["rotations"] = {{"qx", "qy", "qz", "qw"}};
  c["weights"][4] = 0.7;
  CHECK_THAT(measured(c).err, Contains("needs one weight, metres per radian"));
  c["weights"][4] = w;
  c["path"][0][6] = 0.8;
  CHECK_THAT(measured(c).err, Contains("path: configuration 1 of 2 has a quaternion of a norm that is not 1"));
}
