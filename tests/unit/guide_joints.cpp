// SPDX-License-Identifier: GPL-3.0-or-later
// A subset of the degrees of freedom: the reduced robot, and its validity.
#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

#include <trellis/base/error.hpp>
#include <trellis/guide/guide.hpp>
#include <trellis/guide/joint_ranges.hpp>
#include <trellis/scene/planar/scene.hpp>

#include "support/catch.hpp"
#include "support/fault.hpp"
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
  return test::fault_of([&] {
    const auto parent = make_instance(problem);
    static_cast<void>(keeping(axes)->project(*parent));
  });
}

/// The number of configurations of S, among this many, in which it differs from a separate checker.
int differences(Instance& sub, const Robot& robot, const World& world) {
  const auto scene = std::make_shared<const PlanarScene>(world, robot);
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
    CHECK(sub->scene->body_count() == links);
    CHECK(planar(*sub->scene).robot.pairs() == arm_of(links).pairs());
    CHECK(differences(*sub, arm_of(links), planar(*problem.scene).world) == 0);
  }
}

TEST_CASE("a joint in the middle moves the links that it carries", "[guide][joints]") {
  const auto problem = arm_problem();
  const auto parent = make_instance(problem);
  for (const auto& axes : std::vector<std::vector<std::string>>{{"theta", "theta3"}, {"4", "1"}}) {
    const auto sub = keeping(axes)->project(*parent);
    REQUIRE(sub->space.dimension() == 2);
    CHECK(sub->space.axes()[0].name == "theta");
    // At any other angle, it checks the first link only.
    Stream stream(1, "joints", "middle");
    const auto link = std::make_shared<const PlanarScene>(planar(*problem.scene).world, arm_of(1));
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
  CHECK(differences(*sub, Robot::disc(0.1), planar(*problem.scene).world) == 0);
  CHECK(sub->start == Configuration{1, 8.5});
}

TEST_CASE("joints that cannot be kept are reported", "[guide][joints]") {
  CHECK_THAT(fault_of({"theta2"}, arm_problem()), Contains("nothing of the robot 'arm' is placed by theta2 alone"));
  CHECK_THAT(fault_of({"x", "theta"}, test::cup_problem()), Contains("keep x and y too"));
  CHECK_THAT(fault_of({"thetta2"}, arm_problem()), Contains("no axis 'thetta2'") &&
                                                       Contains("theta, theta2, theta3, theta4") &&
                                                       Contains("did you mean 'theta2'?"));
  CHECK_THAT(fault_of({"5"}, arm_problem()), Contains("no axis '5'") && Contains("(1 to 4)"));
  CHECK_THAT(fault_of({"theta", "1"}, arm_problem()), Contains("theta is there twice"));
}

namespace {

/// The arm of `slit_problem`.
Arm slit_arm() { return {.links = {2, 3.5}, .widths = {0.2, 0.2}, .base = {2, 5}}; }

/// An arm of two links in a corridor with a slit below its base: the first link fits into it, and then the second one
/// has no room at any angle.
Problem slit_problem() {
  return test::make_problem("slit", test::rectangle_world({{0, 0, 1.6, 3.6}, {2.4, 0, 10, 3.6}, {0, 5.6, 10, 10}}),
                            Robot::arm(slit_arm()), {0, 0}, {0.1, -0.2});
}

std::shared_ptr<JointRanges> ranges_of(const Problem& problem, std::size_t slices) {
  const auto parent = make_instance(problem);
  return std::make_shared<JointRanges>(
      *parent, std::make_shared<AxisProjection>(parent->space, std::vector<std::size_t>{0}, "first"), slices);
}

}  // namespace

TEST_CASE("the free range of a joint is what slices of it are valid", "[guide][joints]") {
  constexpr std::size_t slices = 32;
  for (const Problem& problem : {slit_problem(), arm_problem()}) {
    CAPTURE(problem.name);
    const auto parent = make_instance(problem);
    const auto ranges = ranges_of(problem, slices);
    const double width = 2.0 * std::numbers::pi / slices;
    // An independent checker of the arm up to the joint, at the middles of slices.
    const auto scene = std::make_shared<const PlanarScene>(planar(*problem.scene).world,
                                                           problem.name == "slit" ? Robot::arm(slit_arm()) : arm_of(2));
    const auto checker = make_checker("planar", scene, default_space(planar(*scene).robot, planar(*scene).world, 1.0),
                                      parent->resolution);
    const auto middle = [&](std::size_t slice) {
      return -std::numbers::pi + (static_cast<double>(slice) + 0.5) * width;
    };
    Stream stream(4, "0", "ranges");
    std::size_t partly = 0;
    for (std::size_t first = 0; first < slices; ++first) {
      std::size_t free = 0;
      std::vector<char> valid;
      for (std::size_t k = 0; k < slices; ++k) {
        valid.push_back(checker->valid(Configuration{middle(first), middle(k)}) ? 1 : 0);
        free += valid.back() != 0 ? 1 : 0;
      }
      partly += free > 0 && free < slices ? 1 : 0;
      CHECK(ranges->open(Configuration{middle(first)}) == (free > 0));
      Configuration q(parent->space.dimension());
      q[0] = middle(first);
      for (int i = 0; i < 100; ++i) {
        const bool drawn = ranges->draw(0, stream, q);
        REQUIRE(drawn == (free > 0));
        if (drawn) CHECK(valid[ranges->slice(q, 1)] != 0);
      }
      for (std::size_t k = 0; k < slices; ++k) {
        q[1] = middle(k);
        const double uniform = static_cast<double>(slices) / static_cast<double>(std::max<std::size_t>(free, 1));
        CHECK(ranges->density_factor(0, q) == (free == 0 ? -1.0 : (valid[k] != 0 ? uniform : 0.0)));
      }
    }
    CHECK(partly > 0);
    // Each slice of two joints was checked at most once, and what the density asked for was not counted.
    const std::uint64_t checks = ranges->take_checks();
    CHECK(checks > slices);
    CHECK(checks <= slices * slices);
    CHECK(ranges->take_checks() == 0);
  }
}

TEST_CASE("values drawn from free ranges have the density that is claimed", "[guide][joints]") {
  const Problem problem = arm_problem();
  const auto parent = make_instance(problem);
  const auto ranges = ranges_of(problem, 12);
  const RangedProjection lift(ranges);
  Stream stream(8, "0", "fibre");
  Configuration q(all_links);
  constexpr std::size_t bins = 6;
  for (const double first : {0.7, -2.4, 2.0}) {
    CAPTURE(first);
    std::vector<double> drawn(bins * bins, 0.0);
    std::vector<double> expected(bins * bins, 0.0);
    const double uniform = std::exp(ranges->kept().log_fibre_density(parent->start));
    const auto bin = [&] {
      const auto part = [&](std::size_t axis) {
        const double share = (q[axis] + std::numbers::pi) / (2.0 * std::numbers::pi);
        return std::min(bins - 1, static_cast<std::size_t>(share * static_cast<double>(bins)));
      };
      return part(1) * bins + part(2);
    };
    constexpr int points = 30000;
    for (int i = 0; i < points; ++i) {
      lift.lift(Configuration{first}, stream, q);
      CHECK(q[0] == first);
      CHECK(parent->space.contains(q));
      drawn[bin()] += 1.0 / points;
      ranges->kept().lift(Configuration{first}, stream, q);
      const double density = std::exp(lift.log_fibre_density(q)) / uniform;
      CHECK(density > 0.0);
      expected[bin()] += density / points;
    }
    for (std::size_t k = 0; k < drawn.size(); ++k) CHECK(drawn[k] == Approx(expected[k]).margin(0.012));
  }
}

TEST_CASE("a slice of S without a free range of the next joint is invalid, and pays for being asked",
          "[guide][joints]") {
  const auto problem = slit_problem();
  const auto parent = make_instance(problem);
  const auto plain = guide_of({{"first", std::int64_t{1}}});
  const auto guide = guide_of({{"first", std::int64_t{1}}, {"slices", std::int64_t{64}}});
  const auto without = plain->project(*parent);
  const auto sub = guide->project(*parent);
  guide->attach(*sub);
  CHECK(sub->valid(sub->start));
  CHECK(sub->valid(sub->goal()));
  Stream stream(3, "0", "slices");
  Configuration s(1);
  int lost = 0;
  for (int i = 0; i < 2000; ++i) {
    sub->space.sample_uniform(stream, s);
    const bool valid = without->valid(s);
    if (!valid) CHECK_FALSE(sub->valid(s));
    lost += valid && !sub->valid(s) ? 1 : 0;
    if (valid && sub->valid(s)) CHECK(sub->motion(s, s).valid);
  }
  CHECK(sub->checks.validity > without->checks.validity);
  CHECK(without->checks.validity == 2000);
  // In the slit.
  s[0] = -0.5 * std::numbers::pi;
  CHECK(without->valid(s));
  CHECK_FALSE(sub->valid(s));
  CHECK_FALSE(sub->motion(sub->start, s).valid);
  CHECK(lost > 0);
  CHECK(lost < 400);
}
