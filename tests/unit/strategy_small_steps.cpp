// SPDX-License-Identifier: GPL-3.0-or-later
// One step of the guided search is small: with options at their limits, and with single motions that cost many checks.
#include <cstdint>
#include <string>
#include <vector>

#include <trellis/guide/guide.hpp>
#include <trellis/strategy/executor.hpp>

#include "support/bounded_loss.hpp"
#include "support/catch.hpp"
#include "support/worlds.hpp"

using namespace trellis;

namespace {

/// Guides whose options make one call of f or of h cost many checks or much work.
std::vector<GuideSpec> heavy_guides() {
  const GuideSpec skeleton = GuideSpec::make("skeleton", {});
  return {
      GuideSpec::make("pca", {{"dimensions", std::int64_t{2}}, {"samples", std::int64_t{1000000}}}),
      GuideSpec::make("pca", {{"dimensions", std::int64_t{2}}, {"samples", std::int64_t{5000}}}),
      GuideSpec::make("shrink", {{"scale", 0.5}, {"spacing", 1e-3}}),
      GuideSpec::make("shrink", {{"scale", 0.5}, {"resolution", 1e-3}}),
      GuideSpec::make("shrink", {{"scale", 0.9}, {"paths", std::int64_t{4}}}),
      GuideSpec::make("identity", {{"spacing", 1e-3}}),
      GuideSpec::make("widen", {{"spacing", 1e-3}}),
      GuideSpec::make("skeleton", {{"spacing", 1e-3}}),
      GuideSpec::make("workspace", {{"cell", 0.03}}),
      GuideSpec::make("decomposition", {{"size", 0.1}}),
      GuideSpec::make("lazy", {{"sparse", 1e-3}}),
      GuideSpec::make("lazy", {}),
      skeleton >> GuideSpec::make("lazy", {}),
      skeleton >> GuideSpec::make("shrink", {{"spacing", 1e-3}}) >> GuideSpec::make("lazy", {{"sparse", 1e-3}}),
      GuideSpec::make("drop", {}),
      skeleton >> GuideSpec::make("drop", {}),
      GuideSpec::make("gaussian", {{"tries", std::int64_t{100000}}}),
      GuideSpec::make("gaussian", {{"tries", std::int64_t{100000}}}) >> GuideSpec::make("lazy", {}),
      GuideSpec::make("bridge_test", {{"tries", std::int64_t{100000}}}),
      GuideSpec::make("obstacle_based", {}),
      GuideSpec::make("medial_axis", {}),
  };
}

/// The problem with motions that cost many checks.
Problem fine(Problem problem) {
  problem.name += ", fine";
  problem.resolution = 2e-3;
  return problem;
}

}  // namespace

TEST_CASE("a step is small, whatever the options of a guide", "[strategy][bound]") {
  for (const Problem& problem : {test::cup_problem(), fine(test::cup_problem())}) {
    for (const PlannerSpec& planner :
         {PlannerSpec::make("rrt_connect", {{"step", 2.0}}), PlannerSpec::make("prm", {})}) {
      for (const GuideSpec& guide : heavy_guides()) {
        for (std::uint64_t seed = 1; seed <= 2; ++seed) {
          test::check_law(guide >> planner, problem, seed);
        }
      }
    }
  }
}

TEST_CASE("a run that ends within a step has the costs of that step", "[strategy][bound]") {
  // A set-up that costs more than the whole run of the planner alone.
  const GuideSpec pca = GuideSpec::make("pca", {{"dimensions", std::int64_t{2}}, {"samples", std::int64_t{1000000}}});
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    CAPTURE(seed);
    const RunRecord run = execute(pca >> PlannerSpec::make("rrt_connect", {}), test::cup_problem(), seed);
    CHECK(run.solved);
    CHECK(run.bounded.unguided_won);
    CHECK_FALSE(run.bounded.guides_set_up);
    // Its levels are not part of the record, and their checks are those of the root.
    REQUIRE(run.levels.size() == 1);
    CHECK(run.bounded.guided.checks > 0.0);
    CHECK(static_cast<double>(run.levels.front().search.checks.validity) ==
          run.bounded.guided.checks + run.bounded.unguided.checks);
  }
}

TEST_CASE("work grows where a roadmap begins anew with another start", "[strategy][bound]") {
  const GuideSpec pca = GuideSpec::make("pca", {{"dimensions", std::int64_t{2}}, {"follow", std::string("waypoints")}},
                                        PlannerSpec::make("prm", {{"proposals", std::int64_t{1000}}}));
  const PlannerSpec root = PlannerSpec::make("lazy_rrg_star", {{"proposals", std::int64_t{800}}, {"bound", 10.0}});
  const StrategySpec strategy = pca >> GuideSpec::make("drop", {}) >> root;
  for (std::uint64_t seed = 1; seed <= 3; ++seed) test::check_law(split(strategy, {}), test::trap_problem(), seed);
}

TEST_CASE("what lazy lost reaches its guide, so that another path is found", "[strategy][routes]") {
  const Problem problem = test::make_problem("block", test::rectangle_world({{3.5, 3, 6.5, 7}}),
                                             test::rectangle_robot(), {1, 5, 0}, {9, 5, 0});
  const PlannerSpec root = PlannerSpec::make("rrt", {{"step", 0.5}, {"bound", 0.0}, {"uniform", 0.0}});
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    CAPTURE(seed);
    CHECK(execute(GuideSpec::make("identity", {}) >> GuideSpec::make("lazy", {}) >> root, problem, seed).solved);
  }
}
