// SPDX-License-Identifier: GPL-3.0-or-later
// Combinators of guides, and user-defined guides: where each saves checks, and where it misleads, by the validity
// checks of 30 runs, all levels together, relative to the same planner without guidance and to the single guides.
#include <string>

#include "support/catch.hpp"
#include "support/folder.hpp"
#include "support/trials.hpp"

using namespace trellis;
using namespace trellis::test;
using namespace trellis::testing;

namespace {

// In the cup both save checks; before the pickets both mislead.
GuideSpec one() { return guide("skeleton"); }
GuideSpec other() { return guide("lazy"); }

GuideSpec half() { return by_two_trees("shrink", {{"scale", 0.5}}); }
GuideSpec most() { return by_two_trees("shrink", {{"scale", 0.8}}); }

}  // namespace

SCENARIO("a >> b: what guides the guide", "[catalogue][combinators]") {
  const StrategySpec nested = guide("skeleton") >> guide("shrink") >> tree();
  GIVEN("a narrow passage") {
    const Problem problem = simple_passage_problem();
    THEN("it saves checks, and some of those that the guide alone spends") {
      CHECK_THAT(tried(nested, problem), Spends(below(tried(tree(), problem)).validity_checks()));
      CHECK_THAT(tried(nested, problem), Spends(below(tried(guide("shrink") >> tree(), problem)).validity_checks()));
    }
  }
  GIVEN("one block in the middle of an open world") {
    const Problem problem = open_world();
    THEN("a search for the guide and one for the guide's guide cost little") {
      const Trial plain = tried(tree(), problem);
      CHECK_THAT(tried(nested, problem), LosesLittle(plain));
    }
  }
}

SCENARIO("a + b: it hedges, and loses little where both mislead", "[catalogue][combinators]") {
  const StrategySpec mixed = (one() + other()) >> tree();
  GIVEN("a cup between start and goal") {
    const Problem problem = cup_problem();
    THEN("it saves checks, and spends little more than the worse part alone; the better one spends still fewer") {
      const PlannerSpec planner = trusting(tree());
      const Trial trial = tried((one() + other()) >> planner, problem);
      CHECK_THAT(trial, Spends(below(tried(tree(), problem)).validity_checks()));
      CHECK_THAT(trial, SpendsLittleMoreThan(tried(other() >> planner, problem)));
      CHECK_THAT(trial, Spends(above(tried(one() >> planner, problem)).validity_checks()));
    }
  }
  GIVEN("a wall of pickets, where both of them mislead") {
    const Problem problem = pickets();
    THEN("it loses little") {
      const Trial plain = tried(tree(), problem);
      CHECK_THAT(tried(mixed, problem), LosesLittle(plain));
    }
  }
}

SCENARIO("blend: by what the parts achieve, where they achieve something", "[catalogue][combinators]") {
  GIVEN("a cup between start and goal") {
    const Problem problem = cup_problem();
    const Trial plain = tried(tree(), problem);
    THEN("by rates, by exp3 and by efficiency it saves checks") {
      const PlannerSpec planner = trusting(tree());
      CHECK_THAT(tried(blend({one(), other()}) >> planner, problem), Spends(below(plain).validity_checks()));
      CHECK_THAT(tried(blend({one(), other()}, {.rule = "exp3"}) >> planner, problem),
                 Spends(below(plain).validity_checks()));
      CHECK_THAT(tried(blend({one(), other()}, {.credit = "efficiency"}) >> planner, problem),
                 Spends(below(plain).validity_checks()));
    }
  }
  GIVEN("a wall of pickets, where both of them mislead") {
    const Problem problem = pickets();
    const Trial plain = tried(tree(), problem);
    THEN("by rates, by exp3 and by efficiency it loses little") {
      CHECK_THAT(tried(blend({one(), other()}) >> tree(), problem), LosesLittle(plain));
      CHECK_THAT(tried(blend({one(), other()}, {.rule = "exp3"}) >> tree(), problem), LosesLittle(plain));
      CHECK_THAT(tried(blend({one(), other()}, {.credit = "efficiency"}) >> tree(), problem), LosesLittle(plain));
    }
  }
}

SCENARIO("a .. b: turns, each of which is paid", "[catalogue][combinators]") {
  const StrategySpec turns = sequence({other(), one()}, 50) >> tree();
  GIVEN("a cup between start and goal") {
    const Problem problem = cup_problem();
    THEN("it saves checks") {
      CHECK_THAT(tried(sequence({other(), one()}, 50) >> trusting(tree()), problem),
                 Spends(below(tried(tree(), problem)).validity_checks()));
    }
  }
  GIVEN("a wall of pickets, where both of them mislead") {
    const Problem problem = pickets();
    THEN("it loses little") {
      const Trial plain = tried(tree(), problem);
      CHECK_THAT(tried(turns, problem), LosesLittle(plain));
    }
  }
}

SCENARIO("schedule: robots that grow, each until it is refuted", "[catalogue][combinators]") {
  const StrategySpec growing = schedule({half(), most()}) >> tree();
  GIVEN("a narrow passage") {
    const Problem problem = passage(0.5, 1);
    THEN("it saves checks") {
      CHECK_THAT(tried(growing, problem), Spends(below(tried(tree(), problem)).validity_checks()));
    }
  }
  GIVEN("alleys, and a robot that is too long for most of their corners") {
    const Problem problem = alleys();
    THEN("refuting each of them costs checks") {
      const Trial plain = tried(tree(), problem);
      CHECK_THAT(tried(growing, problem), Spends(above(plain).validity_checks()) && LosesLittle(plain));
    }
  }
}

SCENARIO("race: the quick one leads, the slow one is paid a slice", "[catalogue][combinators]") {
  const GuideSpec slow = guide("shrink", {{"scale", 0.9}});
  const GuideSpec quick = guide("skeleton") >> guide("shrink", {{"scale", 0.6}});
  const StrategySpec raced = race({slow, quick}, {.slice = 50}) >> tree();
  GIVEN("a slit that the robot does not pass, and a route around it") {
    const Problem problem = detour();
    const Trial trial = tried(raced, problem);
    THEN("it spends fewer checks than their mixture, than the slow one and than no guide") {
      CHECK_THAT(trial, Spends(below(tried((slow + quick) >> tree(), problem)).validity_checks()));
      CHECK_THAT(trial, Spends(below(tried(slow >> tree(), problem)).validity_checks()));
      CHECK_THAT(trial, Spends(below(tried(tree(), problem)).validity_checks()));
    }
    THEN("the quick one alone spends fewer than a race") {
      CHECK_THAT(trial, Spends(above(tried(quick >> tree(), problem)).validity_checks()));
    }
  }
  GIVEN("one block in the middle of an open world") {
    const Problem problem = open_world();
    THEN("no race costs much") {
      const Trial plain = tried(tree(), problem);
      CHECK_THAT(tried(raced, problem), LosesLittle(plain));
    }
  }
}

SCENARIO("split: a sub-goal that halves the path, and an unnecessary one", "[catalogue][combinators]") {
  const PlannerSpec trees = trusting(PlannerSpec::make("rrt_connect", {{"proposals", std::int64_t{20000}}}));
  const GuideSpec skeleton = guide("skeleton");
  GIVEN("a narrow passage, and a skeleton through it") {
    const Problem problem = simple_passage_problem();
    THEN("two trees that begin in it spend few checks beside no guide, and little more than undivided") {
      const Trial whole = tried(skeleton >> trees, problem);
      const Trial plain = tried(trees, problem);
      for (const std::int64_t depth : {1, 2}) {
        const Trial divided = tried(skeleton >> split(trees, {.depth = depth}), problem);
        CHECK_THAT(divided, SpendsLittleMoreThan(whole));
        CHECK_THAT(divided, Spends(below(plain).validity_checks()));
      }
    }
    THEN("a tree that grows from the start alone spends more: it need not reach just this configuration") {
      CHECK_THAT(tried(skeleton >> split(tree()), problem),
                 Spends(above(tried(skeleton >> tree(), problem)).validity_checks()));
    }
  }
  GIVEN("a cup, whose rim the path leads around") {
    const Problem problem = cup_problem();
    THEN("it saves checks beside no guide, and spends little more than undivided") {
      const Trial divided = tried(skeleton >> split(trees), problem);
      CHECK_THAT(divided, SpendsLittleMoreThan(tried(skeleton >> trees, problem)));
      CHECK_THAT(divided, Spends(below(tried(trees, problem)).validity_checks()));
      CHECK_THAT(tried(skeleton >> split(tree()), problem), Spends(below(tried(tree(), problem)).validity_checks()));
    }
  }
  GIVEN("alleys, and a robot that is too long for most of their corners") {
    const Problem problem = alleys();
    THEN("sub-goals in corners cost little") {
      const Trial plain = tried(tree(), problem);
      CHECK_THAT(tried(skeleton >> split(tree()), problem), LosesLittle(plain));
    }
  }
}

SCENARIO("guiding_space: correct and wrong knowledge of its author", "[catalogue][combinators]") {
  GIVEN("a script for a door in the middle of the wall") {
    const Folder folder;
    const std::string script = folder.write("door.lua", R"lua(
      local door = guiding_space {
        name = "door",
        space = {},
        heuristic = function()
          return function(random, normal)
            return 5 + 0.5 * normal(), 5 + 0.5 * normal(), math.pi * (2 * random() - 1)
          end
        end,
      }
      local function crossing(name, lower, upper)
        return problem {
          name = name,
          world = world { bounds = {0, 0, 10, 10}, box(lower), box(upper) },
          robot = robot.rectangle(0.6, 0.2),
          start = {2, 5, 0},
          goal = {8, 5, 0},
        }
      end
      local plain = rrt { step = 0.5, proposals = 20000 }
      return experiment {
        problems = {
          crossing("a door", {4, 0, 6, 4.75}, {4, 5.25, 6, 10}),
          crossing("a slit", {4, 1, 6, 4.94}, {4, 5.06, 6, 10}),
        },
        strategies = { plain = plain, door = door >> plain },
      }
    )lua");
    const Script knows = load(script);
    WHEN("it is there") {
      const Trial guided = knows.trial("door", seeds(30), "a door");
      THEN("it saves checks") {
        CHECK_THAT(guided, Spends(below(knows.trial("plain", seeds(30), "a door")).validity_checks()));
      }
    }
    WHEN("it is a slit, and the path leads elsewhere") {
      const Trial guided = knows.trial("door", seeds(30), "a slit");
      THEN("it costs checks") {
        const Trial plain = knows.trial("plain", seeds(30), "a slit");
        CHECK_THAT(guided, Spends(above(plain).validity_checks()) && LosesLittle(plain));
      }
    }
  }
}
