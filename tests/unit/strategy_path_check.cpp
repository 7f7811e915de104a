// SPDX-License-Identifier: GPL-3.0-or-later
// A path is certified before it is reported; one that is refuted is not reported, and the search continues.
#include <algorithm>
#include <string>
#include <vector>

#include <trellis/instance/path_fault.hpp>
#include <trellis/strategy/executor.hpp>

#include "support/catch.hpp"
#include "support/guides.hpp"
#include "support/worlds.hpp"

using namespace trellis;

namespace {

/// Thin walls that a motion steps over where it is checked at a coarse resolution only.
Problem thin_walls(double robot = 0.2) {
  test::Rectangles walls;
  for (int i = 0; i < 4; ++i) {
    const double x = 2.0 + 2.0 * i;
    if (i % 2 == 0) {
      walls.push_back({x, 0, x + 0.06, 6});
    } else {
      walls.push_back({x, 4, x + 0.06, 10});
    }
  }
  auto problem = test::make_problem("thin walls", test::rectangle_world(walls),
                                    test::rectangle_robot(robot, 0.5 * robot), {1, 1, 0}, {9.4, 9, 0});
  problem.resolution = 0.3;
  return problem;
}

std::uint64_t refuted(const StrategySpec& strategy, const Problem& problem, int seeds) {
  std::uint64_t all = 0;
  for (int seed = 1; seed <= seeds; ++seed) {
    const RunRecord run = execute(strategy, problem, static_cast<std::uint64_t>(seed));
    INFO("seed " << seed);
    all += run.refuted_paths;
    CHECK(run.solved);
    if (!run.solved) {
      CHECK(run.path.empty());
      continue;
    }
    CHECK(path_fault(problem, run.path).empty());
    CHECK(run.path_checks > 0);
    CHECK(run.certified);
    CHECK(run.clearance > 0.0);
  }
  return all;
}

}  // namespace

TEST_CASE("no planner reports a path that its certificate refutes", "[executor][path_check][slow]") {
  const Problem problem = thin_walls();
  for (const PlannerKind& kind : planner_kinds()) {
    const std::string& name = kind.component->name;
    if (kind.graph || kind.kinodynamic) continue;
    INFO(name);
    CHECK(refuted(PlannerSpec::make(name, {{"proposals", 20000.0}}), problem, 3) > 0);
  }
}

TEST_CASE("a guided search continues where its path was refuted", "[executor][path_check]") {
  Problem problem = test::trap_problem();
  problem.resolution = 0.4;
  std::uint64_t all = 0;
  const auto rrt = [] { return PlannerSpec::make("rrt", {{"proposals", 50000.0}}); };
  for (const GuideKind& kind : test::guides_of_one_robot()) {
    if (kind.default_planner.empty()) continue;
    INFO(kind.component->name);
    all += refuted(GuideSpec::make(kind.component->name, {}) >> rrt(), problem, 2);
  }
  CHECK(all > 0);
}

TEST_CASE("a space that shares motions with the root certifies them, too, once the root does",
          "[executor][path_check]") {
  Problem problem = test::trap_problem();
  problem.resolution = 0.8;
  const auto planner = [] { return PlannerSpec::make("rrt_connect", {{"bound", 0.0}, {"proposals", 20000.0}}); };
  const auto shrink = [] { return GuideSpec::make("shrink", {{"scale", 0.9}}); };
  const std::vector<StrategySpec> strategies = {shrink() >> planner(),
                                                GuideSpec::make("skeleton", {}) >> shrink() >> planner(),
                                                shrink() >> shrink() >> planner(),
                                                shrink() >> GuideSpec::make("lazy", {}) >> planner(),
                                                GuideSpec::make("lazy", {}) >> shrink() >> planner(),
                                                GuideSpec::make("identity", {}) >> planner()};
  std::uint64_t most = 0;
  for (const StrategySpec& strategy : strategies) {
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
      const RunRecord run = execute(strategy, problem, seed);
      INFO(strategy.text() << ", seed " << seed);
      // The fifth refutation makes the root certify its motions: then only what lies within the tolerance differs.
      CHECK(run.refuted_paths <= 5);
      most = std::max(most, run.refuted_paths);
      CHECK(run.solved);
    }
  }
  CHECK(most == 5);
}

TEST_CASE("a path that is refuted when all proposals are spent leaves the next best one", "[executor][path_check]") {
  Problem problem = test::cup_problem();
  problem.resolution = 0.15;
  for (const char* name : {"rrt_star", "prm_star", "lazy_prm_star", "lazy_rrg_star"}) {
    INFO(name);
    CHECK(refuted(PlannerSpec::make(name, {{"proposals", 3000.0}, {"improve", 3000.0}}), problem, 4) > 0);
  }
}

TEST_CASE("RRT* finds another path in its tree where its path is refuted after the last proposal",
          "[executor][path_check]") {
  Problem problem = test::cup_problem();
  problem.resolution = 0.15;
  // Of the first 200 seeds, those whose goal is beyond more than one node that lost its parent.
  for (const std::uint64_t seed : {81, 114, 167, 186}) {
    CAPTURE(seed);
    const RunRecord run = execute(
        PlannerSpec::make("rrt_star", {{"proposals", 3000.0}, {"improve", 3000.0}, {"factor", 1.1}}), problem, seed);
    CHECK(run.refuted_paths > 0);
    CHECK(run.levels.front().search.proposals.size() == 3000);
    REQUIRE(run.solved);
    CHECK(path_fault(problem, run.path).empty());
  }
}

TEST_CASE("a driven path is certified, too", "[executor][path_check][kinodynamic]") {
  // A step of 0.1 m from one side of a wall to the other.
  const Problem problem = test::driven(thin_walls(0.02));
  CHECK(refuted(PlannerSpec::make("kinodynamic_rrt", {{"extend", "controls"}}), problem, 3) > 0);
}

TEST_CASE("shortcutting keeps to certified motions", "[executor][path_check]") {
  const Problem problem = thin_walls();
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    const RunRecord run =
        execute(PlannerSpec::make("rrt_connect", {{"proposals", 20000.0}}), problem, seed, {.shortcut = 100});
    REQUIRE(run.solved);
    CHECK(path_fault(problem, run.path).empty());
  }
}

TEST_CASE("what a certificate spends is not in the costs of planning", "[executor][path_check]") {
  const Problem problem = test::simple_passage_problem();
  const RunRecord run = execute(PlannerSpec::make("rrt_connect", {}), problem, 1);
  REQUIRE(run.solved);
  std::uint64_t levels = 0;
  for (const LevelRecord& level : run.levels) levels += level.search.checks.validity;
  CHECK(run.validity_checks == levels);
  CHECK(run.path_checks > 0);
}
