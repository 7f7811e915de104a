// SPDX-License-Identifier: GPL-3.0-or-later
// Problems with several goals, each of which solves them.
#include <algorithm>
#include <string>
#include <vector>

#include <trellis/base/error.hpp>
#include <trellis/planner/planner.hpp>
#include <trellis/strategy/executor.hpp>

#include "support/catch.hpp"
#include "support/guides.hpp"
#include "support/worlds.hpp"

using namespace trellis;
using Catch::Matchers::Contains;

namespace {

void add_goal(Problem& problem, const Configuration& q) { problem.goals.push_back(q); }

/// The first goal is shut in by four walls; the second lies in the open, the third behind it.
Problem shut_in() {
  Problem problem = test::make_problem(
      "shut in", test::rectangle_world({{6, 6, 9, 6.2}, {6, 8.8, 9, 9}, {6, 6, 6.2, 9}, {8.8, 6, 9, 9}}),
      test::rectangle_robot(), {2, 2, 0}, {7.5, 7.5, 0});
  add_goal(problem, {5, 3, 1});
  add_goal(problem, {9.4, 2, -1});
  return problem;
}

std::size_t goal_reached(const Problem& problem, const RunRecord& run) {
  REQUIRE(run.solved);
  const auto instance = make_instance(problem);
  const auto near = instance->nearest_goal(run.path.back());
  CHECK(near.distance <= problem.goal_tolerance);
  CHECK(problem.space.distance(run.levels[0].goal, run.path.back()) <= problem.goal_tolerance);
  for (std::size_t i = 1; i < run.path.size(); ++i) CHECK(instance->motion(run.path[i - 1], run.path[i]).valid);
  return near.goal;
}

PlannerSpec planner(const PlannerKind& kind) {
  const auto& options = kind.component->options;
  const bool goes_on = std::any_of(options.begin(), options.end(), [](const Option& o) { return o.name == "improve"; });
  return PlannerSpec::make(kind.component->name,
                           goes_on ? std::vector<Options::Entry>{{"improve", 300.0}} : std::vector<Options::Entry>{});
}

}  // namespace

TEST_CASE("every planner stops at whichever goal it comes to", "[strategy][goals]") {
  for (const auto& kind : planner_kinds()) {
    if (kind.graph) continue;
    CAPTURE(kind.component->name);
    Problem problem = shut_in();
    if (kind.kinodynamic) {
      problem = test::driven(problem);
      CHECK(problem.goals.size() == 3);
    }
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
      const RunRecord run = execute(StrategySpec(planner(kind)), problem, seed);
      CHECK(goal_reached(problem, run) > 0);
      CHECK(execute(StrategySpec(planner(kind)), problem, seed).validity_checks == run.validity_checks);
    }
  }
}

TEST_CASE("anytime planners find the path to the nearer goal", "[strategy][goals]") {
  Problem problem =
      test::make_problem("open", test::rectangle_world({{4, 4, 5, 5}}), test::rectangle_robot(), {2, 2, 0}, {9, 9, 0});
  add_goal(problem, {2, 5, 0});
  for (const auto* name : {"rrt_star", "prm_star", "lazy_prm_star", "lazy_rrg_star"}) {
    CAPTURE(name);
    const StrategySpec strategy(PlannerSpec::make(name, {{"improve", 1000.0}}));
    const RunRecord run = execute(strategy, problem, 2);
    CHECK(goal_reached(problem, run) == 1);
    CHECK(path_length(problem.space, run.path) < 3.3);
  }
}

TEST_CASE("guides guide to several goals", "[strategy][goals]") {
  const Problem problem = shut_in();
  const auto rrt = PlannerSpec::make("rrt", {{"step", 0.5}});
  for (const auto& kind : test::guides_of_one_robot()) {
    CAPTURE(kind.component->name);
    const StrategySpec strategy = GuideSpec::make(kind.component->name, {}) >> rrt;
    CHECK(goal_reached(problem, execute(strategy, problem, 3)) > 0);
    const StrategySpec nested = GuideSpec::make(kind.component->name, {}) >> GuideSpec::make("shrink", {}) >> rrt;
    CHECK(goal_reached(problem, execute(nested, problem, 3)) > 0);
  }
}

TEST_CASE("a goal that is in collision is named by its number", "[strategy][goals]") {
  Problem problem = shut_in();
  add_goal(problem, {7.5, 6.1, 0});
  CHECK_THROWS_WITH(check(problem), Contains("goal 4 (7.5, 6.1, 0) is in collision with obstacle 1"));
  problem = shut_in();
  problem.goals.front() = {7.5, 6.1, 0};
  CHECK_THROWS_WITH(check(problem), Contains("goal 1 (7.5, 6.1, 0) is in collision"));
}

namespace {

/// A goal near the start, and one far behind a cup, each for itself reachable.
Problem near_and_far() {
  Problem problem = test::cup_problem();
  problem.goals = {{2, 7.5, 0.5}, {9, 5, 0}};
  return problem;
}

double median(std::vector<double> values) {
  std::ranges::sort(values);
  return values[values.size() / 2];
}

struct Cost {
  double checks = 0.0;
  double length = 0.0;
};

/// Medians over seeds; each run is solved.
Cost cost_of(const StrategySpec& strategy, const Problem& problem) {
  std::vector<double> checks;
  std::vector<double> lengths;
  for (std::uint64_t seed = 1; seed <= 21; ++seed) {
    const RunRecord run = execute(strategy, problem, seed);
    goal_reached(problem, run);
    checks.push_back(static_cast<double>(run.validity_checks));
    lengths.push_back(run.length);
  }
  return {median(checks), median(lengths)};
}

}  // namespace

TEST_CASE("what a guided run costs does not depend on the order of the goals", "[strategy][goals][slow]") {
  // Without a companion, which comes to the near goal soon.
  const auto rrt = PlannerSpec::make("rrt", {{"step", 0.5}, {"bound", 0.0}});
  std::vector<StrategySpec> strategies;
  for (const auto& kind : test::guides_of_one_robot()) {
    strategies.push_back(GuideSpec::make(kind.component->name, {}) >> rrt);
  }
  strategies.push_back(GuideSpec::make("skeleton", {{"follow", std::string("regions")}}) >> rrt);
  strategies.push_back(GuideSpec::make("workspace", {{"lift", std::string("path")}}) >> rrt);
  strategies.push_back(GuideSpec::make("skeleton", {}) >> GuideSpec::make("shrink", {}) >> rrt);
  strategies.push_back(GuideSpec::make("workspace", {}) >> PlannerSpec::make("prm", {{"bound", 0.0}}));
  for (const StrategySpec& strategy : strategies) {
    CAPTURE(strategy.text());
    Problem problem = near_and_far();
    const Cost near_first = cost_of(strategy, problem);
    std::swap(problem.goals[0], problem.goals[1]);
    const Cost far_first = cost_of(strategy, problem);
    CHECK(far_first.checks <= 1.5 * near_first.checks);
    CHECK(near_first.checks <= 1.5 * far_first.checks);
    CHECK(far_first.length == Approx(near_first.length).epsilon(0.25));
  }
}

TEST_CASE("a skeleton, a grid and cells lead to the nearer goal, which costs less than the far one",
          "[strategy][goals]") {
  const auto rrt = PlannerSpec::make("rrt", {{"step", 0.5}});
  for (const auto* name : {"skeleton", "workspace", "decomposition"}) {
    CAPTURE(name);
    const StrategySpec strategy = GuideSpec::make(name, {}) >> rrt;
    Problem problem = near_and_far();
    std::ranges::reverse(problem.goals);
    const Cost both = cost_of(strategy, problem);
    problem.goals.pop_back();
    const Cost far_alone = cost_of(strategy, problem);
    CHECK(both.checks < 0.6 * far_alone.checks);
    CHECK(both.length < 0.6 * far_alone.length);
  }
}

TEST_CASE("an arm is guided to the goal that it reaches, of several at one place of its tip", "[strategy][goals]") {
  // Two boxes beside the base keep the first link above them, so that it does not reach the goal nearer to the start.
  const Arm arm{.links = {2, 2}, .widths = {0.1, 0.1}, .base = {5, 5}, .limits = {std::nullopt, std::pair(-2.6, 2.6)}};
  Problem problem = test::make_problem("elbows", test::rectangle_world({{5.8, 4.55, 6.1, 4.85}, {3.9, 4.5, 4.2, 4.8}}),
                                       Robot::arm(arm), {0.3, 0.9}, {-0.9, 1.6});
  problem.goals.push_back({0.7, -1.6});
  REQUIRE(problem.space.distance(problem.start, problem.goals[0]) <
          problem.space.distance(problem.start, problem.goals[1]));
  for (const auto* name : {"skeleton", "workspace"}) {
    for (int order = 0; order < 2; ++order) {
      CAPTURE(name, order);
      const StrategySpec strategy = GuideSpec::make(name, {}) >> PlannerSpec::make("rrt", {{"step", 0.3}});
      for (std::uint64_t seed = 1; seed <= 5; ++seed) {
        const RunRecord run = execute(strategy, problem, seed);
        CHECK(problem.goals[goal_reached(problem, run)] == Configuration{0.7, -1.6});
      }
      std::swap(problem.goals[0], problem.goals[1]);
    }
  }
}
