// SPDX-License-Identifier: GPL-3.0-or-later
// Guides in the workspace, for arms with a fixed base: inverse kinematics is the lift.
#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <numbers>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include <trellis/guide/arm_projection.hpp>
#include <trellis/guide/guide.hpp>
#include <trellis/guide/path_steps.hpp>
#include <trellis/guide/pieces.hpp>
#include <trellis/guide/position.hpp>
#include <trellis/scene/planar/scene.hpp>

#include "support/catch.hpp"
#include "support/worlds.hpp"

using namespace trellis;

namespace {

constexpr double pi = std::numbers::pi;

Arm arm_of(const std::vector<double>& links) {
  return {.links = links, .widths = std::vector<double>(links.size(), 0.1), .base = {5, 5}};
}

Problem problem_of(const Robot& robot, const test::Rectangles& boxes = {}) {
  Configuration start(robot.dimension(), 0.4);
  Configuration goal(robot.dimension(), -0.4);
  return test::make_problem("arm", test::rectangle_world(boxes), robot, start, goal);
}

Problem problem_of(const std::vector<double>& links) { return problem_of(Robot::arm(arm_of(links))); }

/// A robot's tip where its last link ends on its own first axis.
Vec2 tip(const Robot& robot, View q, double last) {
  std::vector<Pose2> poses(robot.bodies().size());
  robot.place(q, poses);
  return poses.back()(Vec2{last, 0.0});
}

std::string why_not(const Robot& robot) {
  const auto problem = problem_of(robot);
  const auto instance = make_instance(problem);
  const auto chain = arm_chain(*instance);
  const auto* why = std::get_if<std::string>(&chain);
  return why == nullptr ? "" : *why;
}

/// The density of positions that are uniform on S.
class UniformPositions final : public Density {
 public:
  explicit UniformPositions(const Space& space) : height_(std::exp(-space.log_volume())) {}
  [[nodiscard]] double at(View) const override { return height_; }

 private:
  double height_;
};

}  // namespace

TEST_CASE("the position of an arm is that of its tip", "[guide][arm]") {
  const std::vector<double> links = {1.5, 1.0, 0.7};
  const auto problem = problem_of(links);
  const auto parent = make_instance(problem);
  const PositionProjection position("skeleton", *parent);
  Stream stream(1, "0", "tip");
  Configuration q(3);
  Configuration s(2);
  for (int i = 0; i < 100; ++i) {
    parent->space.sample_uniform(stream, q);
    position.project(q, s);
    CHECK(norm(Vec2{s[0], s[1]} - tip(planar(*problem.scene).robot, q, 0.7)) < 1e-12);
  }
}

TEST_CASE("angles in the world and bodies that do not turn are part of an arm", "[guide][arm]") {
  const auto link = [](double length, int axis, int parent, Vec2 joint) {
    Body body;
    body.parts = {Polygon{rectangle_vertices({{0, -0.05}, {length, 0.05}})}};
    body.angle_axis = axis;
    body.parent = parent;
    body.joint = joint;
    return body;
  };
  Body upper = link(1.2, 0, -1, {0.3, 0.2});
  Body bracket = link(0.5, -1, 0, {1.2, 0.4});  // at an angle on the upper link
  Body fore = link(1.1, 1, 1, {0.5, 0});
  fore.absolute = true;
  Body hand = link(0.6, 2, 2, {1.1, 0});
  const Robot robot("arm", {upper, bracket, fore, hand}, false, {5, 5});
  const auto problem = problem_of(robot);
  const auto parent = make_instance(problem);
  const PositionProjection position("skeleton", *parent);
  Stream stream(2, "0", "absolute");
  Configuration q(3);
  Configuration s(2);
  Configuration back(2);
  for (int i = 0; i < 100; ++i) {
    parent->space.sample_uniform(stream, q);
    position.project(q, s);
    CHECK(norm(Vec2{s[0], s[1]} - tip(robot, q, 0.6)) < 1e-12);
    position.lift(s, stream, q);
    position.project(q, back);
    CHECK(position.space().distance(s, back) < 1e-9);
  }
}

TEST_CASE("two links have two solutions, either as likely as the other", "[guide][arm]") {
  const auto problem = problem_of({1.5, 1.0});
  const auto parent = make_instance(problem);
  const PositionProjection position("skeleton", *parent);
  Stream stream(3, "0", "elbow");
  Configuration q(2);
  Configuration s = {6.2, 6.4};
  int up = 0;
  std::vector<Configuration> seen;
  constexpr int draws = 2000;
  for (int i = 0; i < draws; ++i) {
    position.lift(s, stream, q);
    up += q[1] > 0.0 ? 1 : 0;
    if (std::none_of(seen.begin(), seen.end(),
                     [&](const Configuration& other) { return parent->space.distance(other, q) < 1e-9; })) {
      seen.push_back(q);
    }
  }
  CHECK(seen.size() == 2);
  CHECK(std::abs(up - draws / 2) < 5 * std::sqrt(draws / 4.0));
}

TEST_CASE("what is drawn for a position brings the tip there, however many links there are", "[guide][arm]") {
  // The long first link leaves a disc about the base that the third arm does not reach.
  for (const auto& links : {std::vector<double>{1.5, 1.0}, {1, 1, 1, 1, 1}, {2.5, 0.6, 0.7}, {0.3, 0.4, 2.4, 0.2}}) {
    const auto problem = problem_of(links);
    const auto parent = make_instance(problem);
    const PositionProjection position("skeleton", *parent);
    const auto point = position.point_instance(*parent);
    Stream stream(4, "0", "fibre");
    Configuration q(links.size());
    Configuration s(2);
    Configuration back(2);
    double sum = 0.0;
    double longest = 0.0;
    for (const double length : links) {
      sum += length;
      longest = std::max(longest, length);
    }
    const double least = std::max(0.0, 2.0 * longest - sum);
    for (int i = 0; i < 2000; ++i) {
      position.space().sample_uniform(stream, s);
      const double r = norm(Vec2{s[0] - 5, s[1] - 5});
      const bool reached = r <= sum && r >= least;
      CHECK(point->valid(s) == reached);
      position.lift(s, stream, q);
      CHECK(parent->space.contains(q));
      position.project(q, back);
      if (reached) {
        CHECK(position.space().distance(s, back) < 1e-9);
      } else {
        // Somewhere in the same direction, or the opposite one.
        CHECK(std::abs(cross(Vec2{s[0] - 5, s[1] - 5}, Vec2{back[0] - 5, back[1] - 5})) < 1e-6);
      }
    }
  }
}

TEST_CASE("the density of lifted positions integrates to one and is that of the draws", "[guide][arm][density]") {
  for (const auto& links : {std::vector<double>{1.5, 1.0}, {1, 1, 1}, {2.5, 0.6, 0.7}, {0.5, 0.8, 0.6, 0.7}}) {
    for (const double weight : {1.0, 0.4}) {
      CAPTURE(links.size(), weight);
      auto problem = problem_of(links);
      auto axes = problem.space.axes();
      for (auto& axis : axes) axis.weight = weight;
      problem.space = Space(problem.space.name(), axes);
      const auto parent = make_instance(problem);
      const auto position = std::make_shared<const PositionProjection>("skeleton", *parent);
      REQUIRE(position->closed_form());
      const LiftedDensity density(position, 2, std::make_shared<UniformPositions>(position->space()));
      // Bins of the last two joints' angles.
      constexpr std::size_t cells = 5;
      constexpr int draws = 60000;
      const std::size_t n = links.size();
      const auto cell = [&](View q) {
        const auto part = [&](double angle) {
          return static_cast<std::size_t>(std::clamp((angle + pi) / (2 * pi) * cells, 0.0, cells - 1.0));
        };
        return part(q[n - 2]) * cells + part(q[n - 1]);
      };
      std::vector<double> drawn(cells * cells, 0.0);
      std::vector<double> expected(cells * cells, 0.0);
      std::vector<double> squares(cells * cells, 0.0);
      Stream stream(5, "0", "density");
      Configuration q(n);
      Configuration s(2);
      double whole = 0.0;
      double whole_squares = 0.0;
      for (int i = 0; i < draws; ++i) {
        position->space().sample_uniform(stream, s);
        position->lift(s, stream, q);
        drawn[cell(q)] += 1.0 / draws;
        parent->space.sample_uniform(stream, q);
        const double p = density.at(q) * std::exp(parent->space.log_volume());
        whole += p / draws;
        whole_squares += p * p / draws;
        expected[cell(q)] += p / draws;
        squares[cell(q)] += p * p / draws;
      }
      CHECK(std::abs(whole - 1.0) < 4.0 * std::sqrt((whole_squares - whole * whole) / draws));
      for (std::size_t i = 0; i < drawn.size(); ++i) {
        const double error = std::sqrt((squares[i] + drawn[i]) / draws) + 1.0 / draws;
        CHECK(std::abs(drawn[i] - expected[i]) < 5.0 * error);
      }
    }
  }
}

TEST_CASE("limits of joints are kept, and a position beyond them gives some configuration", "[guide][arm]") {
  Arm arm = arm_of({1.2, 1.2, 1.0, 0.8});
  arm.limits = {std::pair(-1.0, 2.0), std::pair(0.2, 2.0), std::nullopt, std::pair(-0.5, 0.5)};
  const auto problem = problem_of(Robot::arm(arm));
  const auto parent = make_instance(problem);
  const PositionProjection position("skeleton", *parent);
  CHECK_FALSE(position.closed_form());
  Stream stream(6, "0", "limits");
  Configuration q(4);
  Configuration s(2);
  Configuration back(2);
  for (int i = 0; i < 500; ++i) {
    parent->space.sample_uniform(stream, q);
    position.project(q, s);
    position.lift(s, stream, q);
    CHECK(parent->space.contains(q));
    position.project(q, back);
    CHECK(position.space().distance(s, back) < 1e-9);
    position.space().sample_uniform(stream, s);
    position.lift(s, stream, q);
    CHECK(parent->space.contains(q));
  }
}

TEST_CASE("points of a path are lifted to configurations that follow one another", "[guide][arm]") {
  const auto problem = problem_of({1, 1, 1, 1, 1});
  const auto parent = make_instance(problem);
  const PositionProjection position("skeleton", *parent);
  const PointLift lift = position.point_lift(*parent);
  Stream stream(7, "0", "follow");
  // Half a turn around the base, 3 m from it, in steps of about 0.1 m.
  constexpr int steps = 100;
  const auto at = [](int i) {
    const double angle = pi * i / steps;
    return Configuration{5 + 3 * std::cos(angle), 5 + 3 * std::sin(angle)};
  };
  Configuration previous(5);
  position.lift(at(0), stream, previous);
  Configuration q(5);
  Configuration s(2);
  for (int i = 1; i <= steps; ++i) {
    REQUIRE(lift(0, at(i), previous, at(std::min(i + 1, steps)), stream, q));
    position.project(q, s);
    CHECK(position.space().distance(s, at(i)) < 1e-4);
    // No joint turns by more than a tenth of a turn for a step of 0.1 m.
    for (std::size_t j = 0; j < q.size(); ++j) {
      CHECK(std::abs(std::remainder(q[j] - previous[j], 2 * pi)) < 0.2 * pi);
    }
    previous = q;
  }
  // Further attempts give other configurations, and there is an end to them.
  int attempts = 0;
  Configuration other(5);
  while (lift(attempts, at(0), previous, at(1), stream, other)) {
    CHECK(parent->space.contains(other));
    ++attempts;
  }
  CHECK(attempts > 10);
  CHECK(attempts < 100);
}

TEST_CASE("the skeleton of an arm's workspace ends where the arm's reach does", "[guide][arm][skeleton]") {
  const auto problem = problem_of(Robot::arm(arm_of({1, 1, 1})), {{6, 5.5, 7, 6.5}, {3, 3, 4, 4}});
  const auto parent = make_instance(problem);
  const auto guide = find_guide("skeleton")->make(Options::validate(*find_guide("skeleton")->component, {}));
  const auto sub = guide->project(*parent);
  REQUIRE(sub->graph);
  REQUIRE_FALSE(sub->graph->edges.empty());
  for (const auto& edge : sub->graph->edges) {
    for (std::size_t i = 0; i < edge.points.size(); ++i) {
      CHECK(norm(Vec2{edge.points[i][0] - 5, edge.points[i][1] - 5}) < 3.01);
    }
  }
  CHECK_FALSE(sub->valid(Configuration{5, 8.0001}));
  CHECK(sub->valid(Configuration{5, 7.9999}));
}

TEST_CASE("what has no tip that moves in the plane is refused with the reason", "[guide][arm]") {
  Body link;
  link.parts = {Polygon{rectangle_vertices({{0, -0.1}, {1, 0.1}})}};
  link.angle_axis = 0;
  Body second = link;
  second.parent = 0;
  second.joint = {1, 0};
  second.angle_axis = 1;
  Body beside = second;
  beside.angle_axis = 2;
  Body coupled = second;
  coupled.angle_axis = 0;
  Body wheel = second;
  wheel.parts = {Disc{{}, 0.2}};
  Body same = second;
  same.joint = {};
  CHECK(why_not(Robot("arm", {link, second}, false, {5, 5})).empty());
  CHECK(why_not(Robot("arm", {link}, false, {5, 5})) ==
        "the robot 'arm' has one joint, so that its tip stays on a circle");
  CHECK(why_not(Robot("arm", {link, second, beside}, false, {5, 5})) ==
        "the links of the robot 'arm' are no single chain");
  CHECK(why_not(Robot("arm", {link, coupled}, false, {5, 5})) == "joints of the robot 'arm' turn together");
  CHECK(why_not(Robot("arm", {link, wheel}, false, {5, 5})) ==
        "the last link of the robot 'arm' has its middle at its joint, and no tip");
  CHECK(why_not(Robot("arm", {link, same}, false, {5, 5})) == "two joints of the robot 'arm' are at one place");
  // The guides report this, and their requirements.
  const auto refusal = [](const std::string& name, const std::vector<Options::Entry>& given, const Robot& robot) {
    const auto problem = problem_of(robot);
    const auto parent = make_instance(problem);
    try {
      static_cast<void>(
          find_guide(name)->make(Options::validate(*find_guide(name)->component, given))->project(*parent));
    } catch (const std::exception& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  for (const std::string name : {"skeleton", "workspace", "decomposition"}) {
    CHECK(refusal(name, {}, Robot("arm", {link, second}, false, {5, 5})).empty());
    CHECK(
        refusal(name, {}, Robot("arm", {link}, false, {5, 5})) ==
        name +
            ": needs a robot whose reference point moves in the plane, or an arm of two links or more that is fixed to "
            "its base; the robot 'arm' has one joint, so that its tip stays on a circle");
  }
  CHECK(refusal("learned", {}, Robot("arm", {link, second}, false, {5, 5})) ==
        "learned: needs a robot whose reference point moves in the plane; this space (SO(2)^2) has no position");
  CHECK_THAT(refusal("workspace", {{"lift", std::string("handles")}}, Robot("arm", {link, second}, false, {5, 5})),
             Catch::Contains("decide where its tip is"));
}

TEST_CASE("limits of more than a turn: every turn of a joint is drawn, and brings the tip there", "[guide][arm]") {
  Arm arm = arm_of({1.5, 1.2});
  arm.limits = {std::pair(-2.0 * pi, 2.0 * pi), std::pair(-1.5 * pi, 1.5 * pi)};
  const auto problem = problem_of(Robot::arm(arm));
  const auto parent = make_instance(problem);
  const PositionProjection position("skeleton", *parent);
  Stream stream(8, "0", "turns");
  Configuration q(2);
  Configuration back(2);
  const Configuration s = {6.5, 5.8};
  std::array<int, 4> turns{};
  for (int i = 0; i < 400; ++i) {
    position.lift(s, stream, q);
    REQUIRE(parent->space.contains(q));
    position.project(q, back);
    CHECK(position.space().distance(s, back) < 1e-9);
    ++turns.at(static_cast<std::size_t>(std::floor(q[0] / pi) + 2.0));
  }
  // Both solutions have the first joint between -pi and pi, and again a turn away.
  for (const int drawn : turns) CHECK(drawn > 20);
}
