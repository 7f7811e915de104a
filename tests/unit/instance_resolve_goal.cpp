// SPDX-License-Identifier: GPL-3.0-or-later
// Goals of a goal region.
#include <trellis/base/error.hpp>
#include <trellis/collision/checker.hpp>
#include <trellis/instance/resolve_goal.hpp>
#include <trellis/scene/planar/scene.hpp>

#include "support/catch.hpp"
#include "support/worlds.hpp"

using namespace trellis;

namespace {

Problem reaching(const Box2& box) {
  const Arm arm{.links = {2, 2, 1}, .widths = {0.2, 0.2, 0.2}, .base = {5, 1}};
  Problem problem =
      test::make_problem("reaching", test::rectangle_world({{3, 4, 4, 7}}), Robot::arm(arm), {1.5, 0.2, 0.2}, {});
  problem.reach = Reach{2, {1, 0}, box};
  return problem;
}

void check_resolved(const Problem& problem) {
  REQUIRE(problem.space.contains(problem.goal()));
  CHECK(reaches(planar(*problem.scene).robot, *problem.reach, problem.goal()));
  CHECK(make_checker("planar", problem.scene, problem.space, 0.05)->valid(problem.goal()));
}

}  // namespace

TEST_CASE("a goal is chosen that reaches its box, and is valid", "[instance][goal]") {
  Problem problem = reaching({{6, 4}, {6.4, 4.4}});
  resolve_goal(problem);
  check_resolved(problem);
  Problem again = reaching({{6, 4}, {6.4, 4.4}});
  resolve_goal(again);
  CHECK(again.goal() == problem.goal());
}

TEST_CASE("a box out of reach, or within an obstacle, is an error", "[instance][goal]") {
  Problem far = reaching({{9, 9}, {9.5, 9.5}});
  CHECK_THROWS_WITH(resolve_goal(far), Catch::Contains("brings link 3 into the box (9, 9) to (9.5, 9.5)"));
  Problem inside = reaching({{3.2, 4.5}, {3.6, 4.8}});
  CHECK_THROWS_AS(resolve_goal(inside), Error);
  Problem plain = test::cup_problem();
  const Configuration goal = plain.goal();
  resolve_goal(plain);
  CHECK(plain.goal() == goal);
}
