// SPDX-License-Identifier: GPL-3.0-or-later
// Starts and goals of manipulators are decided by the shapes of the links, and covers are fitted to them.
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include <trellis/base/random.hpp>
#include <trellis/collision/checker.hpp>
#include <trellis/collision/spatial/separation.hpp>
#include <trellis/instance/end_fault.hpp>
#include <trellis/instance/link_shapes.hpp>
#include <trellis/scene/spatial/manipulator_scene.hpp>
#include <trellis/strategy/checks.hpp>

#include "support/catch.hpp"
#include "support/fault.hpp"
#include "support/six_arm.hpp"

using namespace trellis;
using Catch::Matchers::Contains;
using test::drawn;

namespace {

Vec3 unit(const Vec3& a) { return (1.0 / norm(a)) * a; }

/// A chain of links of one shape each, a little beyond joints about random axes.
template <class Shape>
SphereModel chain_of(Stream& stream, const Shape& shape) {
  constexpr std::size_t count = 4;
  std::vector<Link> links = {{"base", {{shape(), {}}}}};
  std::vector<Joint> joints;
  for (std::size_t i = 1; i <= count; ++i) {
    links.push_back(
        {"link" + std::to_string(i), {{shape(), {drawn(stream, -0.05, 0.05), rotation_of(drawn(stream, -1.0, 1.0))}}}});
    joints.push_back({.name = "joint" + std::to_string(i),
                      .kind = Joint::Kind::revolute,
                      .parent = i - 1,
                      .child = i,
                      .origin = {drawn(stream, -0.15, 0.15), rotation_of(drawn(stream, -1.0, 1.0))},
                      .axis = unit(drawn(stream, -1.0, 1.0)),
                      .lo = -2.0,
                      .hi = 2.0});
  }
  return SphereModel(Manipulator(KinematicTree("chain", std::move(links), std::move(joints)), {0, 1, 2, 3}));
}

World3 world_of_boxes(Stream& stream) {
  std::vector<Obstacle3> obstacles;
  for (int i = 0; i < 6; ++i) {
    obstacles.push_back(
        {"box " + std::to_string(i),
         {Cuboid{drawn(stream, 0.05, 0.3)}, {drawn(stream, -0.6, 0.6), rotation_of(drawn(stream, -2.0, 2.0))}}});
  }
  return {{{-3, -3, -3}, {3, 3, 3}}, std::move(obstacles), Contain::none};
}

/// Where the links of a chain are: with the parent's pose, the joint's origin and its turn.
std::vector<Pose3> poses_of(const SphereModel& robot, View q) {
  std::vector<Pose3> poses = {robot.base()};
  for (const Joint& joint : robot.robot().tree().joints()) {
    poses.push_back(poses[joint.parent] * joint.origin * Pose3{{}, rotation_of(q[joint.child - 1] * joint.axis)});
  }
  return poses;
}

/// The least value of a convex function on [0, 1].
template <class F>
double least_of(const F& f) {
  double lo = 0.0, hi = 1.0;
  for (int i = 0; i < 60; ++i) {
    const double a = lo + (hi - lo) / 3.0;
    const double b = hi - (hi - lo) / 3.0;
    (f(a) <= f(b) ? hi : lo) = f(a) <= f(b) ? b : a;
  }
  return f(0.5 * (lo + hi));
}

Vec3 on_axis(const Capsule& capsule, const Pose3& pose, double t) {
  return pose({0.0, 0.0, (t - 0.5) * capsule.length});
}

double box_distance(const Cuboid& box, const Pose3& pose, const Vec3& p) {
  const Vec3 at = pose.inverse()(p);
  const auto beyond = [](double x, double size) { return std::max(std::abs(x) - 0.5 * size, 0.0); };
  return norm({beyond(at.x, box.size.x), beyond(at.y, box.size.y), beyond(at.z, box.size.z)});
}

/// The distance of two shapes, at most 0 just where they meet: of boxes along separating axes, of capsules that of
/// their segments, which is convex.
double gap(const Solid& a, const Solid& b) {
  const auto* capsule = std::get_if<Capsule>(&a.shape);
  if (capsule == nullptr) return separation_gap(a, {a.pose.position, {}, {1, 0, 0}, 0.0}, b).middle;
  if (const auto* box = std::get_if<Cuboid>(&b.shape)) {
    return least_of([&](double t) { return box_distance(*box, b.pose, on_axis(*capsule, a.pose, t)); }) -
           capsule->radius;
  }
  const auto& other = std::get<Capsule>(b.shape);
  return least_of([&](double t) {
           const Vec3 p = on_axis(*capsule, a.pose, t);
           return least_of([&](double u) { return norm(p - on_axis(other, b.pose, u)); });
         }) -
         capsule->radius - other.radius;
}

struct Gaps {
  double robot = std::numeric_limits<double>::infinity();  ///< between its links
  double world = std::numeric_limits<double>::infinity();
};
Gaps gaps_of(const ManipulatorScene& scene, View q) {
  const std::vector<Link>& links = scene.robot.robot().tree().links();
  const std::vector<Pose3> poses = poses_of(scene.robot, q);
  const auto placed = [&](std::size_t l) {
    return Solid{links[l].solids[0].shape, poses[l] * links[l].solids[0].pose};
  };
  Gaps gaps;
  for (std::size_t a = 0; a < links.size(); ++a) {
    for (const Obstacle3& obstacle : scene.world.obstacles()) {
      gaps.world = std::min(gaps.world, gap(placed(a), obstacle.solid));
    }
    for (std::size_t b = a + 2; b < links.size(); ++b) {
      gaps.robot = std::min(gaps.robot, gap(placed(a), placed(b)));
    }
  }
  return gaps;
}

Problem problem_of(SphereModel robot, World3 world, Configuration start, std::vector<Configuration> goals) {
  Problem problem;
  problem.name = "p";
  problem.scene = std::make_shared<const ManipulatorScene>(std::move(world), std::move(robot));
  problem.space = problem.scene->default_space(1.0);
  problem.collision = "spheres";
  problem.start = std::move(start);
  problem.goals = std::move(goals);
  return problem;
}

bool valid(const Problem& problem, View q) {
  return make_checker(problem.collision, problem.scene, problem.space, problem.resolution)->valid(q);
}

/// A slider along x with a box that ends 0.1 m beyond its frame, and a board whose face is at x = 1.
Problem slider(double start, double goal, const std::string& board = "board") {
  std::vector<Link> links = {{"base", {}}, {"hand", {{Cuboid{{0.2, 0.02, 0.02}}, {}}}}};
  std::vector<Joint> joints = {{.name = "slide",
                                .kind = Joint::Kind::prismatic,
                                .parent = 0,
                                .child = 1,
                                .axis = {1, 0, 0},
                                .lo = 0.0,
                                .hi = 2.0}};
  SphereModel robot(Manipulator(KinematicTree("slider", std::move(links), std::move(joints)), {0}));
  World3 world({{-3, -3, -3}, {3, 3, 3}}, {{board, {Cuboid{{0.2, 1, 1}}, {{1.1, 0, 0}, {}}}}}, Contain::none);
  return problem_of(std::move(robot), std::move(world), {start}, {{goal}});
}

}  // namespace

TEST_CASE("the shapes of links decide as a second implementation does", "[robot]") {
  int contacts = 0, free = 0;
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    Stream stream(seed, "link shapes", "");
    const SphereModel robot =
        seed % 2 == 0 ? chain_of(stream, [&] { return Cuboid{drawn(stream, 0.04, 0.15)}; }) : chain_of(stream, [&] {
          return Capsule{stream.uniform(0.02, 0.06), stream.uniform(0.02, 0.1)};
        });
    const auto scene = std::make_shared<const ManipulatorScene>(world_of_boxes(stream), robot);
    ShapeChecker shapes(scene);
    for (int i = 0; i < 50; ++i) {
      Configuration q(4);
      for (double& x : q) x = stream.uniform(-2.0, 2.0);
      const Gaps gaps = gaps_of(*scene, q);
      const double least = std::min(gaps.robot, gaps.world);
      constexpr double rounding = 1e-5;
      if (std::abs(least) < rounding) continue;
      const ShapeReport report = shapes.at(q);
      INFO("seed " << seed << ", configuration " << i << ", gap " << least);
      REQUIRE(report.contact.has_value() == (least < 0.0));
      ++(report.contact ? contacts : free);
      if (report.contact) {
        CHECK(report.contact->obstacle.has_value() == (gaps.world < 0.0));
      } else {
        // The share of a cover differs from half of a distance by at most what a large box needs more than a small one.
        constexpr double coarsest = 0.003;
        for (const double room : report.room) CHECK((std::isinf(room) || room >= 0.49 * least - coarsest));
      }
    }
  }
  CHECK(contacts > 100);
  CHECK(free > 100);
}

TEST_CASE("covers are fitted to ends just where the shapes are far enough from everything", "[robot]") {
  constexpr double finest = 0.001;
  int fitted = 0, refused = 0;
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    Stream stream(seed, "fitted covers", "");
    const SphereModel robot = chain_of(stream, [&] {
      return Capsule{stream.uniform(0.02, 0.06), stream.uniform(0.02, 0.1)};
    });
    const World3 world = world_of_boxes(stream);
    Configuration q(4);
    for (int i = 0; i < 80; ++i) {
      for (double& x : q) x = stream.uniform(-2.0, 2.0);
      Problem problem = problem_of(robot, world, q, {q});
      if (valid(problem, q)) continue;
      const Gaps gaps = gaps_of(*problem.scene->manipulator(), q);
      const EndFault fault = EndChecker(problem).fault(q);
      REQUIRE_FALSE(fault.text.empty());
      const auto pairs = problem.scene->manipulator()->robot.may_touch();
      const std::vector<std::string> texts = fit_covers(problem);
      INFO("seed " << seed << ", configuration " << i << ", gaps " << gaps.robot << " and " << gaps.world);
      CHECK(valid(problem, q) == fault.fits);
      CHECK(texts.size() == (fault.fits ? 1 : 0));
      CHECK(problem.scene->manipulator()->robot.may_touch() == pairs);
      if (gaps.world > 1.01 * finest && gaps.robot > 2.02 * finest) CHECK(fault.fits);
      if (gaps.world < 0.99 * finest || gaps.robot < 1.98 * finest) CHECK_FALSE(fault.fits);
      ++(fault.fits ? fitted : refused);
    }
  }
  CHECK(fitted > 20);
  CHECK(refused > 20);
}

SCENARIO("a goal that is nearer to an obstacle than balls protrude", "[robot]") {
  GIVEN("a hand whose goal is 4 mm from a board") {
    Problem problem = slider(0.5, 0.896);
    CHECK_FALSE(valid(problem, problem.goal()));
    CHECK_THAT(EndChecker(problem).fault(problem.goal()).text,
               Contains("board") && Contains("by its covers alone: its shapes touch nothing"));
    WHEN("its covers are fitted") {
      const std::vector<std::string> texts = fit_covers(problem);
      THEN("start and goal are valid, and the text names the link") {
        CHECK(valid(problem, problem.start));
        CHECK(valid(problem, problem.goal()));
        REQUIRE(texts.size() == 1);
        CHECK_THAT(texts.front(), Contains("problem 'p'") && Contains("'hand' is covered by"));
        CHECK(problem.scene->manipulator()->robot.excess() < 0.004);
        CHECK_NOTHROW(check(problem));
      }
      THEN("a contact of the shapes is one still") {
        CHECK_FALSE(valid(problem, Configuration{0.9001}));
        CHECK(fit_covers(problem).empty());
      }
    }
  }
  GIVEN("a goal 0.3 mm from the board") {
    Problem problem = slider(0.5, 0.8997);
    THEN("it is refused, and the message says how near the shapes come") {
      CHECK(fit_covers(problem).empty());
      CHECK_THAT(test::fault_of([&] { check(problem); }),
                 Contains("board") && Contains("by its covers alone: its shapes come as near as 0.03 cm"));
    }
  }
  GIVEN("a goal in contact") {
    Problem problem = slider(0.5, 0.95);
    THEN("the message names the obstacle, and no covers are made") {
      CHECK(fit_covers(problem).empty());
      const std::string text = test::fault_of([&] { check(problem); });
      CHECK_THAT(text, Contains("in collision with") && Contains("board") && !Contains("covers"));
    }
  }
  GIVEN("a problem that needs nothing") {
    Problem problem = slider(0.2, 0.5);
    const auto scene = problem.scene;
    THEN("it stays as it is") {
      CHECK(fit_covers(problem).empty());
      CHECK(problem.scene == scene);
    }
  }
}
