// SPDX-License-Identifier: GPL-3.0-or-later
// What each guide is good for, and where it misleads: validity checks of a run, all levels together, beside those of
// the same planner without it.
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include <trellis/strategy/executor.hpp>

#include "support/catch.hpp"
#include "support/worlds.hpp"

using namespace trellis;

namespace {

constexpr std::uint64_t seeds = 30;

PlannerSpec tree() { return PlannerSpec::make("rrt", {{"step", 0.5}}); }

/// The median over seeds of guided checks by unguided checks, with its 95 % interval (order statistics of 30).
struct Ratio {
  double lower = 0.0;
  double median = 0.0;
  double upper = 0.0;
};

/// Without a path a run has spent more than any that found one.
double spent(const RunRecord& run) {
  return run.solved ? static_cast<double>(run.validity_checks) : std::numeric_limits<double>::infinity();
}

Ratio compare(const GuideSpec& guide, const Problem& problem, const PlannerSpec& planner) {
  std::vector<double> ratios;
  for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
    const double guided = spent(execute(StrategySpec(planner, guide), problem, seed));
    const double plain = spent(execute(StrategySpec(planner), problem, seed));
    ratios.push_back(std::isinf(guided) && std::isinf(plain) ? 1.0 : guided / plain);
  }
  std::sort(ratios.begin(), ratios.end());
  return {ratios[9], 0.5 * (ratios[14] + ratios[15]), ratios[20]};
}

using Given = std::vector<Options::Entry>;

GuideSpec guide(const std::string& name, const Given& given = {}) { return GuideSpec::make(name, given); }

/// A roadmap whose nodes are few enough that a narrow passage is easily missed.
PlannerSpec roadmap() { return PlannerSpec::make("prm", {{"proposals", std::int64_t{4000}}}); }

Problem boxes(const std::string& name, const test::Rectangles& all, const Configuration& start,
              const Configuration& goal) {
  return test::make_problem(name, test::rectangle_world(all), test::rectangle_robot(), start, goal);
}

/// A wall from side to side with one passage in its middle.
Problem passage(double width, double length) {
  return boxes(
      "passage",
      {{5 - length / 2, 0, 5 + length / 2, 5 - width / 2}, {5 - length / 2, 5 + width / 2, 5 + length / 2, 10}},
      {1, 8.5, 0}, {9, 1.5, 0});
}
/// A wall thinner than the robot, with a wide way round it at the top.
Problem thin_wall() { return boxes("thin wall", {{4.95, 0, 5.05, 8.5}}, {1, 3, 0}, {9, 3, 0}); }
/// One block in the middle.
Problem open_world() { return boxes("open", {{4.5, 4.5, 5.5, 5.5}}, {1, 5, 0}, {9, 5, 0}); }
/// Boxes at random between start and goal.
Problem field() {
  test::Rectangles all;
  Stream stream(7, "", "field");
  while (all.size() < 60) {
    const double x = stream.uniform(2, 7.5);
    const double y = stream.uniform(0, 9.5);
    all.push_back({x, y, x + 0.4, y + 0.4});
  }
  return boxes("field", all, {1, 5, 0}, {9, 5, 0});
}
/// Rows of boxes with gaps that the robot fits into.
Problem rows() {
  test::Rectangles all;
  for (int column = 0; column < 4; ++column) {
    for (int row = 0; row < 6; ++row) {
      const double x = 3 + column * 1.1;
      const double y = 1.5 + row * 1.2;
      all.push_back({x, y, x + 0.7, y + 0.7});
    }
  }
  return boxes("rows", all, {1, 5, 0}, {9, 5, 0});
}
/// Two rows of boxes with the straight way between them.
Problem avenue() {
  test::Rectangles all;
  for (int i = 0; i < 7; ++i) {
    const double x = 1.5 + i;
    all.push_back({x, 5.6, x + 0.8, 7.5});
    all.push_back({x, 2.5, x + 0.8, 4.4});
  }
  return boxes("avenue", all, {0.8, 5, 0}, {9.2, 5, 0});
}
/// Start and goal near one another, on the two sides of a short wall in a wide world.
Problem beside() {
  return boxes("beside", {{4.9, 4, 5.1, 6}, {1, 1, 3, 2}, {7, 7, 8, 9}, {1, 7, 2, 9}, {7, 1, 9, 2}}, {4, 5, 0},
               {6, 5, 0});
}

void check_helps(const GuideSpec& with, const Problem& problem, const PlannerSpec& planner = tree()) {
  const Ratio ratio = compare(with, problem, planner);
  INFO(with.text() << " on " << problem.name << ": checks by those of " << planner.text() << " alone, median "
                   << ratio.median << ", [" << ratio.lower << ", " << ratio.upper << "]");
  CHECK(ratio.upper < 1.0);
}

void check_misleads(const GuideSpec& with, const Problem& problem, const PlannerSpec& planner = tree()) {
  const Ratio ratio = compare(with, problem, planner);
  INFO(with.text() << " on " << problem.name << ": checks by those of " << planner.text() << " alone, median "
                   << ratio.median << ", [" << ratio.lower << ", " << ratio.upper << "]");
  CHECK(ratio.lower > 1.0);
}

}  // namespace

SCENARIO("workspace: where a point goes, and whether the robot can follow", "[catalogue]") {
  GIVEN("passages that the robot fits through") {
    THEN("the point's way saves checks") {
      check_helps(guide("workspace"), test::simple_passage_problem());
      check_helps(guide("workspace"), rows());
    }
  }
  GIVEN("passages that only a point fits through") {
    THEN("the point's way costs checks") { check_misleads(guide("workspace"), test::trap_problem()); }
  }
}

SCENARIO("widen: a narrow passage made wide, and a wall made away with", "[catalogue]") {
  GIVEN("a narrow passage between thick walls") {
    THEN("the way through the wide one saves checks") {
      check_helps(guide("widen", {{"distance", 0.1}}), passage(0.4, 1));
    }
  }
  GIVEN("a wall thinner than twice the distance") {
    THEN("the way through what vanished costs checks") {
      check_misleads(guide("widen", {{"distance", 0.1}}), thin_wall());
    }
  }
}

SCENARIO("aggregate: hulls leave the open ways, and close the narrow ones", "[catalogue]") {
  GIVEN("a field of boxes with a way round them") {
    THEN("a way among hulls, which holds in C, saves checks") { check_helps(guide("aggregate"), field()); }
  }
  GIVEN("a world whose only way a hull would close") {
    THEN("looking among hulls first costs checks") {
      check_misleads(guide("aggregate"), test::simple_passage_problem());
    }
  }
}

SCENARIO("drop: obstacles that are not in the way, and those that are", "[catalogue]") {
  GIVEN("an avenue between rows of boxes") {
    THEN("the way found without them holds, and saves checks") { check_helps(guide("drop"), avenue()); }
  }
  GIVEN("a cup whose walls are all in the way") {
    THEN("finding that out one by one costs checks") { check_misleads(guide("drop"), test::cup_problem()); }
  }
}

SCENARIO("obstacle-based and medial-axis samples find narrow passages for a roadmap", "[catalogue]") {
  GIVEN("a long passage little wider than the robot, and a roadmap") {
    THEN("both save checks") {
      check_helps(guide("obstacle_based"), passage(0.6, 3), roadmap());
      check_helps(guide("medial_axis"), passage(0.6, 3), roadmap());
    }
  }
  GIVEN("a world without narrow passages, or a tree that finds its way by itself") {
    THEN("looking for surfaces and clearance costs checks") {
      check_misleads(guide("obstacle_based"), rows(), roadmap());
      check_misleads(guide("obstacle_based"), open_world());
      check_misleads(guide("medial_axis"), test::cup_problem());
    }
  }
}

SCENARIO("Halton: no large hole for a roadmap's passage to lie in, and nothing for a tree", "[catalogue]") {
  GIVEN("a point, a wall with a gap, and a roadmap") {
    const auto gap = test::make_problem("gap", test::rectangle_world({{4.9, 0, 5.1, 4.925}, {4.9, 5.075, 5.1, 10}}),
                                        Robot::point(), {1, 8.5}, {9, 3});
    THEN("a sample is in the gap earlier, which saves checks") { check_helps(guide("halton"), gap, roadmap()); }
  }
  GIVEN("a tree that grows towards its samples") {
    THEN("even spacing costs it a few checks") { check_misleads(guide("halton"), test::cup_problem()); }
  }
}

SCENARIO("informed: what a short path could pass through, and what it could not", "[catalogue]") {
  GIVEN("start and goal near one another in a wide world") {
    THEN("staying near them saves checks") { check_helps(guide("informed", {{"cost", 5.0}}), beside()); }
  }
  GIVEN("a bound below the length of every path") {
    THEN("it keeps out of where the paths are, and costs checks") {
      check_misleads(guide("informed", {{"cost", 9.0}}), test::cup_problem());
    }
  }
}
