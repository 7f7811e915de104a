// SPDX-License-Identifier: GPL-3.0-or-later
// Classes of problems, each with the guides of the catalogue and planners that suit it, options at their limits among
// them. RandomSpecs draws hierarchies of these.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include <dsl/language/tools/session.hpp>
#include <trellis/memory/library.hpp>
#include <trellis/memory/model.hpp>
#include <trellis/strategy/executor.hpp>

#include "support/families.hpp"
#include "support/folder.hpp"
#include "support/learning_tasks.hpp"
#include "support/manipulators.hpp"

namespace trellis::test {

/// Programs whose strategies name guides and planners; strategies and problems are drawn from these. `more`: a list of
/// further problems.
inline const char* const kinds_head = R"(
local function kinds(problems, guides, roots)
  table.move(more, 1, #more, #problems + 1, problems)
  local strategies = {}
  for i, root in ipairs(roots) do strategies[i] = { "root " .. i, root } end
  for i, guide in ipairs(guides) do strategies[#roots + i] = { "guide " .. i, guide >> roots[1] } end
  return experiment { problems = problems, strategies = strategies, seeds = 1, measure = false }
end
)";

inline const char* const planar_kinds = R"(
local guides = {
  skeleton(), workspace(), workspace { cell = 0.05 }, decomposition(), decomposition { size = 0.2 }, lazy { sparse = 1e-3 },
  skeleton { spacing = 1e-3 }, skeleton { follow = "regions" }, drop(), drop { spacing = 1e-3 }, aggregate(), joints { "x", "y" },
  joints { first = 1, slices = 1000 }, information_gain(1000), state_cells(), state_cells(0.01), uniform(), halton(),
  informed { cost = 15 }, goal_bias(0.5), learned("gaps.model"), learned { "gaps.model", sharpness = 8 }, medial_axis(), medial_axis { rays = 1000, climbs = 1000 }, obstacle_based(),
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

inline const char* const spatial_kinds = R"(
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

inline const char* const arms_kinds = R"(
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

inline const char* const teams_kinds = R"(
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

inline const char* const driven_kinds = R"(
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
  information_gain(100), pca { 2, samples = 100000 }, goal_bias(0.3), learned("gaps.model"), halton(), prioritise(),
  decouple(), drop(),
}
return kinds({ cart, sledge, pair }, guides,
             { kinodynamic_rrt { longest = 3 }, kinodynamic_rrt { extend = "curves" }, kinodynamic_rrt { controls = 100 } })
)";

/// A class of problems, as loaded from its program.
struct Kinds {
  std::vector<GuideSpec> guides;
  std::vector<PlannerSpec> roots;
  std::vector<Problem> problems;
};

/// A small model of worlds that are none of these problems, as a file has it.
inline const std::string& gaps_model() {
  static const std::string bytes = [] {
    TrainingSettings settings;
    settings.cells = 30;
    settings.samples = 200;
    settings.forest.trees = 5;
    return Model::train(family(upper_gaps, 1, 4), settings, "upper gaps").bytes();
  }();
  return bytes;
}

/// The paths that guides of experience retrieve.
inline std::string paths_of(const Folder& folder) { return folder.file("paths.db"); }

/// \param folder  gets the files of robots and a model, and has the paths that guides of experience retrieve
/// (store_paths) \param more  further problems: a list in Lua
inline Kinds load_kinds(const std::string& program, const Folder& folder, const std::string& more = "{}") {
  static_cast<void>(folder.write("six.urdf", six_joints));
  static_cast<void>(folder.write("six.srdf", six_joints_srdf));
  static_cast<void>(folder.write("gaps.model", gaps_model()));
  dsl::Session session(folder.path().string());
  const dsl::Program loaded = session.load("local more = " + more + kinds_head + program, "kinds.lua");
  Kinds kinds;
  for (const auto& [name, strategy] : loaded.experiment.strategies) {
    if (strategy.guide() != nullptr) {
      kinds.guides.push_back(*strategy.guide());
    } else {
      kinds.roots.push_back(strategy.planner());
    }
  }
  kinds.problems = loaded.experiment.problems;
  const std::vector<Options::Entry> db = {{"db", paths_of(folder)}};
  for (const auto* name : {"experience", "path_database"}) {
    if (!kinds.problems.front().motion_model) kinds.guides.push_back(GuideSpec::make(name, db));
  }
  return kinds;
}

/// Adds a few paths of the planner alone to a library; none of a problem with a motion model.
inline void store_paths(const Kinds& kinds, const std::string& file) {
  for (const Problem& problem : kinds.problems) {
    if (problem.motion_model) continue;
    Library library(file, Library::Mode::write);
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
      const RunRecord run = execute(kinds.roots.front(), problem, seed);
      if (run.solved) static_cast<void>(library.add(stored_path(problem, run.path), problem.space, 0.0));
    }
  }
}

}  // namespace trellis::test
