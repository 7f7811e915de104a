// SPDX-License-Identifier: GPL-3.0-or-later
// Robots of links and joints in space: their kinematics, what they carry, and guides through a point of theirs.
#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include <trellis/base/error.hpp>
#include <trellis/base/random.hpp>
#include <trellis/collision/checker.hpp>
#include <trellis/guide/position.hpp>
#include <trellis/instance/instance.hpp>
#include <trellis/instance/manipulator_kinematics.hpp>
#include <trellis/reader/robot_files.hpp>
#include <trellis/scene/spatial/manipulator_scene.hpp>
#include <trellis/scene/uncoupled.hpp>
#include <trellis/strategy/executor.hpp>
#include <trellis/strategy/spec.hpp>

#include "support/catch.hpp"
#include "support/folder.hpp"
#include "support/six_arm.hpp"

using namespace trellis;
using Catch::Matchers::Contains;
using test::six_arm;

namespace {

World3 world_with(std::vector<Obstacle3> obstacles) {
  return {{{-2, -2, -2}, {2, 2, 2}}, std::move(obstacles), Contain::none};
}

Obstacle3 ball(const Vec3& at, double radius) { return {"obstacle 1 (ball)", {Sphere{radius}, {at, {}}}}; }

Problem problem_of(const World3& world, const SphereModel& robot) {
  Problem problem;
  problem.name = "six";
  problem.scene = std::make_shared<ManipulatorScene>(world, robot);
  problem.space = problem.scene->default_space(1.0);
  problem.start = robot.states().at(0).q;
  problem.goals = {robot.states().at(1).q};
  problem.collision = "spheres";
  return problem;
}

}  // namespace

TEST_CASE("inverse kinematics brings a point, and a frame, where some configuration has it", "[robot]") {
  const SphereModel robot = six_arm();
  const Space space = ManipulatorScene(world_with({}), robot).default_space(1.0);
  const PointOnBody tool{robot.tip().body, robot.tip().point};
  ManipulatorKinematics kinematics(robot, space, tool);
  Stream stream(1, "0", "kinematics");
  Configuration target(space.dimension());
  Configuration q(space.dimension());
  int points = 0;
  int frames = 0;
  constexpr int tries = 500;
  for (int i = 0; i < tries; ++i) {
    space.sample_uniform(stream, target);
    space.sample_uniform(stream, q);
    const Pose3 pose = kinematics.frame(target);
    Configuration from = q;
    if (kinematics.bring(from, pose.position, 1e-5)) {
      ++points;
      CHECK(norm(robot.position(tool, from) - pose.position) <= 1e-5);
      CHECK(space.contains(from));
    }
    // From nearby, as along a path.
    from = target;
    for (double& x : from) x += 0.1 * stream.normal();
    space.reflect(from);
    if (kinematics.bring(from, pose, 1e-5, 1e-4)) {
      ++frames;
      const Pose3 found = kinematics.frame(from);
      CHECK(norm(found.position - pose.position) <= 1e-5);
      CHECK(norm(rotation_vector(found.orientation * pose.orientation.inverse())) <= 1e-4 + 1e-9);
    }
  }
  CHECK(points >= 0.7 * tries);
  CHECK(frames >= 0.8 * tries);
}

TEST_CASE("what a link carries collides, except with what it may touch", "[robot][collision]") {
  const SphereModel robot = six_arm();
  const std::size_t hand = *robot.robot().tree().find_link("hand");
  const Solid stick{Cylinder{0.02, 0.4}, {{0.3, 0, 0}, rotation_of({0, 1.5707963267948966, 0})}};
  const SphereModel with = robot.attached("stick", stick, hand, {});
  CHECK(with.robot().dimension() == robot.robot().dimension());
  CHECK(with.states().size() == robot.states().size());
  CHECK(with.robot().tree().find_link("stick"));
  CHECK_THROWS_WITH(with.attached("stick", stick, hand, {}), Contains("has a link 'stick' already"));
  const Configuration q = robot.states().front().q;
  // A ball at the stick's end, which the robot alone does not reach.
  const Vec3 end = robot.position({robot.robot().body_of(hand), robot.robot().pose_in_body(hand)({0.45, 0, 0})}, q);
  const auto valid = [&](const SphereModel& model) {
    const auto scene = std::make_shared<ManipulatorScene>(world_with({ball(end, 0.05)}), model);
    return make_checker("spheres", scene, scene->default_space(1.0), 0.05)->valid(q);
  };
  CHECK(valid(robot));
  CHECK_FALSE(valid(with));
  // Pairs of bodies: a shape that may touch a link is not checked against it.
  const std::size_t base = *robot.robot().tree().find_link("base");
  const SphereModel touching = robot.attached("stick", stick, hand, {base});
  CHECK(touching.pairs().size() <= with.pairs().size());
}

TEST_CASE("pairs that touch nearly everywhere may touch where no file says which", "[robot]") {
  const test::Folder folder;
  // The two outer links overlap at each configuration; the arm can fold back on its base.
  const std::string text =
      R"(<robot name="r"><link name="a"><collision><geometry><sphere radius="0.1"/></geometry></collision></link>
<link name="b"/><link name="c"><collision><geometry><sphere radius="0.1"/></geometry></collision></link>
<link name="d"/><link name="e"><collision><origin xyz="0.5 0 0"/><geometry><sphere radius="0.1"/></geometry></collision></link>
<joint name="j" type="revolute"><parent link="a"/><child link="b"/><axis xyz="0 0 1"/><limit lower="-1" upper="1"/></joint>
<joint name="k" type="revolute"><parent link="b"/><child link="c"/><axis xyz="0 0 1"/><limit lower="-1" upper="1"/></joint>
<joint name="l" type="revolute"><parent link="c"/><child link="d"/><origin xyz="0.5 0 0"/><axis xyz="0 0 1"/><limit lower="-3" upper="3"/></joint>
<joint name="m" type="revolute"><parent link="d"/><child link="e"/><axis xyz="0 0 1"/><limit lower="-1" upper="1"/></joint></robot>)";
  ManipulatorFiles files;
  files.urdf = folder.write("r.urdf", text);
  std::vector<std::string> warnings;
  const SphereModel robot = read_manipulator(files, warnings);
  const auto checked = [&](const std::string& a, const std::string& b) {
    return robot.checked(*robot.robot().tree().find_link(a), *robot.robot().tree().find_link(b));
  };
  CHECK_FALSE(checked("a", "c"));
  CHECK(checked("a", "e"));
}

TEST_CASE("a base that moves in the plane comes before the joints", "[robot]") {
  const SphereModel robot = six_arm("arm", true);
  CHECK(robot.robot().dimension() == 9);
  const Configuration q = {0.3, -0.2, 1.5707963267948966, 0, 0.1, 0.5, 0, 0.3, 0};
  const Configuration still = {0, 0, 0, 0, 0.1, 0.5, 0, 0.3, 0};
  const Vec3 moved = robot.tip_at(q);
  const Vec3 at = robot.tip_at(still);
  CHECK(norm(moved - Vec3{0.3 - at.y, -0.2 + at.x, at.z}) < 1e-12);
  const Space space = ManipulatorScene(world_with({}), robot).default_space(1.0);
  CHECK(space.axes()[0].name == "base.x");
  CHECK(space.axes()[2].periodic);
}

TEST_CASE("f of a manipulator is a point's position, and lifted positions have it", "[robot][guide]") {
  const Problem problem = problem_of(world_with({ball({1, 1, 1}, 0.2)}), six_arm());
  const auto instance = make_instance(problem);
  for (const std::vector<std::string>& link : {std::vector<std::string>{}, std::vector<std::string>{"tool"}}) {
    const PositionProjection projection("workspace", *instance, link);
    CHECK(projection.arm());
    Stream stream(1, "0", "lift");
    Configuration q(instance->space.dimension());
    Configuration s(3);
    Configuration again(3);
    int met = 0;
    constexpr int tries = 200;
    for (int i = 0; i < tries; ++i) {
      instance->space.sample_uniform(stream, q);
      projection.project(q, s);
      CHECK(projection.space().contains(s));
      projection.lift(s, stream, q);
      CHECK(instance->space.contains(q));
      projection.project(q, again);
      met += projection.space().distance(s, again) < 1e-3 ? 1 : 0;
    }
    CHECK(met >= 0.95 * tries);
  }
  CHECK_THROWS_WITH(PositionProjection("workspace", *instance, {"hnd"}),
                    Contains("has no such link (did you mean 'hand'?)"));
  CHECK_THROWS_WITH(PositionProjection("workspace", *instance, {"base"}),
                    Contains("link 'base'") && Contains("does not move"));
}

TEST_CASE("each guide that works in space guides a manipulator", "[robot][guide]") {
  const Problem problem = problem_of(world_with({ball({0.5, 0.6, 0.7}, 0.15), ball({0.3, -0.7, 0.4}, 0.2)}), six_arm());
  const PlannerSpec planner = PlannerSpec::make("rrt_connect", {{"proposals", 200000.0}});
  for (const char* name :
       {"workspace",        "skeleton",  "decomposition", "shrink",      "lazy",           "identity",
        "joints",           "pca",       "drop",          "widen",       "aggregate",      "uniform",
        "halton",           "goal_bias", "gaussian",      "bridge_test", "obstacle_based", "medial_axis",
        "information_gain", "informed"}) {
    CAPTURE(name);
    GuideSpec guide = std::string(name) == "joints"
                          ? GuideSpec::make(name, {{"axes", std::vector<std::string>{"turn", "lift", "elbow"}}})
                          : GuideSpec::make(name, {});
    const RunRecord run = execute(guide >> planner, problem, 1);
    CHECK(run.solved);
  }
}

TEST_CASE("rrt_connect grows the smaller tree of an arm, unless a script says otherwise", "[robot]") {
  const Problem problem = problem_of(world_with({ball({0.5, 0.6, 0.7}, 0.15), ball({0.3, -0.7, 0.4}, 0.2)}), six_arm());
  const auto nodes = [&](const std::vector<Options::Entry>& options) {
    const RunRecord run = execute(PlannerSpec::make("rrt_connect", options), problem, 1);
    CHECK(run.solved);
    return run.levels.front().search.nodes;
  };
  const Configurations automatic = nodes({});
  CHECK(std::ranges::equal(automatic.values(), nodes({{"grow", "smaller"}}).values()));
  CHECK_FALSE(std::ranges::equal(automatic.values(), nodes({{"grow", "in_turn"}}).values()));
}

TEST_CASE("a guide of a tip needs one arm, or the name of a link", "[robot][guide][team]") {
  const SphereModel team =
      SphereModel::team({six_arm().based_at({{-0.8, 0, 0}, {}}), six_arm().based_at({{0.8, 0, 0}, {}})});
  const Problem problem = problem_of(world_with({ball({0.0, 0.6, 0.7}, 0.15)}), team);
  const PlannerSpec planner = PlannerSpec::make("rrt_connect", {{"proposals", 200000.0}, {"bound", 0.0}});
  for (const std::string name : {"workspace", "skeleton"}) {
    CAPTURE(name);
    const GuideSpec tip = GuideSpec::make(name, {});
    CHECK_THROWS_WITH(execute(tip >> planner, problem, 1), Contains(name + ": the robot") && Contains("2 tips") &&
                                                               Contains("\"1/hand\", \"2/hand\"") &&
                                                               Contains("decouple"));
    const GuideSpec second = GuideSpec::make(name, {{"point", std::vector<std::string>{"2/hand"}}});
    CHECK(execute(second >> planner, problem, 1).solved);
    // The searches have one arm each.
    CHECK(execute(tip >> GuideSpec::make("decouple", {}) >> planner, problem, 1).solved);
    CHECK(execute(tip >> GuideSpec::make("team", {{"robots", std::vector<std::string>{"2"}}}) >> planner, problem, 1)
              .solved);
  }
}

TEST_CASE("two arms that are uncoupled are valid where each of them is alone", "[robot][team]") {
  const SphereModel team =
      SphereModel::team({six_arm().based_at({{-0.3, 0, 0}, {}}), six_arm().based_at({{0.3, 0, 0}, {}})});
  const Problem problem = problem_of(world_with({ball({0.0, 0.6, 0.7}, 0.15)}), team);
  const auto apart = uncoupled(*problem.scene, {{1, 2}});
  REQUIRE(apart);
  const auto checker_of = [&](const std::shared_ptr<const Scene>& scene, std::size_t from, std::size_t to) {
    const std::vector<Axis>& axes = problem.space.axes();
    const auto at = [&](std::size_t i) { return axes.begin() + static_cast<std::ptrdiff_t>(i); };
    return make_checker(problem.collision, scene, Space("arms", std::vector<Axis>(at(from), at(to))), 0.05);
  };
  const auto coupled = checker_of(problem.scene, 0, 12), passing = checker_of(apart, 0, 12);
  const auto first = checker_of(problem.scene->reduced({0, 1, 2, 3, 4, 5}), 0, 6);
  const auto second = checker_of(problem.scene->reduced({6, 7, 8, 9, 10, 11}), 6, 12);
  Stream stream(1, "uncoupled", "configurations");
  Configuration q(12);
  int touching = 0, invalid = 0;
  for (int i = 0; i < 3000; ++i) {
    problem.space.sample_uniform(stream, q);
    const bool alone = first->valid(View(q).first(6)) && second->valid(View(q).subspan(6));
    CHECK(passing->valid(q) == alone);
    if (!coupled->valid(q) && alone) ++touching;
    invalid += alone ? 0 : 1;
  }
  CHECK(touching > 100);
  CHECK(invalid > 100);
}

TEST_CASE("a guide searches its space for an arm with two trees, unless it or a script names a planner",
          "[robot][guide]") {
  const Problem problem = problem_of(world_with({ball({0.5, 0.6, 0.7}, 0.15)}), six_arm());
  const PlannerSpec root = PlannerSpec::make("rrt_connect", {{"bound", 0.0}});
  const GuideSpec smaller = GuideSpec::make("shrink", {});
  const GuideSpec hand = GuideSpec::make("workspace", {});
  const auto inner = [&](const StrategySpec& strategy) { return execute(strategy, problem, 1).levels.at(1).planner; };
  CHECK(inner(smaller >> root) == "rrt_connect");
  CHECK(inner(hand >> smaller >> root) == "rrt_connect");
  CHECK(inner(hand >> GuideSpec::make("lazy", {}) >> root) == "rrt");
  CHECK(inner(hand >> root) == "graph_search");
  CHECK(inner(GuideSpec::make("shrink", {}, PlannerSpec::make("rrt", {})) >> root) == "rrt");
}
