// SPDX-License-Identifier: GPL-3.0-or-later
// User-defined guides: their definition, their behaviour in a run, and the diagnostics of errors.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include <dsl/language/tools/session.hpp>
#include <dsl/language/words/guiding_space.hpp>
#include <dsl/lua/snapshot.hpp>
#include <trellis/experiment/experiment.hpp>
#include <trellis/scene/planar/scene.hpp>
#include <trellis/strategy/ablation.hpp>

#include "support/catch.hpp"
#include "support/fault.hpp"
#include "support/script.hpp"
#include "support/worlds.hpp"

using namespace trellis;
using Catch::Matchers::Contains;

namespace {

const std::string room =
    "local room = problem { name = 'room', world = world { bounds = {0, 0, 10, 10}, box {4, 0, 6, 7} },\n"
    "  robot = robot.rectangle(0.6, 0.2), start = {1, 1, 0}, goal = {9, 1, 0} }\n";

/// An experiment on the room, after a line of the script.
std::string script(const std::string& guide, const std::string& strategy, const std::string& more = "") {
  return room + guide + "\nreturn experiment { problems = room, strategies = { it = " + strategy +
         " }, measure = false" + more + " }\n";
}

dsl::Program load(const std::string& text) { return dsl::Session("").load(text, "test.lua"); }

StrategySpec strategy_of(const std::string& guide, const std::string& strategy = "g >> rrt {}") {
  return load(script("local g = " + guide, strategy)).experiment.strategies.front().second;
}

RunRecord run_of(const std::string& guide, const std::string& strategy = "g >> rrt {}", std::uint64_t seed = 1) {
  const Experiment experiment = load(script("local g = " + guide, strategy)).experiment;
  return execute(experiment.strategies.front().second, experiment.problems.front(), seed);
}

/// Returns the error of a run, "" if there is none.
std::string run_failure(const std::string& guide, const std::string& strategy = "g >> rrt {}") {
  return test::fault_of([&] { run_of(guide, strategy); });
}

std::vector<double> all(const Configurations& rows) { return {rows.values().begin(), rows.values().end()}; }

ExperimentResult run_all(const std::string& text, unsigned jobs) {
  ExperimentOptions options;
  options.jobs = jobs;
  return trellis::run(load(text).experiment, options);
}

const std::string half = "guiding_space { name = 'half', robot = function(i) return i.robot:scaled(0.5) end }";

}  // namespace

TEST_CASE("a guide of a script's own stands in strategies as built-in ones do") {
  CHECK(strategy_of(half).text() == "half >> rrt()");
  CHECK(strategy_of(half, "(0.5*g + 0.5*uniform()) >> lazy() >> rrt {}").text() ==
        "(0.5*half + 0.5*uniform()) >> lazy() >> rrt()");
  CHECK(strategy_of(half, "skeleton() >> g .. shrink(0.5) >> rrt {}").tree().find("half") != std::string::npos);
  CHECK(strategy_of("guiding_space { name = 'half', robot = robot.disc(0.1), planner = rrt_connect {} }").text() ==
        "half { planner = rrt_connect() } >> rrt()");
  CHECK_THAT(strategy_of(half).json(), Contains("{\"guide\":\"half\",\"custom\":\"half (test.lua:3, "));
  const auto taken = ablations(strategy_of(half, "skeleton() >> g >> rrt {}"));
  REQUIRE(taken.size() == 3);
  CHECK(taken[0].text() == "without half");
  CHECK(taken[1].text() == "skipping half");
}

TEST_CASE("the record of a run has the time of functions in Lua") {
  CHECK(run_of("shrink(0.5)").lua_seconds == 0.0);
  CHECK(run_of("0.5 * goal_bias(0.2) + 0.5 * uniform()").lua_seconds == 0.0);
  // instance:valid() calls back into the runtime, here into the validity of the guide above.
  const std::string asks =
      "guiding_space { name = 'asks', robot = robot.disc(0.1), heuristic = function(found, instance)\n"
      "  instance:valid(instance.start)\n  return along(found.path) end }";
  for (const char* const strategy : {"g >> rrt { bound = 0 }", "g >> lazy() >> rrt { bound = 0 }"}) {
    const RunRecord run = run_of(asks, strategy);
    CHECK(run.lua_seconds > 0.0);
    CHECK(run.lua_seconds <= run.cpu_seconds);
  }
}

TEST_CASE("equal definitions are equal, wherever they are loaded, and others are not") {
  CHECK(strategy_of(half) == strategy_of(half));
  CHECK(strategy_of(half).hash() == strategy_of(half).hash());
  const auto of = [](const std::string& what) {
    return strategy_of(
        "(function(k) local t = { deep = { k } } return guiding_space { name = 'half', robot = "
        "function(i) return i.robot:scaled(t.deep[1]) end } end)(" +
        what + ")");
  };
  CHECK(of("0.5") == of("0.5"));
  CHECK_FALSE(of("0.5") == of("0.25"));
  CHECK(of("0.5").hash() != of("0.25").hash());
  const auto disc = [](const std::string& radius) {
    return strategy_of("guiding_space { robot = robot.disc(" + radius + ") }");
  };
  CHECK(disc("0.1") == disc("0.1"));
  CHECK_FALSE(disc("0.1") == disc("0.2"));
}

TEST_CASE("shrink written in Lua does what the built-in does, sample by sample") {
  // The built-in guide's own are the coarser resolution, and what it takes out of S where a path was refuted.
  const std::string mine =
      "guiding_space { name = 'half', robot = function(i) return i.robot:scaled(0.5) end, resolves = 0, "
      "heuristic = function(found) return along(found.path, { follow = '";
  const double resolution = load(script("local g = " + half, "g >> rrt {}")).experiment.problems.front().resolution;
  const std::string theirs = "shrink { 0.5, resolution = " + std::to_string(resolution) + ", resolves = 0, follow = '";
  for (const std::string follow : {"tube", "waypoints"}) {
    for (const std::string strategy :
         {"g >> rrt { bound = 0 }", "g >> rrt { bound = 0, uniform = 0.5 }", "g >> rrt_connect { bound = 0 }"}) {
      for (const std::uint64_t seed : {1U, 2U, 3U}) {
        INFO("follow " << follow << ", " << strategy << ", seed " << seed);
        const RunRecord own = run_of(mine + follow + "' }) end }", strategy, seed);
        const RunRecord built_in = run_of(theirs + follow + "' }", strategy, seed);
        REQUIRE(own.levels.size() == 2);
        CHECK(own.solved);
        CHECK((all(own.path) == all(built_in.path)));
        for (std::size_t i = 0; i < 2; ++i) {
          CHECK((all(own.levels[i].search.proposals) == all(built_in.levels[i].search.proposals)));
          CHECK((all(own.levels[i].root_nodes()) == all(built_in.levels[i].root_nodes())));
          REQUIRE(own.levels[i].root_proposal_density);
          const View q = own.levels[0].search.proposals[5];
          CHECK(own.levels[i].root_proposal_density(q) == built_in.levels[i].root_proposal_density(q));
        }
        CHECK(own.validity_checks == built_in.validity_checks);
      }
    }
  }
}

TEST_CASE("by default h is along the path that was found") {
  const RunRecord plain = run_of(half);
  const RunRecord written = run_of(
      "guiding_space { name = 'half', robot = function(i) return i.robot:scaled(0.5) end,\n"
      "  heuristic = function(found) return along(found.path) end }");
  CHECK(plain.solved);
  for (std::size_t i = 0; i < 2; ++i) {
    CHECK(all(plain.levels[i].search.proposals) == all(written.levels[i].search.proposals));
  }
}

TEST_CASE("f by the names of axes: the axes that S lacks are lifted uniformly, and the density is exact") {
  const std::string point = "guiding_space { name = 'point', space = {'x', 'y'}, robot = robot.point() }";
  const RunRecord run = run_of(point);
  CHECK(run.solved);
  REQUIRE(run.levels.size() == 2);
  const LevelRecord& level = run.levels[1];
  CHECK(level.space.dimension() == 2);
  CHECK(level.position_axes == std::vector<std::size_t>{0, 1});
  CHECK(level.root_nodes().dimension() == 3);
  for (std::size_t i = 0; i < level.root_nodes().size(); ++i) {
    CHECK(level.root_nodes()[i][0] == level.search.nodes[i][0]);
    CHECK(level.root_nodes()[i][1] == level.search.nodes[i][1]);
  }
  REQUIRE(run.levels[0].proposal_density);
  REQUIRE(level.root_proposal_density);
  // Uniform points: the mean of the density times the volume is the mass, less the atoms at the goal.
  for (const auto& density : {run.levels[0].proposal_density, level.root_proposal_density}) {
    Stream stream(1, "0", "test");
    Configuration q(3);
    const Space& c = run.levels[0].space;
    constexpr int points = 40000;
    double sum = 0.0;
    double squares = 0.0;
    for (int i = 0; i < points; ++i) {
      c.sample_uniform(stream, q);
      const double p = density(q) * std::exp(c.log_volume());
      sum += p;
      squares += p * p;
    }
    const double mass = sum / points;
    const double error = std::sqrt(std::max(0.0, squares / points - mass * mass) / points);
    CHECK(std::abs(mass - (1.0 - run.levels[0].proposal_atoms)) < 4.0 * error + 0.02);
  }
}

TEST_CASE("f and its fibres may be functions") {
  // S is C mirrored in x.
  const RunRecord run = run_of(
      "guiding_space { name = 'mirror', space = function(i) return i.space end,\n"
      "  project = function(x, y, t) return 10 - x, y, t end,\n"
      "  lift = function(x, y, t, random) return { 10 - x, y, t } end,\n"
      "  valid = function(x, y) return x < 3.5 or x > 6.5 or y > 7.5 end,\n"
      "  heuristic = function(found) return lifted(along(found.path, { radius = 0.5 })) end }",
      "g >> rrt { bound = 0 }");
  CHECK(run.solved);
  REQUIRE(run.levels.size() == 2);
  CHECK(run.levels[1].start == Configuration{9, 1, 0});
  CHECK(run.levels[1].root_nodes()[0][0] == Approx(1.0));
  CHECK(run.levels[1].search.checks.validity > 0);
  // Its density would require that of the fibre.
  CHECK_FALSE(run.levels[0].proposal_density);
  CHECK_FALSE(run.levels[1].root_proposal_density);
  CHECK_THAT(run_failure("guiding_space { name = 'skew', project = function(x, y, t) return x, y, t end,\n"
                         "  lift = function(x, y, t) return x, y, 0 end, valid = 'free' }"),
             Contains("test.lua:3: in skew >> rrt, level 1 (problem 'room', seed 1): project(lift(s)) must be s, but "
                      "lift at (") &&
                 Contains("and project of that ("));
}

TEST_CASE("S may be an explicit graph, searched exactly") {
  const RunRecord run = run_of(
      "guiding_space { name = 'map', space = {'x', 'y'}, graph = function(instance)\n"
      "  local s, t = instance.start, instance.goal\n"
      "  return { vertices = { {s[1], s[2]}, {5, 8}, {5, 9}, {t[1], t[2]} },\n"
      "    edges = { {1, 2}, {2, 4}, {1, 3, 0.1}, {3, 4, 0.1} }, start = 1, goal = 4 } end,\n"
      "  heuristic = function(found) return lifted(along(found.path, { radius = 0.7 })) end }");
  CHECK(run.solved);
  REQUIRE(run.levels.size() == 2);
  CHECK(run.levels[1].planner == "graph_search");
  // The longer path, because its edges are made cheap.
  CHECK(all(run.levels[1].solution.path) == std::vector<double>{1, 1, 5, 9, 9, 1});
}

TEST_CASE("a graph of S may have several goals, and an instance lists all") {
  const std::string map =
      "guiding_space { name = 'map', space = {'x', 'y'}, graph = function(instance)\n"
      "  assert(#instance.goals == 1 and instance.goals[1][1] == instance.goal[1])\n"
      "  local s, t = instance.start, instance.goals[1]\n"
      "  return { vertices = { {s[1], s[2]}, {5, 8}, {t[1], t[2]}, {2, 9} },\n"
      "    edges = { {1, 2}, {2, 3}, {1, 4} }, start = 1, goal = GOALS } end,\n"
      "  heuristic = function(found) return lifted(along(found.path, { radius = 0.7 })) end }";
  const auto with = [&](const std::string& goals) {
    std::string text = map;
    return text.replace(text.find("GOALS"), 5, goals);
  };
  const RunRecord run = run_of(with("{3, 4}"));
  CHECK(run.solved);
  REQUIRE(run.levels.size() == 2);
  CHECK(all(run.levels[1].solution.path) == std::vector<double>{1, 1, 2, 9});
  CHECK_THAT(run_failure(with("{3, 5}")), Contains("entry 2 of 'goal' must be the number of a vertex, from 1 to 4"));
  CHECK_THAT(run_failure(with("{}")), Contains("'goal' is an empty list"));
}

TEST_CASE("h may be a function that draws, with its density") {
  const std::string box =
      "guiding_space { name = 'box', space = {}, heuristic = function(found, instance)\n"
      "  return function(random, normal) return random() * 10, 5 + random() * 5, (random() - 0.5) end,\n"
      "    function(x, y, t) return (y >= 5 and math.abs(t) <= 0.5) and 1 / (10 * 5 * instance.space.weights[3]) or 0 "
      "end end }";
  const RunRecord run = run_of(box, "g >> rrt { bound = 0 }");
  REQUIRE(run.levels.size() == 1);
  CHECK(run.solved);
  REQUIRE(run.levels[0].proposal_density);
  // Half the volume and more has uniform proposals alone.
  const double inside = run.levels[0].proposal_density(Configuration{5, 8, 0.1});
  const double outside = run.levels[0].proposal_density(Configuration{5, 2, 0.1});
  const double uniform = 0.95 * 0.05 * std::exp(-run.levels[0].space.log_volume());
  CHECK(outside == Approx(uniform));
  CHECK(inside == Approx(uniform + 0.95 * 0.95 / 50.0 * std::numbers::pi));
  CHECK_THAT(run_failure("guiding_space { name = 'box', space = {}, heuristic = function() return function(random) "
                         "return random(), 1, 1 end end,\n density = function() return 0 end }"),
             Contains("in box >> rrt (problem 'room', seed 1): density at (") &&
                 Contains("where it drew a sample: it returned 0, expected a finite number greater than 0"));
}

TEST_CASE("a function that draws may name the node to extend") {
  // `observe` compares the node that was extended with the one that was named, the first of three.
  const RunRecord run = run_of(
      "(function() local nodes, named = {}, nil\n"
      "  return guiding_space { name = 'first', space = {}, heuristic = function()\n"
      "      return function(random) named = nodes[#nodes > 2 and #nodes - 2 or 1]\n"
      "        return random() * 10, random() * 10, random(), named and named.number end end,\n"
      "    observe = function(o)\n"
      "      if o.mine and named then assert(o.near[1] == named.q[1] and o.near[2] == named.q[2], 'another node') end\n"
      "      assert((o.added == nil) == (o.number == nil), 'a node without a number')\n"
      "      if o.added then nodes[#nodes + 1] = { q = { o.added[1], o.added[2] }, number = o.number } end\n"
      "    end } end)()",
      "g >> rrt { bound = 0, proposals = 200 }");
  CHECK(run.levels[0].search.nodes.size() > 20);
  const std::string draws = "guiding_space { name = 'g', space = {}, heuristic = function() return function() return ";
  CHECK_THAT(run_failure(draws + "1, 2, 1, 0.5 end end }"),
             Contains("its sample 1: after the coordinates it returned 0.5, expected the number of a node"));
  CHECK(run_failure(draws + "1, 2, 1, nil end end }", "g >> rrt { proposals = 5 }").empty());
}

TEST_CASE("a function that draws may choose the control of the extension") {
  const auto cart = [](const std::string& guide, const std::string& planner = "bound = 0, proposals = 200",
                       const std::string& motion = "motion.unicycle1 { min_speed = 0, max_speed = 1 }") {
    return load(
               "local cart = problem { name = 'cart', world = world { bounds = {0, 0, 10, 10}, box {4, 0, 6, 7} },\n"
               "  robot = robot.rectangle(0.6, 0.2), start = {1, 1, 0}, goal = {9, 1, 0}, goal_tolerance = 0.1,\n"
               "  motion = " +
               motion + " }\nlocal g = " + guide +
               "\nreturn experiment { problems = cart, strategies = { it = g >> kinodynamic_rrt { goal_bias = 0, "
               "uniform = 0, " +
               planner + " } }, measure = false }\n")
        .experiment;
  };
  const auto run = [&](const Experiment& experiment) {
    return execute(experiment.strategies.front().second, experiment.problems.front(), 1);
  };
  // `observe` compares the node, the control and the duration of each extension with those that were chosen.
  const RunRecord chosen =
      run(cart("(function() local nodes, last, c = {}, nil, nil\n"
               "  return guiding_space { name = 'chooses', space = {}, heuristic = function(_, instance)\n"
               "      c = instance\n"
               "      assert(c.motion.name == 'unicycle1' and c.motion.dt == 0.1 and #c.motion.controls == 2)\n"
               "      assert(c.motion.controls[1].lower == 0 and c.motion.controls[1].upper == 1)\n"
               "      return function(random)\n"
               "        local from = nodes[#nodes]\n"
               "        last = { from = from, control = { random(), 0.2 * random() - 0.1 }, duration = 0.1 * (1 + "
               "#nodes % 5) }\n"
               "        return { to = {random() * 10, 5, 0}, node = from and from.number, control = last.control,\n"
               "          duration = last.duration } end end,\n"
               "    observe = function(o)\n"
               "      if not o.mine then return end\n"
               "      assert(o.control[1] == last.control[1] and o.control[2] == last.control[2], 'another control')\n"
               "      if last.from then assert(o.near_number == last.from.number, 'another node') end\n"
               "      assert(o.duration <= last.duration + 1e-9, 'too long')\n"
               "      if not o.added then return end\n"
               "      local to = c:drive(o.near, o.control, o.duration)\n"
               "      for i = 1, 3 do assert(to[i] == o.added[i], 'drive ends elsewhere') end\n"
               "      nodes[#nodes + 1] = { number = o.number }\n"
               "    end } end)()"));
  const Search& search = chosen.levels.front().search;
  CHECK(search.nodes.size() > 20);
  for (const std::uint32_t steps : search.controls.steps) CHECK(steps <= 5);

  const auto failure = [&](const std::string& result, const std::string& motion = "motion.unicycle1 {}") {
    try {
      run(cart("guiding_space { name = 'g', space = {}, heuristic = function(_, instance) return function() return " +
                   result + " end end }",
               "proposals = 5", motion));
    } catch (const Error& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  CHECK(failure("{ to = {1, 2, 1} }").empty());
  CHECK(failure("{ to = {1, 2, 1}, control = {0, 0}, duration = 0.3 }").empty());
  // Longer than the planner's longest motion: as long as that.
  CHECK(failure("{ to = {1, 2, 1}, control = {0, 0}, duration = 30 }").empty());
  CHECK_THAT(failure("{ to = {1, 2, 1}, control = {0}, duration = 0.3 }"),
             Contains("its sample 1: 'control' must be 2 numbers (speed, angular_speed), the controls of unicycle1"));
  CHECK_THAT(failure("{ to = {1, 2, 1}, control = {7, 0}, duration = 0.3 }"),
             Contains("'control': speed is 7, expected"));
  CHECK_THAT(failure("{ to = {1, 2, 1}, control = {0, 0} }"), Contains("'control' and 'duration' belong together"));
  CHECK_THAT(failure("{ to = {1, 2, 1}, control = {0, 0}, duration = 0 }"),
             Contains("'duration' must be a number greater than 0"));
  CHECK_THAT(failure("{ control = {0, 0}, duration = 1 }"), Contains("needs 'to'"));
  CHECK_THAT(failure("{ to = {1, 2, 1}, controls = {0, 0} }"), Contains("the field 'controls'") && Contains("control"));
  CHECK_THAT(failure("{ to = {1, 2, 1}, node = 0.5 }"), Contains("'node' is 0.5, expected the number of a node"));
  CHECK_THAT(failure("{ to = instance:drive({1, 1, 0}, {0, 9}, 1) }"),
             Contains("instance:drive: control: angular_speed is 9"));
  CHECK_THAT(run_failure("guiding_space { name = 'g', space = {}, heuristic = function() return function()\n"
                         "  return { to = {1, 2, 1}, control = {0, 0}, duration = 1 } end end }"),
             Contains("'control' needs a motion model"));
}

TEST_CASE("shapes have a kind, a name, bounds and vertices, and cannot be changed") {
  const std::string world =
      "local w = world { bounds = {0, 0, 10, 10}, box {4, 0, 6, 7, name = 'left'}, disc {1, 8, 0.5}, "
      "polygon { {7, 7}, {9, 7}, {8, 9} } } ";
  const std::string text =
      "local function text(shape) local corners = {} "
      "if shape.kind ~= 'disc' then for i, v in ipairs(shape.vertices) do corners[i] = ('%g %g'):format(v[1], v[2]) "
      "end "
      "end local b = shape.bounds return ('%s, %s, %g %g %g %g, %s'):format(shape.kind, shape.name, b[1], b[2], b[3], "
      "b[4], table.concat(corners, '; ')) end ";
  CHECK(test::values(world + text +
                     "local o = w.obstacles return text(o[1]), text(o[2]), text(o[3]), "
                     "text(box {0, 1, 2, 3}), text(box {0, 1, 2, 3, name = 'b'})") ==
        std::vector<std::string>{"box, left, 4 0 6 7, 4 0; 6 0; 6 7; 4 7", "disc, disc 1 8 0.5, 0.5 7.5 1.5 8.5, ",
                                 "polygon, polygon of 3 vertices, 7 7 9 9, 7 7; 9 7; 8 9",
                                 "box, box 0 1 2 3, 0 1 2 3, 0 1; 2 1; 2 3; 0 3",
                                 "box, b, 0 1 2 3, 0 1; 2 1; 2 3; 0 3"});
  CHECK_THAT(test::failure(world + "return w.obstacles[2].vertices"),
             Contains("test.lua:1: a disc has no vertices; it has kind, name and bounds"));
  CHECK_THAT(
      test::failure(world + "return w.obstacles[1].vertexes"),
      Contains("a shape has no field \"vertexes\" (did you mean 'vertices'?); it has: kind, name, bounds, vertices"));
  CHECK_THAT(test::failure(world + "w.obstacles[1].name = 'right'"),
             Contains("test.lua:1: a shape cannot be changed, so its field \"name\" cannot be set; make another one"));
  CHECK_THAT(test::failure(world + "w.bounds = {}"), Contains("a world cannot be changed, so its field \"bounds\""));
  CHECK_THAT(test::failure("robot.disc(1).radius = 2"), Contains("a robot cannot be changed"));
  CHECK_THAT(test::failure("tube {}.delta = 2"), Contains("a target cannot be changed"));
}

TEST_CASE("the functions of a guide ask the instance for validity, clearance and the nearest obstacle") {
  const std::string ask =
      "guiding_space { name = 'g', space = {}, heuristic = function(_, i)\n"
      "  local function near(a, b) assert(math.abs(a - b) < 1e-9, a .. ' is not ' .. b) end\n"
      "  assert(i:valid(i.start) and i:valid(1, 1, 0) and i.valid(1, 1, 0) and not i:valid({5, 5, 0}))\n"
      "  assert(not i:valid(50, 5, 0))\n"
      "  near(i:clearance(2, 1, 0), 0.9) near(i:clearance({5, 5, 0}), 0) near(i:clearance(50, 5, 0), 0)\n"
      "  local n = i:nearest_obstacle(2, 1, 0)\n"
      "  near(n.distance, 1.7) near(n.point[1], 4) assert(#n.point == 2 and math.abs(n.point[2] - 1) <= 0.1 + 1e-9)\n"
      "  assert(n.name == 'box 4 0 6 7' and n.shape.name == n.name and n.number == 1 and n.shape.bounds[4] == 7)\n"
      "  local inside = i:nearest_obstacle({5, 5, 0})\n"
      "  assert(inside.distance == 0 and inside.point == nil)\n"
      "  assert(tostring(i) == 'an instance' and #i.goals == 1 and i.world.obstacles[1].kind == 'box')\n"
      "  return uniform() end }";
  const RunRecord run = run_of(ask, "g >> rrt { bound = 0, goal_bias = 0, uniform = 0, proposals = 10 }");
  const RunRecord without =
      run_of("guiding_space { name = 'g', space = {}, heuristic = function() return uniform() end }",
             "g >> rrt { bound = 0, goal_bias = 0, uniform = 0, proposals = 10 }");
  // Each answer is a check of the level, but where a configuration lies outside of the space.
  CHECK(run.levels[0].search.checks.validity == without.levels[0].search.checks.validity + 8);
  // Of the functions that make S: of S's level.
  const auto checks = [&](const std::string& more) {
    return run_of("guiding_space { name = 'g', robot = function(i) " + more + " return i.robot:scaled(0.5) end }",
                  "g >> rrt { bound = 0 }")
        .levels[1]
        .search.checks.validity;
  };
  CHECK(checks("for k = 1, 10 do i:valid(i.start) i:clearance(i.start) i:nearest_obstacle(i.start) end") ==
        checks("") + 30);
}

TEST_CASE("what is wrong with a question to the instance is said") {
  const auto fails = [](const std::string& code) {
    return run_failure("guiding_space { name = 'g', space = {}, heuristic = function(_, i)\n" + code +
                       "\nreturn uniform() end }");
  };
  const std::string at = "in g >> rrt (problem 'room', seed 1): heuristic: test.lua:4: ";
  CHECK_THAT(fails("i:clearance(1, 2)"),
             Contains(at + "instance:clearance: its configuration must be 3 numbers (x, y, theta), got 1, 2"));
  CHECK_THAT(fails("i:valid()"),
             Contains(at + "instance:valid: its configuration must be 3 numbers (x, y, theta), got nothing"));
  CHECK_THAT(fails("i:valid('a', 2, 3)"), Contains("must be 3 numbers (x, y, theta), got \"a\", 2, 3"));
  CHECK_THAT(
      fails("i:valid({1, 2})"),
      Contains(at + "instance:valid: its configuration must be a configuration of 3 numbers (x, y, theta), got 2"));
  CHECK_THAT(fails("i:nearest_obstacle(1, 2, 0/0)"), Contains("must be finite numbers: theta is nan"));
  CHECK_THAT(fails("i:nearest_obstacle(50, 2, 0)"),
             Contains(at + "instance:nearest_obstacle: (50, 2, 0) lies outside of the space SE(2)"));
  CHECK_THAT(fails("i:clearence(1, 2, 0)"),
             Contains(at + "an instance has no field \"clearence\" (did you mean 'clearance'?); it has: space, start"));
  CHECK_THAT(fails("i.start = {1, 2, 0}"),
             Contains(at + "an instance cannot be changed, so its field \"start\" cannot be set; make another one"));
  // A space without collision checks has a clearance or not, and no obstacle.
  CHECK_THAT(run_failure("(function() local f = guiding_space { name = 'f', valid = function() return true end }\n"
                         "local g = guiding_space { name = 'g', space = {}, heuristic = function(_, i) "
                         "i:clearance(i.start) return uniform() end } return g >> f end)()"),
             Contains("instance:clearance: validity is a function of the script, which has no clearance"));
  CHECK_THAT(run_failure("guiding_space { name = 'g', space = {}, heuristic = function(_, i) "
                         "assert(i:clearance(i.start) == math.huge) i:nearest_obstacle(i.start) return uniform() end }",
                         "g >> lazy() >> rrt {}"),
             Contains("instance:nearest_obstacle: no collision check decides validity in this space, so it has no "
                      "nearest obstacle"));
  CHECK_THAT(
      run_failure("(function() local kept return guiding_space { name = 'g', robot = function(i) kept = i return "
                  "i.robot end, heuristic = function() kept:valid(1, 1, 0) end } end)()"),
      Contains("instance:valid: the call that this instance was given to is over"));
}

TEST_CASE("f is applied again to what is known where h is stale") {
  // S presumes that everything is valid, so that C refutes the path; then the wall of C is a wall of S too.
  const RunRecord run = run_of(
      "(function() local calls, last = 0, 0\n"
      "return guiding_space { name = 'learning', resolves = 3, world = function(instance, known)\n"
      "    calls = calls + 1\n"
      "    assert((#known.samples > 0) == (calls > 1) and #known.new == #known.samples - last)\n"
      "    last = #known.samples\n"
      "    if calls == 1 then return world { bounds = instance.world.bounds } end\n"
      "    local blocked = 0\n"
      "    for _, sample in ipairs(known.samples) do\n"
      "      assert(#sample.q == 3 and (sample.node == nil) == (sample.fate == 'rejected'))\n"
      "      assert(type(sample.mine) == 'boolean')\n"
      "      if sample.blocked_at then blocked = blocked + 1 end\n"
      "    end\n"
      "    assert(blocked > 0 and #known.paths == 1 and known.paths[1].guide == 'learning')\n"
      "    assert(#known.paths[1].path > 1 and #known.paths[1].path[1] == 3)\n"
      "    assert(#known.refuted == 1 and #known.refuted[1] == 3)\n"
      "    assert(tostring(known) == 'a record of C' and known.samples == known.samples)\n"
      "    return instance.world end } end)()",
      "g >> rrt { bound = 0 }");
  CHECK(run.solved);
  REQUIRE(run.levels.size() == 2);
  CHECK(run.levels[1].solves > 1);
  const auto& resolves = run.levels[1].resolves;
  CHECK(resolves.rejections + resolves.invalid_path == run.levels[1].solves - 1);
  CHECK(planar(*run.levels[1].scene).world.obstacles().size() == 1);
}

TEST_CASE("with turns of one sample a graph of a script grows by that sample") {
  const std::string growing =
      "(function() local last\n"
      "local function growing(name) return guiding_space { name = name, space = {'x', 'y'}, graph = function(i, "
      "known)\n"
      "  local n = #known.samples\n"
      "  if last and n ~= (n == 0 and 0 or last + 1) then error(n .. ' samples after ' .. last) end\n"
      "  last = n\n"
      "  local vertices, edges = { {i.start[1], i.start[2]}, {i.goal[1], i.goal[2]} }, { {1, 2} }\n"
      "  for _, sample in ipairs(known.samples) do\n"
      "    vertices[#vertices + 1] = {sample.q[1], sample.q[2]}\n"
      "    edges[#edges + 1] = {1, #vertices, 0} edges[#edges + 1] = {#vertices, 2, 1 / #vertices}\n"
      "  end\n"
      "  return { vertices = vertices, edges = edges, start = 1, goal = 2 } end } end\n"
      "return sequence { growing('a'), growing('b'), turn = 1 } end)()";
  const RunRecord run =
      run_of(growing, "g >> rrt { bound = 0, goal_bias = 0, uniform = 0, connect_goal = false, proposals = 15 }");
  REQUIRE(run.levels.size() == 3);
  CHECK(run.levels[0].search.proposals.size() == 15);
  CHECK(run.levels[1].resolves.new_turn == 7);
  CHECK(run.levels[2].resolves.new_turn == 6);
  // The path leads by the latest sample, whose edge costs least.
  const View sample = run.levels[0].search.proposals[13];
  const Configurations& path = run.levels[1].solution.path;
  REQUIRE(path.size() == 3);
  CHECK(path[1][0] == sample[0]);
  CHECK(path[1][1] == sample[1]);
}

TEST_CASE("a function without a second parameter is called once, and what is known ends with its call") {
  const auto fails = [](const std::string& guide, const std::string& strategy = "g >> rrt { bound = 0 }") {
    return run_failure(
        "(function() local calls, kept = 0 return guiding_space { name = 'g', resolves = 3, " + guide + " } end)()",
        strategy);
  };
  const std::string open = "return world { bounds = i.world.bounds } end";
  CHECK(fails("world = function(i) calls = calls + 1 assert(calls == 1) " + open) == "");
  CHECK_THAT(fails("world = function(i, known) calls = calls + 1 assert(calls == 1) " + open), Contains("assertion"));
  CHECK_THAT(fails("world = function(i, ...) calls = calls + 1 assert(calls == 1) " + open), Contains("assertion"));
  CHECK_THAT(
      fails("world = function(i, known) kept = known " + open + ", heuristic = function() return kept.samples end"),
      Contains("heuristic: test.lua:3: known.samples: the call that it was given to is over"));
  CHECK_THAT(fails("world = function(i, known) return known.sample end"),
             Contains("known has no field \"sample\" (did you mean 'samples'?); it has: samples, new, paths, refuted"));
  CHECK_THAT(fails("world = function(i, known) known.samples = {} end"), Contains("a record of C cannot be changed"));
  // A level keeps its space.
  CHECK_THAT(fails("valid = 'free', space = function(i, known) return #known.samples == 0 and {'x', 'y'} or {'x'} end"),
             Contains("in g >> rrt, level 1 (problem 'room', seed 1): f is applied again, and S is another space than "
                      "before"));
  CHECK_THAT(strategy_of("guiding_space { name = 'g', world = function(i, known) return i.world end }").json(),
             Contains("\"custom\""));
}

TEST_CASE("guides whose functions keep other shapes are different") {
  const auto with = [](const std::string& shape) {
    return strategy_of(
        "(function(s) return guiding_space { name = 'g', world = function(i) return world { bounds = "
        "i.world.bounds, s } end } end)(" +
        shape + ")");
  };
  CHECK(with("box {4, 0, 6, 7}") == with("box {4, 0, 6, 7}"));
  CHECK_FALSE(with("box {4, 0, 6, 7}") == with("box {4, 0, 6, 6}"));
  CHECK_FALSE(with("disc {4, 1, 1}") == with("disc {4, 1, 2}"));
  CHECK_FALSE(with("sphere {4, 1, 1, 1}") == with("sphere {4, 1, 1, 2}"));
}

TEST_CASE("h receives the outcomes of its proposals, may adapt to them, and requests another solution") {
  const RunRecord run = run_of(
      "(function() local n, kinds = 0, {}\n"
      "return guiding_space { name = 'informed', valid = 'free', resolves = 2,\n"
      "  heuristic = function(found, instance) n = 0 return ball(instance.start, 1) end,\n"
      "  observe = function(o) n = n + 1\n"
      "    assert(#o.proposal == 3 and (o.added == nil) == (o.fate == 'rejected') and type(o.mine) == 'boolean')\n"
      "    assert(o.fate ~= 'reached' or o.added[1] == o.proposal[1])\n"
      "    if n == 10 then return 0.5 * uniform() + 0.5 * ball({9, 1, 0}, 1) end end,\n"
      "  stale = function() return n == 60 end } end)()",
      "g >> rrt { uniform = 0, goal_bias = 0, bound = 0, proposals = 1000 }");
  REQUIRE(run.levels.size() == 2);
  CHECK(run.levels[1].solves == 3);
  const Space& space = run.levels[0].space;
  const auto& proposals = run.levels[0].search.proposals;
  REQUIRE(proposals.size() > 10);
  for (std::size_t i = 0; i < 10; ++i) CHECK(space.distance(proposals[i], Configuration{1, 1, 0}) <= 1.0 + 1e-9);
  bool far = false;
  for (std::size_t i = 10; i < std::min<std::size_t>(proposals.size(), 60); ++i) {
    far = far || space.distance(proposals[i], Configuration{1, 1, 0}) > 1.0 + 1e-9;
  }
  CHECK(far);
}

TEST_CASE("what is lifted from a space with C's axes guides as it does over C") {
  for (const std::string follow : {"steps", "tube", "waypoints"}) {
    const auto guide = [&](const std::string& h) {
      return "guiding_space { name = 'same', valid = 'parent', planner = rrt { step = 0.5 },\n"
             "  heuristic = function(found) return " +
             h + " end }";
    };
    const std::string along =
        "along(found.path, { follow = '" + follow + "', radius = 0.3, window = 1, evidence = 20 })";
    for (const std::string strategy : {"g >> rrt { step = 0.5 }", "g >> rrt_connect { step = 0.5 }"}) {
      for (const std::uint64_t seed : {1U, 2U, 3U}) {
        CAPTURE(follow, strategy, seed);
        const RunRecord plain = run_of(guide(along), strategy, seed);
        const RunRecord lifted = run_of(guide("lifted(" + along + ")"), strategy, seed);
        REQUIRE(lifted.levels.size() == plain.levels.size());
        for (std::size_t i = 0; i < plain.levels.size(); ++i) {
          CHECK((all(lifted.levels[i].search.proposals) == all(plain.levels[i].search.proposals)));
          CHECK((all(lifted.levels[i].search.nodes) == all(plain.levels[i].search.nodes)));
        }
        CHECK(lifted.validity_checks == plain.validity_checks);
      }
    }
  }
}

TEST_CASE("a distribution that a script returns hears of everything that it would hear of by itself") {
  const std::string planner = " >> rrt_star { step = 0.5, proposals = 1500, uniform = 0, bound = 0 }";
  for (const std::string distribution : {"informed()", "halton()", "goal_bias()", "gaussian()", "uniform()"}) {
    CAPTURE(distribution);
    const RunRecord alone = run_of("0", distribution + planner);
    const RunRecord returned =
        run_of("guiding_space { name = 'mine', space = {}, heuristic = function() return " + distribution + " end }",
               "g" + planner);
    CHECK(alone.solved);
    CHECK((all(returned.levels[0].search.proposals) == all(alone.levels[0].search.proposals)));
    CHECK((all(returned.path) == all(alone.path)));
  }
}

TEST_CASE("where the planner lost nodes a script is notified, receives the others, and recomputes h") {
  // `drop` removes the blocking obstacle, which returns: the tree in that space loses branches.
  const std::string strategy = "g >> drop { planner = rrt { step = 0.5, bound = 0 } } >> rrt { step = 0.5, bound = 0 }";
  const auto guide = [](const std::string& restart, const std::string& more) {
    return "(function() local lost = false\n"
           "return guiding_space { name = 'mine', space = {}, restart = function() " +
           restart +
           " end,\n"
           "  heuristic = function(found, instance) assert(not lost, 'made anew') return uniform() end" +
           more + " } end)()";
  };
  CHECK_THAT(run_failure(guide("error('lost nodes')", ""), strategy), Contains("restart: ") && Contains("lost nodes"));
  CHECK_THAT(run_failure(guide("lost = true", ""), strategy), Contains("made anew"));
  CHECK_THAT(run_failure(guide("lost = true",
                               ",\n  observe = function(o) if lost and o.added and not o.mine then "
                               "error('a node that is left: ' .. o.fate .. ' ' .. #o.added) end end"),
                         strategy),
             Contains("a node that is left: reached 3"));
  // With a space, too, which is projected anew where the world changed.
  for (const std::string h : {"along(found.path)", "lifted(along(found.path))"}) {
    CAPTURE(h);
    std::uint64_t most = 0;
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
      const RunRecord run = run_of(
          "guiding_space { name = 'half', robot = function(i) return i.robot:scaled(0.5) end, "
          "heuristic = function(found) return " +
              h + " end }",
          strategy, seed);
      CHECK(run.solved);
      REQUIRE(run.levels.size() == 3);
      most = std::max<std::uint64_t>(most, run.levels[2].solves);
    }
    CHECK(most > 1);
  }
}

TEST_CASE("what a function leaves behind reaches no other run, and any number of jobs gives the same") {
  const std::string counting = script(
      "local n = 0\n"
      "local g = guiding_space { name = 'counting', space = {}, heuristic = function(_, instance)\n"
      "  return function(random) n = n + 1 return n % 10, 10 * random(), math.random() end end }",
      "g >> lazy() >> rrt {}", ", seeds = 6");
  const auto rows = [&](unsigned jobs) {
    std::vector<std::vector<double>> all_rows;
    for (const RunResult& run : run_all(counting, jobs).runs) {
      for (const auto& level : run.levels) all_rows.push_back(all(level.record.search.proposals));
    }
    return all_rows;
  };
  const auto one = rows(1);
  CHECK(one == rows(4));
  const Experiment experiment = load(counting).experiment;
  for (int again = 0; again < 2; ++again) {
    const RunRecord run = execute(experiment.strategies[0].second, experiment.problems[0], 1);
    CHECK(all(run.levels[0].search.proposals) == one[0]);
    CHECK(all(run.levels[1].search.proposals) == one[1]);
  }
  CHECK(one[0] != one[2]);
}

TEST_CASE("runs whose records call no function of the script share its interpreter while they wait for scores") {
  // The ball's x is from the address of a table of the script, which names the interpreter.
  const std::string named = script(
      "local here = {}\n"
      "local half = guiding_space { name = 'half', space = {'x', 'y'}, robot = robot.point(),\n"
      "  heuristic = function(found) return lifted(along(found.path)) end }\n"
      "local g = guiding_space { name = 'ball', space = {}, heuristic = function()\n"
      "  local address = tonumber(tostring(here):match('0x(%x+)'), 16)\n"
      "  return ball({2 + address // 16 % 1000000 / 1e6, 9, 3}, 1e-8) end }",
      "(half + g) >> rrt { bound = 0 }");
  const Experiment experiment = load(named).experiment;
  std::set<double> interpreters;
  std::vector<RunRecord> runs;
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    runs.push_back(execute(experiment.strategies[0].second, experiment.problems[0], seed));
    const Configurations& proposals = runs.back().levels[0].search.proposals;
    for (std::size_t i = 0; i < proposals.size(); ++i) {
      const View q = proposals[i];
      if (std::abs(q[1] - 9.0) + std::abs(q[2] - 3.0) < 1e-7) interpreters.insert(std::round(q[0] * 1e6));
    }
  }
  CHECK(interpreters.size() == 1);
  for (const RunRecord& run : runs) {
    REQUIRE(run.levels.size() == 2);
    CHECK(run.levels[0].proposal_density(Configuration{5, 8, 0}) > 0.0);
    CHECK(run.levels[1].root_proposal_density(Configuration{5, 9, 1}) > 0.0);
  }
}

TEST_CASE("the density of a run has the state that this run left") {
  const Experiment experiment =
      load(script("local n = 0\n"
                  "local g = guiding_space { name = 'counting', space = {}, heuristic = function()\n"
                  "  return function(random) n = n + 1 return 10 * random(), 10 * random(), 0 end,\n"
                  "    function() return 1 + n end end }",
                  "g >> rrt { bound = 0 }"))
          .experiment;
  const auto run = [&](std::uint64_t seed) {
    return execute(experiment.strategies[0].second, experiment.problems[0], seed);
  };
  const Configuration q{5, 8, 0};
  const RunRecord first = run(1);
  const double density = first.levels[0].proposal_density(q);
  const RunRecord second = run(2);
  CHECK(second.levels[0].proposal_density(q) != density);
  CHECK(first.levels[0].proposal_density(q) == density);
  CHECK(run(1).levels[0].proposal_density(q) == density);
}

TEST_CASE("a snapshot shows whether a call changed a value that functions of the script can reach") {
  const std::string script =
      "text = 'abc'\n"
      "deep = { list = { 1, 2, { 3 } } }\n"
      "meta = setmetatable({}, { __index = { key = 1 } })\n"
      "local n, seen = 0, {}\n"
      "function count() n = n + 1 return n end\n"
      "function see(x) seen[#seen + 1] = x end\n"
      "function work() local t = {} for i = 1, 100 do t[i] = tostring(i) end return #table.concat(t) end\n"
      "words = string.gmatch('a b c', '%a')\n";
  const auto changed_by = [&](const std::string& call, const std::string& more = "") {
    dsl::Session session("");
    std::optional<lua::Snapshot> snapshot;
    session.with([&](lua::Stack& stack) {
      stack.load(script + more, "@test.lua");
      stack.call(0);
      snapshot.emplace(stack, std::vector<const lua::Reference*>{});
    });
    bool same = false;
    session.with([&](lua::Stack& stack) {
      stack.load(call, "@call.lua");
      stack.call(0);
      stack.resize(0);
      same = snapshot->unchanged(stack);
    });
    session.with([&](lua::Stack&) { snapshot.reset(); });
    return !same;
  };
  for (const char* reads : {"work()", "return deep.list[3][1] + meta.key", "local t = { deep } t[1] = nil",
                            "local f = function() return text end f()", "return skeleton() >> rrt {}",
                            "collectgarbage() work()", "return #deep.list", "deep.list[1] = 1", "math.random()"}) {
    INFO(reads);
    CHECK_FALSE(changed_by(reads));
  }
  for (const char* writes :
       {"count()", "see(1)", "text = 'abd'", "text = nil", "new = 1", "deep.list[3][1] = 4", "deep.list[3].x = 1",
        "deep.list = { 1, 2, { 3 } }", "getmetatable(meta).__index.key = 2", "setmetatable(deep, {})",
        "getmetatable('').__index = nil", "words()", "string.upper = string.lower", "deep.list[1] = 1.0",
        "return scenes.cup()", "count = see", "print = nil", "text = text:upper():lower() .. 'd' collectgarbage()"}) {
    INFO(writes);
    CHECK(changed_by(writes));
  }
  // What changes by itself always counts as changed.
  for (const char* more : {"thread = coroutine.create(work)", "weak = setmetatable({}, { __mode = 'k' })",
                           "wrapped = coroutine.wrap(function() while true do coroutine.yield(1) end end)"}) {
    INFO(more);
    CHECK(changed_by("return 1", more));
  }
}

TEST_CASE("a script that defines other guides when it is loaded again is an error") {
  dsl::SessionOptions options;
  options.trust = true;
  const std::string fickle = script(
      "local k = os.clock()\n"
      "local g = guiding_space { name = 'fickle', robot = function(i) return i.robot:scaled(1 / (1 + k)) end }",
      "g >> rrt {}");
  const Experiment experiment = dsl::Session("", options).load(fickle, "test.lua").experiment;
  CHECK_THROWS_WITH(execute(experiment.strategies[0].second, experiment.problems[0], 1),
                    Contains("the script does not define the same guides each time it is loaded: guide 1 was fickle "
                             "(test.lua:4, "));
}

TEST_CASE("what is wrong with a guide is said where it is written") {
  const auto fails = [](const std::string& fields) { return test::failure("guiding_space { " + fields + " }"); };
  CHECK_THAT(fails("nmae = 'x'"), Contains("test.lua:1: guiding_space: unknown field 'nmae' (did you mean 'name'?)"));
  CHECK_THAT(fails("name = 'a b'"), Contains("field 'name' must be a name as of a variable, got \"a b\""));
  CHECK_THAT(fails("project = 3"), Contains("field 'project' must be a function, got 3"));
  CHECK_THAT(fails("robot = world { bounds = {0, 0, 1, 1} }"),
             Contains("field 'robot' must be a robot, or a function"));
  CHECK_THAT(fails("valid = 'fre'"), Contains("field 'valid' must be a function, \"free\""));
  CHECK_THAT(fails("planner = 1"), Contains("field 'planner' must be a planner, got 1"));
  CHECK_THAT(fails("resolves = -1"), Contains("resolves"));
  CHECK_THAT(fails("project = function() end"), Contains("'lift' must say how to draw from the fibre"));
  CHECK_THAT(fails("space = {}"), Contains("S = {0} (space = {}) needs a 'heuristic'"));
  CHECK_THAT(fails("space = {}, valid = 'free', heuristic = print"), Contains("S = {0} (space = {}) has no 'valid'"));
  CHECK_THAT(fails("valid = 'free', robot = robot.point()"), Contains("leave out 'robot' and 'world'"));
  CHECK_THAT(fails("density = print"), Contains("there is no 'heuristic'"));
  CHECK_THAT(fails("planner = graph_search {}"), Contains("its space is no explicit graph"));
  CHECK_THAT(test::failure("along(3)"), Contains("along: its first argument must be a path"));
  CHECK_THAT(test::failure("along({{1, 2}, {3}})"), Contains("along: point 2 of the path has 1 coordinates"));
  CHECK_THAT(test::failure("along({}, { radus = 1 })"), Contains("did you mean 'radius'?"));
  CHECK_THAT(test::failure("ball({1, 2}, 0)"), Contains("ball: its radius must be a number greater than 0"));
  CHECK_THAT(test::failure("lifted(3)"), Contains("lifted: takes a distribution over S"));
}

TEST_CASE("an error in a guide's function names the level, the run and the line") {
  const std::string at = "test.lua:3: in g >> rrt, level 1 (problem 'room', seed 1): ";
  const auto fails = [](const std::string& fields) {
    return run_failure("guiding_space { name = 'g', " + fields + " }");
  };
  CHECK_THAT(fails("robot = function() return nil + 1 end"),
             Contains(at + "robot: test.lua:3: attempt to perform arithmetic on a nil value\nstack traceback:\n"));
  CHECK_THAT(fails("robot = function() return 3 end"), Contains(at + "robot: it must be a robot, got 3"));
  CHECK_THAT(fails("robot = function() end"), Contains(at + "robot: it returned nothing"));
  CHECK_THAT(fails("space = {'x', 'z'}, valid = 'free'"),
             Contains(at + "space: entry 2 must be the name of an axis of C"));
  CHECK_THAT(fails("space = {'x'}"), Contains("'robot', 'world' or 'valid' must say what is valid in it"));
  CHECK_THAT(fails("space = {'x', 'y'}, world = function(i) return i.world end"),
             Contains("its robot needs 3 coordinates, and S has 2 (x, y)"));
  CHECK_THAT(fails("space = { names = {'x'}, lower = {2}, upper = {8} }, valid = 'free'"),
             Contains("f of the start, (1), is outside of S"));
  CHECK_THAT(fails("space = {'x'}, valid = 'parent'"), Contains("valid = \"parent\": S has other axes than C"));
  CHECK_THAT(fails("valid = function() return 1 end"),
             Contains(at + "valid at (") && Contains("expected true or false"));
  CHECK_THAT(fails("heuristic = function() return 3 end"),
             Contains(at + "heuristic: it returned 3, expected a distri"));
  CHECK_THAT(fails("heuristic = function() return shrink(0.5) end"), Contains("has a space of its own to search"));
  CHECK_THAT(fails("heuristic = function() return along({{1, 2}, {3, 4}}) end"),
             Contains("along: point 1 of the path has 2 coordinates, and the space SE(2)"));
  CHECK_THAT(fails("heuristic = function() return ball({11, 1, 0}, 1) end"), Contains("is outside of the space SE(2)"));
  const std::string draws = "heuristic = function() return function(random, normal) ";
  CHECK_THAT(fails(draws + "return 1, 2 end end"),
             Contains(at + "its sample 1: what the function that draws returns must be 3 numbers (x, y, theta), got 1, "
                           "2"));
  CHECK_THAT(fails(draws + "return 1, 0/0, 1 end end"), Contains("must be finite numbers: y is nan"));
  CHECK_THAT(fails(draws + "return 1, 12, 1 end end"), Contains("y = 12 is outside of [0, 10]"));
  CHECK_THAT(fails(draws + "error('seven') end end"),
             Contains(at + "its sample 1: test.lua:3: seven\nstack traceback:"));
  CHECK_THAT(fails(draws + "while true do end end end"),
             Contains(at + "its sample 1: ") && Contains("does not terminate"));
  CHECK_THAT(fails("observe = function(o) error(o.fate) end"), Contains(at + "observe, outcome 1: test.lua:3: "));
  CHECK_THAT(fails("stale = function() end"), Contains(at + "stale") && Contains("it returned nothing"));
  CHECK_THAT(fails("graph = function() return { vertices = {{1, 2, 3}}, edges = {{1, 2}}, start = 1, goal = 1 } end"),
             Contains("edge 1: its second end must be the number of a vertex, from 1 to 1, got 2"));
  CHECK_THAT(run_failure("uniform()", "lifted(uniform()) >> rrt {}"),
             Contains("only the heuristic of a guiding_space may return what is lifted"));
}

TEST_CASE("functions that no run called are known, and random draws in its call only") {
  const dsl::Program program = load(script(
      "local g = guiding_space { name = 'g', valid = 'free', observe = function() end, stale = function() return false "
      "end }\nlocal unused = guiding_space { name = 'unused', observe = function() end }",
      "g >> rrt {}"));
  trellis::run(program.experiment);
  const auto uncalled = program.uncalled();
  REQUIRE(uncalled.size() == 1);
  CHECK(uncalled[0].function == "test.lua:4: 'observe' of the guiding space 'unused'");
  CHECK(uncalled[0].guides);
  CHECK_THAT(run_failure("(function() local kept return guiding_space { name = 'g', heuristic = function() return "
                         "function(random) kept = random return 1, 1, 0 end end, stale = function() if kept then "
                         "kept() end return false end } "
                         "end)()"),
             Contains("random: draws only while the function that it was given to is called"));
}

TEST_CASE("distributions guide by themselves, and within a guide's own space") {
  const RunRecord run = run_of("along({{1, 1, 0}, {5, 8.5, 0}, {9, 1, 0}}, { radius = 0.8 })");
  CHECK(run.solved);
  REQUIRE(run.levels.size() == 1);
  CHECK(run.levels[0].proposal_density);
  CHECK(strategy_of("ball({5, 8, 0}, 1)", "(0.5*g + 0.5*uniform()) >> rrt {}").text() ==
        "(0.5*ball({ 5, 8, 0 }, 1) + 0.5*uniform()) >> rrt()");
}

TEST_CASE("guides in a session without a script use its own interpreter") {
  dsl::Session session("");
  session.with([](lua::Stack& stack) {
    stack.load(
        "calls = 0\n"
        "g = guiding_space { name = 'live', valid = 'free', observe = function() calls = calls + 1 end }",
        "@input 1");
    stack.call(0);
  });
  StrategySpec strategy = PlannerSpec::make("rrt", {});
  session.with([&](lua::Stack& stack) {
    stack.load("return g >> rrt {}", "@input 2");
    stack.call(0);
    strategy = *stack[1].get<StrategySpec>();
    // Within the call, as a session's `plan` does it.
    CHECK(execute(strategy, test::simple_passage_problem(), 1).solved);
  });
  session.with([](lua::Stack& stack) { CHECK(*stack.push_global("calls").integer() > 0); });
}
