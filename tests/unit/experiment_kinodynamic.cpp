// SPDX-License-Identifier: GPL-3.0-or-later
// Kinodynamic robots: the record of their paths, and the planners that are rejected.
#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include <trellis/base/error.hpp>
#include <trellis/strategy/executor.hpp>

#include "support/catch.hpp"
#include "support/worlds.hpp"

using namespace trellis;
using Catch::Matchers::Contains;

namespace {

/// The guides of a list, the first one outermost, above a kinodynamic RRT.
StrategySpec strategy(const std::vector<GuideSpec>& guides, const std::string& extend = "controls") {
  const PlannerSpec planner = PlannerSpec::make("kinodynamic_rrt", {{"extend", extend}});
  if (guides.empty()) return StrategySpec(planner);
  GuideSpec all = guides.front();
  for (std::size_t i = 1; i < guides.size(); ++i) all = all >> guides[i];
  return all >> planner;
}

}  // namespace

TEST_CASE("a driven path is recorded as its controls, which give its states to the bit", "[kinodynamic]") {
  for (const std::string model : {"unicycle1", "unicycle2", "car"}) {
    const Problem problem = test::driven(test::cup_problem(), model);
    for (const auto& [guided, extend] :
         {std::pair(false, "controls"), std::pair(true, "controls"), std::pair(false, "curves")}) {
      CAPTURE(model, guided, extend);
      const auto spec = guided ? strategy({GuideSpec::make("skeleton", {}), GuideSpec::make("holonomic", {})}, extend)
                               : strategy({}, extend);
      const auto run = execute(spec, problem, 3, {.shortcut = 100});
      REQUIRE(run.solved);
      const auto states = replay(*problem.motion_model, problem.space, problem.start, run.trajectory);
      REQUIRE(states.size() == run.path.size());
      CHECK(std::equal(states.values().begin(), states.values().end(), run.path.values().begin()));
      CHECK(run.trajectory.duration() == Approx(0.1 * static_cast<double>(states.size() - 1)));
      CHECK(run.shortcut_checks == 0);
      CHECK(problem.space.distance(run.path.back(), problem.goal()) <= problem.goal_tolerance);
      auto instance = make_instance(problem);
      for (std::size_t i = 0; i < states.size(); ++i) CHECK(instance->valid(states[i]));
      for (std::size_t i = 1; i < states.size(); ++i) CHECK(instance->motion(states[i - 1], states[i]).valid);
      const auto again = execute(spec, problem, 3);
      CHECK(std::equal(run.path.values().begin(), run.path.values().end(), again.path.values().begin(),
                       again.path.values().end()));
    }
  }
}

TEST_CASE("a default planner that becomes kinodynamic keeps the options that its guide sets", "[kinodynamic]") {
  const Problem driven = test::driven(test::simple_passage_problem());
  const auto goals = [&](const std::vector<GuideSpec>& guides) {
    const RunRecord run = execute(strategy(guides), driven, 1, {.companion = false});
    const LevelRecord& level = run.levels.at(1);
    CHECK(level.planner == "kinodynamic_rrt");
    CHECK(level.search.proposals.size() > 50);
    return std::count(level.search.proposal_sources.begin(), level.search.proposal_sources.end(), 0);
  };
  // lazy asks for a search without a goal bias where a guide stands below it; shrink asks for nothing.
  CHECK(goals({GuideSpec::make("holonomic", {}), GuideSpec::make("lazy", {})}) == 0);
  CHECK(goals({GuideSpec::make("holonomic", {}), GuideSpec::make("shrink", {})}) > 0);
}

TEST_CASE("a motion of too many integration steps is refused", "[kinodynamic]") {
  Problem problem = test::driven(test::cup_problem());
  problem.motion_model =
      find_motion("unicycle1")->make(Options::validate(*find_motion("unicycle1")->component, {{"dt", 1e-12}}));
  CHECK_THROWS_WITH(execute(strategy({}), problem, 1),
                    Contains("longest = ") && Contains("dt = 1e-12 s") && Contains("increase dt"));
}

TEST_CASE("a planner that cannot respect the motion model is refused, and one that drives where there is none",
          "[kinodynamic]") {
  const Problem driven = test::driven(test::cup_problem());
  const StrategySpec straight(PlannerSpec::make("rrt", {}));
  for (const bool running : {false, true}) {
    const auto refused = [&] { running ? static_cast<void>(execute(straight, driven, 1)) : check(straight, driven); };
    CHECK_THROWS_WITH(refused(), Contains("rrt joins configurations by straight motions") &&
                                     Contains("motion model unicycle1") && Contains("kinodynamic_rrt") &&
                                     Contains("holonomic()") && Contains("level 0"));
  }
  CHECK_THROWS_WITH(check(strategy({}), test::cup_problem()),
                    Contains("kinodynamic_rrt drives a motion model") && Contains("motion.unicycle1"));
  // shrink's level has the motion model: its default planner is kinodynamic, and another planner is an error.
  CHECK_NOTHROW(check(strategy({GuideSpec::make("shrink", {})}), driven));
  CHECK_THROWS_WITH(check(strategy({GuideSpec::make("shrink", {}, PlannerSpec::make("rrt", {}))}), driven),
                    Contains("level 1") && Contains("rrt joins configurations by straight motions"));
  GuideSpec driving = GuideSpec::make("shrink", {}, PlannerSpec::make("kinodynamic_rrt", {}));
  CHECK_NOTHROW(check(strategy({driving}), driven));
  CHECK_NOTHROW(check(strategy({GuideSpec::make("shrink", {}), GuideSpec::make("holonomic", {})}), driven));
  CHECK_NOTHROW(check(strategy({GuideSpec::make("lazy", {}), GuideSpec::make("holonomic", {})}), driven));
  // holonomic's own search is one of straight motions.
  CHECK_THROWS_WITH(
      check(strategy({GuideSpec::make("holonomic", {}, PlannerSpec::make("kinodynamic_rrt", {}))}), driven),
      Contains("level 1") && Contains("kinodynamic_rrt drives a motion model"));
}
