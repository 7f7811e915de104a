// SPDX-License-Identifier: GPL-3.0-or-later
// Runs the built program: exit statuses, output streams, and remaining files.
#include <signal.h>  // NOLINT(modernize-deprecated-headers): kill is POSIX's

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include "support/catch.hpp"
#include "support/process.hpp"
#include "support/timeless.hpp"

namespace fs = std::filesystem;
using Json = nlohmann::json;
using Catch::Matchers::Contains;
using trellis::test::content;
using trellis::test::Outcome;
using trellis::test::Place;

namespace {

constexpr const char* quick = "return rrt { step = 0.5 }, scenes.cup()\n";
// No path to the goal: a run that does not end by itself.
constexpr const char* endless = R"(
return experiment {
  problems = problem {
    world = world { bounds = {0, 0, 10, 10}, box {4, 0, 6, 10} }, robot = robot.point(), start = {1, 1}, goal = {9, 9},
  },
  strategies = { rrt = rrt { step = 0.001, proposals = 1e9 } },
  seeds = 1000,
}
)";

bool one_message(const Outcome& outcome) {
  return outcome.err.starts_with("trellis: ") && outcome.err.ends_with("\n") && outcome.out.empty();
}

}  // namespace

TEST_CASE("a run prints a report and ends with 0") {
  const Place place;
  place.script("quick.lua", quick);
  const auto outcome = place.run({"run", "quick.lua"});
  CHECK(outcome.status == 0);
  CHECK(outcome.out.find("cup") != std::string::npos);
  CHECK(outcome.err.empty());  // no progress bar where stderr is no terminal
  const auto quiet = place.run({"run", "quick.lua", "--quiet"});
  CHECK(quiet.status == 0);
  CHECK(quiet.out.empty());
  CHECK(quiet.err.empty());
}

TEST_CASE("an unsolved run is a result") {
  const Place place;
  place.script("hopeless.lua",
               "return rrt { step = 0.5, proposals = 50 }, problem { world = world { bounds = {0, 0, 10, 10}, "
               "box {4, 0, 6, 10} }, robot = robot.point(), start = {1, 1}, goal = {9, 9} }");
  const auto outcome = place.run({"run", "hopeless.lua"});
  INFO(outcome.err);
  CHECK(outcome.status == 0);
}

TEST_CASE("files are written where they are asked for") {
  const Place place;
  place.script("quick.lua", quick);
  const auto outcome =
      place.run({"run", "quick.lua", "--seeds", "2", "--seed", "5", "--json", "all.json", "--samples", "deep/samples"});
  INFO(outcome.err);
  CHECK(outcome.status == 0);
  const std::string json = content(place / "all.json");
  CHECK(json.find("\"script\"") != std::string::npos);
  CHECK(json.find("quick.lua") != std::string::npos);
  for (const std::string seed : {"5", "6"}) {
    for (const std::string file : {"samples.csv", "expansions.csv", "path.csv"}) {
      CHECK(fs::file_size(place / ("deep/samples/cup/strategy/seed-" + seed + "/" + file)) > 0);
    }
  }
  CHECK_FALSE(fs::exists(place / "deep/samples/cup/strategy/seed-7"));
}

TEST_CASE("a page is written where it is asked for") {
  const Place place;
  place.script("quick.lua", quick);
  const auto outcome = place.run({"run", "quick.lua", "--seeds", "2", "--html", "page.html"});
  INFO(outcome.err);
  CHECK(outcome.status == 0);
  CHECK(outcome.err.empty());
  const std::string page = content(place / "page.html");
  CHECK(page.starts_with("<!DOCTYPE html>"));
  CHECK(page.find("<title>Trellis: quick.lua</title>") != std::string::npos);
  CHECK(page.find("id=\"run-1\"") != std::string::npos);
  CHECK(page.ends_with("</html>\n"));
}

TEST_CASE("the command line asks for ablations and other paths", "[slow]") {
  const Place place;
  place.script("guided.lua",
               "return experiment { problems = scenes.cup(), seeds = 2, measure = tube { points = 256, pool = 1024 }, "
               "strategies = { guided = skeleton() >> rrt { step = 0.5 }, plain = rrt { step = 0.5 } } }");
  const auto outcome = place.run({"run", "guided.lua", "--ablate", "--cross", "0", "--json", "all.json"});
  INFO(outcome.err);
  CHECK(outcome.status == 0);
  const std::string json = content(place / "all.json");
  CHECK(json.find("guided without skeleton") != std::string::npos);
  CHECK(json.find("plain without") == std::string::npos);

  // One strategy with its ablations, and an ablation by its name.
  CHECK(place.run({"run", "guided.lua", "--strategy", "guided", "--ablate", "--cross", "0", "--json", "one.json"})
            .status == 0);
  const std::string one = content(place / "one.json");
  CHECK(one.find("\"guided without skeleton()\"") != std::string::npos);
  CHECK(one.find("\"plain\"") == std::string::npos);
  const auto ablated =
      place.run({"run", "guided.lua", "--strategy", "guided without skeleton()", "--ablate", "--cross", "0"});
  CHECK(ablated.status == 0);
  CHECK(place.run({"run", "guided.lua", "--strategy", "plain", "--ablate"}).err ==
        "trellis: --ablate: no strategy has a guide that could be taken out\n");

  place.script("quick.lua", quick);
  CHECK(place.run({"run", "quick.lua", "--ablate"}).err ==
        "trellis: --ablate: no strategy has a guide that could be taken out\n");
  place.script("unmeasured.lua",
               "return experiment { problems = scenes.cup(), strategies = { rrt {} }, measure = false }");
  CHECK(place.run({"run", "unmeasured.lua", "--cross", "1"}).err ==
        "trellis: --cross: the script measures nothing (measure = false)\n");
}

TEST_CASE("run --figures draws the figures of the document, and its tables", "[slow]") {
  if (!trellis::test::draws_figures()) return;
  const Place place;
  place.script("guided.lua",
               "return experiment { problems = scenes.cup(), seeds = 2, measure = tube { points = 256, pool = 1024 }, "
               "strategies = { guided = skeleton() >> rrt { step = 0.5 }, rrt = rrt { step = 0.5 } } }");
  const auto outcome =
      place.run({"run", "guided.lua", "--quiet", "--figures", "figures", "--json", "it.json", "--samples", "samples"});
  INFO(outcome.err);
  CHECK(outcome.status == 0);
  CHECK(outcome.out.empty());
  CHECK(outcome.err.empty());
  for (const std::string picture :
       {"costs", "success", "ratios", "world-cup", "levels_of_world-cup-guided", "strip-cup"}) {
    for (const std::string format : {"svg", "png", "pdf"}) {
      CAPTURE(picture, format);
      CHECK(fs::file_size(place / ("figures/" + picture + "." + format)) > 0);
    }
  }
  CHECK(content(place / "figures/costs.tex").find("\\toprule") != std::string::npos);
  // The same bytes from the stored document.
  REQUIRE(place.run({"report", "it.json", "--figures", "again"}).status == 0);
  for (const auto& entry : fs::directory_iterator(place / "figures")) {
    const std::string name = entry.path().filename().string();
    CAPTURE(name);
    const bool same = content(place / ("again/" + name)) == content(entry.path());
    CHECK(same);
  }
}

TEST_CASE("without matplotlib a run says what to install, and continues") {
  const Place place;
  place.script("plain.lua",
               "return experiment { problems = scenes.cup(), seeds = 1, measure = false, strategies = { rrt {} } }");
  const auto outcome =
      place.shell("TRELLIS_PYTHON=false $T run plain.lua --figures figures --html page.html --json it.json");
  CHECK(outcome.status == 2);
  CHECK(outcome.err.ends_with(
      "trellis: figures are drawn by Python 3 with matplotlib and pandas: install "
      "python3-matplotlib and python3-pandas (Debian), or set TRELLIS_PYTHON to a Python that has them\n"));
  CHECK_FALSE(outcome.out.empty());
  CHECK(content(place / "page.html").ends_with("</html>\n"));
  CHECK(fs::exists(place / "it.json"));
  CHECK(place.shell("TRELLIS_PYTHON=/no/such/python $T report it.json --figures figures")
            .err.find("install python3-matplotlib") != std::string::npos);
}

TEST_CASE("the samples do not depend on the number of jobs, or on the day") {
  const Place place;
  place.script("nested.lua",
               "return experiment { problems = scenes.simple_passage(), seeds = 2, measure = false, "
               "strategies = { nested = skeleton() >> shrink(0.5) >> lazy() >> rrt { step = 0.5 } } }");
  for (const std::string jobs : {"1", "2"}) {
    REQUIRE(place.run({"run", "nested.lua", "--quiet", "--jobs", jobs, "--samples", "jobs" + jobs}).status == 0);
  }
  REQUIRE(place.run({"run", "nested.lua", "--quiet", "--samples", "again"}).status == 0);
  for (const std::string seed : {"seed-1", "seed-2"}) {
    const std::string file = "/simple_passage/nested/" + seed + "/samples.csv";
    const std::string once = content(place / ("jobs1" + file));
    CHECK_FALSE(once.empty());
    CHECK(once == content(place / ("jobs2" + file)));
    CHECK(once == content(place / ("again" + file)));
  }
}

TEST_CASE("wrong usage ends with 2 and one message") {
  const Place place;
  place.script("quick.lua", quick);
  const std::vector<std::vector<std::string>> wrong = {{},
                                                       {"walk"},
                                                       {"run"},
                                                       {"run", "quick.lua", "--sedes", "3"},
                                                       {"run", "quick.lua", "another.lua"},
                                                       {"run", "quick.lua", "--seeds"},
                                                       {"run", "quick.lua", "--seeds", "0"},
                                                       {"run", "quick.lua", "--seeds", "-3"},
                                                       {"run", "quick.lua", "--seeds", "nan"},
                                                       {"run", "quick.lua", "--seeds", "1.5"},
                                                       {"run", "quick.lua", "--seeds", "1e3"},
                                                       {"run", "quick.lua", "--seeds", ""},
                                                       {"run", "quick.lua", "--seeds", "99999999999999999999"},
                                                       {"run", "quick.lua", "--seeds", "1000001"},
                                                       {"run", "quick.lua", "--seed", "-1"},
                                                       {"run", "quick.lua", "--seed", "9223372036854775808"},
                                                       {"run", "quick.lua", "--jobs", "0"},
                                                       {"run", "quick.lua", "--jobs", "many"},
                                                       {"run", "quick.lua", "--cross", "-1"},
                                                       {"run", "quick.lua", "--cross", "all"},
                                                       {"run", "quick.lua", "--figures", ""},
                                                       {"run", "quick.lua", "--html", ""},
                                                       {"run", "quick.lua", "--figures", "new", "--palette", "blue"},
                                                       {"run", "quick.lua", "--ablate"},
                                                       {"check"},
                                                       {"help", "shrnik"}};
  for (const auto& arguments : wrong) {
    std::string line;
    for (const auto& argument : arguments) line += " '" + argument + "'";
    const auto outcome = place.run(arguments);
    INFO(line << "\n" << outcome.err);
    CHECK(outcome.status == 2);
    CHECK(one_message(outcome));
  }
}

TEST_CASE("a script error ends with 2, names the line and writes nothing") {
  const Place place;
  place.script("wrong.lua", "\n\nreturn rrt { stp = 0.5 }, scenes.cup()\n");
  const auto outcome = place.run({"run", "wrong.lua", "--json", "all.json", "--samples", "samples"});
  CHECK(outcome.status == 2);
  CHECK(one_message(outcome));
  CHECK(outcome.err.starts_with("trellis: wrong.lua:3: rrt: unknown option 'stp' (did you mean 'step'?)"));
  CHECK_FALSE(fs::exists(place / "all.json"));
  CHECK_FALSE(fs::exists(place / "samples"));

  const auto missing = place.run({"run", "missing.lua"});
  CHECK(missing.status == 2);
  CHECK(missing.err == "trellis: cannot read 'missing.lua': No such file or directory\n");
  const auto folder = place.run({"run", "."});
  CHECK(folder.status == 2);
  CHECK(folder.err == "trellis: cannot read '.': it is a folder\n");
}

TEST_CASE("an output that cannot be written is found out before the run") {
  const Place place;
  place.script("endless.lua", endless);
  place.script("file", "a file");
  for (const std::vector<std::string>& output : {std::vector<std::string>{"--json", "no/such/folder/all.json"},
                                                 {"--json", "."},
                                                 {"--json", "file/all.json"},
                                                 {"--html", "no/such/folder/page.html"},
                                                 {"--html", "."},
                                                 {"--json", "/proc/none.json"},
                                                 {"--figures", "file"},
                                                 {"--samples", "file"},
                                                 {"--samples", "file/samples"},
                                                 {"--samples", "/proc/samples"}}) {
    std::vector<std::string> arguments = {"run", "endless.lua"};
    arguments.insert(arguments.end(), output.begin(), output.end());
    const auto outcome = place.run(arguments);
    INFO(output[0] << ' ' << output[1] << "\n" << outcome.err);
    CHECK(outcome.status == 2);
    CHECK(one_message(outcome));
    CHECK(outcome.err.find("cannot write '" + output[1] + "'") != std::string::npos);
  }
  CHECK(content(place / "file") == "a file");
}

TEST_CASE("check validates without planning") {
  const Place place;
  place.script("endless.lua", endless);
  place.script("wrong.lua", "return 42\n");
  const auto good = place.run({"check", "endless.lua"});
  CHECK(good.status == 0);
  CHECK(good.out.starts_with(
      "endless.lua: 1 problem, 1 strategy, 1000 seeds\n\n  rrt: rrt { step = 0.001, proposals = 1e+09 }\n    rrt"));
  CHECK(good.out.ends_with("\n  measured against tube {}, by exact, arc, knn, on 2 paths of other seeds too\n"));
  const auto both = place.run({"check", "wrong.lua", "endless.lua"});
  CHECK(both.status == 2);
  CHECK(both.err.starts_with("trellis: wrong.lua:1: the script returns 42"));
  CHECK(both.out.find("endless.lua: 1 problem") != std::string::npos);
}

TEST_CASE("check finds what a run would meet late: names in functions, guides that never draw") {
  const Place place;
  place.script("late.lua",
               "local mine = target {\n"
               "  sample = function(c) return ofset(c.path[1]) end,\n"
               "  log_density = function(q)\n"
               "    helper = helper or 1\n"
               "    return math.log(q[1] + offset) - skeletn\n"
               "  end,\n"
               "}\n"
               "offset = 1\n"
               "return experiment {\n"
               "  problems = scenes.cup(), measure = mine,\n"
               "  strategies = {\n"
               "    late = sequence { lazy(), skeleton(), turn = 500 } >> rrt { proposals = 300 },\n"
               "    unheard = shrink(0.5) >> rrt { uniform = 1 },\n"
               "  },\n"
               "}\n");
  const auto outcome = place.run({"check", "late.lua"});
  CHECK(outcome.status == 2);
  CHECK(outcome.out.starts_with("late.lua: 1 problem, 2 strategies, 1 seed\n"));
  CHECK(
      outcome.err ==
      "trellis: late.lua:2: unknown name 'ofset' (did you mean 'offset'?)\n"
      "trellis: late.lua:5: unknown name 'skeletn' (did you mean 'skeleton'?)\n"
      "trellis: 2 mistakes\n"
      "trellis: warning: late.lua:12: skeleton() never draws: its turn begins after 500 proposals, and rrt { proposals "
      "= 300 } ends after 300 (strategy 'late')\n"
      "trellis: warning: late.lua:13: shrink(0.5) never draws: rrt { uniform = 1 } leaves it no share of its proposals "
      "(uniform = 1, goal_bias = 0.05) (strategy 'unheard')\n");
}

TEST_CASE("inputs that are probably mistakes are warned of, by check and by run") {
  const Place place;
  place.script(
      "odd.lua",
      "local w = world { bounds = {0, 0, 10, 10}, box {4, 0, 5, 10} }\n"
      "return experiment { measure = false, strategies = { shrunken = shrink(0.5) >> rrt { proposals = 50 } }, "
      "problems = { problem { name = 'walled', world = w, robot = robot.point(), start = {1, 1}, goal = {{9, 9}, {9, "
      "1}} },\n"
      "  problem { name = 'halved', world = w, robot = robot.point(), start = {1, 1}, goal = {{9, 9}, {1, 9}} },\n"
      "  problem { name = 'turned', world = world { bounds = {0, 0, 10, 10} }, robot = robot.rectangle(0.6, 0.2), "
      "start = {1, 1, 90}, goal = {9, 9, 0} },\n"
      "  problem { name = 'wound', world = world { bounds = {0, 0, 10, 10} }, robot = robot.arm { links = {1}, base = "
      "{5, 5}, limits = { {-45, 45} } }, start = {0}, goal = {1} },\n"
      "  problem { name = 'usual', world = world { bounds = {0, 0, 10, 10} }, robot = robot.arm { links = {1}, base = "
      "{5, 5}, limits = { {math.rad(-720), math.rad(720)} } }, start = {0}, goal = {7} } } }\n");
  for (const char* verb : {"check", "run"}) {
    const auto outcome = place.run({verb, "odd.lua"});
    INFO(verb << "\n" << outcome.err);
    CHECK(outcome.status == 0);
    CHECK_THAT(outcome.err, Contains("warning: problem 'walled': obstacles separate start and goal") &&
                                Contains("a point, which has nothing to shrink") &&
                                Contains("problem 'turned': start: theta = 90 is more than a full turn") &&
                                Contains("math.rad(90) = 1.5708") && !Contains("'turned': obstacles") &&
                                !Contains("'halved': obstacles") &&
                                Contains("problem 'wound': the limits of joint 1, -45 and 45, are 14.3 turns apart") &&
                                Contains("math.rad(-45)") && !Contains("problem 'usual'"));
    CHECK((outcome.out.find("no run on walled can succeed: obstacles separate start and goal") != std::string::npos) ==
          (std::string(verb) == "run"));
  }
}

TEST_CASE("a single tree for the thin links of an arm is warned of") {
  const Place place;
  const auto warns = [&](const std::string& strategy) {
    place.script("arm.lua",
                 "return experiment { measure = false, strategies = { method = " + strategy +
                     " }, problems = problem { name = 'reach', world = world { bounds = {0, 0, 10, 10} }, "
                     "robot = robot.arm { links = {1, 1}, base = {5, 5} }, start = {0, 0}, goal = {1, 1} } }");
    const auto outcome = place.run({"check", "arm.lua"});
    INFO(strategy << "\n" << outcome.err);
    CHECK(outcome.status == 0);
    return outcome.err.find(
               "strategy 'method': of a robot that is fixed to its base, shrink makes only the links "
               "thinner") != std::string::npos;
  };
  CHECK(warns("strategies.irc {}"));
  CHECK(warns("strategies.vonasek {}"));
  CHECK_FALSE(warns("strategies.irc { planner = rrt_connect {} }"));
  CHECK_FALSE(warns("shrink(0.5) >> rrt {}"));
}

TEST_CASE("a resolution that is coarser than an obstacle is thick is warned of, by check, run and explain") {
  const Place place;
  const auto script = [&](const char* robot, const char* resolution) {
    place.script("coarse.lua",
                 std::string("return rrt { proposals = 10 }, problem { name = 'thin', world = world { bounds = {0, "
                             "0, 8, 8}, box {4, 0, 4.1, 6} }, robot = ") +
                     robot + ", start = {1, 1, 0}, goal = {7, 1, 0}, resolution = " + resolution + " }");
  };
  script("robot.rectangle(0.6, 0.2)", "2");
  for (const char* verb : {"check", "run", "explain"}) {
    const Outcome outcome = place.run({verb, "coarse.lua"});
    CAPTURE(verb, outcome.err);
    CHECK(outcome.err.find("warning: problem 'thin': between two configurations that are checked the robot moves by up "
                           "to resolution = 2 m, and obstacle 1 (box 4 0 4.1 6) is 0.1 m thick, the largest disc") !=
          std::string::npos);
    CHECK(outcome.err.find("with resolution = 0.3 it does not") != std::string::npos);
  }
  script("robot.rectangle(0.6, 0.2)", "0.3");
  CHECK(place.run({"check", "coarse.lua"}).err.find("thick") == std::string::npos);
}

TEST_CASE("a script alone is run, and a misspelt command is named with the nearest one") {
  const Place place;
  place.script("quick.lua", quick);
  const auto outcome = place.run({"quick.lua", "--quiet"});
  INFO(outcome.err);
  CHECK(outcome.status == 0);
  CHECK(place.run({"runn", "quick.lua"}).err ==
        "trellis: no command 'runn' (did you mean 'run'?); 'trellis help' shows the usage\n");
  const auto none = place.run({});
  CHECK(none.err.starts_with("trellis: no command given; there are: "));
  CHECK(none.status == 2);
}

TEST_CASE("a command of an earlier version is named with what replaces it") {
  const Place place;
  const auto said = [&](std::vector<std::string> words) {
    const auto outcome = place.run(std::move(words));
    CHECK(outcome.status == 2);
    CHECK(outcome.out.empty());
    return outcome.err;
  };
  const std::string more = "; 'trellis help' shows the usage\n";
  CHECK(said({"plot", "results.json"}) ==
        "trellis: no command 'plot': 'trellis report RESULTS --figures FOLDER' draws results" + more);
  CHECK(said({"compare", "a.json", "b.json"}) ==
        "trellis: no command 'compare': 'trellis report RESULTS RESULTS' compares results" + more);
  CHECK(said({"train", "--data", "worlds"}) ==
        "trellis: no command 'train': 'trellis experience --data FOLDER' trains a heuristic" + more);
}

TEST_CASE("check names inputs that are valid and probably mistakes") {
  const Place place;
  const std::string walls = "world { bounds = {0, 0, 10, 10}, box {4, 0, 6, 4.8}, box {4, 5.2, 6, 10} }";
  const std::string ends = ", start = {1, 8, 0}, goal = {9, 2, 0} }";
  const auto problem = [&](const std::string& robot) {
    return "problem { world = " + walls + ", robot = " + robot + ends;
  };
  const auto strategies = [](const std::string& of, const std::string& more = "") {
    return "return experiment { problems = { p }, strategies = { " + of + " }" + more + " }\n";
  };
  const std::string rim = "the reference point of the robot of problem 'problem' lies ";
  const std::vector<std::pair<std::string, std::string>> cases = {
      {"p = " + problem("robot.rigid { polygon { {0.3, 0}, {0.9, 0}, {0.9, 0.2}, {0.3, 0.2} } }") + "\n" +
           strategies("a = skeleton() >> rrt {}"),
       "skeleton() in strategy 'a': " + rim + "outside or on the rim of its body"},
      {"p = " + problem("robot.rigid { polygon { {0, 0}, {0.3, 0}, {0.3, 0.1}, {0, 0.1} } }") + "\n" +
           strategies("a = shrink(0.5) >> skeleton() >> rrt {}"),
       rim + "outside or on the rim of its body"},
      {"p = " + problem("robot.rectangle(0.8, 0.6)") + "\n" + strategies("a = rrt {}"),
       "problem 'problem': the robot fits no gap between start and goal: the widest route is 0.4 m wide, and the robot "
       "contains a disc 0.6 m wide about its reference point"},
      {"p = scenes.trap()\n" + strategies("a = informed() >> rrt {}"),
       "informed() in strategy 'a': it changes nothing: it draws uniformly until a path is known, and rrt ends with "
       "its "
       "first path; give it the option cost, or a planner that improves its path, such as rrt_star"},
      {"p = scenes.trap()\n" + strategies("a = rrt { step = 0.5 }, b = skeleton() >> rrt { step = 1 }"),
       "strategy 'b': its step is 1 m, and that of the baseline 'a' 0.5 m: the comparison shows the step and the guide "
       "together"},
      {"local world = world { bounds = {0, 0, 10, 10} }\np = scenes.trap()\n" + strategies("a = rrt {}"),
       "hint.lua:1: nothing uses the local 'world', which hides the word of the language"},
      {"p = scenes.trap()\n" + strategies("a = rrt {}", ", seed = 15"),
       "hint.lua:2: experiment: seed = 15 runs the seed 15 alone; seeds = 15 runs the seeds 1 to 15"},
      {"p = scenes.trap()\n" + strategies("a = rrt {}", ", seeds = {1, 2}, seed = 15"),
       "hint.lua:2: experiment: seed = 15 has no effect beside a list of seeds"},
  };
  for (const auto& [script, warning] : cases) {
    place.script("hint.lua", script);
    const auto outcome = place.run({"check", "hint.lua"});
    INFO(script << outcome.err);
    CHECK(outcome.status == 0);
    CHECK(outcome.err.starts_with("trellis: warning: "));
    CHECK(outcome.err.find(warning) != std::string::npos);
    CHECK(std::count(outcome.err.begin(), outcome.err.end(), '\n') == 1);
  }
  for (const std::string& script :
       {"p = " + problem("robot.rectangle(0.6, 0.2)") + "\n" + strategies("a = rrt {}, b = skeleton() >> rrt {}"),
        "local world = world { bounds = {0, 0, 10, 10} }\n"
        "p = problem { world = world, robot = robot.disc(0.2), start = {1, 1}, goal = {9, 9} }\n" +
            strategies("a = rrt {}"),
        "p = scenes.trap()\n" + strategies("a = informed() >> rrt_star {}, b = informed { cost = 20 } >> rrt {}"),
        "p = scenes.trap()\n" +
            strategies("a = rrt { step = 1 }, b = rrt { step = 2 }, c = skeleton() >> rrt { step = 2 }",
                       ", seeds = 3, seed = 15, baseline = 'a'")}) {
    place.script("hint.lua", script);
    const auto outcome = place.run({"check", "hint.lua"});
    INFO(script << outcome.err);
    CHECK(outcome.status == 0);
    CHECK(outcome.err.empty());
  }
  // The advice after runs that failed names the reason, too.
  place.script("hint.lua",
               "p = " + problem("robot.rectangle(0.8, 0.6)") + "\n" + strategies("a = rrt { proposals = 100 }"));
  CHECK(place.run({"run", "hint.lua"}).out.find("the robot fits no gap between start and goal") != std::string::npos);
}

TEST_CASE("errors of frequent mistakes say how to mend them") {
  const Place place;
  const std::vector<std::pair<std::string, std::string>> cases = {
      {"local world = world { bounds = {0, 0, 10, 10} }\nlocal w = world { bounds = {0, 0, 1, 1} }\n",
       "wrong.lua:2: attempt to call a world value (local 'world'); the local 'world' hides the word of the language: "
       "rename it"},
      {"return rrt {}, scenes.trap\n",
       "what follows the strategy must be a problem or a list of problems, got a function; call it, as scenes.trap()"},
      {"return rrt { stepsize = 0.5 }, scenes.trap()\n", "rrt: unknown option 'stepsize' (did you mean 'step'?)"},
  };
  for (const auto& [script, message] : cases) {
    place.script("wrong.lua", script);
    const auto outcome = place.run({"check", "wrong.lua"});
    INFO(outcome.err);
    CHECK(outcome.status == 2);
    CHECK(outcome.err.find(message) != std::string::npos);
  }
  CHECK(place.run({"help", "step"}).out.starts_with("step is an option or a field\n\nof rrt"));
  CHECK(place.run({"help", "arm"}).out.find("robot.arm") != std::string::npos);
  CHECK(place.run({"help", "obstacle"}).out.find("obstacle_based") != std::string::npos);
  CHECK(place.run({"help", "zebra"}).status == 2);
  CHECK(place.run({"help", "explan"}).err.find("did you mean 'explain'?") != std::string::npos);
  // A command's name explains the command; `tune` is a word of the language, too.
  CHECK(place.run({"help", "sweep"}).out == place.run({"sweep", "--help"}).out);
  const std::string tune = place.run({"help", "tune"}).out;
  CHECK(tune.starts_with("tune: "));
  CHECK(tune.ends_with(place.run({"tune", "--help"}).out));
}

TEST_CASE("the program prints its version and its words") {
  const Place place;
  // With the commit where the sources are a git repository.
  const std::string version = place.run({"version"}).out;
  const std::string commit = version.substr(std::min(version.size(), std::string("trellis " TRELLIS_VERSION).size()));
  INFO(version);
  CHECK(version.starts_with("trellis " TRELLIS_VERSION));
  CHECK((commit == "\n" || (commit.starts_with(" (") && commit.ends_with(")\n"))));
  CHECK(place.run({"--version"}).out == version);
  const auto all = place.run({"help"});
  CHECK(all.status == 0);
  CHECK(all.out.find("shrink") != std::string::npos);
  CHECK(place.run({"help", "shrink"}).out.find("scale") != std::string::npos);
  CHECK(place.run({"--help"}).status == 0);
  CHECK(place.run({"run", "--help"}).out.find("--samples") != std::string::npos);
  CHECK(all.out.find("measure ") != std::string::npos);
  CHECK(place.run({"measure", "--help"}).out.find("--estimator") != std::string::npos);
  CHECK(place.run({"help", "near_optimal"}).out.starts_with("near_optimal (target): "));
  CHECK(place.run({"help", "strategies.irc"}).out.starts_with("strategies.irc: "));
  place.script("ask.lua", "help 'shrink'\nreturn rrt { step = 0.5 }, scenes.cup()\n");
  CHECK(place.run({"run", "ask.lua", "--quiet"}).out == place.run({"help", "shrink"}).out);
}

TEST_CASE("the manual page and the completions have every verb and option of --help") {
  const Place place;
  const std::string page = place.run({"reference", "man"}).out;
  const std::string bash = place.run({"reference", "bash"}).out;
  const std::string fish = place.run({"reference", "fish"}).out;
  const std::string zsh = place.run({"reference", "zsh"}).out;
  CHECK(page.find(".TH TRELLIS 1 \"\" \"Trellis " TRELLIS_VERSION "\"") != std::string::npos);
  const std::string words = place.run({"reference", "words"}).out;
  CHECK(words.find("\nstrategies.irc\n") != std::string::npos);
  const std::string help = place.run({"--help"}).out;
  std::istringstream verbs(help.substr(help.find("Subcommands:\n") + 13));
  std::size_t count = 0;
  for (std::string verb, rest; verbs >> verb && std::getline(verbs, rest); ++count) {
    INFO(verb);
    CHECK(page.find(".SS \\fBtrellis " + verb + "\\fR") != std::string::npos);
    CHECK(bash.find("    " + verb + ")\n") != std::string::npos);
    CHECK(fish.find("__fish_use_subcommand -a " + verb + " ") != std::string::npos);
    CHECK(zsh.find("    " + verb + ")\n") != std::string::npos);
    std::istringstream options(place.run({verb, "--help"}).out);
    for (std::string option; options >> option;) {
      if (!option.starts_with("--") || option == "--") continue;
      const std::string name =
          option.substr(2, option.find(',') == std::string::npos ? option.npos : option.find(',') - 2);
      INFO(option);
      std::string escaped;
      for (const char c : "--" + name) escaped += c == '-' ? "\\-" : std::string(1, c);
      CHECK(page.find("\\fB" + escaped + "\\fR") != std::string::npos);
      CHECK(bash.find("--" + name) != std::string::npos);
      CHECK(fish.find(" -l " + name + " ") != std::string::npos);
      CHECK(zsh.find("'--" + name + "[") != std::string::npos);
    }
    // Every value has its own name.
    CHECK(place.run({verb, "--help"}).out.find(" TEXT ") == std::string::npos);
  }
  CHECK(count >= 7);
}

TEST_CASE("new writes a script that runs, and never over another", "[slow]") {
  const Place place;
  const auto made = place.run({"new", "mine"});
  INFO(made.err);
  CHECK(made.status == 0);
  CHECK(made.out ==
        "mine.lua: a strategy and an experiment to change; run it with: trellis run mine.lua\n"
        "mine_test.lua: what is expected of it; try it with: trellis test mine_test.lua\n");
  const std::string text = content(place / "mine.lua");
  CHECK(text.starts_with("-- mine: "));
  CHECK(text.find("trellis run mine.lua --html") != std::string::npos);
  CHECK(text.find('@') == std::string::npos);
  const auto report = place.run({"run", "mine.lua", "--seeds", "1"});
  INFO(report.err);
  CHECK(report.status == 0);
  CHECK(report.out.find("guided") != std::string::npos);
  const auto test = place.run({"test", "mine_test.lua"});
  INFO(test.out << test.err);
  CHECK(test.status == 0);
  CHECK(test.out.ends_with("\npassed: 2 scenarios, 4 expectations\n"));
  place.script("mine.lua", "mine");
  const auto again = place.run({"new", "mine"});
  CHECK(again.status == 2);
  CHECK(again.err == "trellis: new: 'mine.lua' exists already, and is left as it is; choose another name\n");
  CHECK(content(place / "mine.lua") == "mine");

  place.script("else_test.lua", "else");
  CHECK(place.run({"new", "else"}).err ==
        "trellis: new: 'else_test.lua' exists already, and is left as it is; choose another name\n");
  CHECK_FALSE(fs::exists(place / "else.lua"));

  fs::create_directories(place / "deep");
  CHECK(place.run({"new", "deep/other.lua"}).status == 0);
  CHECK(content(place / "deep/other_test.lua").find("script = \"other.lua\"") != std::string::npos);
  CHECK(content(place / "deep/other.lua").starts_with("-- other: "));
  CHECK(place.run({"new", "no/folder"}).err == "trellis: new: there is no folder 'no'\n");
  CHECK(place.run({"new", "my strategy"}).err ==
        "trellis: new: 'my strategy' is no name for a script: expected letters, digits and '_', a letter first, as "
        "my_strategy\n");
  CHECK(place.run({"new", "3d"}).err.find("a letter first, as _3d") != std::string::npos);
  CHECK(place.run({"new", ""}).status == 2);
  CHECK_FALSE(fs::exists(place / "my strategy.lua"));
}

TEST_CASE("the program writes its words out for other programs") {
  const Place place;
  CHECK(place.run({"reference"}).out.find("\n### shrink\n") != std::string::npos);
  CHECK(place.run({"reference", "markdown"}).out == place.run({"reference"}).out);
  CHECK(place.run({"reference", "stubs"}).out.starts_with("---@meta\n"));
  CHECK(place.run({"reference", "luacheck"}).out.find("stds.trellis = {") != std::string::npos);
  CHECK(place.run({"reference", "python"}).out.find("\ndef shrink(") != std::string::npos);
  CHECK(place.run({"reference", "stub"}).err ==
        "trellis: reference: no form 'stub' (did you mean 'stubs'?); there are: markdown, catalogue, stubs, luacheck, "
        "python, words, man, bash, fish, zsh\n");
}

TEST_CASE("Ctrl-C ends a run, and a script that loops, promptly with 130") {
  const Place place;
  place.script("endless.lua", endless);
  place.script("loop.lua", "while true do pcall(error) end");
  for (const std::string script : {"endless.lua", "loop.lua"}) {
    INFO(script);
    const pid_t child = place.start({"run", script, "--jobs", "2", "--json", "all.json", "--samples", "samples"});
    std::this_thread::sleep_for(std::chrono::milliseconds(700));
    ::kill(child, SIGINT);
    const auto start = std::chrono::steady_clock::now();
    const auto outcome = place.finish(child);
    CHECK(std::chrono::steady_clock::now() - start < std::chrono::seconds(5));
    CHECK(outcome.status == 130);
    CHECK(outcome.err.find("interrupted") != std::string::npos);
    CHECK_FALSE(fs::exists(place / "all.json"));
    CHECK_FALSE(fs::exists(place / "samples"));
  }
}

TEST_CASE("a folder gets the table of runs, the document, the page and the samples", "[slow]") {
  const Place place;
  place.script(
      "pair.lua",
      "return experiment { problems = { scenes.cup(), scenes.trap() }, seeds = 2, measure = tube { points = 256, "
      "pool = 1024 }, estimators = { knn(), exact() }, strategies = { guided = skeleton() >> rrt { step = 0.5 }, "
      "rrt = rrt { step = 0.5 } } }");
  const auto outcome = place.run({"run", "pair.lua", "--quiet", "--out", "here"});
  INFO(outcome.err);
  CHECK(outcome.status == 0);
  CHECK(outcome.err.empty());
  CHECK(content(place / "here/report.html").ends_with("</html>\n"));
  CHECK(Json::parse(content(place / "here/results.json"))["runs"].size() == 8);
  for (const std::string problem : {"cup", "trap"}) {
    for (const std::string strategy : {"guided", "rrt"}) {
      CHECK(fs::file_size(place / ("here/samples/" + problem + "/" + strategy + "/seed-1/run.json")) > 0);
    }
  }
  CHECK(place.run({"run", "pair.lua", "--quiet", "--out", "there", "--jobs", "2"}).status == 0);
  const auto timeless = [&](const std::string& folder) {
    Json document = Json::parse(content(place / (folder + "/results.json")));
    trellis::test::remove_times(document);
    return document.dump();
  };
  CHECK(timeless("here") == timeless("there"));
}

TEST_CASE("Ctrl-C keeps the problems that are finished, and says so") {
  const Place place;
  std::string text = endless;
  const std::string begin = "problems = problem {";
  text.replace(text.find(begin), begin.size(), "problems = { scenes.cup(), problem {");
  const std::string end = "goal = {9, 9},\n  },";
  text.replace(text.find(end), end.size(), "goal = {9, 9}, name = 'wall' } },");
  text.replace(text.find("seeds = 1000"), 12, "seeds = 2, measure = tube { points = 64, pool = 64 }");
  text.replace(text.find("step = 0.001"), 12, "step = 0.1");
  place.script("two.lua", text);
  const pid_t child = place.start({"run", "two.lua", "--out", "kept"});
  for (int i = 0; i < 600 && content(place / "kept/scores.jsonl").find("cup") == std::string::npos; ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
  }
  std::this_thread::sleep_for(std::chrono::milliseconds(500));
  ::kill(child, SIGINT);
  const auto outcome = place.finish(child);
  CHECK(outcome.status == 130);
  CHECK(outcome.err.ends_with(
      "trellis: interrupted; 'kept' holds 2 of 4 runs and the results of cup; the same command continues\n"));
  CHECK(outcome.err.starts_with("trellis: warning: problem 'wall': obstacles separate start and goal"));
  CHECK(Json::parse(content(place / "kept/results.json"))["runs"].size() == 2);
  CHECK(content(place / "kept/report.html").ends_with("</html>\n"));
  std::vector<std::string> left;
  for (const auto& entry : fs::directory_iterator(place / "kept")) left.push_back(entry.path().filename().string());
  std::sort(left.begin(), left.end());
  CHECK(left == std::vector<std::string>{"manifest.json", "report.html", "results.json", "runs.csv", "runs.jsonl",
                                         "samples", "scores.jsonl"});
}

TEST_CASE("a report says where the planner alone solved the problem before its guides were set up") {
  const Place place;
  // The medial axis of the cup costs more work than the planner alone.
  place.script("once.lua",
               "return experiment { problems = scenes.cup(), seeds = 2, measure = false,\n"
               "  strategies = { once = skeleton() >> rrt_connect { bound = 2, queries = 1 } } }\n");
  const std::string sentence =
      "rrt_connect without guides, beside the guided search: 100 % of the work; it found the path in all runs; the "
      "guides "
      "were not set up in all runs, where it had not done as much work as that costs";
  for (const std::string kind : {"overview", "levels"}) {
    CAPTURE(kind);
    const auto outcome = place.run({"run", "once.lua", "--report", kind});
    CHECK(outcome.status == 0);
    std::istringstream words(outcome.out);
    std::string text;
    for (std::string word; words >> word;) text += (text.empty() ? "" : " ") + word;
    CHECK(text.find(sentence) != std::string::npos);
  }
}

TEST_CASE("run --once makes each run the only one in its world") {
  const Place place;
  place.script("cup.lua",
               "return experiment { problems = scenes.cup(), seeds = 2, measure = false,\n"
               "  strategies = { guided = skeleton() >> rrt { bound = 0 } } }\n");
  const auto work = [&](std::vector<std::string> arguments) {
    arguments.insert(arguments.end(), {"--json", "cup.json"});
    REQUIRE(place.run(arguments).status == 0);
    return Json::parse(content(place / "cup.json"));
  };
  const Json shared = work({"run", "cup.lua"});
  const Json once = work({"run", "cup.lua", "--once"});
  const Json parallel = work({"run", "cup.lua", "--once", "--jobs", "2"});
  CHECK(once["experiment"]["strategies"][0]["text"] == "skeleton() >> rrt { bound = 0, queries = 1 }");
  for (std::size_t i = 0; i < 2; ++i) {
    const Json& a = shared["runs"][i];
    const Json& b = once["runs"][i];
    CHECK(a["queries"] == 1000);
    CHECK(b["queries"] == 1);
    CHECK(a["path"] == b["path"]);
    CHECK(b["work"].get<double>() > b["set_up_work"].get<double>());
    CHECK(b["work"].get<double>() > 2.0 * a["work"].get<double>());
    CHECK(parallel["runs"][i]["work"] == b["work"]);
  }
  const auto printed = place.run({"run", "cup.lua"});
  CHECK(printed.out.find("shared by 1000 queries, by assumption") != std::string::npos);
  CHECK(place.run({"run", "cup.lua", "--once"}).out.find("in each run (queries = 1)") != std::string::npos);
}

TEST_CASE("unused parts of a script are reported once, after the report") {
  const Place place;
  place.script("unused.lua",
               "local mine = target { sample = function(c) return c.path[1] end,\n"
               "  log_density = function() return 0 end }\n"
               "return experiment { problems = scenes.cup(), seeds = 2,\n"
               "  strategies = { unheard = shrink(0.5) >> rrt { uniform = 1, proposals = 40 }, rrt = rrt {} },\n"
               "  measure = tube { points = 256, pool = 1024 } }\n");
  const auto outcome = place.run({"run", "unused.lua"});
  CHECK(outcome.status == 0);
  CHECK(outcome.out.find("cup") != std::string::npos);
  CHECK(
      outcome.err ==
      "trellis: warning: unused.lua:4: strategy 'unheard', rrt, level 0: shrink(0.5) drew none of the 80 proposals in "
      "2 runs\n"
      "trellis: warning: unused.lua:1: 'sample' and 'log_density' of this target were never called: the experiment is "
      "measured by another target (field 'measure')\n");
}

TEST_CASE("guides of a script's own: functions that no run called, prints, and what check finds without planning") {
  const Place place;
  place.script(
      "own.lua",
      "print('loaded')\n"
      "local own = guiding_space { name = 'own', robot = function(i) print('asked') return i.robot:scaled(0.5) "
      "end }\n"
      "local unused = guiding_space { name = 'unused', stale = function() return false end }\n"
      "return experiment { problems = scenes.cup(), seeds = 2, strategies = { own = own >> rrt {} },\n"
      "  measure = false }\n");
  const auto outcome = place.run({"run", "own.lua", "--quiet", "--ablation", "0"});
  CHECK(outcome.status == 0);
  // Loading it for each run prints nothing; the output of its functions appears.
  CHECK(outcome.out == "loaded\nasked\nasked\n");
  CHECK(outcome.err ==
        "trellis: warning: own.lua:3: 'stale' of the guiding space 'unused' was never called in any run\n");

  place.script(
      "flat.lua",
      "local flat = guiding_space { name = 'flat', space = {'x', 'y'}, world = function(i) return i.world end }\n"
      "return experiment { problems = scenes.cup(), strategies = { flat = lazy() >> flat >> rrt {} } }\n");
  const auto checked = place.run({"check", "flat.lua"});
  CHECK(checked.status == 2);
  CHECK(checked.err ==
        "trellis: flat.lua:1: in flat >> rrt, level 1 (problem 'cup'): its robot needs 3 coordinates, and S has 2 (x, "
        "y)\n");
}

TEST_CASE("a folder where nothing was solved says so, and where to look") {
  const Place place;
  place.script("hopeless.lua",
               "return experiment { strategies = { rrt = rrt { proposals = 50 } }, seeds = 1, problems = problem { "
               "name = 'wall', "
               "world = world { bounds = {0, 0, 10, 10}, box {4, 0, 6, 10} }, robot = robot.point(), start = {1, 1}, "
               "goal = {9, 9} } }");
  const auto outcome = place.run({"run", "hopeless.lua", "--quiet", "--out", "kept"});
  CHECK(outcome.status == 0);
  CHECK_THAT(outcome.err, Contains("trellis: wall: no run of any strategy found a path, so there is no target and no "
                                   "efficiency; give the planners more `proposals`"));
  CHECK(fs::file_size(place / "kept/samples/wall/rrt/seed-1/run.json") > 0);

  place.script("file", "");
  const auto blocked = place.run({"run", "hopeless.lua", "--out", "file"});
  CHECK(blocked.status == 2);
  CHECK(blocked.err == "trellis: cannot write 'file': Not a directory\n");
}

TEST_CASE("the standard library can be read from a folder") {
  const Place place;
  fs::create_directories(place / "lib");
  std::ofstream(place / "lib/scenes.lua") << "return { here = function() return 'here' end }\n";
  place.script("ask.lua", "error(scenes.here(), 0)");
  ::setenv("TRELLIS_STDLIB", (place / "lib").c_str(), 1);
  const auto outcome = place.run({"run", "ask.lua"});
  ::unsetenv("TRELLIS_STDLIB");
  CHECK(outcome.err.starts_with("trellis: here\n"));
}

TEST_CASE("every example is valid") {
  const Place place;
  const fs::path examples = fs::path(TRELLIS_SOURCE) / "examples";
  std::vector<std::string> arguments = {"check"};
  for (const auto& entry : fs::directory_iterator(examples)) {
    const bool scenarios = entry.path().stem().string().ends_with("_test");  // for `trellis test`
    if (entry.path().extension() == ".lua" && !scenarios) arguments.push_back(entry.path().string());
  }
  REQUIRE(arguments.size() >= 5);
  const auto outcome = place.run(arguments);
  INFO(outcome.err);
  CHECK(outcome.status == 0);
}

TEST_CASE("each part of a mixture has a row, and parts of a split table name their rows") {
  const Place place;
  place.script("mixed.lua", R"(
local mixed = (0.7*skeleton() + 0.2*goal_bias(0.2) + 0.1*bridge_test()) >> rrt { step = 0.5 }
return experiment { problems = { scenes.cup() }, strategies = { mixed = mixed, rrt = rrt { step = 0.5 } }, seeds = 5 }
)");
  const Outcome overview = place.run({"run", "mixed.lua", "--width", "160"});
  CHECK_THAT(overview.out, Catch::Matchers::Matches("(.|\n)*\nmixed .*\n"
                                                    "  without skeleton\\(\\) .* keep it *\n"
                                                    "  without goal_bias\\(0.2\\) .* not shown *\n"
                                                    "  without bridge_test\\(0.5\\) .* drop it *\n(.|\n)*"));
  const Outcome levels = place.run({"run", "mixed.lua", "--width", "160", "--report", "levels"});
  CHECK_THAT(levels.out,
             Catch::Matchers::Matches("(.|\n)*0 root .*\n"
                                      "  \\+ goal_bias\\(0.2\\) +not shown \\[.*; draws [0-9]+ % of proposals\n"
                                      "  \\+ bridge_test\\(0.5\\) +costs .*; draws [0-9]+ % of proposals\n"
                                      "1 └ skeleton\\(\\)(.|\n)*"));

  const Outcome narrow = place.run({"run", "mixed.lua", "--width", "60", "--report", "full"});
  std::istringstream lines(narrow.out);
  std::size_t named = 0;
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with("0 root") && line.find(" tree ") != std::string::npos) ++named;
  }
  CHECK(named >= 4);  // in two strategies, each table in several parts
  CHECK_THAT(narrow.out, Contains("medians over the runs: those of the levels do not"));
}
