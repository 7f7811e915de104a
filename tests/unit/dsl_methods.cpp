// SPDX-License-Identifier: GPL-3.0-or-later
// The methods of the standard library match docs/methods.md, and compose with all guides.
#include <string>
#include <vector>

#include "support/catch.hpp"
#include "support/script.hpp"

using namespace trellis;
using test::failure;
using test::value;
using test::values;

TEST_CASE("the methods of the paper are written in the language from parts") {
  CHECK(value("strategies.dr_rrt() == skeleton { follow = 'regions', prune = false, emphasis = 1, region = 2, "
              "explore = 0.5, decay = 0.9, alignment = 0.1, drop = 1000, resolves = 0 } >> rrt { uniform = 0, bound = "
              "0 }") == "true");
  CHECK(value("strategies.irc { scales = {0.25, 0.5} } == "
              "shrink { 0.5, follow = 'waypoints', keep_tree = true, evidence = 100, resolves = 10, "
              "planner = rrt { uniform = 0.5, bound = 0 } } "
              ">> shrink { 0.5, follow = 'waypoints', keep_tree = true, evidence = 100, resolves = 10, "
              "planner = rrt { uniform = 0.5, bound = 0 } } >> rrt { uniform = 0.5, bound = 0 }") == "true");
  CHECK(value("strategies.vonasek { paths = 2 } == shrink { 0.5, follow = 'waypoints', evidence = 100, resolves = 10, "
              "paths = 2, inhibit = 'bottlenecks', planner = rrt { uniform = 0.1, bound = 0 } } >> rrt { uniform = "
              "0.5, bound = 0 }") == "true");
}

TEST_CASE("every method takes options, and most another planner") {
  for (const std::string name : {"dr_rrt", "irc", "vonasek", "nested"}) {
    CAPTURE(name);
    CHECK(value("tostring(strategies." + name +
                " { planner = prm { batch = 5 } }):match('>> prm { batch = 5 }$') ~= nil") == "true");
    CHECK(failure("strategies." + name + " { plannner = prm {} }").find("unknown field 'plannner'") !=
          std::string::npos);
    CHECK(failure("strategies." + name + "(5)").find("takes a table") != std::string::npos);
  }
  CHECK(value("strategies.dr_rrt { region = 3, step = 0.25 } == "
              "skeleton { follow = 'regions', prune = false, emphasis = 1, region = 3, alignment = 0.1, drop = 1000, "
              "resolves = 0 } >> "
              "rrt { uniform = 0, step = 0.25, bound = 0 }") == "true");
  CHECK(value("strategies.irc { scales = {0.5}, planner = rrt_connect {} } == "
              "shrink { 0.5, follow = 'waypoints', keep_tree = true, evidence = 100, resolves = 10, "
              "planner = rrt_connect {} } >> rrt_connect {}") == "true");
  CHECK(value("strategies.vonasek { planner = prm {} } == strategies.several { planner = prm {} } >> prm {}") ==
        "true");
}

TEST_CASE("the methods' guides serve at any level") {
  CHECK(value("strategies.regions() >> shrink(0.5) >> rrt_connect {} == "
              "skeleton { follow = 'regions', prune = false, emphasis = 1, alignment = 0.1, drop = 1000, resolves = "
              "0 } >> shrink(0.5) >> rrt_connect "
              "{}") == "true");
  CHECK(
      value("tostring(blend { strategies.several(), strategies.relaxation { scales = {0.5} } } >> prm {})") ==
      "blend { shrink { 0.5, follow = \"waypoints\", evidence = 100, resolves = 10, paths = 3, "
      "inhibit = \"bottlenecks\", planner = rrt { uniform = 0.1, bound = 0 } }, shrink { 0.5, keep_tree = true, "
      "follow = \"waypoints\", evidence = 100, resolves = 10, planner = rrt { uniform = 0.5, bound = 0 } } } >> prm()");
  CHECK(value("skeleton() >> strategies.irc { scales = {0.5} } == "
              "(skeleton() >> strategies.relaxation { scales = {0.5} }) >> rrt { uniform = 0.5, bound = 0 }") ==
        "true");
}

TEST_CASE("the paper's experiment lists every method under its name, and the presets of the authors' library") {
  // A script in the folder of the examples.
  const auto of_paper = [](const std::string& expression) {
    dsl::Session session(TRELLIS_SOURCE "/examples");
    const auto all = session.evaluate("local attali = require 'paper.attali' return " + expression, "test.lua");
    REQUIRE(all.size() == 1);
    return all.front();
  };
  CHECK(of_paper("#attali.scenes()") == "3");
  CHECK(of_paper("#attali.methods()") == "9");
  CHECK(of_paper("attali.methods()[2][1]") == "lazy_prm");
  CHECK(of_paper("attali.methods { rrt = { step = 0.25 } }[1][2] == rrt { step = 0.25 }") == "true");
  CHECK(of_paper("attali.methods()[6][2] == rrt_connect {}") == "true");
  CHECK(of_paper("attali.methods { hybrid = { step = 0.25 } }[8][2] == "
                 "0.5*strategies.regions() + 0.5*strategies.relaxation() >> rrt { uniform = 0.1, step = 0.25 }") ==
        "true");
  CHECK(of_paper("attali.methods()[9][2] == "
                 "blend { strategies.regions(), strategies.relaxation(), decay = 0.98 } >> rrt { uniform = 0.1 }") ==
        "true");
  CHECK(of_paper("select(2, pcall(attali.methods, { ircc = {} }))").find("there is no method 'ircc'") !=
        std::string::npos);
  CHECK(of_paper("#attali.presets()") == "4");
  CHECK(of_paper("attali.presets()[4][2] == strategies.irc { goal_bias = 0 }") == "true");
  CHECK(of_paper("attali.preset 'rrt' == rrt { goal_bias = 0 }") == "true");
  CHECK(of_paper("attali.preset 'dr_rrt' == skeleton { follow = 'regions', prune = false, emphasis = 1, penetration = "
                 "1, drop = 0, resolves = 0 } >> rrt { uniform = 0, goal_bias = 0, bound = 0 }") == "true");
  CHECK(of_paper("attali.preset('lazy_prm', { samples = 100, batch = 20, neighbours = 10, proposals = 50000 }) == "
                 "lazy_prm { remove = 'first' }") == "true");
}
