// SPDX-License-Identifier: GPL-3.0-or-later
// Biases without a space (S = {0}): where each saves checks, and where it misleads, by the validity checks of 30 runs
// relative to the same planner without it.
#include "support/catch.hpp"
#include "support/trials.hpp"

using namespace trellis;
using namespace trellis::test;
using namespace trellis::testing;

SCENARIO("goal_bias: straight to the goal, and straight into what is in front of it", "[catalogue][samplers]") {
  GIVEN("a block that is easily passed") {
    const Problem problem = open_world();
    WHEN("a tree is guided by it") {
      const Trial greedy = tried(guide("goal_bias", {{"share", 0.9}}) >> tree(), problem);
      THEN("it saves checks") { CHECK_THAT(greedy, Spends(below(tried(tree(), problem)).validity_checks())); }
    }
  }
  GIVEN("a cup between start and goal") {
    const Problem problem = cup_problem();
    WHEN("a tree is guided by it") {
      const Trial greedy = tried(guide("goal_bias", {{"share", 0.9}}) >> tree(), problem);
      THEN("it costs checks") {
        const Trial plain = tried(tree(), problem);
        CHECK_THAT(greedy, Spends(above(plain).validity_checks()) && LosesLittle(plain));
      }
    }
  }
}

SCENARIO("samples near what is invalid in a long passage for a roadmap that checks few edges",
         "[catalogue][samplers]") {
  GIVEN("a long passage little wider than the robot") {
    const Problem problem = passage(0.6, 3);
    const Trial plain = tried(roadmap(), problem);
    WHEN("a roadmap is guided by gaussian") {
      const Trial guided = tried(guide("gaussian", {{"sigma", 0.1}}) >> roadmap(), problem);
      THEN("it loses little") { CHECK_THAT(guided, LosesLittle(plain)); }
    }
    WHEN("a roadmap is guided by bridge_test") {
      const Trial guided = tried(guide("bridge_test", {{"sigma", 0.6}}) >> roadmap(), problem);
      THEN("it loses little") { CHECK_THAT(guided, LosesLittle(plain)); }
    }
    WHEN("a roadmap is guided by bridge_test alone, without a bound") {
      const PlannerSpec alone = PlannerSpec::make("prm", {{"proposals", std::int64_t{4000}}, {"bound", 0.0}});
      const Trial guided = tried(guide("bridge_test", {{"sigma", 0.6}}) >> alone, problem);
      THEN("it saves proposals") { CHECK_THAT(guided, Spends(below(plain).proposals())); }
    }
    WHEN("a roadmap is guided by obstacle_based") {
      const Trial guided = tried(guide("obstacle_based") >> roadmap(), problem);
      THEN("it loses little") { CHECK_THAT(guided, LosesLittle(plain)); }
    }
    WHEN("a roadmap is guided by medial_axis") {
      const Trial guided = tried(guide("medial_axis") >> roadmap(), problem);
      THEN("it loses little") { CHECK_THAT(guided, LosesLittle(plain)); }
    }
  }
}

SCENARIO("samples near what is invalid are not worth their checks where there is room", "[catalogue][samplers]") {
  GIVEN("one block in the middle of an open world, and a roadmap") {
    const Problem problem = open_world();
    const Trial plain = tried(roadmap(), problem);
    WHEN("it is guided by gaussian") {
      const Trial guided = tried(guide("gaussian", {{"sigma", 0.1}}) >> roadmap(), problem);
      THEN("it costs checks") { CHECK_THAT(guided, Spends(above(plain).validity_checks()) && LosesLittle(plain)); }
    }
    WHEN("it is guided by bridge_test") {
      const Trial guided = tried(guide("bridge_test", {{"sigma", 0.6}}) >> roadmap(), problem);
      THEN("it costs checks") { CHECK_THAT(guided, Spends(above(plain).validity_checks()) && LosesLittle(plain)); }
    }
    WHEN("it is guided by obstacle_based") {
      const Trial guided = tried(guide("obstacle_based") >> roadmap(), problem);
      THEN("it costs checks") { CHECK_THAT(guided, Spends(above(plain).validity_checks()) && LosesLittle(plain)); }
    }
  }
  GIVEN("a tree that finds a path without guidance") {
    WHEN("it is guided by obstacle_based in an open world") {
      const Problem problem = open_world();
      const Trial guided = tried(guide("obstacle_based") >> tree(), problem);
      THEN("it costs checks") {
        const Trial plain = tried(tree(), problem);
        CHECK_THAT(guided, Spends(above(plain).validity_checks()) && LosesLittle(plain));
      }
    }
    WHEN("it is guided by medial_axis round a cup") {
      const Problem problem = cup_problem();
      const Trial guided = tried(guide("medial_axis") >> tree(), problem);
      THEN("it costs checks") {
        const Trial plain = tried(tree(), problem);
        CHECK_THAT(guided, Spends(above(plain).validity_checks()) && LosesLittle(plain));
      }
    }
  }
}

SCENARIO("halton: no large hole for a roadmap's passage to lie in, and nothing for a tree", "[catalogue][samplers]") {
  GIVEN("a point, and a wall with a gap") {
    const Problem problem = make_problem("gap", rectangle_world({{4.9, 0, 5.1, 4.925}, {4.9, 5.075, 5.1, 10}}),
                                         Robot::point(), {1, 8.5}, {9, 3});
    WHEN("a roadmap is guided by it") {
      const Trial even = tried(guide("halton") >> trusting(roadmap()), problem);
      THEN("a sample is in the gap earlier, which saves checks") {
        CHECK_THAT(even, Spends(below(tried(roadmap(), problem)).validity_checks()));
      }
    }
  }
  GIVEN("a cup between start and goal") {
    const Problem problem = cup_problem();
    WHEN("a tree is guided by it, which grows towards its samples and takes no notice of holes") {
      const Trial even = tried(guide("halton") >> tree(), problem);
      THEN("it costs little") {
        const Trial plain = tried(tree(), problem);
        CHECK_THAT(even, LosesLittle(plain));
      }
    }
  }
}

SCENARIO("informed: what a short path could pass through, and what it could not", "[catalogue][samplers]") {
  GIVEN("start and goal near one another, on the two sides of a short wall in a wide world") {
    const Problem problem = boxes("beside", {{4.9, 4, 5.1, 6}, {1, 1, 3, 2}, {7, 7, 8, 9}, {1, 7, 2, 9}, {7, 1, 9, 2}},
                                  {4, 5, 0}, {6, 5, 0});
    WHEN("a tree is kept near them") {
      const Trial kept = tried(guide("informed", {{"cost", 5.0}}) >> tree(), problem);
      THEN("it saves checks") { CHECK_THAT(kept, Spends(below(tried(tree(), problem)).validity_checks())); }
    }
  }
  GIVEN("a cup between start and goal") {
    const Problem problem = cup_problem();
    WHEN("the bound is below the length of every path") {
      const Trial kept = tried(guide("informed", {{"cost", 9.0}}) >> tree(), problem);
      THEN("it keeps out of where the paths are, and costs checks") {
        const Trial plain = tried(tree(), problem);
        CHECK_THAT(kept, Spends(above(plain).validity_checks()) && LosesLittle(plain));
      }
    }
  }
}
