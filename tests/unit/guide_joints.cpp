// SPDX-License-Identifier: GPL-3.0-or-later
// Some of the degrees of freedom: which robot is left, and what is valid for it.
#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include <trellis/base/error.hpp>
#include <trellis/guide/guide.hpp>

#include "support/catch.hpp"
#include "support/worlds.hpp"

using namespace trellis;
using Catch::Matchers::Contains;

namespace {

constexpr std::size_t all_links = 4;

/// The first `links` of an arm of four.
Robot arm_of(std::size_t links) {
  Arm arm{.links = {1.5, 1.2, 1.2, 0.8}, .widths = {0.2, 0.2, 0.1, 0.1}, .base = {5, 5}};
  arm.links.resize(links);
  arm.widths.resize(links);
  return Robot::arm(arm);
}

Problem arm_problem() {
  return test::make_problem("arm", test::rectangle_world({{6.5, 6, 8, 8}, {2, 2, 4, 3.5}}), arm_of(all_links),
                            {1.8, 0.3, 0.3, 0}, {-0.8, -0.4, 0.5, 0});
}

std::unique_ptr<Guide> guide_of(const std::vector<Options::Entry>& options) {
  const GuideKind& kind = *find_guide("joints");
  return kind.make(Options::validate(*kind.component, options));
}

std::unique_ptr<Guide> keeping(const std::vector<std::string>& axes) { return guide_of({{"axes", axes}}); }

std::string fault_of(const std::vector<std::string>& axes, const Problem& problem) {
  try {
    const auto parent = make_instance(problem);
    static_cast<void>(keeping(axes)->project(*parent));
  } catch (const Error& e) {
    return e.what();
  }
  return "";
}

/// Of this many configurations of S, those in which it says otherwise than a checker of its own.
int differences(Instance& sub, const Robot& robot, const World& world) {
  const auto scene = std::make_shared<const Scene>(Scene{world, robot});
  const auto checker = make_checker("planar", scene, sub.space, sub.resolution);
  Stream stream(2, "joints", "differences");
  Configuration s(sub.space.dimension());
  int count = 0;
  for (int i = 0; i < 4000; ++i) {
    sub.space.sample_uniform(stream, s);
    count += sub.valid(s) == checker->valid(s) ? 0 : 1;
  }
  return count;
}

}  // namespace

TEST_CASE("without its last joints an arm is cut off", "[guide][joints]") {
  const auto problem = arm_problem();
  const auto parent = make_instance(problem);
  for (std::size_t links = 1; links <= all_links; ++links) {
    CAPTURE(links);
    const auto guide = guide_of({{"first", static_cast<std::int64_t>(links)}});
    const auto sub = guide->project(*parent);
    REQUIRE(sub->space.dimension() == links);
    CHECK(sub->scene->robot.bodies().size() == links);
    CHECK(sub->scene->robot.pairs() == arm_of(links).pairs());
    CHECK(differences(*sub, arm_of(links), problem.scene->world) == 0);
  }
}

TEST_CASE("a joint in the middle takes what hangs on it along", "[guide][joints]") {
  const auto problem = arm_problem();
  const auto parent = make_instance(problem);
  for (const auto& axes : std::vector<std::vector<std::string>>{{"theta", "theta3"}, {"4", "1"}}) {
    const auto sub = keeping(axes)->project(*parent);
    REQUIRE(sub->space.dimension() == 2);
    CHECK(sub->space.axes()[0].name == "theta");
    // Whatever the other angle is, the first link is all that is looked at.
    Stream stream(1, "joints", "middle");
    const auto link = std::make_shared<const Scene>(Scene{problem.scene->world, arm_of(1)});
    const auto checker = make_checker("planar", link, default_space(link->robot, link->world, 1.0), 0.05);
    for (int i = 0; i < 2000; ++i) {
      Configuration s(2);
      sub->space.sample_uniform(stream, s);
      REQUIRE(sub->valid(s) == checker->valid(View(s).first(1)));
    }
  }
}

TEST_CASE("without its angle a body is the largest disc inside it", "[guide][joints]") {
  const auto problem = test::simple_passage_problem();
  const auto parent = make_instance(problem);
  const auto sub = keeping({"x", "y"})->project(*parent);
  CHECK(sub->space.name() == "x, y of SE(2)");
  CHECK(sub->position_axes == std::vector<std::size_t>{0, 1});
  CHECK(differences(*sub, Robot::disc(0.1), problem.scene->world) == 0);
  CHECK(sub->start == Configuration{1, 8.5});
}

TEST_CASE("what joints cannot keep is told", "[guide][joints]") {
  CHECK_THAT(fault_of({"theta2"}, arm_problem()), Contains("nothing of the robot 'arm' is placed by theta2 alone"));
  CHECK_THAT(fault_of({"x", "theta"}, test::cup_problem()), Contains("keep x and y too"));
  CHECK_THAT(fault_of({"thetta2"}, arm_problem()), Contains("no axis 'thetta2'") &&
                                                       Contains("theta, theta2, theta3, theta4") &&
                                                       Contains("did you mean 'theta2'?"));
  CHECK_THAT(fault_of({"5"}, arm_problem()), Contains("no axis '5'") && Contains("(1 to 4)"));
  CHECK_THAT(fault_of({"theta", "1"}, arm_problem()), Contains("theta is there twice"));
}
