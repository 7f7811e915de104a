// SPDX-License-Identifier: GPL-3.0-or-later
// What the combinators are good for, and where they mislead: validity checks over 30 seeds, paired by seed. Of fair
// coins 20 or more in 30 show heads with a probability of 0.05: where the one spends fewer checks that often, at least
// half of all seeds do with 95 % confidence.
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include <trellis/strategy/executor.hpp>

#include "support/catch.hpp"
#include "support/worlds.hpp"

using namespace trellis;

namespace {

constexpr std::uint64_t seeds = 30;
constexpr int many = 20;

GuideSpec guide(const std::string& name, const std::vector<Options::Entry>& given = {}) {
  return GuideSpec::make(name, given);
}
PlannerSpec planner(const std::string& name) { return PlannerSpec::make(name, {{"proposals", 20000.0}}); }

/// On how many seeds `a` spends fewer checks than `b`; a run without a path spends more than any other.
int fewer(const StrategySpec& a, const StrategySpec& b, const Problem& problem) {
  const auto spent = [&](const StrategySpec& strategy, std::uint64_t seed) {
    const auto run = execute(strategy, problem, seed);
    return run.solved ? run.validity_checks : std::numeric_limits<std::uint64_t>::max();
  };
  int count = 0;
  for (std::uint64_t seed = 1; seed <= seeds; ++seed) count += spent(a, seed) < spent(b, seed) ? 1 : 0;
  return count;
}

}  // namespace

SCENARIO("sub-goals on a guide's path let two trees begin where it is narrow", "[combinators][worth]") {
  const auto connect = planner("rrt_connect");
  const auto skeleton = guide("skeleton");
  GIVEN("a narrow passage, and a skeleton through it") {
    const auto problem = test::simple_passage_problem();
    THEN("a split spends fewer checks than the same strategy undivided") {
      CHECK(fewer(skeleton >> split(connect), skeleton >> connect, problem) >= many);
      CHECK(fewer(skeleton >> split(connect, {.depth = 2}), skeleton >> connect, problem) >= many);
    }
    THEN("a tree that grows from the start alone is misled: it need not reach just this configuration of the passage") {
      const auto rrt = planner("rrt");
      CHECK(fewer(skeleton >> rrt, skeleton >> split(rrt), problem) >= many);
    }
  }
  GIVEN("a cup, whose rim the way leads around") {
    const auto problem = test::cup_problem();
    THEN("a split spends fewer checks than the same strategy undivided, and than no guide") {
      CHECK(fewer(skeleton >> split(connect), skeleton >> connect, problem) >= many);
      CHECK(fewer(skeleton >> split(connect), connect, problem) >= many);
    }
  }
}

SCENARIO("a race does not pay for the guides that lose", "[combinators][worth]") {
  GIVEN("a slit that the robot does not pass, a way round it, and two guides of which one is quick") {
    const auto problem = test::make_problem("detour", test::rectangle_world({{4, 1, 6, 4.94}, {4, 5.06, 6, 10}}),
                                            test::rectangle_robot(), {2, 5, 0}, {8, 5, 0});
    const auto slow = guide("shrink", {{"scale", 0.9}});
    const auto quick = guide("skeleton") >> guide("shrink", {{"scale", 0.6}});
    const auto rrt = planner("rrt");
    const auto raced = race({slow, quick}, {.slice = 50}) >> rrt;
    THEN("it spends fewer checks than their mixture, than the slow one and than no guide") {
      CHECK(fewer(raced, (slow + quick) >> rrt, problem) >= many);
      CHECK(fewer(raced, slow >> rrt, problem) >= many);
      CHECK(fewer(raced, rrt, problem) >= many);
    }
    THEN("whoever knows the quick one spends fewer without a race") {
      CHECK(fewer(quick >> rrt, raced, problem) >= many);
    }
  }
}
