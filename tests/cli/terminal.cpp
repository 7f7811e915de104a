// SPDX-License-Identifier: GPL-3.0-or-later
// Text that leaves for the terminal: it has nothing that a terminal obeys, and a stderr that takes nothing changes no
// status.
#include <algorithm>
#include <string>
#include <vector>

#include "support/catch.hpp"
#include "support/process.hpp"
#include "support/terminal.hpp"

using Catch::Matchers::Contains;
using trellis::test::content;
using trellis::test::Outcome;
using trellis::test::Place;
using trellis::test::Terminal;

namespace {

constexpr const char* quick = "return rrt { step = 0.5 }, scenes.cup()\n";

/// Whether a text has control characters other than line feeds and tabs.
bool has_controls(const std::string& text) {
  return std::any_of(text.begin(), text.end(), [](char c) {
    const auto byte = static_cast<unsigned char>(c);
    return (byte < 0x20 && c != '\n' && c != '\t') || byte == 0x7f;
  });
}

}  // namespace

TEST_CASE("names and messages of scripts and files reach the terminal as text") {
  const Place place;
  // A name that clears the screen, sets the title, ends at a NUL for C, and turns the direction of the text.
  const std::string name = R"('a\27[2J\27]0;title\7\0b\r\u{9b}1m\u{202e}')";
  place.script("named.lua", "print(" + name + ")\nreturn experiment { problems = problem { name = " + name +
                                ", world = world { bounds = {0, 0, 10, 10}, box { 4, 0, 6, 10, name = " + name +
                                " } }, robot = robot.point(), start = {1, 1}, goal = {9, 9} }, strategies = { [" +
                                name + "] = rrt { proposals = 10 } }, seeds = 2 }\n");
  place.script("error.lua", "error(" + name + ")\n");
  place.script("thrown.lua",
               "local t = setmetatable({}, { __tostring = function() return " + name + " end }) print(t) error(t)\n");
  place.script("syntax.lua", "x = = '\x1b[31m'\n");
  place.script("unknown.lua", "return rrt { ['\\27[31m'] = 1 }, scenes.cup()\n");
  place.script("scenario_test.lua", "scenario(" + name +
                                        ", function() expect(when { rrt {}, problem = scenes.cup(), "
                                        "seeds = 2 }, solves(" +
                                        "):at_least(2)) end)\n");
  place.script("map\x1b[31m.map", "type octile\nheight x\n");
  place.script("inputs", "x = " + name + "\nx\n{ x }\nprint(x)\nerror(x)\n");
  for (const std::string command :
       {"run named.lua", "run named.lua --quiet", "run named.lua --full", "check named.lua", "explain named.lua",
        "run error.lua", "check thrown.lua", "check syntax.lua", "check unknown.lua", "test scenario_test.lua",
        "scene 'map\x1b[31m.map'", "run 'no\x1b[31m.lua'", "\x1b[31m", "run named.lua --out 'folder\x1b[31m'",
        "run named.lua --problem '\x1b[31m'", "repl < inputs", "repl named.lua < inputs"}) {
    const Outcome outcome = place.shell("$T " + command);
    INFO(command << "\n" << outcome.out << outcome.err);
    CHECK(outcome.status < 128);
    CHECK_FALSE(has_controls(outcome.out));
    CHECK_FALSE(has_controls(outcome.err));
    CHECK(outcome.out.find('\0') == std::string::npos);
    CHECK((outcome.out + outcome.err).find("\xe2\x80\xae") == std::string::npos);
  }
  const Outcome printed = place.run({"run", "named.lua", "--quiet"});
  CHECK_THAT(printed.out, Contains(R"(a\x1b[2J\x1b]0;title\x07\x00b\x0d\u{009b}1m\u{202e})"));
  // Documents keep the names as they are.
  REQUIRE(place.run({"run", "named.lua", "--quiet", "--json", "all.json"}).status == 0);
  CHECK_THAT(content(place / "all.json"), Contains(R"(a\u001b[2J\u001b]0;title\u0007\u0000b)"));
}

TEST_CASE("a session draws in colour, and shows other control characters as text") {
  const Place place;
  place.script("named.lua",
               "return rrt {}, problem { name = 'a\\27[2J', world = world { bounds = {0, 0, 10, 10} }, "
               "robot = robot.point(), start = {1, 1}, goal = {9, 9} }\n");
  Terminal terminal(place / "", {"repl", "named.lua"}, {{"TRELLIS_HISTORY", ""}, {"NO_COLOR", ""}});
  CHECK_THAT(terminal.wait_for(Terminal::prompt), Contains("a\\x1b[2J"));
  CHECK_THAT(terminal.enter("plan(script.strategies.strategy)"), Contains("run 1 on a\\x1b[2J"));
  CHECK_THAT(terminal.enter("plot()"), Contains("\x1b[38;5;"));
  CHECK_THAT(terminal.enter("'\\27[2J'"), Contains("\\x1b[2J\r\n"));
}

TEST_CASE("where stderr cannot be written, every command ends with its own status") {
  const Place place;
  place.script("quick.lua", quick);
  place.script("wrong.lua", "return rrt { stp = 1 }, scenes.cup()\n");
  place.script("closed.lua",
               "return rrt { proposals = 10 }, problem { world = world { bounds = {0, 0, 10, 10}, box {4, 0, 6, 10} }, "
               "robot = robot.point(), start = {1, 1}, goal = {9, 9} }\n");
  place.script("fails_test.lua",
               "scenario 'fails' (function() expect(when { rrt { proposals = 1 }, problem = scenes.cup(), seeds = 2 }, "
               "solves():at_least(2)) end)\n");
  place.script("boom", "boom\n");
  REQUIRE(place.run({"run", "quick.lua", "--quiet", "--json", "all.json"}).status == 0);
  for (const std::string command : {"run quick.lua",
                                    "run closed.lua",
                                    "run wrong.lua",
                                    "run none.lua",
                                    "run quick.lua --nothing",
                                    "run quick.lua --learn paths.db",
                                    "run quick.lua --quiet --html /dev/full",
                                    "check wrong.lua",
                                    "check closed.lua",
                                    "explain wrong.lua",
                                    "test fails_test.lua",
                                    "test wrong.lua",
                                    "scene none.map",
                                    "experience none.db",
                                    "verify none.json",
                                    "report none.json --html page.html",
                                    "report none.json --baseline a --figures tables",
                                    "measure none.json",
                                    "tune quick.lua",
                                    "sweep none.lua --out swept",
                                    "merge none --out merged",
                                    "experience --data none --out a.model",
                                    "new quick",
                                    "help nothing_like_it",
                                    "reference nothing",
                                    "nothing",
                                    "",
                                    "repl < boom",
                                    "repl wrong.lua < boom",
                                    "version",
                                    "help"}) {
    const Outcome outcome = place.shell("$T " + command);
    CHECK(outcome.status < 128);
    for (const std::string to : {"2>&-", "2>/dev/full", "2</dev/null"}) {
      const Outcome silent = place.shell("$T " + command + " " + to);
      INFO(command << " " << to);
      CHECK(silent.status == outcome.status);
    }
  }
}
