// SPDX-License-Identifier: GPL-3.0-or-later
// Bounded loss for random hierarchies of all guides of the catalogue and of guides in Lua that mislead.
#include <cstdint>
#include <cstdlib>
#include <string>
#include <vector>

#include <dsl/language/tools/session.hpp>
#include <trellis/base/error.hpp>
#include <trellis/memory/library.hpp>
#include <trellis/strategy/executor.hpp>

#include "support/bounded_loss.hpp"
#include "support/catch.hpp"
#include "support/folder.hpp"
#include "support/manipulators.hpp"
#include "support/random_specs.hpp"
#include "support/worlds.hpp"

using namespace trellis;

namespace {

const char* const guides = R"(
local function bias(name, draw)
  return guiding_space { name = name, space = {}, heuristic = function(_, instance)
    return function(random) return draw(random, instance) end
  end }
end
-- Valid motion near the start, which leads nowhere.
local zigzag = bias("zigzag", function(random, instance)
  local q, lower, upper = {}, instance.space.lower, instance.space.upper
  for i = 1, #lower do q[i] = math.max(lower[i], math.min(upper[i], instance.start[i] + (i < 3 and random() or 0))) end
  return table.unpack(q)
end)
local goal = bias("goal", function(_, instance)
  local q = {}
  for i = 1, #instance.space.lower do q[i] = instance.goal[i] end
  return table.unpack(q)
end)
-- The workspace as a Lua guide, which spends checks of its own.
local point = guiding_space {
  name = "point", space = { "x", "y" }, robot = robot.point(),
  heuristic = function(found) return lifted(along(found.path, { radius = 0.5 })) end,
}
local all = {
  zigzag, goal, point, workspace(), decomposition(), holonomic(), blossom(), joints { "x", "y" }, pca(2), widen(0.1), drop(),
  aggregate(), uniform(), bridge_test(0.6), obstacle_based(), medial_axis(), halton(), informed { cost = 30 },
  -- Options at their limits: what one call of such a guide spends must not be one step.
  pca { 2, samples = 5000 }, shrink { 0.5, spacing = 1e-3 }, identity { spacing = 1e-3 }, widen { 0.1, spacing = 1e-3 },
  skeleton { spacing = 1e-3 }, lazy { sparse = 1e-3 }, decomposition { size = 0.2 }, workspace { cell = 0.05 },
  gaussian { tries = 10000 }, bridge_test { tries = 10000 }, shrink { 0.9, paths = 4 },
}
local strategies = {}
for i, guide in ipairs(all) do strategies[i] = { tostring(i), guide >> rrt() } end
return experiment { problems = scenes.cup(), strategies = strategies, seeds = 1 }
)";

/// Programs whose strategies name guides and planners; strategies and problems are drawn from these.
const char* const kinds_head = R"(
local function kinds(problems, guides, roots)
  local strategies = {}
  for i, root in ipairs(roots) do strategies[i] = { "root " .. i, root } end
  for i, guide in ipairs(guides) do strategies[#roots + i] = { "guide " .. i, guide >> roots[1] } end
  return experiment { problems = problems, strategies = strategies, seeds = 1, measure = false }
end
)";

const char* const planar_kinds = R"(
local guides = {
  skeleton(), workspace(), workspace { cell = 0.05 }, decomposition(), decomposition { size = 0.2 }, lazy { sparse = 1e-3 },
  skeleton { spacing = 1e-3 }, skeleton { follow = "regions" }, drop(), drop { spacing = 1e-3 }, aggregate(), joints { "x", "y" },
  joints { first = 1, slices = 1000 }, information_gain(1000), state_cells(), state_cells(0.01), uniform(), halton(),
  informed { cost = 15 }, goal_bias(0.5), medial_axis(), medial_axis { rays = 1000, climbs = 1000 }, obstacle_based(),
  obstacle_based { tries = 1000000 },
}
for _, samples in ipairs { 1, 10, 1000, 1000000 } do guides[#guides + 1] = pca { 2, samples = samples } end
for _, tries in ipairs { 1, 100, 1000000 } do
  guides[#guides + 1] = gaussian { tries = tries }
  guides[#guides + 1] = bridge_test { sigma = 0.6, tries = tries }
end
for _, follow in ipairs { "steps", "tube", "waypoints" } do
  for _, spacing in ipairs { 0, 1e-3 } do
    guides[#guides + 1] = shrink { 0.5, spacing = spacing, follow = follow }
    guides[#guides + 1] = identity { spacing = spacing, follow = follow }
    guides[#guides + 1] = widen { 0.1, spacing = spacing, follow = follow }
    guides[#guides + 1] = lazy { spacing = spacing, follow = follow }
  end
end
for _, event in ipairs { "shortest_path", "constant_depth", "heuristic_progress", "subpath_existence" } do
  guides[#guides + 1] = lazy { event = event, selector = "fail_fast" }
end
for _, planner in ipairs { prm(), lazy_prm(), rrt_star { proposals = 300 }, lazy_prm_star { proposals = 300 } } do
  guides[#guides + 1] = shrink { 0.7, planner = planner, paths = 8, effort = 500 }
  guides[#guides + 1] = shrink { 0.7, planner = planner, keep_tree = true, resolution = 1e-3 }
  guides[#guides + 1] = pca { 2, planner = planner }
end
return kinds({ scenes.cup(), scenes.trap(), scenes.simple_passage() }, guides,
             { rrt(), rrt_connect {}, rrt { step = 0.5 }, rrt_connect { step = 5 }, prm(), lazy_prm(), rrt_star(),
               lazy_prm_star(), lazy_rrg_star(), prm_star() })
)";

const char* const spatial_kinds = R"(
local blocks = world {
  bounds = {0, 0, 0, 10, 10, 10}, box {4, 0, 0, 6, 10, 4.6}, box {4, 0, 5.4, 6, 10, 10}, sphere {2.5, 5, 5, 0.6},
}
local plank = robot.rigid { box {-0.8, -0.5, -0.1, 0.8, 0.5, 0.1} }
local slot = problem {
  name = "slot", world = blocks, robot = plank, start = pose {1, 5, 5, axis = {0, 1, 0}, angle = math.pi / 2},
  goal = pose {9, 5, 5, axis = {1, 0, 0}, angle = math.pi / 2},
}
local small = problem {
  name = "small", world = blocks, robot = robot.rigid { box {-0.2, -0.1, -0.1, 0.2, 0.1, 0.1} }, start = pose {1, 5, 5},
  goal = pose {9, 5, 5}, resolution = 0.005,
}
local guides = {
  skeleton(), skeleton { spacing = 1e-2 }, skeleton { follow = "regions" }, workspace(), workspace { cell = 0.3 },
  decomposition(), decomposition { size = 1 }, lazy(), lazy { sparse = 1e-2 }, drop(), aggregate(), joints { "x", "y", "z" },
  gaussian { tries = 100000 }, bridge_test(0.6), obstacle_based(), medial_axis(), halton(), information_gain(100), widen(0.1),
  shrink(0.5), shrink { 0.7, spacing = 1e-2 }, shrink { 0.7, resolution = 1e-2, paths = 4 }, identity { spacing = 1e-2 },
  pca { 3, samples = 1000000 }, pca { 3, samples = 1000 }, shrink { 0.7, planner = lazy_prm() }, goal_bias(0.5),
}
return kinds({ slot, small }, guides,
             { rrt { step = 1 }, rrt_connect { step = 1 }, rrt_connect { step = 10 }, prm(), lazy_prm(), rrt_star() })
)";

const char* const arms_kinds = R"(
local arm = problem {
  name = "arm", robot = robot.arm { links = {2.4, 2}, width = 0.25, base = {5, 5} },
  world = world { bounds = {0, 0, 10, 10}, box {6.2, 7, 8.2, 8.2}, box {6.8, 2.2, 8, 3.6} },
  start = {1.9, 0.4}, goal = {-0.9, -0.5}, resolution = 0.02,
}
local six = robot.urdf("six.urdf", { srdf = "six.srdf", group = "arm" })
local reach = problem {
  name = "six", robot = six, start = "ready", goal = "aside", resolution = 0.02,
  world = world { bounds = {-2, -2, -2, 2, 2, 2}, contain = "none", sphere {0.5, 0.6, 0.7, 0.15},
                  box {-0.2, 0.7, 0.3, 0.2, 1.0, 0.8} },
}
local guides = {
  shrink(0.5), shrink { 0.5, spacing = 1e-2 }, identity { spacing = 1e-2 }, lazy(), lazy { sparse = 1e-2 }, joints { first = 1 },
  joints { first = 2, slices = 100 }, workspace(), skeleton(), pca { 1, samples = 100000 }, pca { 1, samples = 100 }, drop(),
  aggregate(), gaussian { tries = 100000 }, bridge_test(0.3), obstacle_based(), halton(), goal_bias(0.3), information_gain(50),
  shrink { 0.8, paths = 3 }, widen(0.02),
}
return kinds({ arm, reach }, guides,
             { rrt { step = 0.5 }, rrt_connect { step = 0.5 }, rrt_connect { step = 3 }, prm(), lazy_prm() })
)";

const char* const teams_kinds = R"(
local start, goal = {}, {}
for i = 1, 3 do
  local x, y = 4 * math.cos(i * 2 * math.pi / 3), 4 * math.sin(i * 2 * math.pi / 3)
  start[i], goal[i] = { 5 + x, 5 + y }, { 5 - x, 5 - y }
end
local discs = problem { name = "discs", world = world { bounds = {0, 0, 10, 10}, box {4.6, 4.6, 5.4, 5.4} },
                        robot = robots { robot.disc(0.7), count = 3 }, start = start, goal = goal }
local boxes = problem {
  name = "boxes", world = world { bounds = {0, 0, 0, 6, 6, 6}, box {2, 2, 0, 4, 4, 4} },
  robot = robots { robot.rigid { box {-0.3, -0.15, -0.15, 0.3, 0.15, 0.15} }, count = 2 },
  start = { pose {1, 3, 1}, pose {5, 3, 1} }, goal = { pose {5, 3, 1}, pose {1, 3, 1} },
}
local guides = {
  team { 1 }, team { 1, 2 }, decouple(), decouple { tries = 1 }, prioritise(), couple(), couple { where = "path" }, lazy(),
  prioritise { spacing = 1e-2, follow = "steps" }, shrink(0.5), identity { spacing = 1e-2 }, pca { 2, samples = 100000 }, drop(),
  gaussian { tries = 1000 }, joints { first = 3 }, halton(), goal_bias(0.3),
}
return kinds({ discs, boxes }, guides,
             { rrt_connect { step = 1 }, rrt { step = 1 }, rrt_connect { step = 8 }, drrt(), prm() })
)";

const char* const driven_kinds = R"(
local depot = world { bounds = {0, 0, 8, 6}, box {2.4, 0, 2.8, 4.4}, box {5.0, 1.6, 5.4, 6} }
local cart = problem {
  name = "cart", world = depot, robot = robot.rectangle(0.5, 0.3), start = {1.2, 1, math.pi / 2}, goal = {7, 5, math.pi / 2},
  motion = motion.unicycle1 { min_speed = 0, max_speed = 1, max_angular_speed = 1.5 }, goal_tolerance = 0.4,
}
local sledge = problem {
  name = "sledge", world = depot, robot = robot.rectangle(0.5, 0.3), goal_tolerance = 0.5,
  motion = motion.unicycle2 { max_speed = 1, max_angular_speed = 1.5, max_acceleration = 1, max_angular_acceleration = 3 },
  start = {1.2, 1, math.pi / 2, 0, 0}, goal = {7, 5, math.pi / 2, 0, 0},
}
local pair = problem {
  name = "pair", world = world { bounds = {0, 0, 6, 6} }, robot = robots { robot.rectangle(0.5, 0.3), count = 2 },
  motion = motion.car { wheelbase = 0.3, min_speed = 0, max_speed = 1, max_steering = 0.7 },
  start = { {1, 3, 0}, {5, 3, math.pi} }, goal = { {5, 3, 0}, {1, 3, math.pi} }, goal_tolerance = 0.5,
}
local guides = {
  holonomic(), holonomic { follow = "steps", spacing = 1e-2 }, holonomic { paths = 3 }, blossom(), blossom(10000), decomposition(),
  decomposition { size = 0.3 }, skeleton(), skeleton { follow = "regions" }, workspace(), state_cells(), shrink(0.5), lazy(),
  information_gain(100), pca { 2, samples = 100000 }, goal_bias(0.3), halton(), prioritise(), decouple(), drop(),
}
return kinds({ cart, sledge, pair }, guides,
             { kinodynamic_rrt { longest = 3 }, kinodynamic_rrt { extend = "curves" }, kinodynamic_rrt { controls = 100 } })
)";

std::uint64_t number_of_runs(std::uint64_t usual) {
  const char* set = std::getenv("TRELLIS_RUNS");  // NOLINT(concurrency-mt-unsafe): nothing here sets it
  return set != nullptr ? std::strtoull(set, nullptr, 10) : usual;
}

/// Adds a few paths of the planner alone to a library; none of a problem with a motion model.
void store_paths(const Problem& problem, const PlannerSpec& planner, const std::string& file) {
  if (problem.motion_model) return;
  Library library(file, Library::Mode::write);
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const RunRecord run = execute(planner, problem, seed);
    if (run.solved) static_cast<void>(library.add(stored_path(problem, run.path), problem.space, 0.0));
  }
}

void check_kinds(const std::string& program, std::uint64_t seed) {
  const test::Folder folder;
  static_cast<void>(folder.write("six.urdf", test::six_joints));
  static_cast<void>(folder.write("six.srdf", test::six_joints_srdf));
  dsl::Session session(folder.path().string());
  const dsl::Program kinds = session.load(kinds_head + program, "kinds.lua");
  std::vector<GuideSpec> guides;
  std::vector<PlannerSpec> roots;
  for (const auto& [name, strategy] : kinds.experiment.strategies) {
    if (strategy.guide() != nullptr) {
      guides.push_back(*strategy.guide());
    } else {
      roots.push_back(strategy.planner());
    }
  }
  const std::vector<Problem>& problems = kinds.experiment.problems;
  const std::string paths = folder.file("paths.db");
  for (const Problem& problem : problems) store_paths(problem, roots.front(), paths);
  for (const auto* name : {"experience", "path_database"}) {
    const std::vector<Options::Entry> db = {{"db", paths}};
    if (!problems.front().motion_model) guides.push_back(GuideSpec::make(name, db));
  }
  test::RandomSpecs specs(seed, 2.0, guides, roots);
  const std::uint64_t runs = number_of_runs(20);
  std::uint64_t checked = 0, drawn = 0;
  for (; checked < runs && drawn < 20 * runs; ++drawn) {
    const StrategySpec strategy = specs.strategy(4);
    const Problem& problem = problems[drawn % problems.size()];
    try {
      check(strategy, problem);
      test::check_law(strategy, problem, drawn);
      ++checked;
    } catch (const Error&) {
      // A guide cannot make its space from that of another one.
      continue;
    }
  }
  CHECK(checked == runs);
}

}  // namespace

TEST_CASE("bounded loss holds for random hierarchies", "[dsl][bound]") {
  const std::uint64_t runs = number_of_runs(60);
  const dsl::Program program = dsl::Session("").load(guides, "guides.lua");
  std::vector<GuideSpec> others;
  for (const auto& [name, strategy] : program.experiment.strategies) others.push_back(*strategy.guide());
  test::RandomSpecs specs(7, 2.0, others);
  const std::vector<Problem> problems = {test::simple_passage_problem(), test::trap_problem(), test::cup_problem()};
  std::uint64_t refused = 0;
  for (std::uint64_t i = 0; i < runs; ++i) {
    const StrategySpec strategy = specs.strategy(4);
    const Problem& problem = problems[i % problems.size()];
    try {
      check(strategy, problem);
    } catch (const Error&) {
      // Some guides cannot make their space from that of another one, as two dimensions of two.
      ++refused;
      continue;
    }
    test::check_law(strategy, problem, i);
  }
  CHECK(10 * refused < runs);
}

TEST_CASE("bounded loss holds in the plane with options at their limits", "[dsl][bound]") {
  check_kinds(planar_kinds, 1);
}

TEST_CASE("bounded loss holds in space", "[dsl][bound]") { check_kinds(spatial_kinds, 2); }

TEST_CASE("bounded loss holds for arms", "[dsl][bound]") { check_kinds(arms_kinds, 3); }

TEST_CASE("bounded loss holds for teams", "[dsl][bound]") { check_kinds(teams_kinds, 4); }

TEST_CASE("bounded loss holds for kinodynamic planners", "[dsl][bound]") { check_kinds(driven_kinds, 5); }
