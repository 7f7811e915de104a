// SPDX-License-Identifier: GPL-3.0-or-later
// Scene files with several robots: agents of Moving AI, and environments of PPL with several active bodies.
#include <cmath>
#include <numbers>
#include <string>

#include <trellis/base/error.hpp>
#include <trellis/collision/checker.hpp>
#include <trellis/reader/readers.hpp>
#include <trellis/scene/planar/scene.hpp>

#include "support/catch.hpp"
#include "support/fault.hpp"
#include "support/folder.hpp"
#include "unit/scene_spatial.hpp"

using namespace trellis;
using Catch::Matchers::Contains;

namespace {

std::string fault_of(const std::string& path, const ReadOptions& options = {}) {
  return test::fault_of([&] { read_problems(path, options); });
}

const std::string map = "type octile\nheight 2\nwidth 4\nmap\n....\n..@.\n";
const std::string agents =
    "version 1\n"
    "0\tfour.map\t4\t2\t0\t0\t3\t0\t3\n"
    "0\tfour.map\t4\t2\t3\t0\t0\t0\t3\n"
    "0\tfour.map\t4\t2\t0\t1\t3\t1\t4\n"
    "0\tfour.map\t4\t2\t0\t0\t1\t1\t2\n";

std::string environment(const std::string& second) {
  return "Boundary Box [-10:10 ; -10:10]\n\nMultibodies\n3\n\nActive\n1\nrod.obj Planar Rotational\nConnections\n0\n\n"
         "Active\n1\n" +
         second + "\nConnections\n0\n\nPassive\nblock.obj 0 0 0 0 0 0\n";
}

std::string written(const test::Folder& folder, const std::string& second, const std::string& query) {
  static_cast<void>(folder.write("rod.obj", spatial_tests::box_text(4, 1, 1)));
  static_cast<void>(folder.write("cube.obj", spatial_tests::box_text(1, 1, 1)));
  static_cast<void>(folder.write("high.obj", spatial_tests::box_text(1, 1, 9)));
  static_cast<void>(folder.write("block.obj", spatial_tests::box_text(2, 4, 1)));
  static_cast<void>(folder.write("a.query", query));
  return folder.write("a.env", environment(second));
}

}  // namespace

TEST_CASE("the first queries of Moving AI are the robots of one team", "[reader][moving_ai]") {
  const test::Folder folder;
  static_cast<void>(folder.write("four.map", map));
  const std::string path = folder.write("four.scen", agents);
  const SceneFile file = read_scene(path, {.agents = 3});
  REQUIRE(file.problems.size() == 1);
  const Problem& problem = file.problems.front();
  CHECK(problem.name == "four/3 agents");
  CHECK(problem.start == Configuration{0.5, 1.5, 3.5, 1.5, 0.5, 0.5});
  CHECK(problem.goal() == Configuration{3.5, 1.5, 0.5, 1.5, 3.5, 0.5});
  const Robot& team = planar(*problem.scene).robot;
  REQUIRE(team.members().size() == 3);
  CHECK(team.members()[2].robot->inscribed_radius() == 0.3);
  const auto wide = read_problems(path, {.agents = 2, .agent_radius = 0.45});
  CHECK(planar(*wide[0].scene).robot.members()[0].robot->inscribed_radius() == 0.45);
  const auto turning = read_problems(path, {.robot = Robot::rigid({Box2{{-0.2, -0.1}, {0.2, 0.1}}}), .agents = 2});
  CHECK(turning[0].start == Configuration{0.5, 1.5, 0, 3.5, 1.5, 0});
  const auto one = read_problems(path, {.agents = 1});
  CHECK(one[0].start == Configuration{0.5, 1.5});
  CHECK(read_problems(path, {}).size() == 4);
}

TEST_CASE("agents that are no team are an error with file and line", "[reader][moving_ai]") {
  const test::Folder folder;
  static_cast<void>(folder.write("four.map", map));
  const std::string path = folder.write("four.scen", agents);
  CHECK_THAT(fault_of(path, {.agents = 4}),
             Contains("four.scen:5: the start cell (0, 0) is that of the agent in line 2"));
  const std::string few = folder.write("few.scen", agents.substr(0, agents.find("0\tfour.map\t4\t2\t0\t1")));
  CHECK_THAT(fault_of(few, {.agents = 3}), Contains("few.scen:3: 2 agents, expected at least 3"));
  CHECK_THAT(fault_of(path, {.robot = Robot::point(), .agents = 2}), Contains("robot 1 is a point"));
  CHECK_THAT(fault_of(folder.file("four.map"), {.start = {0.5, 0.5}, .goal = {0.5, 1.5}, .agents = 2}),
             Contains("four.map: ") && Contains("agents are in queries of Moving AI (.scen)"));
}

TEST_CASE("PPL: several active bodies of the plane are a team", "[reader][ppl]") {
  const test::Folder folder;
  const std::string path = written(folder, "cube.obj Planar Translational", "0 -5 -5 0.5\n1 -5 5\n1 5 5\n0 5 -5 0\n");
  const SceneFile file = read_scene(path, {});
  REQUIRE(file.problems.size() == 1);
  const Problem& problem = file.problems.front();
  REQUIRE(problem.scene->members().size() == 2);
  CHECK(problem.space.dimension() == 5);
  CHECK(problem.start == Configuration{-5, -5, 0.5 * std::numbers::pi, -5, 5});
  CHECK(problem.goal() == Configuration{5, -5, 0, 5, 5});
  const auto checker = make_checker(problem.collision, problem.scene, problem.space, problem.resolution);
  CHECK(checker->valid(problem.start));
  CHECK_FALSE(checker->valid(Configuration{-5, 5, 0, -5, 5}));  // the one in the other
  CHECK_FALSE(checker->valid(Configuration{-5, -5, 0, 0, 0}));  // in the block
  // The block above the rod, and beside the high body.
  std::string text = environment("high.obj Planar Translational");
  const std::string raised = folder.write("a.env", text.replace(text.find("0 0 0 0 0 0"), 11, "0 0 3 0 0 0"));
  const SceneFile high = read_scene(raised, {});
  REQUIRE(high.warnings.size() == 1);
  CHECK_THAT(high.warnings[0],
             Contains("block.obj: it is above or below some of the robots, and is an obstacle of all"));
  CHECK(planar(*high.problems[0].scene).world.obstacles().size() == 1);
}

TEST_CASE("PPL: what is no team or no query of one is named with its line", "[reader][ppl]") {
  const test::Folder folder;
  const std::string good = "0 -5 -5 0.5\n1 -5 5\n0 5 -5 0\n1 5 5\n";
  const auto fault = [&](const std::string& second, const std::string& query) {
    return fault_of(written(folder, second, query));
  };
  const std::string cube = "cube.obj Planar Translational";
  CHECK(fault(cube, good).empty());
  CHECK_THAT(fault("cube.obj Volumetric Rotational", good),
             Contains("a.env:14: a second active body: several robots are read only where all are 'Planar'"));
  CHECK_THAT(fault(cube, good + "2 5 5\n"), Contains("a.query:5: expected the number of a robot, 0 to 1, got 2"));
  CHECK_THAT(fault(cube, "0 -5 -5 0.5\n1 -5 5 0\n"), Contains("a.query:2: expected 2 numbers of robot 1"));
  CHECK_THAT(fault(cube, good + "1 6 6\n"), Contains("a.query:5: robot 0 has 2 configurations and robot 1 has 3"));
  CHECK_THAT(fault(cube, "0 -5 -5 0.5\n1 -5 5\n"), Contains("a query needs a start and a goal, got 1"));
}

namespace {

/// A scenario of FibrationTrees: a box, a cylinder, two discs.
std::string scenario(const std::string& second = "DiskRobot", const std::string& goal = "[6, 0, -6, 0]") {
  return "name: crossing\nobstacles:\n  Obstacle0:\n    type: floor\n    height: -0.15\n"
         "  Obstacle1:\n    name: wall\n    type: box\n    position: [0, 4, 1]\n    size: [6, 2, 2]\n"
         "  Obstacle2:\n    type: cylinder\n    position: [0, -4, 1]\n    size: [0.5, 5]\n"
         "robots:\n  Robot0:\n    name: MultiRobot\n    robots: [Robot1, Robot2]\n    root: True\n"
         "  Robot1:\n    name: DiskRobot\n    lower_limits: [-8, -8]\n    upper_limits: [8, 8]\n    radius: 1.25\n"
         "  Robot2:\n    name: " +
         second +
         "\n    lower_limits: [-8, -8]\n    upper_limits: [8, 8]\n"
         "problem:\n  start:\n    type: joint\n    config: [-6, 0, 6, 0]\n"
         "  goal:\n    type: joint\n    threshold: 0.5\n    config: " +
         goal + "\n";
}

}  // namespace

TEST_CASE("a scenario of FibrationTrees is a team of discs among outlines on the floor", "[reader][team]") {
  const test::Folder folder;
  const SceneFile file = read_scene(folder.write("crossing.yaml", scenario()), {});
  CHECK(file.format == "FibrationTrees");
  REQUIRE(file.problems.size() == 1);
  const Problem& problem = file.problems[0];
  CHECK(problem.name == "crossing");
  CHECK(problem.start == Configuration{-6, 0, 6, 0});
  CHECK(problem.goal() == Configuration{6, 0, -6, 0});
  const PlanarScene& scene = planar(*problem.scene);
  REQUIRE(scene.robot.members().size() == 2);
  CHECK(scene.robot.members()[0].robot->inscribed_radius() == Approx(1.25));
  // Without a radius it is 1 m.
  CHECK(scene.robot.members()[1].robot->inscribed_radius() == Approx(1.0));
  CHECK(scene.world.obstacles().size() == 2);
  // Limits are those of centres: the larger disc touches the bounds at its limit.
  CHECK(scene.world.bounds().lo.x == Approx(-9.25));
  CHECK(scene.world.bounds().hi.y == Approx(9.25));
  const auto checker = make_checker("planar", problem.scene, problem.space, 0.05);
  CHECK(checker->valid(problem.start));
  CHECK_FALSE(checker->valid(Configuration{0, 2, 6, 0}));     // the box
  CHECK_FALSE(checker->valid(Configuration{0, -2.5, 6, 0}));  // the cylinder
  CHECK_FALSE(checker->valid(Configuration{4.5, 0, 6, 0}));   // each other
  CHECK(file.warnings.size() == 2);
}

TEST_CASE("what of FibrationTrees is not read is an error with its line", "[reader][team]") {
  const test::Folder folder;
  CHECK_THAT(fault_of(folder.write("a.yaml", scenario("DroneRobot"))),
             Contains("a.yaml:26") && Contains("'DroneRobot'") && Contains("teams of discs"));
  CHECK_THAT(fault_of(folder.write("b.yaml", scenario("DiskRobot", "[6, 0]"))),
             Contains("b.yaml:") && Contains("expected 4 numbers: x, y of each robot"));
  std::string mesh = scenario();
  mesh.replace(mesh.find("cylinder"), 8, "urdf");
  CHECK_THAT(fault_of(folder.write("c.yaml", mesh)), Contains("expected one of floor, box, cylinder"));
  std::string rootless = scenario();
  rootless.replace(rootless.find("root: True"), 10, "root: False");
  CHECK_THAT(fault_of(folder.write("d.yaml", rootless)), Contains("no robot has 'root: True'"));
}
