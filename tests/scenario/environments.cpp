// SPDX-License-Identifier: GPL-3.0-or-later
// Guides that change the environment, or nothing: where each saves checks, and where it misleads, by the validity
// checks of 30 runs, all levels together, relative to the same planner without it.
#include "support/catch.hpp"
#include "support/trials.hpp"

using namespace trellis;
using namespace trellis::test;
using namespace trellis::testing;

namespace {

/// Random boxes between start and goal.
Problem field() {
  Rectangles all;
  Stream stream(7, "", "field");
  while (all.size() < 60) {
    const double x = stream.uniform(2, 7.5);
    const double y = stream.uniform(0, 9.5);
    all.push_back({x, y, x + 0.4, y + 0.4});
  }
  return boxes("field", all, {1, 5, 0}, {9, 5, 0});
}
/// Two rows of boxes on both sides of the straight line between start and goal.
Problem avenue() {
  Rectangles all;
  for (int i = 0; i < 7; ++i) {
    const double x = 1.5 + i;
    all.push_back({x, 5.6, x + 0.8, 7.5});
    all.push_back({x, 2.5, x + 0.8, 4.4});
  }
  return boxes("avenue", all, {0.8, 5, 0}, {9.2, 5, 0});
}

}  // namespace

SCENARIO("widen: a narrow passage made wide, and a wall made away with", "[catalogue][environments]") {
  GIVEN("a narrow passage between thick walls") {
    const Problem problem = passage(0.4, 1);
    WHEN("a tree is guided by it") {
      const Trial guided = tried(guide("widen", {{"distance", 0.1}}) >> tree(), problem);
      THEN("the path through the wide one saves checks") {
        CHECK_THAT(guided, Spends(below(tried(tree(), problem)).validity_checks()));
      }
    }
  }
  GIVEN("a wall thinner than twice the distance, with a wide route around it") {
    const Problem problem = boxes("thin wall", {{4.95, 0, 5.05, 8.5}}, {1, 3, 0}, {9, 3, 0});
    WHEN("a tree is guided by it") {
      const Trial guided = tried(guide("widen", {{"distance", 0.1}}) >> tree(), problem);
      THEN("the path through the vanished wall costs checks") {
        const Trial plain = tried(tree(), problem);
        CHECK_THAT(guided, Spends(above(plain).validity_checks()) && LosesLittle(plain));
      }
    }
  }
}

SCENARIO("lazy: what is presumed valid mostly is, or mostly is not", "[catalogue][environments]") {
  GIVEN("one block in the middle of an open world") {
    const Problem problem = open_world();
    WHEN("a tree is guided by it") {
      const Trial guided = tried(guide("lazy") >> trusting(tree()), problem);
      THEN("it saves checks") { CHECK_THAT(guided, Spends(below(tried(tree(), problem)).validity_checks())); }
    }
  }
  GIVEN("a wall of pickets with slits that the robot is too wide for") {
    const Problem problem = pickets();
    WHEN("a tree is guided by it") {
      const Trial guided = tried(guide("lazy") >> tree(), problem);
      THEN("finding out one by one that none can be passed costs little") {
        const Trial plain = tried(tree(), problem);
        CHECK_THAT(guided, LosesLittle(plain));
      }
    }
  }
}

SCENARIO("lazy below a planner and above other guides: it takes little from what they save",
         "[catalogue][environments]") {
  GIVEN("boxes at random, between which a smaller robot passes where the whole one may not") {
    const Problem problem = field();
    const Trial two = tried(guide("skeleton") >> guide("shrink") >> tree(), problem);
    WHEN("the path of the smaller robot guides a search that presumes everything valid") {
      const Trial three = tried(guide("skeleton") >> guide("shrink") >> guide("lazy") >> tree(), problem);
      THEN("the three spaces save checks beside the tree, and cost little beside the two") {
        CHECK_THAT(three, Spends(below(tried(tree(), problem)).validity_checks()));
        CHECK_THAT(three, SpendsLittleMoreThan(two));
      }
    }
  }
}

SCENARIO("drop: obstacles beside the path, and obstacles on it", "[catalogue][environments]") {
  GIVEN("an avenue between rows of boxes") {
    const Problem problem = avenue();
    WHEN("a tree is guided by it") {
      const Trial guided = tried(guide("drop") >> tree(), problem);
      THEN("the path found without them is valid, and saves checks") {
        CHECK_THAT(guided, Spends(below(tried(tree(), problem)).validity_checks()));
      }
    }
  }
  GIVEN("a cup whose walls all block the path") {
    const Problem problem = cup_problem();
    WHEN("a tree is guided by it") {
      const Trial guided = tried(guide("drop") >> tree(), problem);
      THEN("finding that out one by one costs checks") {
        const Trial plain = tried(tree(), problem);
        CHECK_THAT(guided, Spends(above(plain).validity_checks()) && LosesLittle(plain));
      }
    }
  }
}

SCENARIO("aggregate: hulls leave wide passages open, and close narrow ones", "[catalogue][environments]") {
  GIVEN("a field of boxes with a route around them") {
    const Problem problem = field();
    WHEN("a tree is guided by it") {
      const Trial guided = tried(guide("aggregate") >> trusting(tree()), problem);
      THEN("a path among hulls, which holds in C, saves checks") {
        CHECK_THAT(guided, Spends(below(tried(tree(), problem)).validity_checks()));
      }
    }
  }
  GIVEN("a world whose only passage a hull would close") {
    const Problem problem = simple_passage_problem();
    WHEN("a tree is guided by it") {
      const Trial guided = tried(guide("aggregate") >> tree(), problem);
      THEN("looking among hulls first costs checks") {
        const Trial plain = tried(tree(), problem);
        CHECK_THAT(guided, Spends(above(plain).validity_checks()) && LosesLittle(plain));
      }
    }
  }
}

SCENARIO("identity: the same instance by another planner, which is quicker or is not", "[catalogue][environments]") {
  GIVEN("a cup that two trees leave soon") {
    const Problem problem = cup_problem();
    WHEN("one tree is guided by their path") {
      const Trial guided = tried(by_two_trees("identity") >> trusting(tree()), problem);
      THEN("it saves checks, theirs counted") {
        CHECK_THAT(guided, Spends(below(tried(tree(), problem)).validity_checks()));
      }
    }
  }
  GIVEN("a slit that both of them reach, and a route around it") {
    const Problem problem = detour();
    WHEN("one tree is guided by their path") {
      const Trial guided = tried(by_two_trees("identity") >> tree(), problem);
      THEN("it costs checks: everything is looked for twice") {
        const Trial plain = tried(tree(), problem);
        CHECK_THAT(guided, Spends(above(plain).validity_checks()) && LosesLittle(plain));
      }
    }
  }
}
