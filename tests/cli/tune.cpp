// SPDX-License-Identifier: GPL-3.0-or-later
// trellis tune, and tune(...) in a session.
#include <string>

#include "support/catch.hpp"
#include "support/process.hpp"

using Catch::Matchers::Contains;
using trellis::test::content;
using trellis::test::Outcome;
using trellis::test::Place;

namespace {

// The longest step is by far the cheapest in the cup.
constexpr const char* script = R"(
return tune(function(p) return p.guide >> rrt { step = p.step } end, scenes.cup(), {
  over = { guide = { shrink(0.5), skeleton() }, step = { 0.02, 0.03, 0.6 } },
  budget = 120,
}))";

}  // namespace

SCENARIO("trellis tune prints the best strategy to paste", "[cli][tune][slow]") {
  GIVEN("a script that returns a tuning") {
    const Place place;
    place.script("own.lua", script);
    WHEN("it is tuned by one thread and by two") {
      const Outcome one = place.run({"tune", "own.lua"});
      const Outcome two = place.run({"tune", "own.lua", "--jobs", "2"});
      THEN("both print the same, with the known best step, its intervals and held-out seeds") {
        INFO(one.err);
        REQUIRE(one.status == 0);
        CHECK(one.out == two.out);
        CHECK_THAT(one.out, Contains(", step = 0.6\n") && Contains(">> rrt { step = 0.6 }\n"));
        CHECK_THAT(one.out, Contains("guide = shrink(0.5), step = 0.02 (start)"));
        CHECK_THAT(one.out, Contains("that nothing was selected on, the winner has 0.") && Contains("p <0.001"));
      }
      THEN("its last line is a strategy in the language") {
        const std::size_t last = one.out.rfind('\n', one.out.size() - 2) + 1;
        place.script("pasted.lua", "return " + one.out.substr(last, one.out.size() - last - 1) + ", scenes.cup()\n");
        CHECK(place.run({"run", "pasted.lua", "--quiet"}).status == 0);
      }
    }
    WHEN("it is checked and run") {
      const Outcome checked = place.run({"check", "own.lua"});
      const Outcome ran = place.run({"run", "own.lua", "--seeds", "2", "--width", "200"});
      THEN("it is an experiment of all its strategies") {
        CHECK(checked.status == 0);
        CHECK(ran.status == 0);
        CHECK_THAT(ran.out, Contains("guide = skeleton(), step = 0.03"));
      }
    }
    WHEN("the budget is too small") {
      const Outcome out = place.run({"tune", "own.lua", "--budget", "10"});
      THEN("the message has the least budget") {
        CHECK(out.status == 2);
        CHECK_THAT(out.err, Contains("a budget of 10 runs is too small: 6 strategies on 1 problem require at least "));
      }
    }
  }
  GIVEN("a script that returns an experiment") {
    const Place place;
    place.script("other.lua", "return rrt {}, scenes.cup()\n");
    WHEN("it is tuned") {
      const Outcome out = place.run({"tune", "other.lua"});
      THEN("the message says what to return") {
        CHECK(out.status == 2);
        CHECK_THAT(out.err, Contains("other.lua: the script returns no tuning; end it with 'return tune("));
      }
    }
  }
}

SCENARIO("tune in a session runs at once and returns the best strategy", "[cli][tune]") {
  GIVEN("a session with a script that returns a tuning") {
    const Place place;
    place.script("own.lua", script);
    WHEN("the session tunes") {
      const Outcome out = place.shell(
          "printf '%s\\n' 'script.strategies[\"guide = skeleton(), step = 0.6\"]' "
          "'best = tune(function(p) return rrt { step = p.step } end, scenes.cup(), "
          "{ over = { step = { 0.02, 0.6 } }, budget = 40 })' 'best:hash() == (rrt { step = 0.6 }):hash()' "
          "'help \"tune\"' | $T repl own.lua");
      THEN("the script's tuning has not run, the session's has") {
        INFO(out.err);
        CHECK(out.status == 0);
        CHECK_THAT(out.out, Contains("skeleton()  searched by") && Contains("\n-- step = 0.6\nrrt { step = 0.6 }\n"));
        CHECK_THAT(out.out, Contains("\ntrue\n"));
        CHECK_THAT(out.out, Contains("budget") && Contains("the largest number of runs"));
      }
    }
  }
}
