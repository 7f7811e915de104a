// SPDX-License-Identifier: GPL-3.0-or-later
// trellis verify: paths of results are validated again.
#include <fmt/format.h>
#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "support/catch.hpp"
#include "support/process.hpp"

using Json = nlohmann::json;
using trellis::test::content;
using trellis::test::Outcome;
using trellis::test::Place;

namespace {

constexpr const char* script = R"(
return experiment {
  problems = { scenes.cup(), scenes.trap() },
  strategies = { guided = skeleton() >> rrt { step = 0.5 }, plain = rrt { step = 0.5, proposals = 20000 } },
  seeds = 3, measure = false,
}
)";

constexpr const char* driven = R"(
return holonomic() >> kinodynamic_rrt { proposals = 20000 }, problem {
  name = "yard", world = world { bounds = {0, 0, 4, 4}, box {1.8, 0, 2.2, 2} }, robot = robot.rectangle(0.4, 0.2),
  motion = motion.unicycle1 {}, start = {0.5, 0.5, 0}, goal = {3.5, 0.5, 0}, goal_tolerance = 0.3,
}
)";

/// A folder with a script and its results.
struct Results {
  explicit Results(const char* text = script) {
    place.script("it.lua", text);
    REQUIRE(place.run({"run", "it.lua", "--quiet", "--json", "it.json"}).status == 0);
  }
  [[nodiscard]] Json document() const { return Json::parse(content(place / "it.json")); }
  void write(const Json& json) const { std::ofstream(place / "it.json") << json; }
  [[nodiscard]] Outcome verify() const { return place.run({"verify", "it.json"}); }

  Place place;
};

}  // namespace

TEST_CASE("paths of a run are certified, and their smallest clearance is that of the document") {
  const Results results;
  double least = 1.0;
  const Json document = results.document();
  for (const Json& run : document["runs"]) {
    CHECK(run["certified"] == true);
    CHECK(run["clearance"] > 0.0);
    least = std::min(least, run["clearance"].get<double>());
  }
  const Outcome outcome = results.verify();
  CHECK(outcome.status == 0);
  CHECK(outcome.out == fmt::format("12 of 12 paths certified, smallest clearance {:.3g} m\n", least));
}

TEST_CASE("paths in space are certified") {
  const Results results(R"(
return rrt_connect { step = 0.5 }, problem {
  name = "plate", world = world { bounds = {0, 0, 0, 4, 4, 4}, box {1.9, 0, 0, 1.92, 3, 4} },
  robot = robot.rigid { box {-0.2, -0.1, -0.1, 0.2, 0.1, 0.1} },
  start = pose {1, 1, 1}, goal = pose {3, 1, 1},
}
)");
  const Outcome outcome = results.verify();
  CHECK(outcome.status == 0);
  CHECK(outcome.out.find(" of 1 paths certified, smallest clearance ") == 1);
}

TEST_CASE("a path through a wall that is thinner than the resolution is refuted") {
  const Results results(R"(
return rrt_connect {}, problem {
  name = "thin", world = world { bounds = {0, 0, 1, 1}, box {0.5, 0, 0.503, 0.9}, box {0.25, 0.1, 0.253, 1} },
  robot = robot.point(), start = {0.1, 0.1}, goal = {0.9, 0.1},
}
)");
  Json json = results.document();
  json["runs"][0]["path"] = Json::parse("[[0.1, 0.1], [0.9, 0.1]]");
  results.write(json);
  const Outcome outcome = results.verify();
  CHECK(outcome.status == 1);
  CAPTURE(outcome.out);
  CHECK(outcome.out.find("the path is invalid between the points 1 and 2: (") != std::string::npos);
  CHECK(outcome.out.find("touches obstacle ") != std::string::npos);
}

TEST_CASE("a path through an obstacle is named, with the place and the obstacle") {
  const Results results;
  Json json = results.document();
  auto& path = json["runs"][0]["path"];
  const Json first = path.front();
  const Json last = path.back();
  path = Json::array({first, last});
  json["runs"][1]["path"].back()[0] = 0.5;
  json["runs"][2]["path"].erase(0);
  results.write(json);
  const Outcome outcome = results.verify();
  CHECK(outcome.status == 1);
  CAPTURE(outcome.out);
  CHECK(outcome.out.find("cup: guided, seed 1: the path is invalid between the points 1 and 2: (") == 0);
  CHECK(outcome.out.find("touches obstacle") != std::string::npos);
  CHECK(outcome.out.find("cup: guided, seed 2: the path does not end at the goal\n") != std::string::npos);
  CHECK(outcome.out.find("cup: guided, seed 3: the path does not begin at the start\n") != std::string::npos);
  CHECK(outcome.out.find("9 of 12 paths certified") != std::string::npos);
}

TEST_CASE("a trajectory must drive the robot along its path") {
  const Results results(driven);
  Json json = results.document();
  REQUIRE(json["runs"][0]["solved"] == true);
  CHECK(results.verify().status == 0);
  json["runs"][0]["trajectory"]["controls"][0][0] = 0.0;
  results.write(json);
  const Outcome outcome = results.verify();
  CHECK(outcome.status == 1);
  CHECK(outcome.out.find("the path is not where its controls drive the robot, at point ") != std::string::npos);
  for (auto& control : json["runs"][0]["trajectory"]["controls"]) control = Json::array({control[0]});
  results.write(json);
  CHECK(results.verify().out.find("the path cannot be driven: control 1 of the trajectory") != std::string::npos);
  json["runs"][0]["trajectory"]["steps"][0] = 4000000000U;
  results.write(json);
  CHECK(results.verify().out.find("states, and its controls drive the robot through 40000") != std::string::npos);
}

TEST_CASE("results of another script, and what is no document, are refused") {
  const Results results;
  results.place.script("other.lua", "return rrt {}, scenes.simple_passage()\n");
  const Outcome other = results.place.run({"verify", "it.json", "--script", "other.lua"});
  CHECK(other.status == 2);
  CHECK(other.err == "trellis: other.lua: no problem is called 'cup'; --script names the script of the results\n");
  results.write(Json::array());
  const Outcome none = results.verify();
  CHECK(none.status == 2);
  CHECK(none.err == "trellis: it.json: this is no document that trellis run --json writes\n");
}
