// SPDX-License-Identifier: GPL-3.0-or-later
// The skeleton of worlds of space as a guide: it leads through passages, of real scenes too, and nests.
#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <trellis/collision/checker.hpp>
#include <trellis/guide/guide.hpp>
#include <trellis/reader/readers.hpp>
#include <trellis/scene/spatial/scene.hpp>
#include <trellis/strategy/executor.hpp>

#include "support/catch.hpp"
#include "support/scenes.hpp"

using namespace trellis;

namespace {

/// A ball of 0.2 m among blocks in the air, without rotation.
Problem floating(bool rotates) {
  std::vector<Obstacle3> blocks;
  for (int i = 0; i < 27; ++i) {
    const Vec3 centre{2.0 + 3.0 * (i % 3), 2.0 + 3.0 * (i / 3 % 3), 2.0 + 3.0 * (i / 9)};
    blocks.push_back({"block", {Cuboid{{1.8, 1.8, 1.8}}, {centre, {}}}});
  }
  Problem problem;
  problem.name = "floating";
  problem.scene = std::make_shared<const SpatialScene>(World3({{0, 0, 0}, {10, 10, 10}}, std::move(blocks)),
                                                       Robot3("rod", {{Cuboid{{1.4, 0.3, 0.3}}, {}}}, rotates));
  problem.space = problem.scene->default_space(0.7);
  problem.start = {0.8, 0.5, 0.5};
  problem.goals = {{9.1, 9.5, 9.5}};
  if (rotates) {
    for (Configuration* q : {&problem.start, &problem.goals.front()}) q->insert(q->end(), {0, 0, 0, 1});
  }
  problem.collision = "fcl";
  return problem;
}

/// The path of graph search on the skeleton alone, for a guide's options.
Solution searched(const Problem& problem, const std::vector<Options::Entry>& options) {
  const auto parent = make_instance(problem);
  const GuideKind& kind = *find_guide("skeleton");
  const auto guide = kind.make(Options::validate(*kind.component, options));
  const auto sub = guide->project(*parent);
  const PlannerKind& planner = *find_planner("graph_search");
  const Options none = Options::validate(*planner.component, {});
  UniformGuidance uniform(sub->space);
  Search search(3);
  Solution found = planner.make(none, {*sub, uniform, Stream(1, "0/0", "proposals"), search, false})
                       ->solve(uniform, planner.common(none).budget);
  for (std::size_t i = 1; i < found.path.size(); ++i) CHECK(sub->motion(found.path[i - 1], found.path[i]).valid);
  return found;
}

void check_plans(const Problem& problem, const StrategySpec& strategy) {
  const RunRecord run = execute(strategy, problem, 1);
  const RunRecord again = execute(strategy, problem, 1);
  REQUIRE(!run.path.empty());
  const auto fine = make_checker("fcl_plain", problem.scene, problem.space, 0.25 * problem.resolution);
  for (std::size_t i = 1; i < run.path.size(); ++i) CHECK(fine->motion(run.path[i - 1], run.path[i]).valid);
  CHECK(std::equal(run.path.values().begin(), run.path.values().end(), again.path.values().begin(),
                   again.path.values().end()));
}

}  // namespace

TEST_CASE("the skeleton leads through a lattice of floating blocks", "[strategy][space][skeleton]") {
  for (const bool rotates : {false, true}) {
    const Problem problem = floating(rotates);
    CHECK(searched(problem, {}).solved());
    // Corridors are 1.2 m wide.
    CHECK_FALSE(searched(problem, {{"clearance", 0.9}}).solved());
  }
}

TEST_CASE("the skeleton guides a body in space, by paths and by regions, alone and nested",
          "[strategy][space][skeleton]") {
  const Problem problem = floating(true);
  const auto connect = PlannerSpec::make("rrt_connect", {{"step", 1.0}, {"proposals", 20000.0}});
  const auto tree = PlannerSpec::make("rrt", {{"step", 1.0}, {"proposals", 20000.0}});
  const auto skeleton = GuideSpec::make("skeleton", {});
  check_plans(problem, skeleton >> connect);
  check_plans(problem, GuideSpec::make("skeleton", {{"follow", std::string("regions")}}) >> tree);
  check_plans(problem, skeleton >> GuideSpec::make("shrink", {{"scale", 0.5}}) >> connect);
  check_plans(problem, skeleton >> GuideSpec::make("lazy", {}) >> connect);
  check_plans(problem, skeleton >> GuideSpec::make("shrink", {{"scale", 0.5}}) >> GuideSpec::make("lazy", {}) >> tree);
}

TEST_CASE("the skeleton leads through the passages of the hook and of the box in the maze",
          "[strategy][space][skeleton]") {
  const auto maze = test::scene("rl/rlplan/box-6d-300505_maze_rrtConCon.mdl.sixDof.xml");
  if (!maze.empty()) {
    CHECK(searched(read_scene(maze.string(), {}).problems.at(0), {}).solved());
    CHECK(searched(read_scene(maze.string(), {}).problems.at(0), {{"prune", false}}).solved());
  }
  const auto hook = test::scene("open_ppl/hook/hook.env");
  if (!hook.empty()) CHECK(searched(read_scene(hook.string(), {}).problems.at(0), {}).solved());
}
