// SPDX-License-Identifier: GPL-3.0-or-later
// Robots of links whose bases move: floating and sliding ones, bodies of space and robots of the plane as links, and
// teams of all of them.
#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include <trellis/base/random.hpp>
#include <trellis/collision/certificate.hpp>
#include <trellis/collision/checker.hpp>
#include <trellis/instance/manipulator_kinematics.hpp>
#include <trellis/scene/planar/scene.hpp>
#include <trellis/scene/spatial/linked_robot.hpp>
#include <trellis/scene/spatial/manipulator_scene.hpp>
#include <trellis/scene/spatial/scene.hpp>

#include "support/catch.hpp"
#include "support/six_arm.hpp"

using namespace trellis;
using Catch::Matchers::WithinAbs;
using test::drawn;
using test::six_arm;

namespace {

World3 world_of_solids(Stream& stream, int count) {
  std::vector<Obstacle3> obstacles;
  for (int i = 0; i < count; ++i) {
    const Pose3 pose{drawn(stream, -1.5, 1.5), normalised(rotation_of(drawn(stream, -2.0, 2.0)))};
    const Shape3 shape =
        i % 2 == 0 ? Shape3(Cuboid{drawn(stream, 0.1, 0.5)}) : Shape3(Sphere{stream.uniform(0.1, 0.3)});
    obstacles.push_back({"obstacle " + std::to_string(i + 1), {shape, pose}});
  }
  return {{{-2, -2, -2}, {2, 2, 2}}, std::move(obstacles)};
}

/// A body of spheres, which balls cover exactly.
Robot3 dumbbell(double length) {
  return {"dumbbell", {{Sphere{0.15}, {{-length, 0, 0}, {}}}, {Sphere{0.2}, {{length, 0.05, 0}, {}}}}, true};
}

/// A palm on a floating joint, and two fingers that one joint moves.
SphereModel hand() {
  std::vector<Link> links = {{"palm", {{Cuboid{{0.12, 0.08, 0.04}}, {}}}},
                             {"left", {{Capsule{0.015, 0.08}, {{0, 0, 0.06}, {}}}}},
                             {"right", {{Capsule{0.015, 0.08}, {{0, 0, 0.06}, {}}}}}};
  std::vector<Joint> joints = {{.name = "open",
                                .kind = Joint::Kind::prismatic,
                                .parent = 0,
                                .child = 1,
                                .origin = {{0.02, 0, 0.02}, {}},
                                .axis = {1, 0, 0},
                                .lo = 0.0,
                                .hi = 0.04},
                               {.name = "follow",
                                .kind = Joint::Kind::prismatic,
                                .parent = 0,
                                .child = 2,
                                .origin = {{-0.02, 0, 0.02}, {}},
                                .axis = {-1, 0, 0},
                                .lo = 0.0,
                                .hi = 0.04,
                                .mimic = Joint::Mimic{0}}};
  const KinematicTree tree = KinematicTree("hand", links, joints).on_ground(Joint::Kind::floating);
  std::vector<std::size_t> moving;
  for (std::size_t j = 0; j < tree.joints().size(); ++j) {
    if (tree.joints()[j].width() > 0) moving.push_back(j);
  }
  return SphereModel(Manipulator(tree, moving));
}

Robot planar_arm() { return Robot::arm({.links = {0.8, 0.6, 0.5}, .widths = {0.1, 0.1, 0.08}, .base = {-0.4, 0.2}}); }

/// An arm, a disc and a body: all kinds of roots.
SphereModel mixed_team() {
  std::vector<SphereModel> robots = upright(planar_arm(), 0.3);
  robots.push_back(upright(Robot::disc(0.2), 0.5).front());
  robots.push_back(linked(dumbbell(0.3)).front());
  return SphereModel::team(robots);
}

/// The centres of all balls in the world.
std::vector<Vec3> centres(const SphereModel& model, View q) {
  std::vector<Pose3> poses;
  model.robot().poses(q, poses);
  std::vector<Vec3> all;
  for (std::size_t b = 0; b < poses.size(); ++b) {
    for (const BodySphere& ball : model.bodies()[b]) all.push_back(model.base()(poses[b](ball.centre)));
  }
  return all;
}

}  // namespace

TEST_CASE("a body of spheres as links is checked as the body is", "[collision][robot]") {
  Stream stream(1, "bodies", "links");
  for (int round = 0; round < 4; ++round) {
    const World3 world = world_of_solids(stream, 6);
    const std::vector<Robot3> bodies = {dumbbell(0.3), dumbbell(0.1)};
    const bool team = round % 2 == 1;
    const Robot3 whole = team ? Robot3::team(bodies) : bodies.front();
    const SphereModel model = team ? SphereModel::team(linked(whole)) : linked(whole).front();
    const auto scene = std::make_shared<SpatialScene>(world, whole);
    const auto tree = std::make_shared<ManipulatorScene>(world, model);
    const Space space = tree->own_space();
    REQUIRE(space.dimension() == scene->robot_dimension());
    const auto expected = make_checker("fcl", scene, scene->own_space(), 0.05);
    const auto found = make_checker("spheres", tree, space, 0.05);
    Configuration a(space.dimension()), b(space.dimension());
    int valid = 0, differ = 0;
    for (int i = 0; i < 400; ++i) {
      space.sample_uniform(stream, a);
      space.sample_uniform(stream, b);
      REQUIRE_THAT(space.distance(a, b), WithinAbs(scene->own_space().distance(a, b), 1e-9));
      // What touches within rounding may differ.
      if (expected->valid(a) != found->valid(a)) ++differ;
      if (!found->valid(a)) continue;
      ++valid;
      REQUIRE(expected->most_checks(a, b) == found->most_checks(a, b));
      const MotionReport one = expected->motion(a, b), other = found->motion(a, b);
      if (one.valid != other.valid || one.checks != other.checks) ++differ;
    }
    CHECK(valid > 20);
    CHECK(differ == 0);
  }
}

TEST_CASE("no ball moves farther than the bound of a robot whose base moves", "[collision][robot]") {
  Stream stream(2, "bases", "bounds");
  for (const SphereModel& model : {hand(), mixed_team(), linked(dumbbell(0.4)).front()}) {
    const Manipulator& robot = model.robot();
    const ManipulatorScene scene(World3({{-2, -2, -2}, {2, 2, 2}}, {}), model);
    const Space space = scene.own_space();
    Configuration a(space.dimension()), b(space.dimension()), q(space.dimension()), change(space.dimension());
    for (int i = 0; i < 200; ++i) {
      space.sample_uniform(stream, a);
      space.sample_uniform(stream, b);
      robot.change(space, a, b, change);
      double bound = 0.0;
      for (std::size_t body = 0; body < robot.bodies().size(); ++body) {
        bound = std::max(bound, robot.displacement_bound(body, change));
      }
      std::vector<Vec3> before = centres(model, a);
      std::vector<double> length(before.size(), 0.0);
      constexpr int parts = 64;
      for (int k = 1; k <= parts; ++k) {
        space.interpolate(a, b, static_cast<double>(k) / parts, q);
        const std::vector<Vec3> now = centres(model, q);
        for (std::size_t c = 0; c < now.size(); ++c) length[c] += norm(now[c] - before[c]);
        before = now;
      }
      REQUIRE(*std::max_element(length.begin(), length.end()) <= bound * (1.0 + 1e-9));
    }
  }
}

TEST_CASE("certified motions of robots whose bases move are free throughout", "[collision][certificate]") {
  Stream stream(3, "bases", "certificates");
  int certified = 0, refuted = 0;
  for (const SphereModel& model : {hand(), mixed_team(), six_arm("arm", true)}) {
    const auto scene = std::make_shared<ManipulatorScene>(world_of_solids(stream, 5), model);
    const Space space = scene->own_space();
    const auto checker = make_checker("spheres", scene, space, 0.05);
    Configuration a(space.dimension()), b(space.dimension()), q(space.dimension());
    for (int i = 0; i < 400; ++i) {
      space.sample_uniform(stream, a);
      space.sample_uniform(stream, b);
      space.interpolate(a, b, 0.2, q);
      b = q;
      if (!checker->valid(a)) continue;
      Certificate certificate;
      checker->certify(a, b, certificate);
      bool free = true;
      for (int k = 0; k <= 500; ++k) {
        space.interpolate(a, b, k / 500.0, q);
        free = free && checker->valid(q);
      }
      if (certificate.refuted_at) {
        ++refuted;
        space.interpolate(a, b, *certificate.refuted_at, q);
        CHECK(checker->clearance(q) < 1e-6);
      } else {
        ++certified;
        CHECK(free);
      }
    }
  }
  CHECK(certified > 20);
  CHECK(refuted > 20);
}

TEST_CASE("kernels and single configurations agree about robots whose bases move", "[collision][robot]") {
  Stream stream(7, "bases", "kernels");
  int valid = 0, contacts = 0;
  for (const SphereModel& model : {hand(), mixed_team(), six_arm("arm", true)}) {
    const auto scene = std::make_shared<ManipulatorScene>(world_of_solids(stream, 5), model);
    const Space space = scene->own_space();
    const auto checker = make_checker("spheres", scene, space, 0.05);
    Configuration a(space.dimension()), b(space.dimension()), q(space.dimension());
    for (int i = 0; i < 300; ++i) {
      space.sample_uniform(stream, a);
      space.sample_uniform(stream, b);
      // Distances are computed ball by ball.
      REQUIRE(checker->valid(a) == (checker->clearance(a) > 0.0));
      REQUIRE(checker->valid(a) == !checker->contact(a));
      if (!checker->valid(a)) continue;
      const MotionReport report = checker->motion(a, b);
      std::uint32_t checks = 0;
      bool free = true;
      const std::uint32_t n = checker->most_checks(a, b);
      for (const std::uint32_t k : bisection_order(n)) {
        space.interpolate(a, b, static_cast<double>(k) / n, q);
        ++checks;
        free = checker->clearance(q) > 0.0;
        if (!free) break;
      }
      REQUIRE(report.valid == free);
      REQUIRE(report.checks == checks);
      (report.valid ? valid : contacts) += 1;
    }
  }
  CHECK(valid > 20);
  CHECK(contacts > 20);
}

TEST_CASE("a robot of the plane stands in space where it is in the plane", "[scene][robot]") {
  Stream stream(4, "plane", "space");
  const std::vector<Robot> robots = {
      Robot::disc(0.3), Robot::rigid({Polygon{{{0, 0}, {0.6, 0}, {0.2, 0.5}}}}),
      Robot::rigid({Box2{{-0.3, -0.1}, {0.3, 0.1}}}), planar_arm(),
      Robot("bird", {Body{.parts = {Disc{{}, 0.2}}, .angle_axis = 2},
                     Body{.parts = {Disc{{0.3, 0}, 0.1}}, .parent = 0, .joint = {0.2, 0.1}, .angle_axis = 3}})};
  for (const Robot& robot : robots) {
    INFO(robot.name());
    const SphereModel model = upright(robot, 0.5).front();
    REQUIRE(model.robot().dimension() == robot.dimension());
    const World plane({{-2, -2}, {2, 2}}, {});
    const Space space = default_space(robot, plane, 1.0);
    const ManipulatorScene scene(World3({{-2, -2, -2}, {2, 2, 2}}, {}), model);
    CHECK(scene.default_space(1.0).dimension() == space.dimension());
    Configuration q(space.dimension());
    std::vector<Pose2> frames(robot.bodies().size());
    for (int i = 0; i < 100; ++i) {
      space.sample_uniform(stream, q);
      robot.place(q, frames);
      for (std::size_t body = 0; body < frames.size(); ++body) {
        const auto& name = robot.bodies()[body].name;
        const auto link = model.robot().tree().find_link(name.empty() ? "body " + std::to_string(body + 1) : name);
        REQUIRE(link);
        const Pose3 pose = model.base() * model.robot().pose_of(*link, q);
        const Vec2 corner = frames[body]({0.7, 0.3});
        const Vec3 there = pose({0.7, 0.3, 0.25});
        CHECK_THAT(there.x, WithinAbs(corner.x, 1e-14));
        CHECK_THAT(there.y, WithinAbs(corner.y, 1e-14));
        CHECK_THAT(there.z, WithinAbs(0.25, 1e-14));
      }
    }
  }
  CHECK_THROWS_WITH(upright(Robot::point(), 0.5), Catch::Contains("a point has no height"));
  CHECK_THROWS_WITH(upright(Robot::disc(0.3), -1.0), Catch::Contains("must be a number > 0, got -1"));
  CHECK_THROWS_WITH(linked(Robot3::point()), Catch::Contains("nothing can touch it"));
}

TEST_CASE("what stands in space without contact is without contact in the plane", "[collision][robot]") {
  Stream stream(5, "plane", "walls");
  const std::vector<Robot> team = {planar_arm(), Robot::disc(0.2), Robot::rigid({Box2{{-0.3, -0.1}, {0.3, 0.1}}})};
  const std::vector<Box2> walls = {{{0.4, 0.4}, {1.2, 0.9}}, {{-1.4, -1.2}, {-0.6, -0.7}}};
  std::vector<Obstacle> flat;
  std::vector<Obstacle3> solid;
  for (const Box2& box : walls) {
    flat.push_back({"", box});
    const Vec2 size = box.hi - box.lo, middle = 0.5 * (box.lo + box.hi);
    solid.push_back({"", {Cuboid{{size.x, size.y, 2.0}}, {{middle.x, middle.y, 0.5}, {}}}});
  }
  const auto plane = std::make_shared<PlanarScene>(World({{-2, -2}, {2, 2}}, flat), Robot::team(team));
  const auto space = std::make_shared<ManipulatorScene>(World3({{-2, -2, -1}, {2, 2, 1}}, solid),
                                                        SphereModel::team(upright(plane->robot, 0.5)));
  const auto in_plane = make_checker("planar", plane, plane->default_space(1.0), 0.05);
  const auto in_space = make_checker("spheres", space, space->default_space(1.0), 0.05);
  Configuration q(plane->robot_dimension());
  const Space sampled = plane->default_space(1.0);
  int both = 0, covers = 0;
  for (int i = 0; i < 2000; ++i) {
    sampled.sample_uniform(stream, q);
    const bool free = in_plane->valid(q);
    if (in_space->valid(q)) {
      ++both;
      REQUIRE(free);
    } else if (free) {
      ++covers;
      // Only what the balls protrude by, on both sides, is lost.
      CHECK(in_plane->clearance(q) <= 2.0 * space->robot.excess() + 1e-9);
    }
  }
  CHECK(both > 200);
  CHECK(covers < both / 4);
}

TEST_CASE("inverse kinematics brings a floating hand to a pose", "[instance][robot]") {
  Stream stream(6, "hand", "poses");
  const SphereModel model = hand();
  const ManipulatorScene scene(World3({{-2, -2, -2}, {2, 2, 2}}, {}), model);
  const Space space = scene.own_space();
  const std::size_t finger = model.robot().body_of(*model.robot().tree().find_link("left"));
  ManipulatorKinematics kinematics(model, space, {finger, {0, 0, 0.1}});
  Configuration q(space.dimension());
  int found = 0;
  for (int i = 0; i < 50; ++i) {
    space.sample_uniform(stream, q);
    const Pose3 target{drawn(stream, -1.5, 1.5), normalised(rotation_of(drawn(stream, -2.0, 2.0)))};
    if (!kinematics.bring(q, target, 1e-6, 1e-6)) continue;
    ++found;
    REQUIRE(space.contains(q));
    const Pose3 at = kinematics.frame(q);
    CHECK(norm(at.position - target.position) <= 1e-6);
    CHECK(angle_between(at.orientation, target.orientation) <= 1e-6);
  }
  CHECK(found >= 45);
}

TEST_CASE("a team of all kinds has the coordinates of its robots", "[scene][robot]") {
  const SphereModel team = mixed_team();
  const ManipulatorScene scene(World3({{-2, -2, -2}, {2, 2, 2}}, {}), team);
  const std::vector<TeamMember> members = scene.members();
  REQUIRE(members.size() == 3);
  CHECK(members[0].axes == std::vector<std::size_t>{0, 1, 2});
  CHECK(members[1].axes == std::vector<std::size_t>{3, 4});
  CHECK(members[2].axes == std::vector<std::size_t>{5, 6, 7, 8, 9, 10, 11});
  const std::vector<Axis> axes = scene.own_space().coordinates();
  CHECK(axes[3].name == "2/base.x");
  CHECK(axes[8].name == "3/base.rotation.x");
  const auto drone = scene.reduced(members[2].axes);
  REQUIRE(drone != nullptr);
  CHECK(drone->robot_dimension() == 7);
  CHECK(scene.reduced({5, 6, 7, 8}) == nullptr);
  const auto disc = scene.reduced({3, 4});
  REQUIRE(disc != nullptr);
  CHECK(disc->robot_dimension() == 2);
}

TEST_CASE("a joint that carries a robot moves its base", "[scene][robot]") {
  const std::vector<Link> links = {{"base", {}}, {"arm", {{Sphere{0.1}, {}}}}, {"hand", {{Sphere{0.1}, {}}}}};
  const std::vector<Joint> joints = {
      {.name = "lift", .kind = Joint::Kind::prismatic, .parent = 0, .child = 1, .lo = 0.0, .hi = 1.0},
      {.name = "free", .kind = Joint::Kind::floating, .parent = 1, .child = 2}};
  const KinematicTree tree("broken", links, joints);
  CHECK_THROWS_WITH(Manipulator(tree, {0, 1}), Catch::Contains("joint 'free' is floating and does not move the base"));
}
