// SPDX-License-Identifier: GPL-3.0-or-later
// Bounded loss for random hierarchies of all guides of the catalogue and of guides in Lua that mislead.
#include <cstdint>
#include <cstdlib>
#include <string>
#include <vector>

#include <dsl/language/tools/session.hpp>
#include <trellis/base/error.hpp>
#include <trellis/strategy/executor.hpp>

#include "support/bounded_loss.hpp"
#include "support/catch.hpp"
#include "support/folder.hpp"
#include "support/kinds.hpp"
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

std::uint64_t number_of_runs(std::uint64_t usual) {
  const char* set = std::getenv("TRELLIS_RUNS");  // NOLINT(concurrency-mt-unsafe): nothing here sets it
  return set != nullptr ? std::strtoull(set, nullptr, 10) : usual;
}

void check_kinds(const std::string& program, std::uint64_t seed) {
  const test::Folder folder;
  const test::Kinds kinds = test::load_kinds(program, folder);
  test::store_paths(kinds, test::paths_of(folder));
  test::RandomSpecs specs(seed, 2.0, kinds.guides, kinds.roots);
  const std::uint64_t runs = number_of_runs(20);
  std::uint64_t checked = 0, drawn = 0;
  for (; checked < runs && drawn < 20 * runs; ++drawn) {
    const StrategySpec strategy = specs.strategy(4);
    const Problem& problem = kinds.problems[drawn % kinds.problems.size()];
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
  check_kinds(test::planar_kinds, 1);
}

TEST_CASE("bounded loss holds in space", "[dsl][bound]") { check_kinds(test::spatial_kinds, 2); }

TEST_CASE("bounded loss holds for arms", "[dsl][bound]") { check_kinds(test::arms_kinds, 3); }

TEST_CASE("bounded loss holds for teams", "[dsl][bound]") { check_kinds(test::teams_kinds, 4); }

TEST_CASE("bounded loss holds for kinodynamic planners", "[dsl][bound]") { check_kinds(test::driven_kinds, 5); }
