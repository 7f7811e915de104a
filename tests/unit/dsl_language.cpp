// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <numbers>
#include <sstream>
#include <string>
#include <variant>

#include "support/catch.hpp"
#include "support/folder.hpp"
#include "support/script.hpp"

#include <dsl/language/tools/vocabulary.hpp>
#include <dsl/language/tools/words.hpp>
#include <trellis/report/views/table.hpp>
#include <trellis/scene/planar/scene.hpp>
#include <trellis/strategy/registry.hpp>

namespace fs = std::filesystem;
using namespace trellis;
using test::failure;
using test::value;
using test::values;

namespace {

dsl::Program load(const std::string& text) { return dsl::Session("").load(text, "test.lua"); }

Problem problem(const std::string& expression) {
  return load("return rrt {}, " + expression).experiment.problems.front();
}

}  // namespace

TEST_CASE("the paper's scenes are as published") {
  const Problem passage = problem("scenes.simple_passage()");
  CHECK(passage.name == "simple_passage");
  CHECK(passage.start == Configuration{1, 8.5, 0});
  CHECK(passage.goal() == Configuration{9, 1.5, 0});
  CHECK(passage.space.name() == "SE(2)");
  CHECK(passage.space.axes()[2].weight == Approx(1 / std::numbers::pi));
  CHECK(passage.resolution == 0.05);
  CHECK(passage.collision == "planar");
  const World& world = planar(*passage.scene).world;
  CHECK(world.bounds() == Box2{{0, 0}, {10, 10}});
  REQUIRE(world.obstacles().size() == 2);
  CHECK(world.obstacles()[0].name == "obstacle 1 (box 4 0 6 4.75)");
  CHECK(std::get<Box2>(world.obstacles()[1].shape) == Box2{{4, 5.25}, {6, 10}});
  CHECK(passage.scene->bounding_radius() == Approx(std::hypot(0.3, 0.1)));

  const Problem trap = problem("scenes.trap()");
  CHECK(trap.start == Configuration{1, 4, 0});
  CHECK(trap.goal() == Configuration{9, 4, 0});
  CHECK(trap.scene->obstacle_count() == 10);
  const Problem cup = problem("scenes.cup()");
  CHECK(cup.start == Configuration{1, 5, 0});
  CHECK(cup.goal() == Configuration{9, 5, 0});
  CHECK(cup.scene->obstacle_count() == 3);
}

TEST_CASE("a scene takes what shall differ") {
  const Problem trap = problem("scenes.trap { collision = 'fcl', resolution = 0.02, start = {1, 5, 0}, weight = 1 }");
  CHECK(trap.collision == "fcl");
  CHECK(trap.resolution == 0.02);
  CHECK(trap.start == Configuration{1, 5, 0});
  CHECK(trap.goal() == Configuration{9, 4, 0});
  CHECK(trap.space.axes()[2].weight == 1);
  CHECK(problem("scenes.trap()").collision == "planar");
}

TEST_CASE("what is offered for an invalid start or goal is valid as it stands") {
  for (const std::string wrong : {"scenes.cup { start = {6.7, 5, 0} }", "scenes.cup { goal = {0.05, 0.05, 1} }",
                                  "scenes.trap { start = {-1, 5, 0} }", "scenes.simple_passage { goal = {5, 1, 2} }"}) {
    INFO(wrong);
    const std::string message = failure("return " + wrong);
    const std::string offer = "a valid configuration near by is (";
    const auto begin = message.find(offer);
    REQUIRE(begin != std::string::npos);
    const auto from = begin + offer.size();
    const std::string offered = message.substr(from, message.find(')', from) - from);
    INFO(offered);
    const auto open = wrong.rfind('{'), close = wrong.find('}');
    CHECK(failure("return " + wrong.substr(0, open) + "{" + offered + wrong.substr(close)).empty());
  }
}

TEST_CASE("worlds and robots are made of shapes") {
  const Problem here = problem(
      "problem { name = 'here', world = world { bounds = {0, 0, 8, 6}, { disc {4, 3, 0.5}, { box(1, 4, 2, 5) } }, "
      "polygon { {6, 1}, {7, 1}, {6.2, 1.2}, {6, 2} } }, "
      "robot = robot.rigid { box {-0.2, -0.1, 0.2, 0.1}, disc {0.2, 0, 0.1} }, start = {1, 1, 0}, goal = {7, 5, 1} }");
  CHECK(here.name == "here");
  CHECK(here.scene->obstacle_count() == 3);
  CHECK(planar(*here.scene).world.parts().size() > 3);
  CHECK(planar(*here.scene).robot.bodies().front().parts.size() == 2);
  CHECK(here.space.dimension() == 3);
  const std::string around = ", world = world { bounds = {0, 0, 8, 6} }, start = {1, 1}, goal = {2, 2} }";
  CHECK(problem("problem { robot = robot.point()" + around).scene->is_point());
  CHECK(problem("problem { robot = robot.disc(0.3)" + around).space.dimension() == 2);
  CHECK(problem("problem { robot = robot.rectangle { 0.3, 0.1, rotates = false }" + around).space.dimension() == 2);
  CHECK(problem("problem { robot = robot.rigid { polygon { {0, 0}, {0.5, 0}, {0, 0.5} }, rotates = false }" + around)
            .space.name() == "R^2");
}

TEST_CASE("a problem can be read") {
  CHECK(values("local p = scenes.cup() return p.name, p.start[2], #p.goal, p.collision, p.resolution, tostring(p)") ==
        std::vector<std::string>{"cup", "5.0", "3", "planar", "0.05", "problem 'cup' in SE(2)"});
  CHECK(value("tostring(scenes.cup().world)") == "world of 3 obstacles in 0 0 10 10");
  CHECK(failure("return scenes.cup().strat").find("did you mean 'start'?") != std::string::npos);
}

TEST_CASE("an experiment holds what was given, in a known order") {
  const auto program = load(
      "return experiment { problems = { { scenes.cup() }, scenes.trap() }, seeds = 3, seed = 7, shortcut = 5, "
      "strategies = { plain = rrt {}, a = lazy() >> rrt {}, nested = shrink(0.5) >> rrt {} }, "
      "measure = tube { delta = 0.25, distance = 'full' } }");
  const Experiment& e = program.experiment;
  CHECK(program.seed == 7);
  CHECK(e.seeds == std::vector<std::uint64_t>{7, 8, 9});
  CHECK(e.shortcut == 5);
  REQUIRE(e.problems.size() == 2);
  CHECK(e.problems[1].name == "trap");
  REQUIRE(e.strategies.size() == 3);
  // As the script makes them.
  CHECK(e.strategies[0].first == "plain");
  CHECK(e.strategies[1].first == "a");
  CHECK(e.strategies[2].first == "nested");
  const auto shared = load(
      "local p = rrt {} local q = prm {} "
      "return experiment { problems = scenes.cup(), strategies = { d = q, c = p, b = rrt {}, a = q } }");
  const std::vector<std::string> order = {"c", "a", "d", "b"};
  for (std::size_t i = 0; i < order.size(); ++i) CHECK(shared.experiment.strategies[i].first == order[i]);
  REQUIRE(e.measure);
  CHECK(std::get<TubeSettings>(e.measure->target).delta == 0.25);
  CHECK(std::get<TubeSettings>(e.measure->target).distance == TubeSettings::Distance::full);

  const auto listed = load(
      "return experiment { problems = scenes.cup(), strategies = { {'z', rrt {}}, {'a', prm {}}, rrt_connect {} }, "
      "seeds = {5, 1}, measure = false }");
  CHECK(listed.experiment.strategies[0].first == "z");
  CHECK(listed.experiment.strategies[1].first == "a");
  CHECK(listed.experiment.strategies[2].first == listed.experiment.strategies[2].second.text());
  CHECK(listed.experiment.seeds == std::vector<std::uint64_t>{5, 1});
  CHECK_FALSE(listed.experiment.measure);
}

TEST_CASE("a problem may have several goals, any of which will do") {
  const std::string head =
      "local function p(goal) return problem { robot = robot.point(), world = world { bounds = {0, 0, 4, 4}, "
      "box {1, 1, 2, 2} }, start = {0.5, 0.5}, goal = goal } end return ";
  CHECK(value("#(function() " + head + "p { {3, 3}, {3.5, 1} }.goal end)()") == "2");
  CHECK(value("(function() " + head + "p { {3, 3}, {3.5, 1} }.goal[2][1] end)()") == "3.5");
  CHECK(value("(function() " + head + "p(p { {3, 3}, {3.5, 1} }.goal).goal[1][2] end)()") == "3.0");
  CHECK(value("(function() " + head + "p({3, 2}).goal[2] end)()") == "2.0");
  CHECK_THAT(failure("(function() " + head + "p { {3, 3}, {3.5} } end)()"),
             Catch::Contains("goal 2 of field 'goal' must have 2 coordinates (x, y), got 1"));
  CHECK_THAT(failure("(function() " + head + "p { {3, 3}, 4 } end)()"),
             Catch::Contains("goal 2 of field 'goal' must be a list of numbers"));
  CHECK_THAT(failure("(function() " + head + "p { {3, 3}, {1.5, 1.5} } end)()"),
             Catch::Contains("goal 2 (1.5, 1.5) is in collision with"));
  CHECK_THAT(failure("(function() " + head + "p {} end)()"), Catch::Contains("field 'goal' must have 2 coordinates"));
}

TEST_CASE("a script may return a strategy and a problem") {
  for (const char* script : {"return shrink(0.5) >> rrt {}, scenes.cup()",
                             "return { strategy = shrink(0.5) >> rrt {}, problem = scenes.cup() }"}) {
    const auto program = load(script);
    CHECK(program.experiment.problems.front().name == "cup");
    CHECK(program.experiment.strategies.front().second.text() == value("tostring(shrink(0.5) >> rrt {})"));
    CHECK(program.experiment.seeds == std::vector<std::uint64_t>{1});
  }
}

TEST_CASE("seeds given on the command line replace the script's") {
  const auto program =
      load("return experiment { problems = scenes.cup(), strategies = { rrt {} }, seeds = 3, seed = 7 }");
  const auto seeds = [&](std::optional<std::uint64_t> count, std::optional<std::uint64_t> first) {
    auto copy = program;
    dsl::override_seeds(copy, count, first);
    return copy.experiment.seeds;
  };
  using Seeds = std::vector<std::uint64_t>;
  CHECK(seeds({}, {}) == Seeds{7, 8, 9});
  CHECK(seeds(2, {}) == Seeds{7, 8});
  CHECK(seeds({}, 20) == Seeds{20, 21, 22});
  CHECK(seeds(1, 20) == Seeds{20});
  CHECK_THROWS_AS(seeds(0, {}), Error);
  CHECK_THROWS_AS(seeds(dsl::most_seeds + 1, {}), Error);
  CHECK_THROWS_AS(seeds(2, std::uint64_t{1} << 63U), Error);
}

TEST_CASE("scenes.load names its problems, and what it finds in files is a warning") {
  const test::Folder folder;
  static_cast<void>(folder.write("yard.map", "type octile\nheight 2\nwidth 2\nmap\n..\nW.\n"));
  static_cast<void>(folder.write("yard.map.scen", "version 1\n0 yard.map 2 2 0 0 1 0 1\n0 yard.map 2 2 1 0 1 1 1\n"));
  static_cast<void>(folder.write("map.pgm", "P5 1 1 255\n\xFE"));
  static_cast<void>(folder.write("map.yaml",
                                 "image: map.pgm\nresolution: 4\norigin: [0, 0, 0]\nnegate: 0\noccupied_thresh: 0.65\n"
                                 "free_thresh: 0.196\nmap_type: occupancy\n"));
  dsl::Session session(folder.path());
  const auto names = [&](const std::string& call) {
    return session.evaluate("local p = scenes.load(" + call + ") return p[1].name, p[#p].name", "test.lua");
  };
  const std::string ends = ", start = {1, 1}, goal = {2, 2} }";
  CHECK(names("'map.yaml', { name = 'hall'" + ends) == std::vector<std::string>{"hall", "hall"});
  CHECK(names("'map.yaml', { map_server = 'ros1'" + ends) == std::vector<std::string>{"map", "map"});
  CHECK(names("'yard.map.scen', { name = 'yards' }") == std::vector<std::string>{"yards/1", "yards/2"});
  const std::vector<std::string> warnings = session.take_warnings();
  REQUIRE(warnings.size() == 2);
  CHECK(warnings[0].ends_with("map.yaml:7: 'map_type' is not read"));
  CHECK(warnings[1] == "scenes.load: yard.map.scen: 1 cells of water (W) are obstacles");
  const auto fault = [&](const std::string& call) {
    try {
      static_cast<void>(names(call));
    } catch (const Error& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  CHECK(fault("'map.yaml', { name = ''" + ends).find("option 'name' must be a string that is not empty") !=
        std::string::npos);
  CHECK(fault("'map.yaml', { name = {}" + ends).find("option 'name' must be a string") != std::string::npos);
  CHECK(fault("'map.yaml', { map_server = 'ros2'" + ends).find("map_server") != std::string::npos);
}

TEST_CASE("scene files are looked for, and read, with options") {
  CHECK(value("scenes.exists 'no/such/file.txt'") == "false");
  CHECK(failure("scenes.load 'no/such/file.txt'").find("no file 'no/such/file.txt' (looked for ") != std::string::npos);
  CHECK(failure("scenes.load(7)").find("the file must be a string") != std::string::npos);
  if (value("scenes.exists 'ompl_tests/circle_obstacles.txt'") == "false") {
    WARN("the folder of scenes is missing: reading them is not tested");
    return;
  }
  CHECK(value("#scenes.load 'ompl_tests/circle_obstacles.txt'") == "100");
  CHECK(value("scenes.load('ompl_tests/circle_obstacles.txt', { resolution = 0.25 })[1].resolution") == "0.25");
  CHECK(failure("scenes.load('ompl_tests/circle_obstacles.txt', { resolutoin = 0.25 })")
            .find("did you mean 'resolution'?") != std::string::npos);
}

TEST_CASE("help wraps its lines at words, in every width") {
  constexpr std::size_t width = 60;
  for (const dsl::Word& word : dsl::words()) {
    if (word.kind == dsl::Word::Kind::module) continue;  // its text has lines of its own
    std::istringstream lines(dsl::help_text(word.name, width));
    for (std::string line; std::getline(lines, line);) {
      if (word.usage.find(line.substr(std::min<std::size_t>(line.size(), 2))) != std::string::npos) continue;
      INFO(word.name << ": " << line);
      const bool one_word = line.find(' ', line.find_first_not_of(' ')) == std::string::npos;
      CHECK((display_width(line) <= width || one_word));
    }
  }
  CHECK(dsl::help_text("shrink", width) != dsl::help_text("shrink"));
}

TEST_CASE("help has every word and each of its options") {
  const std::string all = dsl::vocabulary_text();
  // The meaning follows the name, on its own line where it is long.
  const auto has = [](const std::string& text, const std::string& name) {
    return text.find("  " + name + " ") != std::string::npos || text.find("  " + name + "\n") != std::string::npos;
  };
  for (const dsl::Word& word : dsl::words()) {
    INFO(word.name);
    const std::string module = word.module();
    const std::string listed =
        word.kind == dsl::Word::Kind::function && !module.empty() ? word.name.substr(module.size() + 1) : word.name;
    CHECK((has(all, listed) || all.find("module " + word.name + ": ") != std::string::npos));
    const std::string text = dsl::help_text(word.name, 100000);
    CHECK(text.find(word.summary) != std::string::npos);
    for (const auto& name : word.named()) CHECK(has(text, name));
    for (const auto& argument : word.arguments) CHECK(has(text, argument.name));
    if (word.kind != dsl::Word::Kind::module) CHECK(text.find(word.usage) != std::string::npos);
  }
  CHECK(dsl::help_text("scenes").find("simple_passage") != std::string::npos);
  CHECK(dsl::help_text("guide.shrink") == dsl::help_text("shrink"));
  CHECK_THROWS_WITH(dsl::help_text("shrnik"), Catch::Contains("did you mean 'shrink'?"));
  CHECK_THROWS_WITH(dsl::help_text("planner.shrink"), Catch::Contains("no help on 'planner.shrink'"));
}

TEST_CASE("help on a name that is no word has its options, else the words near it") {
  const std::string step = dsl::help_text("step", 100000);
  CHECK(step.starts_with("step is an option or a field\n\nof rrt, "));
  CHECK(step.find("longest extension") != std::string::npos);
  CHECK(dsl::help_text("arm").find("\n  robot.arm ") != std::string::npos);
  CHECK(dsl::help_text("obstacle").find("\n  obstacle_based ") != std::string::npos);
  const std::string recentred = dsl::help_text("recentred", 100000);
  CHECK(recentred.find("of a robot:") != std::string::npos);
  CHECK(recentred.find(":recentred()") != std::string::npos);
  CHECK_THROWS_WITH(dsl::help_text("stepsize"), Catch::Contains("did you mean 'step'?"));
  CHECK_THROWS_WITH(dsl::help_text("evidense"), Catch::Contains("did you mean 'evidence'?"));
}

TEST_CASE("help lists the options of a function of the standard library, with its own defaults") {
  const std::string irc = dsl::help_text("strategies.irc");
  CHECK(irc.starts_with("strategies.irc: ever larger robots"));
  CHECK(irc.find("source: Bayazit") != std::string::npos);
  CHECK(irc.find("default {0.25, 0.5, 0.75}") != std::string::npos);
  const auto default_of = [](const std::string& word, const std::string& option) {
    for (const dsl::Word& known : dsl::words()) {
      for (const Option& described : known.options) {
        if (known.name == word && described.name == option) return dsl::default_text(described);
      }
    }
    return std::string("none");
  };
  CHECK(default_of("strategies.irc", "goal_bias") == "0.05");
  CHECK(default_of("strategies.irc", "uniform") == "0.5");
  CHECK(default_of("rrt", "uniform") == "0.05");
  CHECK(default_of("rrt", "bound") == "2");
  CHECK(default_of("strategies.dr_rrt", "drop") == "1000");
  CHECK(default_of("rrt", "checks") == "math.huge");
  CHECK(default_of("strategies.lazy_prm", "batch") == "200");
}

TEST_CASE("help lists the operators and members of a type") {
  CHECK(dsl::help_text("guide").find("guide >> planner   a strategy") != std::string::npos);
  CHECK(dsl::help_text("strategy").find(":hash()") != std::string::npos);
  CHECK(dsl::help_text("planner").find(":tree()") != std::string::npos);
  CHECK(dsl::help_text("problem").find(".goal_tolerance") != std::string::npos);
  CHECK(dsl::help_text("robot").find("rectangle") != std::string::npos);
}

TEST_CASE("functions of the standard library check what they are given") {
  CHECK(failure("strategies.dr_rrt { regon = 3 }")
            .find("test.lua:1: strategies.dr_rrt: unknown field 'regon' (did you mean 'region'?)") == 0);
  CHECK(failure("strategies.irc { step = -1 }").find("strategies.irc: option 'step' must be a number at least 1e-06") !=
        std::string::npos);
  CHECK(failure("strategies.nested { planner = lazy() }")
            .find("strategies.nested: field 'planner' must be a planner, got the guide 'lazy()'") != std::string::npos);
  CHECK(failure("scenes.trap({}, 1)").find("takes a table of what shall differ, got 2 arguments") != std::string::npos);
  CHECK(value("strategies.irc(nil) == strategies.irc {}") == "true");
  // What is given once is no default of the next call.
  CHECK(values("strategies.regions { region = 5 } return strategies.regions() == strategies.regions { region = 2 }") ==
        std::vector<std::string>{"true"});
}

TEST_CASE("a script can ask for help on words, functions and values") {
  std::string printed;
  dsl::Session session("", {.print = [&](const std::string& text) { printed += text; }});
  const auto help = [&](const std::string& call) {
    printed.clear();
    CHECK(session.evaluate("return " + call, "test.lua").empty());
    return printed;
  };
  CHECK(help("help()") == dsl::vocabulary_text());
  for (const std::string call : {"help(shrink)", "help 'shrink'", "help 'guide.shrink'", "help('shrink')"}) {
    INFO(call);
    CHECK(help(call) == dsl::help_text("shrink"));
  }
  CHECK(help("help(box)") == dsl::help_text("box"));
  CHECK(help("help(robot.disc)") == dsl::help_text("robot.disc"));
  CHECK(help("help(scenes)") == dsl::help_text("scenes"));
  CHECK(help("help(scenes.trap)") == dsl::help_text("scenes.trap"));
  CHECK(help("help(strategies.irc)") == dsl::help_text("strategies.irc"));
  CHECK(help("help(require 'strategies'.nested)") == dsl::help_text("strategies.nested"));
  CHECK(help("help(help)") == dsl::help_text("help"));
  CHECK(help("help(skeleton() >> shrink(0.5) >> rrt {})")
            .starts_with("strategy: skeleton() >> shrink(0.5) >> rrt()\n\n" +
                         value("(skeleton() >> shrink(0.5) >> rrt {}):tree()")));
  CHECK(help("help(shrink(0.25))").starts_with("guide: shrink(0.25)\n"));
  CHECK(help("help(lazy() + skeleton())").find("a guide") != std::string::npos);
  CHECK(help("help(rrt {})").starts_with("planner: rrt()\n"));
  CHECK(help("help(scenes.cup())").starts_with("a problem: problem 'cup' in SE(2)"));
  CHECK(failure("help 'shrnik'").find("did you mean 'shrink'?") != std::string::npos);
  CHECK(failure("help(42)").find("help: nothing is known about 42") != std::string::npos);
  CHECK(failure("help(function() end)").find("nothing is known about a function") != std::string::npos);
}
