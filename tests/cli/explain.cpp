// SPDX-License-Identifier: GPL-3.0-or-later
// trellis explain: the hierarchy and its settings, level by level.
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "support/catch.hpp"
#include "support/golden.hpp"
#include "support/process.hpp"

using Json = nlohmann::json;
using trellis::test::check_golden;
using trellis::test::content;
using trellis::test::Outcome;
using trellis::test::Place;
namespace fs = std::filesystem;

namespace {

constexpr const char* mixture = R"(
local mixed = (0.7 * (skeleton() >> shrink(0.5)) + 0.2 * goal_bias(0.2) + 0.1 * bridge_test()) >> rrt { step = 0.4 }
return experiment {
  problems = { scenes.cup(), scenes.trap() },
  strategies = { mixed = mixed, plain = rrt_connect { proposals = 900 } },
  measure = false,
}
)";

std::string example(const std::string& name) { return (fs::path(TRELLIS_SOURCE) / "examples" / name).string(); }

}  // namespace

TEST_CASE("a hierarchy is explained as it was read and approved") {
  const Place place;
  const Outcome outcome = place.run({"explain", example("nested.lua"), "--strategy", "nested"});
  CHECK(outcome.status == 0);
  CHECK(outcome.err.empty());
  check_golden("explain_nested.txt", outcome.out);
}

TEST_CASE("a mixture is explained as it was read and approved") {
  const Place place;
  place.script("mixed.lua", mixture);
  const Outcome outcome = place.run({"explain", "mixed.lua"});
  CHECK(outcome.status == 0);
  CHECK(outcome.err.empty());
  check_golden("explain_mixture.txt", outcome.out);
}

TEST_CASE("every strategy of the catalogue's example is explained, with the levels that run") {
  const Place place;
  const Outcome outcome = place.run({"explain", example("catalogue.lua"), "--json", "-"});
  INFO(outcome.err);
  REQUIRE(outcome.status == 0);
  const Json document = Json::parse(outcome.out);
  REQUIRE(document["strategies"].size() > 25);
  for (const Json& strategy : document["strategies"]) {
    INFO(strategy["strategy"]);
    CHECK(strategy["root"]["level"] == 0);
    const Json& guide = strategy["root"]["guide"];
    CHECK(guide.is_null() == (strategy["strategy"] == "unguided" || strategy["strategy"] == "rrt"));
    if (guide.is_null()) continue;
    CHECK_FALSE(guide["f"].get<std::string>().empty());
    CHECK_FALSE(guide["h"].get<std::string>().empty());
    CHECK_FALSE(guide["density"].get<std::string>().empty());
  }
  const Outcome text = place.run({"explain", example("catalogue.lua"), "--strategy", "guiding_space"});
  CHECK(text.out.find("written at") != std::string::npos);
  CHECK(text.out.find("robot that S checks") != std::string::npos);
}

TEST_CASE("explain chooses strategies and problems by name, and writes the document beside the text") {
  const Place place;
  place.script("mixed.lua", mixture);
  const Outcome one =
      place.run({"explain", "mixed.lua", "--strategy", "plain", "--problem", "trap", "--json", "it.json"});
  REQUIRE(one.status == 0);
  CHECK(one.out.starts_with("plain on trap\n"));
  CHECK(one.out.find("mixed") == std::string::npos);
  const Json document = Json::parse(content(place / "it.json"));
  REQUIRE(document["strategies"].size() == 1);
  CHECK(document["strategies"][0]["problem"] == "trap");
  CHECK(document["strategies"][0]["root"]["limits"]["proposals"] == 900);
}

TEST_CASE("explain names what is wrong, and the nearest right name") {
  const Place place;
  place.script("mixed.lua", mixture);
  const auto fails = [&](std::vector<std::string> arguments, const std::string& message) {
    arguments.insert(arguments.begin(), "explain");
    const Outcome outcome = place.run(arguments);
    CHECK(outcome.status == 2);
    CHECK(outcome.out.empty());
    CHECK(outcome.err == "trellis: " + message + "\n");
  };
  fails({"mixed.lua", "--strategy", "mixd"},
        "--strategy: the script has none that is called 'mixd' (did you mean 'mixed'?); it has: mixed, plain");
  fails({"mixed.lua", "--problem", "cups"},
        "--problem: the script has none that is called 'cups' (did you mean 'cup'?); it has: cup, trap");
  place.script("wrong.lua", "local step = 1\nreturn shrnk(0.5) >> rrt {}, scenes.cup()\n");
  fails({"wrong.lua"}, "wrong.lua:2: unknown name 'shrnk' (did you mean 'shrink'?)");
  CHECK(place.run({"explain", "mixed.lua", "--width", "20"}).status == 2);
  place.script("driven.lua", "return kinodynamic_rrt {}, scenes.cup()\n");
  const Outcome refused = place.run({"explain", "driven.lua"});
  CHECK(refused.status == 2);
  CHECK(refused.err.find("drives a motion model and this space has none") != std::string::npos);
}
