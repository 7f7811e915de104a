// SPDX-License-Identifier: GPL-3.0-or-later
// All mistakes of a file in one pass, warnings of what does something else than it seems to, and runs that are watched
// or interrupted.
#include <signal.h>  // NOLINT(modernize-deprecated-headers): kill is POSIX's

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "support/catch.hpp"
#include "support/golden.hpp"
#include "support/process.hpp"
#include "support/terminal.hpp"

namespace fs = std::filesystem;
using Json = nlohmann::json;
using Catch::Matchers::Contains;
using trellis::test::content;
using trellis::test::Place;

namespace {

// Every line has at least one, of another kind each.
constexpr const char* seeded = R"(local room = world { bounds = {0, 0, 10}, disk(1, 2, 3) }
local open = world { bounds = {0, 0, 10, 10}, box(4, 0, 6, 4.75), obstacles = 3 }
local rod = robot.rectangle(0.6)
local p = problem { world = room, robot = rod, start = {1, 1, 0}, goal = {9, 1, 0}, resolutoin = 0.1 }
local q = problem { world = world { bounds = {0, 0, 9, 9} }, robot = robot.point(), start = {1, 1, 0}, goal = {8, 1} }
local nested = skeletn() >> shrink(0.5) >> rrt {}
local guided = skeleton() >> shrink { scale = -1, resolvs = 3 } >> rrt {}
local mixed = rrt {} + shrink(0.5)
local function later() return gauss() end
local strategies = { nested = nested, guided = guided, plain = rrt }
return experiment { problems = { p, q, scenes.cupp() }, strategies = strategies, seeds = 0, baseline = "plan" }
)";

std::size_t lines_of(const std::string& text) {
  return static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
}

/// Waits until a file has the text.
void wait_for(const std::string& file, const std::string& text) {
  for (int i = 0; i < 3000 && content(file).find(text) == std::string::npos; ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  CHECK_THAT(content(file), Contains(text));
}

}  // namespace

TEST_CASE("check and run report all mistakes of a script in one pass, by line") {
  const Place place;
  place.script("seeded.lua", seeded);
  const auto checked = place.run({"check", "seeded.lua"});
  CHECK(checked.status == 2);
  CHECK(checked.out.empty());
  trellis::test::check_golden("mistakes.txt", checked.err);
  const auto run = place.run({"run", "seeded.lua"});
  CHECK(run.status == 2);
  CHECK(run.out.empty());
  CHECK(run.err == checked.err);
}

TEST_CASE("what follows a mistake gives no message of its own", "[slow]") {
  const Place place;
  const std::string end = "return experiment { problems = p, strategies = { a = s } }\n";
  const std::vector<std::string> scripts = {
      "local p = scenes.cup { widht = 1 }\nlocal s = rrt {}\n",
      "local p, s = scenes.cup(), skeletn() >> shrink(0.5) >> rrt {}\nprint(tostring(s) .. '!', #s, s < 3, -s, "
      "s.x.y)\n",
      "local p, s = {}, rrt {}\nfor i, one in ipairs(shrink(2)) do p[i] = one end\n"
      "for k, one in pairs(p[1]) do p[k] = one end\n",
      "local p, s = scenes.cup(), 0.5 * shrink { scale = 2 } + blend { shrink(0.5), skeleton() } >> rrt {}\n",
      "local p, s = scenes.cup(), rrt {}\nlocal n = shrink(2)\nfor i = 1, n do print(i) end\n",
      "local p, s = scenes.cup(), rrt {}\nlocal n = require 'nothing'\nprint(string.rep('a', n.size), n.f(3):g())\n",
      "local p, s = scenes.cup(), rrt {}\nlocal t = setmetatable({}, { __index = shrink(2) })\nprint(t.a)\n",
      "local p, s = scenes.cup(), rrt {}\nwhile shrink(2) > 1 do end\n"};
  for (const std::string& script : scripts) {
    INFO(script);
    place.script("one.lua", script + end);
    const auto outcome = place.run({"check", "one.lua"});
    CHECK(outcome.status == 2);
    INFO(outcome.err);
    CHECK(lines_of(outcome.err) == 1);
  }
  // A script that catches an error still does.
  place.script("caught.lua",
               "local fine, why = pcall(shrink, 2)\nassert(not fine and why:find('scale'))\n"
               "local c = coroutine.create(function() return shrink(2) end)\nassert(not coroutine.resume(c))\n"
               "local p, s = scenes.cup(), rrt {}\n" +
                   end);
  CHECK(place.run({"check", "caught.lua"}).status == 0);
  // The script's own error, and Lua's, end it; they stand beside the mistakes before.
  place.script("thrown.lua", "local s = shrink(2)\nlocal t = nil + 1\nreturn t\n");
  const auto thrown = place.run({"check", "thrown.lua"});
  CHECK_THAT(thrown.err, Contains("thrown.lua:1: shrink: option 'scale'") &&
                             Contains("thrown.lua:2: attempt to perform arithmetic on a nil value") &&
                             Contains("trellis: 2 mistakes\n"));
}

TEST_CASE("very many mistakes are counted") {
  const Place place;
  std::string script;
  for (int i = 1; i <= 60; ++i) script += "shrink(" + std::to_string(i + 1) + ")\n";
  place.script("many.lua", script);
  const auto outcome = place.run({"check", "many.lua"});
  CHECK(outcome.status == 2);
  CHECK_THAT(outcome.err, Contains("many.lua:50: ") && !Contains("many.lua:51: ") &&
                              Contains("trellis: and 10 more\n") && Contains("trellis: 60 mistakes\n"));
}

TEST_CASE("a syntax error says what Lua writes instead") {
  const Place place;
  const std::string comment = "a comment begins with '--' in Lua";
  const std::string carry_on = "Lua has no 'continue': write 'goto continue'";
  const std::string blocks = "Lua has no blocks in braces: write ";
  const std::vector<std::pair<std::string, std::string>> scripts = {
      {"// all of it\nreturn 1\n", comment},
      {"local x = 1 // a comment\nreturn x\n", comment},
      {"# a comment\nlocal x = # y z\n", "near"},
      {"local a = x ? 1 : 2\n", "Lua has no 'a ? b : c': write 'a and b or c'"},
      {"for i = 1, 3 {\n  print(i)\n}\n", blocks + "for i = 1, 3 do ... end"},
      {"if (x) {\n  y()\n}\n", blocks + "if a then ... end"},
      {"while x {\n  y()\n}\n", blocks + "while a do ... end"},
      {"function f(a) {\n  return a\n}\n", blocks + "function f(a) ... end"},
      {"for i = 1, 3 do\n  if i == 2 then continue end\nend\n", carry_on},
      {"while true do\n  continue\nend\n", carry_on},
      {"local t = { 1, , 2 }\n", "is a value missing before this comma, or is there one comma too many?"},
      {"local t = { a = 1 b = 2 }\n", "is a comma missing before 'b'?"},
      {"if a != b then end\n", "Lua writes ~= for 'not equal'"},
      {"var x = 1\n", "Lua writes 'local x = 1' where others write 'var'"},
      {"local t = { 'a // b c', 1 2 }\n", "is a comma missing before '2'?"}};
  for (const auto& [script, hint] : scripts) {
    INFO(script);
    place.script("bad.lua", script);
    const auto outcome = place.run({"check", "bad.lua"});
    CHECK(outcome.status == 2);
    CHECK_THAT(outcome.err, Contains("trellis: bad.lua:") && Contains(hint));
    CHECK(lines_of(outcome.err) == 1);
  }
}

TEST_CASE("readers report all mistakes of a file") {
  const Place place;
  place.script("all_obstacles.txt", "3\nx y r\n0 1 2 0.5\n1 one 2 0.5\n2 1 2 -1\n3 1 2\n");
  place.script("all_queries.txt", "0 start: 1 1\n0 goal: 2 2\n1 begin: 1 1\n2 start: 1 x\n");
  place.script("circles.lua", "return rrt {}, scenes.load 'all_obstacles.txt'\n");
  const auto circles = place.run({"check", "circles.lua"});
  CHECK(circles.status == 2);
  INFO(circles.err);
  for (const std::string part :
       {"all_obstacles.txt:4: x is 'one'", "all_obstacles.txt:5: the radius is -1", "all_obstacles.txt:6: a row of 3",
        "all_queries.txt:3: 'begin:'", "all_queries.txt:4: y is 'x'", "all_queries.txt:4: query 2 has no 'goal:'",
        "trellis: 6 mistakes\n"}) {
    CHECK_THAT(circles.err, Contains(part));
  }
  place.script("case.json", R"({ "dim": 2, "coords": ["x", "x"], "weights": [1, "1"], "lo": [0], "hi": [1, 1],
    "periodic": [false, 1], "path": [[0, 0], [1, 1]], "delta": -1, "samples": "", "seeds": 3 })");
  const auto measured = place.run({"measure", "case.json"});
  CHECK(measured.status == 2);
  INFO(measured.err);
  for (const std::string part :
       {"unknown key 'seeds' (did you mean 'seed'?)", "coords holds 'x' twice", "weights must hold finite numbers",
        "lo must be a list of 2 numbers", "periodic must hold booleans", "delta must be", "samples must be",
        "trellis: 7 mistakes\n"}) {
    CHECK_THAT(measured.err, Contains(part));
  }
  place.script("good.json", R"({ "dim": 2, "coords": ["x", "y"], "weights": [1, 1], "lo": [0, 0], "hi": [1, 1],
    "periodic": [false, false], "path": [[0, 0], [1, 1]], "delta": 0.5, "samples": "bad.csv" })");
  place.script("bad.csv", "x,y\n0.5,0.5\n0.1,none\n0.2\n0.3,0.3,0.3\n");
  const auto samples = place.run({"measure", "good.json"});
  CHECK(samples.status == 2);
  CHECK_THAT(samples.err, Contains("bad.csv:3:5: y must be a finite number") && Contains("bad.csv:4:4: too few") &&
                              Contains("bad.csv:5:8: too many") && Contains("trellis: 3 mistakes\n"));
}

TEST_CASE("check and run warn of what does nothing, or something else than it seems to") {
  const Place place;
  const std::string box =
      "problem { world = world { bounds = {0, 0, 10, 10} }, robot = robot.rectangle(1, 0.5), "
      "start = {1, 1, 0}, goal = {9, 9, 0} }";
  const std::vector<std::pair<std::string, std::string>> scripts = {
      {"return joints { 1, 2 } >> rrt {}, " + box,
       "joints(\"1\", \"2\") in strategy 'strategy': the robot of problem 'problem' is a rigid body and has no joints; "
       "1 is its axis x, 2 is y. If S is to keep x, y, write joints { \"x\", \"y\" }"},
      {"return skeleton() >> (shrink(0.5) + bridge_test()) >> rrt {}, " + box,
       "one.lua:1: 'skeleton()' does not guide bridge_test(0.5): it searches no space (S = {0}) and stays unguided; "
       "where that is meant, write "
       "(skeleton() >> ...) + bridge_test(0.5)"},
      {"return experience() >> rrt {}, " + box,
       "there is no library 'experience.db', so it guides nothing; trellis run SCRIPT --learn experience.db makes it"},
      {"return learned() >> rrt {}, " + box,
       "there is no model 'learned.model', so it guides nothing; trellis experience --data makes it"}};
  for (const auto& [script, warning] : scripts) {
    INFO(script);
    place.script("one.lua", script + "\n");
    for (const std::string verb : {"check", "run"}) {
      const auto outcome = place.run({verb, "one.lua"});
      CHECK(outcome.status == 0);
      CHECK_THAT(outcome.err, Contains("trellis: warning: ") && Contains(warning));
    }
  }
  // What is meant gives no warning.
  place.script("fine.lua", "return joints { 'x', 'y' } >> rrt {}, " + box + "\n");
  CHECK(place.run({"check", "fine.lua"}).err.empty());
  place.script("plain.lua", "return ((skeleton() >> shrink(0.5)) + bridge_test()) >> rrt {}, " + box + "\n");
  CHECK(place.run({"check", "plain.lua"}).err.empty());
}

TEST_CASE("a library of another robot is named, with both robots") {
  const Place place;
  const std::string robots = "robot.rectangle(1, 0.5)";
  const auto script = [&](const std::string& name, const std::string& robot, const std::string& strategy) {
    place.script(name, "return " + strategy +
                           ", problem { name = 'yard', world = world { bounds = {0, 0, 10, 10} }, robot = " + robot +
                           ", start = {1, 1, 0}, goal = {9, 9, 0} }\n");
  };
  script("learn.lua", "robot.rectangle(1, 0.5)", "rrt {}");
  REQUIRE(place.run({"run", "learn.lua", "--learn", "paths.db", "--quiet"}).status == 0);
  script("same.lua", "robot.rectangle(1, 0.5)", "experience 'paths.db' >> rrt {}");
  CHECK(place.run({"check", "same.lua"}).err.empty());
  script("other.lua", "robot.rectangle(0.8, 0.4)", "experience 'paths.db' >> rrt {}");
  const auto other = place.run({"check", "other.lua"});
  CHECK(other.status == 0);
  CHECK_THAT(other.err, Contains("the library 'paths.db' has no path of the robot '") &&
                            Contains("' of problem 'yard' in SE(2), so it guides nothing there; its robots are that of "
                                     "problem 'yard' in SE(2); robots = \"any\" uses the paths of other robots"));
}

TEST_CASE("an interrupted run keeps what is finished, and says so") {
  const Place place;
  // The first seeds end at once, and one in the middle does not.
  place.script("slow.lua",
               "local world = world { bounds = {0, 0, 10, 10}, box(4, 0, 6, 10) }\n"
               "local p = problem { world = world, robot = robot.point(), start = {1, 1}, goal = {9, 9} }\n"
               "return experiment { problems = { scenes.cup(), p }, seeds = 3, measure = false,\n"
               "  strategies = { one = rrt { step = 0.5 }, two = rrt_connect { proposals = 1e9 } } }\n");
  trellis::test::Terminal terminal(place / "", {"run", "slow.lua", "--json", "all.json"});
  terminal.wait_for("planning 6/12");
  terminal.type("\x03");
  CHECK(terminal.finish() == 130);
  CHECK_THAT(
      terminal.rest(),
      Contains("cup") && Contains("trellis: interrupted; what is finished, and is kept: seeds 1 to 3 of the problem "
                                  "cup; the same command makes the rest"));
  const Json results = Json::parse(content(place / "all.json"));
  CHECK(results.at("runs").size() == 6);
  CHECK(results.at("experiment").at("problems").size() == 1);
}

TEST_CASE("run --watch runs again when the script or a module changes, until Ctrl-C") {
  const Place place;
  place.script("size.lua", "return 0.4\n");
  place.script("live.lua", "return rrt { step = require 'size' }, scenes.cup()\n");
  const pid_t child = place.start({"run", "live.lua", "--watch", "--report", "levels"});
  wait_for(place / "err", "trellis: watching live.lua, size.lua; Ctrl-C ends\n");
  CHECK_THAT(content(place / "out"), Contains("rrt { step = 0.4 }"));
  place.script("size.lua", "return 0.25\n");
  wait_for(place / "err", "trellis: size.lua has changed\ntrellis: watching");
  CHECK_THAT(content(place / "out"), Contains("rrt { step = 0.25 }"));
  place.script("live.lua", "return shrink(2) >> rrt {}, scenes.cupp()\n");
  wait_for(place / "err", "trellis: 2 mistakes\ntrellis: watching live.lua; Ctrl-C ends\n");
  place.script("live.lua", "return rrt { step = 0.75 }, scenes.cup()\n");
  wait_for(place / "out", "rrt { step = 0.75 }");
  ::kill(child, SIGINT);
  const auto outcome = place.finish(child);
  CHECK(outcome.status == 130);
  CHECK_THAT(outcome.err, Contains("interrupted"));
}

TEST_CASE("check draws a few samples where functions of the script guide") {
  const Place place;
  place.script("few.lua",
               "local mine = guiding_space {\n  space = {}, name = 'mine',\n"
               "  heuristic = function() return function(random) return random(), random() end end,\n}\n"
               "return mine >> rrt {}, scenes.cup()\n");
  const auto outcome = place.run({"check", "few.lua"});
  CHECK(outcome.status == 2);
  CHECK_THAT(outcome.err, Contains("few.lua:1: in mine >> rrt") && Contains("what the function that draws returns"));
  CHECK(lines_of(outcome.err) == 1);
}

TEST_CASE("what is wrong with a team names its robots") {
  const Place place;
  const auto fault = [&](const std::string& strategy, const std::string& start, const std::string& goal) {
    place.script("team.lua",
                 "local p = problem { name = 'four', world = world { bounds = {0, 0, 10, 10}, box {4, 4, 6, 6, name = "
                 "'block'} }, robot = robots { robot.disc(0.5), count = 4 }, start = " +
                     start + ", goal = " + goal + " }\nreturn experiment { problems = p, strategies = { a = " +
                     strategy + " }, seeds = 1, measure = false }\n");
    const auto run = place.run({"run", "team.lua", "--quiet"});
    CHECK(run.status == 2);
    return run.err;
  };
  const std::string start = "{ {1, 1}, {3, 1}, {5, 1}, {7, 1} }";
  const std::string goal = "{ {1, 9}, {3, 9}, {5, 9}, {7, 9} }";
  CHECK_THAT(fault("rrt_connect {}", "{ {1, 1}, {3, 1}, {5, 1}, {1.5, 1} }", goal),
             Contains("problem 'four': start (1, 1, 3, 1, 5, 1, 1.5, 1): robot 1 meets robot 4; a valid"));
  CHECK_THAT(fault("rrt_connect {}", start, "{ {1, 9}, {3, 9}, {3.5, 9}, {7, 9} }"),
             Contains("goal (1, 9, 3, 9, 3.5, 9, 7, 9): robot 2 meets robot 3; a valid"));
  CHECK_THAT(fault("rrt_connect {}", "{ {1, 1}, {3, 1}, {5, 5}, {7, 1} }", goal),
             Contains("): robot 3 is in collision with obstacle 1 (block); a valid"));
  CHECK_THAT(fault("skeleton() >> rrt_connect {}", start, goal),
             Contains("skeleton: '4 robots (disc)' is a team, which has no position of its own") &&
                 Contains("below team, decouple or prioritise"));
  CHECK_THAT(fault("team { 9 } >> rrt_connect {}", start, goal),
             Contains("team: no robot 9 in the team, which has 1, 2, 3, 4"));
}
