// SPDX-License-Identifier: GPL-3.0-or-later
// What dropping joints is good for, and where it misleads: validity checks of a run, all levels together, beside those
// of the same planner without it.
#include <algorithm>
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

PlannerSpec tree() { return PlannerSpec::make("rrt", {{"step", 0.1}}); }

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

Ratio compare(const GuideSpec& guide, const Problem& problem) {
  std::vector<double> ratios;
  ratios.reserve(seeds);
  for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
    ratios.push_back(spent(execute(StrategySpec(tree(), guide), problem, seed)) /
                     spent(execute(StrategySpec(tree()), problem, seed)));
  }
  std::sort(ratios.begin(), ratios.end());
  return {ratios[9], 0.5 * (ratios[14] + ratios[15]), ratios[20]};
}

GuideSpec first_two() { return GuideSpec::make("joints", {}, PlannerSpec::make("rrt_connect", {{"step", 0.1}})); }

}  // namespace

SCENARIO("the first joints of an arm guide the others", "[strategy][joints]") {
  GIVEN("an arm of two long links and a wrist of three short ones") {
    const Arm arm{.links = {2.2, 2.0, 0.3, 0.3, 0.3}, .widths = {0.2, 0.2, 0.1, 0.1, 0.1}, .base = {5, 5}};
    const Problem problem =
        test::make_problem("wrist", test::rectangle_world({{6.2, 7, 8.2, 8.2}, {6.8, 2.2, 8, 3.6}}), Robot::arm(arm),
                           {1.9, 0.4, 0.3, 0.3, 0.3}, {-0.9, -0.5, -0.3, -0.3, -0.3});
    THEN("fewer checks are spent than without, with 95 % confidence") {
      CHECK(compare(first_two(), problem).upper < 1.0);
    }
  }
}

SCENARIO("short first joints say little of the long link that hangs on them", "[strategy][joints]") {
  GIVEN("an arm of two short links and a long one") {
    const Arm arm{.links = {0.8, 0.8, 2.2}, .widths = {0.2, 0.2, 0.2}, .base = {5, 5}};
    const Problem problem =
        test::make_problem("hand", test::rectangle_world({{6.9, 5.6, 8.5, 8.2}, {6.8, 2.2, 8, 3.6}}), Robot::arm(arm),
                           {1.9, 0.4, 0.3}, {-0.9, -0.5, -0.3});
    THEN("more checks are spent than without, with 95 % confidence") {
      CHECK(compare(first_two(), problem).lower > 1.0);
    }
  }
}
