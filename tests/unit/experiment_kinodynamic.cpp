// SPDX-License-Identifier: GPL-3.0-or-later
// What guides are worth for a robot that is driven: where they help and where they mislead, over 30 seeds.
#include <cmath>
#include <string>
#include <vector>

#include <trellis/base/error.hpp>
#include <trellis/measure/statistics.hpp>
#include <trellis/strategy/executor.hpp>

#include "support/catch.hpp"
#include "support/worlds.hpp"

using namespace trellis;
using Catch::Matchers::Contains;

namespace {

constexpr std::uint64_t seeds = 30;

/// The guides of a list, the first one outermost, above a kinodynamic RRT.
StrategySpec strategy(const std::vector<GuideSpec>& guides, const std::vector<Options::Entry>& options = {}) {
  const PlannerSpec planner = PlannerSpec::make("kinodynamic_rrt", options);
  if (guides.empty()) return StrategySpec(planner);
  GuideSpec all = guides.front();
  for (std::size_t i = 1; i < guides.size(); ++i) all = all >> guides[i];
  return all >> planner;
}

/// A car that only goes forwards is to turn about where it stands: it has to drive far off any straight way there.
Problem turn_about() {
  Problem problem = test::make_problem("turn about", World(Box2{{0, 0}, {10, 10}}, {}), test::rectangle_robot(0.5, 0.3),
                                       {2, 5, 0}, {2, 5, 3.1});
  const MotionKind& car = *find_motion("car");
  problem.motion_model = car.make(Options::validate(
      *car.component, {{"min_speed", 0.5}, {"max_speed", 1.0}, {"max_steering", 0.3}, {"wheelbase", 0.5}}));
  problem.goal_tolerance = 0.6;
  return problem;
}

/// The logarithms of the validity checks of 30 runs; a run without success has spent its whole budget at least.
std::vector<double> log_checks(const StrategySpec& strategy, const Problem& problem) {
  std::vector<double> logs;
  for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
    logs.push_back(std::log(static_cast<double>(execute(strategy, problem, seed).validity_checks)));
  }
  return logs;
}

/// The logarithm of how many times the checks of `a` the strategy `b` spends: mean and its interval.
Interval times(const StrategySpec& a, const StrategySpec& b, const Problem& problem) {
  return paired(log_checks(a, problem), log_checks(b, problem), 0.99).difference;
}

}  // namespace

SCENARIO("a path of the robot without its motion model guides the one with it", "[kinodynamic][holonomic]") {
  GIVEN("a wall like a cup between start and goal, and a car that turns in a radius") {
    const auto problem = test::driven(test::cup_problem(), "car");
    THEN("holonomic spends fewer validity checks than the unguided planner") {
      const Interval ratio = times(strategy({}), strategy({GuideSpec::make("holonomic", {})}), problem);
      CAPTURE(std::exp(ratio.value), std::exp(ratio.lo), std::exp(ratio.hi));
      CHECK(ratio.hi < 0.0);
    }
  }
}

SCENARIO("a lead of triangles brings what has momentum through a passage", "[kinodynamic][decomposition]") {
  GIVEN("a narrow corridor, and a unicycle whose speeds are part of its state") {
    const auto problem = test::driven(test::simple_passage_problem(), "unicycle2");
    const std::vector<Options::Entry> budget = {{"proposals", 20000.0}};
    THEN("decomposition spends fewer validity checks than the unguided planner") {
      const Interval ratio =
          times(strategy({}, budget), strategy({GuideSpec::make("decomposition", {})}, budget), problem);
      CAPTURE(std::exp(ratio.value), std::exp(ratio.lo), std::exp(ratio.hi));
      CHECK(ratio.hi < 0.0);
    }
  }
}

SCENARIO("where the way that can be driven leads elsewhere, what forgets the motion model misleads",
         "[kinodynamic][holonomic]") {
  GIVEN("a car that only goes forwards and is to turn about where it stands") {
    const auto problem = turn_about();
    const std::vector<Options::Entry> plain = {{"connect", 0.0}};
    THEN("holonomic spends more validity checks than the unguided planner") {
      const Interval ratio = times(strategy({}, plain), strategy({GuideSpec::make("holonomic", {})}, plain), problem);
      CAPTURE(std::exp(ratio.value), std::exp(ratio.lo), std::exp(ratio.hi));
      CHECK(ratio.lo > 0.0);
    }
    THEN("so does a lead of triangles") {
      const Interval ratio =
          times(strategy({}, plain), strategy({GuideSpec::make("decomposition", {})}, plain), problem);
      CAPTURE(std::exp(ratio.value), std::exp(ratio.lo), std::exp(ratio.hi));
      CHECK(ratio.lo > 0.0);
    }
  }
}

TEST_CASE("a driven path is recorded as its controls, which give its states to the bit", "[kinodynamic]") {
  for (const std::string model : {"unicycle1", "unicycle2", "car"}) {
    const Problem problem = test::driven(test::cup_problem(), model);
    for (const bool guided : {false, true}) {
      CAPTURE(model, guided);
      const auto spec =
          guided ? strategy({GuideSpec::make("skeleton", {}), GuideSpec::make("holonomic", {})}) : strategy({});
      const auto run = execute(spec, problem, 3, {.shortcut = 100});
      REQUIRE(run.solved);
      const auto states = replay(*problem.motion_model, problem.space, problem.start, run.trajectory);
      REQUIRE(states.size() == run.path.size());
      CHECK(std::equal(states.values().begin(), states.values().end(), run.path.values().begin()));
      CHECK(run.trajectory.duration() == Approx((states.size() - 1) * 0.1));
      CHECK(run.shortcut_checks == 0);
      CHECK(problem.space.distance(run.path.back(), problem.goal) <= problem.goal_tolerance);
      auto instance = make_instance(problem);
      for (std::size_t i = 0; i < states.size(); ++i) CHECK(instance->valid(states[i]));
      for (std::size_t i = 1; i < states.size(); ++i) CHECK(instance->motion(states[i - 1], states[i]).valid);
      const auto again = execute(spec, problem, 3);
      CHECK(std::equal(run.path.values().begin(), run.path.values().end(), again.path.values().begin(),
                       again.path.values().end()));
    }
  }
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
  // The level that shrink makes keeps the motion model, and says who searches it.
  CHECK_THROWS_WITH(check(strategy({GuideSpec::make("shrink", {})}), driven),
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
