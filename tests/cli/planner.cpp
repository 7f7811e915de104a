// SPDX-License-Identifier: GPL-3.0-or-later
// The command with a planner that a program registers: examples/planner, and names that are refused.
#include <cstddef>
#include <nlohmann/json.hpp>
#include <string>

#include "support/catch.hpp"
#include "support/process.hpp"

using Catch::Matchers::Contains;
using Json = nlohmann::json;
using trellis::test::content;
using trellis::test::Outcome;
using trellis::test::Place;

namespace {

/// Runs a program of the tests in the folder of the place.
Outcome run(const Place& place, const std::string& command) {
  return place.shell("export PATH='" TRELLIS_PROGRAMS "':\"$PATH\"\n" + command);
}

}  // namespace

SCENARIO("a planner of one's own runs under guides", "[cli][planner][slow]") {
  const std::string script = "'" TRELLIS_SOURCE "/examples/planner/nested.lua'";
  GIVEN("the program of examples/planner") {
    const Place place;
    WHEN("it runs a nested strategy") {
      const Outcome one = run(place, "my_trellis run " + script + " --json one.json --report levels --width 120");
      const Outcome two = run(place, "my_trellis run " + script + " --json two.json --jobs 2 --quiet");
      THEN("every run is solved, at each level by the named planner, with the same proposals for two threads") {
        INFO(one.err);
        REQUIRE(one.status == 0);
        REQUIRE(two.status == 0);
        const Json first = Json::parse(content(place / "one.json"))["runs"];
        const Json second = Json::parse(content(place / "two.json"))["runs"];
        REQUIRE(first.size() == 20);
        for (std::size_t i = 0; i < first.size(); ++i) {
          CHECK(first[i]["validity_checks"] == second[i]["validity_checks"]);
          CHECK(first[i]["path"] == second[i]["path"]);
        }
        CHECK_THAT(one.out, Contains("nested") && Contains("solved 10/10 runs"));
        CHECK_THAT(one.out, Contains("shrink(0.5)  ") && Contains("sampled_rrt"));
      }
    }
    WHEN("its words are asked for") {
      THEN("help, the reference, the stubs, luacheck's configuration and completion have the planner") {
        CHECK_THAT(run(place, "my_trellis help sampled_rrt").out,
                   Contains("sampled_rrt (planner): RRT that extends") && Contains("candidates") && Contains("bound"));
        CHECK_THAT(run(place, "my_trellis help").out, Contains("  sampled_rrt "));
        CHECK_THAT(run(place, "my_trellis reference").out, Contains("sampled_rrt"));
        CHECK_THAT(run(place, "my_trellis reference stubs").out, Contains("sampled_rrt"));
        CHECK_THAT(run(place, "my_trellis reference luacheck").out, Contains("sampled_rrt"));
        CHECK_THAT(run(place, "my_trellis reference words").out, Contains("sampled_rrt\n"));
        CHECK_THAT(run(place, "echo 'sampled_rt {}' | my_trellis repl").err, Contains("did you mean 'sampled_rrt'?"));
        CHECK_THAT(run(place, "echo 'sampled_rrt { canddates = 2 }' | my_trellis repl").err,
                   Contains("did you mean 'candidates'?"));
      }
    }
  }
}

SCENARIO("a registered planner hides no word of the language", "[cli][planner]") {
  GIVEN("a program that registers a planner under a given name") {
    const Place place;
    place.script("own.lua", "return skeleton() >> own { proposals = 20 }, scenes.cup()\n");
    WHEN("the name is free") {
      const Outcome out = run(place, "named_planner own run own.lua");
      THEN("it runs until its budget is spent") {
        CHECK(out.status == 0);
        CHECK_THAT(out.out, Contains("20 proposals spent"));
      }
    }
    WHEN("the name belongs to something else") {
      THEN("the message says to what") {
        CHECK_THAT(run(place, "named_planner prm run own.lua").err, Contains("there is a planner 'prm' already"));
        CHECK_THAT(run(place, "named_planner shrink run own.lua").err, Contains("there is a guide 'shrink' already"));
        CHECK_THAT(run(place, "named_planner print run own.lua").err, Contains("'print' is a word of Lua already"));
        CHECK_THAT(run(place, "named_planner problem run own.lua").err,
                   Contains("'problem' is a word of the language already"));
        CHECK(run(place, "named_planner problem run own.lua").status == 2);
      }
    }
  }
}

SCENARIO("the steps of a planner without proposals end", "[cli][planner]") {
  GIVEN("a planner that plans such steps and does not override Planner::work") {
    const Place place;
    place.script("alone.lua", "return waits(), scenes.cup()\n");
    place.script("below.lua", "return identity { planner = waits() } >> rrt { step = 0.05 }, scenes.cup()\n");
    THEN("the run fails and names the planner, at the root and below") {
      for (const char* const script : {"alone.lua", "below.lua"}) {
        CAPTURE(script);
        const Outcome out = run(place, std::string("named_planner own run --quiet ") + script);
        CHECK(out.status == 1);
        CHECK_THAT(out.err, Contains("the planner 'waits' plans a step without a proposal, and does not override "
                                     "Planner::work"));
      }
    }
  }
  GIVEN("a planner whose steps do nothing") {
    const Place place;
    place.script("alone.lua", "return works { seconds = 0.2 }, scenes.cup()\n");
    place.script("below.lua", "return identity { planner = works { seconds = 0.2 } } >> rrt(), scenes.cup()\n");
    THEN("the limit of seconds ends them") {
      const Outcome out = run(place, "named_planner own run alone.lua");
      CHECK(out.status == 0);
      CHECK_THAT(out.out, Contains("budget spent") || Contains("spent"));
      CHECK(run(place, "named_planner own run --quiet below.lua").status == 0);
    }
  }
}
