// SPDX-License-Identifier: GPL-3.0-or-later
// Guides that change the robot: where each saves checks, and where it misleads, by the validity checks of 30 runs, all
// levels together, relative to the same planner without it.
#include <cstdint>
#include <string>
#include <vector>

#include "support/catch.hpp"
#include "support/trials.hpp"

using namespace trellis;
using namespace trellis::test;
using namespace trellis::testing;

namespace {

/// Iterative relaxation: robots of a quarter, a half and three quarters of the size, each guided by the path of the
/// previous one; half of the proposals of each are uniform.
/// \param planner  of each smaller robot
GuideSpec relaxation(const PlannerSpec& planner) {
  const auto level = [&](double scale) {
    return GuideSpec::make("shrink", {{"scale", scale}, {"follow", "waypoints"}}, planner);
  };
  return level(0.25 / 0.5) >> level(0.5 / 0.75) >> level(0.75);
}

Problem arm_problem(const std::string& name, const Arm& arm, const Rectangles& boxes, const Configuration& start,
                    const Configuration& goal) {
  return make_problem(name, rectangle_world(boxes), Robot::arm(arm), start, goal);
}
/// An arm of four links, with a bar or a box nearby.
Problem four_links(const Rectangles& boxes, const Configuration& goal) {
  const Arm arm{.links = {1.2, 1.2, 1.2, 1}, .widths = {0.1, 0.1, 0.1, 0.1}, .base = {5, 1}};
  return arm_problem("four links", arm, boxes, {0.9, 0.3, 0.2, 0.1}, goal);
}
GuideSpec flat() { return by_two_trees("pca", {{"dimensions", std::int64_t{2}}}, 0.2); }

PlannerSpec driving(std::vector<Options::Entry> options) {
  options.emplace_back("proposals", std::int64_t{10000});
  return PlannerSpec::make("kinodynamic_rrt", options);
}

/// A forward-only car, and a goal behind it with the same heading: it has to drive a full turn.
Problem goal_behind() {
  Problem problem =
      make_problem("goal behind", World(Box2{{0, 0}, {10, 10}}, {}), rectangle_robot(0.5, 0.3), {5, 5, 0}, {3, 5, 0});
  const MotionKind& car = *find_motion("car");
  problem.motion_model = car.make(Options::validate(
      *car.component, {{"min_speed", 0.5}, {"max_speed", 1.0}, {"max_steering", 0.4}, {"wheelbase", 0.5}}));
  problem.goal_tolerance = 1.0;
  return problem;
}

}  // namespace

SCENARIO("workspace: where a point goes, and whether the robot can follow", "[catalogue][robots][slow]") {
  GIVEN("passages that the robot fits through") {
    THEN("the point's path costs little, whether it saves checks or not") {
      for (const Problem& problem : {simple_passage_problem(), rows()}) {
        CHECK_THAT(tried(guide("workspace") >> tree(), problem), LosesLittle(tried(tree(), problem)));
      }
    }
  }
  GIVEN("passages that only a point fits through") {
    const Problem problem = trap_problem();
    THEN("the point's path costs checks") {
      const Trial plain = tried(tree(), problem);
      CHECK_THAT(tried(guide("workspace") >> trusting(tree()), problem), Spends(above(plain).validity_checks()));
      CHECK_THAT(tried(guide("workspace") >> tree(), problem), LosesLittle(plain));
    }
  }
}

SCENARIO("skeleton: regions that lead through a passage, and regions in slits", "[catalogue][robots]") {
  const GuideSpec regions = guide("skeleton", {{"explore", 0.1}});
  GIVEN("a passage that the robot fits through") {
    const Problem problem = simple_passage_problem();
    THEN("they save checks") {
      const Trial plain = tried(tree(), problem);
      CHECK_THAT(tried(regions >> tree(), problem), Spends(below(plain).validity_checks()));
      CHECK_THAT(tried(guide("skeleton") >> tree(), problem), Spends(below(plain).validity_checks()));
    }
  }
  GIVEN("a wall of pickets, and room below it") {
    const Problem problem = pickets();
    WHEN("a tree is guided by them, one in each slit") {
      THEN("they cost little") {
        const Trial plain = tried(tree(), problem);
        CHECK_THAT(tried(regions >> tree(), problem), LosesLittle(plain));
      }
    }
  }
  GIVEN("two trees in an open world, which find a path without guidance") {
    const Problem problem = open_world();
    const PlannerSpec trees = PlannerSpec::make("rrt_connect", {{"step", 0.5}});
    THEN("they cost little") {
      const Trial plain = tried(trees, problem);
      CHECK_THAT(tried(guide("skeleton") >> trees, problem), LosesLittle(plain));
    }
  }
}

SCENARIO("shrink: what half of the robot passes, the whole may pass too, or may not", "[catalogue][robots]") {
  const GuideSpec half = by_two_trees("shrink", {{"scale", 0.5}});
  GIVEN("a narrow passage") {
    const Problem problem = passage(0.35, 1);
    THEN("the path of half the robot saves checks") {
      CHECK_THAT(tried(half >> tree(), problem), Spends(below(tried(tree(), problem)).validity_checks()));
    }
  }
  GIVEN("a slit that only half of the robot fits through, and a route around it") {
    const Problem problem = detour();
    THEN("its path costs checks") {
      const Trial plain = tried(tree(), problem);
      CHECK_THAT(tried(half >> tree(), problem), Spends(above(plain).validity_checks()) && LosesLittle(plain));
    }
  }
}

SCENARIO("shrink, again and again: iterative relaxation", "[catalogue][robots]") {
  const PlannerSpec planner =
      PlannerSpec::make("rrt", {{"step", 0.5}, {"uniform", 0.5}, {"proposals", std::int64_t{20000}}});
  GIVEN("a narrow passage") {
    const Problem problem = passage(0.35, 0.5);
    THEN("ever larger robots save checks") {
      CHECK_THAT(tried(relaxation(planner) >> trusting(planner), problem),
                 Spends(below(tried(planner, problem)).validity_checks()));
    }
  }
  GIVEN("a block in the middle of an open world") {
    const Problem problem = open_world();
    THEN("three more searches cost checks") {
      const Trial plain = tried(planner, problem);
      CHECK_THAT(tried(relaxation(planner) >> planner, problem),
                 Spends(above(plain).validity_checks()) && LosesLittle(plain));
    }
  }
}

SCENARIO("shrink with several distinct paths", "[catalogue][robots]") {
  const GuideSpec several =
      by_two_trees("shrink", {{"scale", 0.5}, {"paths", std::int64_t{2}}, {"effort", std::int64_t{500}}});
  GIVEN("a narrow passage") {
    const Problem problem = passage(0.35, 1);
    THEN("they save checks") {
      CHECK_THAT(tried(several >> trusting(tree()), problem), Spends(below(tried(tree(), problem)).validity_checks()));
    }
  }
  GIVEN("alleys, and a robot that is too long for most of their corners") {
    const Problem problem = alleys();
    THEN("searching several paths of half of it costs checks") {
      const Trial plain = tried(tree(), problem);
      CHECK_THAT(tried(several >> tree(), problem), Spends(above(plain).validity_checks()) && LosesLittle(plain));
    }
  }
}

SCENARIO("skeleton: an arm whose tip is led through a gap, and one that has to fold", "[catalogue][robots]") {
  const auto planner = PlannerSpec::make("rrt_connect", {{"step", 0.3}});
  GIVEN("an arm of four links below a wall with a gap that its tip goes through") {
    const Arm arm{.links = {1.6, 1.6, 1.6, 1.6}, .widths = {0.15, 0.15, 0.15, 0.15}, .base = {5, 1}};
    const Problem problem = arm_problem("gap", arm, {{0, 4, 4.5, 4.3}, {5.5, 4, 10, 4.3}},
                                        {-0.387, 0.431, 0.575, 1.995}, {1.357, 0.484, -0.452, -1.439});
    THEN("its path saves checks") {
      CHECK_THAT(tried(guide("skeleton") >> planner, problem),
                 Spends(below(tried(planner, problem)).validity_checks()));
    }
    THEN("a single tree that follows it finds a path on every seed") {
      CHECK_THAT(tried(guide("skeleton") >> PlannerSpec::make("rrt", {{"step", 0.3}}), problem), Solves(at_least(1.0)));
    }
  }
  GIVEN("an arm of six links that has to fold to leave one compartment of a shelf for another") {
    const Arm arm{
        .links = {1.2, 1.2, 1.2, 1.2, 1.2, 1.2}, .widths = {0.12, 0.12, 0.12, 0.12, 0.12, 0.12}, .base = {2.5, 5}};
    const Problem problem = arm_problem(
        "shelf", arm,
        {{5, 2, 9, 2.2}, {5, 3.4, 9, 3.6}, {5, 4.9, 9, 5.1}, {5, 6.4, 9, 6.6}, {5, 7.8, 9, 8}, {9, 2, 9.2, 8}},
        {-2.144, 0.776, 1.444, -0.204, 0.459, -0.612}, {2.100, -0.868, -1.069, -0.356, -0.064, 0.562});
    THEN("where the tip goes says little, and costs a bounded number of checks") {
      CHECK_THAT(tried(guide("skeleton") >> planner, problem), LosesLittle(tried(planner, problem)));
    }
  }
}

SCENARIO("joints: the first ones say where the others are, or they say little", "[catalogue][robots]") {
  const GuideSpec first_two = by_two_trees("joints", {}, 0.1);
  GIVEN("an arm of two long links and a wrist of three short ones") {
    const Arm arm{.links = {2.2, 2.0, 0.3, 0.3, 0.3}, .widths = {0.2, 0.2, 0.1, 0.1, 0.1}, .base = {5, 5}};
    const Problem problem = arm_problem("wrist", arm, {{6.2, 7, 8.2, 8.2}, {6.8, 2.2, 8, 3.6}},
                                        {1.9, 0.4, 0.3, 0.3, 0.3}, {-0.9, -0.5, -0.3, -0.3, -0.3});
    THEN("they save checks") {
      CHECK_THAT(tried(first_two >> trusting(tree(0.1)), problem),
                 Spends(below(tried(tree(0.1), problem)).validity_checks()));
    }
  }
  GIVEN("an arm of two short links and a long one") {
    const Arm arm{.links = {0.8, 0.8, 2.2}, .widths = {0.2, 0.2, 0.2}, .base = {5, 5}};
    const Problem problem =
        arm_problem("hand", arm, {{6.9, 5.6, 8.5, 8.2}, {6.8, 2.2, 8, 3.6}}, {1.9, 0.4, 0.3}, {-0.9, -0.5, -0.3});
    THEN("they cost checks") {
      const Trial plain = tried(tree(0.1), problem);
      CHECK_THAT(tried(first_two >> tree(0.1), problem), Spends(above(plain).validity_checks()) && LosesLittle(plain));
    }
  }
}

SCENARIO("pca: a subspace that contains a path, and a motion that needs none", "[catalogue][robots]") {
  GIVEN("an arm of four links that has to draw in a little to pass below a bar") {
    const Problem problem = four_links({{4.7, 5.35, 5.3, 5.5}}, {2.2, -0.3, -0.2, -0.1});
    THEN("a search of two dimensions saves checks, those of the fit counted") {
      CHECK_THAT(tried(flat() >> trusting(tree(0.2)), problem),
                 Spends(below(tried(tree(0.2), problem)).validity_checks()));
    }
  }
  GIVEN("a goal near the start") {
    const Problem problem = four_links({{3.6, 4.8, 4.4, 5.2}}, {1.4, 0.2, 0.2, 0.1});
    THEN("the fit costs more checks than there were to save") {
      const Trial plain = tried(tree(0.2), problem);
      // f spends checks on the fit before the search begins, so no bound limits them.
      CHECK_THAT(tried(flat() >> tree(0.2), problem), Spends(above(plain).validity_checks()));
    }
  }
}

SCENARIO("holonomic and decomposition: what forgets how the robot is driven", "[catalogue][robots]") {
  GIVEN("a wall like a cup between start and goal, and a car that turns in a radius") {
    const Problem problem = driven(cup_problem(), "car");
    const PlannerSpec planner = driving({});
    THEN("both save checks") {
      const Trial plain = tried(planner, problem);
      for (const std::string name : {"holonomic", "decomposition"}) {
        CHECK_THAT(tried(guide(name) >> trusting(planner), problem), Spends(below(plain).validity_checks()));
      }
    }
  }
  GIVEN("a car that only goes forwards, and a goal behind it") {
    const Problem problem = goal_behind();
    const PlannerSpec planner = driving({{"connect", 0.0}});
    THEN("both cost checks, because the robot cannot drive straight there") {
      const Trial plain = tried(planner, problem);
      CHECK_THAT(tried(guide("holonomic") >> planner, problem),
                 Spends(above(plain).validity_checks()) && LosesLittle(plain));
      CHECK_THAT(tried(guide("decomposition") >> trusting(planner), problem), Spends(above(plain).validity_checks()));
      CHECK_THAT(tried(guide("decomposition") >> planner, problem), LosesLittle(plain));
    }
  }
}
