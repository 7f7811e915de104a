// SPDX-License-Identifier: GPL-3.0-or-later
// Arms, and guides that drop their joints, in the language.
#include <string>

#include "support/catch.hpp"
#include "support/script.hpp"

using namespace trellis;
using Catch::Matchers::Contains;
using test::failure;
using test::value;

namespace {

const std::string arm = "robot.arm { links = {1, 1, 1}, width = 0.1, base = {5, 5}, limits = { {-3, 2}, false } }";

std::string problem_of(const std::string& robot, const std::string& ends) {
  return "problem { name = 'p', world = world { bounds = {0, 0, 10, 10} }, robot = " + robot + ", " + ends + " }";
}

Problem problem(const std::string& expression) {
  return dsl::Session("").load("return rrt {}, " + expression, "test.lua").experiment.problems.front();
}

}  // namespace

TEST_CASE("an arm is a robot of links, with limits where they are given") {
  const Problem p = problem(problem_of(arm, "start = {0, 0, 0}, goal = {1, 1, 1}"));
  CHECK(p.space.name() == "R x SO(2)^2");
  CHECK(p.space.axes()[0].lo == -3.0);
  CHECK(p.space.axes()[0].hi == 2.0);
  CHECK(p.space.axes()[2].periodic);
  CHECK(planar(*p.scene).robot.base() == Vec2{5, 5});
  CHECK(planar(*p.scene).robot.pairs().size() == 1);
  CHECK(p.scene->bounding_radius() > 3.0);
  const Problem crossing = problem(
      problem_of("robot.arm { links = {1, 2, 1}, widths = {0.1, 0.2, 0.3}, base = {5, 5}, self_collision = false }",
                 "start = {0, 2.8, 2.8}, goal = {0, 0, 0}"));
  CHECK(planar(*crossing.scene).robot.pairs().empty());
  CHECK(value("robot.arm { links = {1} }") == "robot 'arm'");
}

TEST_CASE("limits of joints of more than a turn are lengths of their axes") {
  const Problem p =
      problem(problem_of("robot.arm { links = {1, 1}, base = {5, 5}, limits = { {math.rad(-270), math.rad(270)}, "
                         "{math.rad(-360), math.rad(360)} } }",
                         "start = {-4, 0}, goal = {4, -6}"));
  CHECK(p.space.name() == "R^2");
  CHECK(p.space.axes()[0].hi == Approx(4.712389));
  CHECK(p.space.axes()[1].lo == Approx(-6.283185));
  CHECK(p.start == Configuration{-4, 0});
  CHECK(p.goal() == Configuration{4, -6});
  CHECK_THAT(failure("robot.arm { links = {1}, limits = { {-270, 270} } }"),
             Contains("limits of joint 1") && Contains("math.rad"));
}

TEST_CASE("a start in which an arm meets itself names the links") {
  CHECK_THAT(failure("return " + problem_of(arm, "start = {0, 2.6, 2.6}, goal = {1, 1, 1}")),
             Contains("start (0, 2.6, 2.6) is in collision with itself (link 1 meets link 3)") &&
                 Contains("a valid configuration near by is"));
  CHECK_THAT(failure("return " + problem_of(arm, "start = {0, 0, 0}, goal = {2.5, 0, 0}")),
             Contains("goal is out of bounds: theta = 2.5, expected it in [-3, 2]"));
}

TEST_CASE("errors in an arm are reported") {
  CHECK_THAT(failure("robot.arm { width = 1 }"), Contains("links"));
  CHECK_THAT(failure("robot.arm { links = {1, -1} }"), Contains("length of link 2") && Contains("got -1"));
  CHECK_THAT(failure("robot.arm { links = {1, 1}, widths = {0.1} }"), Contains("2 links and 1 widths"));
  CHECK_THAT(failure("robot.arm { links = {1}, limits = { {1, 0} } }"), Contains("limits of joint 1"));
  CHECK_THAT(failure("robot.arm { links = {1}, limits = { {1} } }"), Contains("limits"));
  CHECK_THAT(failure("robot.arm { links = {1}, limits = 3 }"), Contains("limits"));
  CHECK_THAT(failure("robot.arm { links = {1}, base = {1} }"), Contains("base"));
  CHECK_THAT(failure("robot.arm { links = {1}, link = {1} }"), Contains("link"));
}

TEST_CASE("joints are named by their axes or their numbers") {
  CHECK(value("joints { 'theta', 'theta3' }") == "joints(\"theta\", \"theta3\")");
  CHECK(value("joints { 1, 3 }") == "joints(\"1\", \"3\")");
  CHECK(value("joints { first = 1 }") == "joints { first = 1 }");
  CHECK_THAT(failure("joints { {} }"), Contains("joints: expected a name"));
  CHECK_THAT(failure("joints { 1.5 }"), Contains("joints: expected a name, got 1.5"));
}
