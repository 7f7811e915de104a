// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include "support/catch.hpp"
#include "support/folder.hpp"
#include "unit/scene_spatial.hpp"

#include <trellis/collision/checker.hpp>
#include <trellis/reader/mesh_file.hpp>
#include <trellis/reader/readers.hpp>
#include <trellis/scene/planar/scene.hpp>
#include <trellis/scene/spatial/scene.hpp>

using namespace trellis;
using namespace trellis::spatial_tests;
using Catch::Matchers::Contains;
using Catch::Matchers::EndsWith;

namespace {

namespace fs = std::filesystem;

/// The path of one of the real scenes, or "" and a line on stderr.
std::string real(const std::string& name) {
  const char* folder = std::getenv("TRELLIS_SCENES");
  const fs::path path = fs::path(folder != nullptr ? folder : "../shared/scenes") / name;
  if (fs::exists(path)) return path.string();
  std::cerr << "skipped: there is no " << path.string() << " (TRELLIS_SCENES names the folder of scenes)\n";
  return "";
}

const SpatialScene& scene_of(const Problem& problem) { return spatial(*problem.scene); }

bool valid(const Problem& problem, View q) {
  return make_checker(problem.collision, problem.scene, problem.space, problem.resolution)->valid(q);
}

const std::string environment =
    "# a comment\nBoundary Box [-10:10 ; -10:10 ; -10:10 ]\n\nMultibodies\n3\n\nActive\n1\n#VIZMO_COLOR 1 0 0\n"
    "rod.obj Volumetric Rotational\nConnections\n0\n\nPassive\nblock.obj -c(0.8 0.8 0.8 1) 1 2 3 0 0 90\n\nPassive\n"
    "block.obj 0 0 -5 90 0 0\n";

/// A folder with an environment of PPL, its meshes and a query.
class PplFolder : public test::Folder {
 public:
  explicit PplFolder(const std::string& text = environment,
                     const std::string& query = "0 5 5 5 0 0 0\n0 5 5 -5 0.5 0 0\n") {
    static_cast<void>(write("rod.obj", box_text(4, 1, 1)));
    static_cast<void>(write("block.obj", box_text(2, 4, 1)));
    path = write("a.env", text);
    if (!query.empty()) static_cast<void>(write("a.query", query));
  }
  std::string path;
};

std::string fault_in(const std::string& text, const std::string& query = "") {
  const PplFolder folder(text, query);
  return fault_of([&] { read_scene(folder.path, {}); });
}

std::string changed(std::string text, const std::string& from, const std::string& to) {
  return text.replace(text.find(from), from.size(), to);
}

}  // namespace

TEST_CASE("PPL: bodies are about the mean of their vertices, turned by degrees", "[reader][ppl]") {
  const PplFolder folder;
  const SceneFile file = read_scene(folder.path, {});
  REQUIRE(file.problems.size() == 1);
  const Problem& problem = file.problems[0];
  const World3& world = scene_of(problem).world;
  CHECK(world.bounds() == Box3{{-10, -10, -10}, {10, 10, 10}});
  CHECK(world.contain() == Contain::robot);
  REQUIRE(world.obstacles().size() == 2);
  CHECK(world.obstacles()[0].name == "obstacle 1 (block.obj)");
  const auto near = [](const Box3& box, const Vec3& lo, const Vec3& hi) {
    return norm(box.lo - lo) < 1e-9 && norm(box.hi - hi) < 1e-9;
  };
  // 2 x 4 x 1, turned about z by 90 degrees; then the other one about x.
  CHECK(near(bounding_box(world.obstacles()[0].solid), {-1, 1, 2.5}, {3, 3, 3.5}));
  CHECK(near(bounding_box(world.obstacles()[1].solid), {-1, -0.5, -7}, {1, 0.5, -3}));
  // One mesh for both.
  CHECK(std::get<4>(world.obstacles()[0].solid.shape) == std::get<4>(world.obstacles()[1].solid.shape));
  const Robot3& robot = scene_of(problem).robot;
  CHECK(robot.rotates());
  CHECK(robot.bounding_radius() == Approx(std::sqrt(4 + 0.25 + 0.25)));
  CHECK(robot.inscribed_radius() == Approx(0.5));
  CHECK(problem.start == Configuration{5, 5, 5, 0, 0, 0, 1});
  CHECK(problem.goal()[2] == -5);
  // A quarter turn about x.
  CHECK(problem.goal()[3] == Approx(std::sqrt(0.5)));
  CHECK(problem.goal()[6] == Approx(std::sqrt(0.5)));
  CHECK(problem.space.factors().back().axis.weight == Approx(robot.bounding_radius()));
  CHECK(valid(problem, problem.start));
  CHECK(valid(problem, problem.goal()));
  CHECK(read_scene(folder.file("a.query"), {}).problems.size() == 1);
}

TEST_CASE("PPL: angles turn about x, then y, then z", "[reader][ppl]") {
  const PplFolder folder(environment, "5 5 5 0.5 0 0.5\n5 5 5 0 0.5 0.5\n5 5 5 1 0 0\n");
  const SceneFile file = read_scene(folder.path, {});
  REQUIRE(file.problems.size() == 2);
  CHECK(file.problems[0].name == "a 1");
  CHECK(file.problems[0].goal() == file.problems[1].start);
  const Robot3& robot = scene_of(file.problems[0]).robot;
  const auto turned = [&](const Configuration& q, const Vec3& v) { return robot.pose(q).orientation(v); };
  // z goes to -y by the turn about x, then to x by the turn about z.
  CHECK(norm(turned(file.problems[0].start, {0, 0, 1}) - Vec3{1, 0, 0}) < 1e-12);
  // z goes to x by the turn about y, then to y.
  CHECK(norm(turned(file.problems[0].goal(), {0, 0, 1}) - Vec3{0, 1, 0}) < 1e-12);
}

TEST_CASE("PPL: a robot in the plane makes a planar scene", "[reader][ppl]") {
  std::string text = changed(environment, "Volumetric", "Planar");
  text = changed(text, "90 0 0\n", "0 0 0\n");
  text = changed(text, "1 2 3 0 0 90", "1 2 0.5 0 0 90");
  const PplFolder folder(text, "0 -5 -5 0.5\n0 5 5 0\n");
  const SceneFile file = read_scene(folder.path, {});
  REQUIRE(file.problems.size() == 1);
  const PlanarScene* scene = file.problems[0].scene->planar();
  REQUIRE(scene != nullptr);
  // The second one is below the robot.
  REQUIRE(scene->world.obstacles().size() == 1);
  REQUIRE(file.warnings.size() == 1);
  CHECK_THAT(file.warnings[0],
             EndsWith("a.env:18: block.obj: it is above or below the robot, which moves in the plane, "
                      "and was left out"));
  const auto& outline = std::get<Polygon>(scene->world.obstacles()[0].shape).vertices;
  REQUIRE(outline.size() == 4);
  for (const Vec2 v : outline) {
    CHECK(std::abs(v.x - 1) == Approx(2));
    CHECK(std::abs(v.y - 2) == Approx(1));
  }
  CHECK(file.problems[0].start[2] == Approx(pi / 2));
  CHECK(valid(file.problems[0], file.problems[0].start));
  CHECK_FALSE(valid(file.problems[0], Configuration{1, 2, 0}));
  CHECK_THAT(
      fault_in(changed(environment, "Active\n1\n#VIZMO_COLOR 1 0 0\nrod.obj Volumetric Rotational\nConnections\n0",
                       "Passive\nrod.obj 0 0 0 0 0 0")),
      Contains("a.env: no active body: the robot must be beside the environment, as ") && EndsWith("a.robot"));
  CHECK_THAT(fault_in(changed(changed(environment, "Volumetric", "Planar"), "90 0 0\n", "45 0 0\n")),
             Contains("a.env:18: block.obj: the robot moves in the "
                      "plane, so each body must be an upright"));
}

namespace {

/// A mesh of an upright prism over an outline, with its top and bottom as one polygon each.
std::string prism_text(const std::vector<Vec2>& outline, double height) {
  std::string text;
  for (const double z : {0.0, height}) {
    for (const Vec2 p : outline) {
      text += "v " + std::to_string(p.x) + " " + std::to_string(p.y) + " " + std::to_string(z) + "\n";
    }
  }
  const std::size_t n = outline.size();
  std::string bottom = "f", top = "f", sides;
  for (std::size_t i = 0; i < n; ++i) {
    bottom += " " + std::to_string(n - i);
    top += " " + std::to_string(n + i + 1);
    const std::size_t j = (i + 1) % n;
    sides += "f " + std::to_string(i + 1) + " " + std::to_string(j + 1) + " " + std::to_string(n + j + 1) + " " +
             std::to_string(n + i + 1) + "\n";
  }
  return text + bottom + "\n" + top + "\n" + sides;
}

}  // namespace

TEST_CASE("PPL: bodies in the plane may be concave", "[reader][ppl]") {
  // An L and a U; their vertices' means are the origins of the meshes.
  const std::vector<Vec2> ell = {{0, 0}, {3, 0}, {3, 1}, {1, 1}, {1, 3}, {0, 3}};
  const std::vector<Vec2> cup = {{0, 0}, {6, 0}, {6, 6}, {4, 6}, {4, 2}, {2, 2}, {2, 6}, {0, 6}};
  const test::Folder folder;
  static_cast<void>(folder.write("ell.obj", prism_text(ell, 1)));
  static_cast<void>(folder.write("cup.obj", prism_text(cup, 1)));
  const std::string path = folder.write("a.env",
                                        "Boundary Box2D [-20:20 ; -20:20]\nMultiBodies\n2\nActive\n1\nell.obj Planar "
                                        "Rotational\nConnections\n0\nPassive\ncup.obj 3 4 0 0 0 0\n");
  static_cast<void>(folder.write("a.query", "0 -9 -9 0\n0 9 9 0.5\n"));
  const Problem problem = read_scene(path, {}).problems.at(0);
  const PlanarScene& scene = planar(*problem.scene);
  const auto& outline = std::get<Polygon>(scene.world.obstacles().at(0).shape).vertices;
  CHECK(outline.size() == cup.size());
  // The cup's mean is (3, 3.5), so that it lies from (0, 0.5) to (6, 6.5); its inside is free.
  for (const auto& [point, inside] : std::vector<std::pair<Vec2, bool>>{
           {{3, 1.5}, true}, {{3, 5}, false}, {{1, 5}, true}, {{5, 5}, true}, {{3, 6.4}, false}, {{3, 7}, false}}) {
    CAPTURE(point.x, point.y);
    const Problem point_robot = [&] {
      Problem one = problem;
      one.scene = std::make_shared<PlanarScene>(scene.world, Robot::point());
      one.space = one.scene->default_space(1.0);
      return one;
    }();
    CHECK(valid(point_robot, Configuration{point.x, point.y}) != inside);
  }
  // The corner of the L is empty: its mean is (4/3, 4/3).
  REQUIRE(scene.robot.bodies().size() == 1);
  CHECK(scene.robot.bodies()[0].parts.size() == 2);
  CHECK(scene.robot.bounding_radius() == Approx(std::hypot(3 - 4.0 / 3, 4.0 / 3)));
  // A ring has an inside: it is refused, and a frustum too.
  const std::string ring =
      "v 0 0 0\nv 3 0 0\nv 3 3 0\nv 0 3 0\nv 1 1 0\nv 2 1 0\nv 2 2 0\nv 1 2 0\nv 0 0 1\nv 3 0 1\nv 3 3 1\nv 0 3 1\nv 1 "
      "1 "
      "1\nv 2 1 1\nv 2 2 1\nv 1 2 1\nf 1 5 6 2\nf 2 6 7 3\nf 3 7 8 4\nf 4 8 5 1\nf 9 10 14 13\nf 10 11 15 14\nf 11 12 "
      "16 "
      "15\nf 12 9 13 16\nf 1 2 10 9\nf 2 3 11 10\nf 3 4 12 11\nf 4 1 9 12\nf 5 13 14 6\nf 6 14 15 7\nf 7 15 16 8\nf 8 "
      "16 "
      "13 5\n";
  static_cast<void>(folder.write("cup.obj", ring));
  CHECK_THAT(
      fault_of([&] { read_scene(path, {}); }),
      Contains("a.env:10: cup.obj: the robot moves in the plane, so each body must be an upright prism without"));
}

TEST_CASE("PPL: the present layout, with the robot in NAME.robot and colours after a blank", "[reader][ppl]") {
  const std::string text =
      "Boundary\nBox [-10:10 ; -10:10 ; -10:10]\n\nPositionRes 0.05\nOrientationRes 0.05\n\nMultiBodies\n2\n\nPassive\n"
      "block.obj -c (1 0 0 0)\n1 2 3\n0 0 90\n\nPassive\nblock.obj -t(wood.png) -a(none) -c(0 1 0 1) -1 0 -5 0 0 0\n";
  const PplFolder folder(text, "5 5 5 0 0 0\n5 5 -5 0.5 0 0\n");
  static_cast<void>(folder.write("a.robot", "1\nrod.obj -c (1 0 0 1) Volumetric Rotational\nConnections\n0\n"));
  const SceneFile file = read_scene(folder.path, {});
  CHECK(file.warnings.empty());
  const SpatialScene& scene = scene_of(file.problems.at(0));
  REQUIRE(scene.world.obstacles().size() == 2);
  const auto near = [](const Box3& box, const Vec3& lo, const Vec3& hi) {
    return norm(box.lo - lo) < 1e-9 && norm(box.hi - hi) < 1e-9;
  };
  CHECK(near(bounding_box(scene.world.obstacles()[0].solid), {-1, 1, 2.5}, {3, 3, 3.5}));
  // -a(none): the mesh of 2 x 4 x 1 from its own origin, where x begins with a minus.
  CHECK(near(bounding_box(scene.world.obstacles()[1].solid), {-1, 0, -5}, {1, 4, -4}));
  CHECK(scene.robot.rotates());
  CHECK(scene.robot.bounding_radius() == Approx(std::sqrt(4 + 0.25 + 0.25)));

  // Another name, where it is the only robot beside the environment.
  fs::rename(folder.file("a.robot"), folder.file("other.robot"));
  const SceneFile other = read_scene(folder.path, {});
  REQUIRE(other.warnings.size() == 1);
  CHECK_THAT(other.warnings[0], Contains("the robot is that of ") && EndsWith("other.robot, the only one beside it"));
  static_cast<void>(folder.write("third.robot", "1\nrod.obj Volumetric Rotational\nConnections\n0\n"));
  CHECK_THAT(fault_of([&] { read_scene(folder.path, {}); }),
             Contains("a.env: no active body: the robot must be beside the environment, as ") &&
                 EndsWith("a.robot; the folder has 2 other robots"));
  static_cast<void>(folder.write("a.robot", "2\nrod.obj Volumetric Rotational\n"));
  CHECK_THAT(fault_of([&] { read_scene(folder.path, {}); }), Contains("a.robot:1: a robot of 2 bodies"));
  static_cast<void>(folder.write("a.robot", "1\nnone.obj Volumetric Rotational\nConnections\n0\n"));
  CHECK_THAT(fault_of([&] { read_scene(folder.path, {}); }), Contains("a.robot:2: its mesh is not there: none.obj"));
  static_cast<void>(folder.write("a.robot", "1\nrod.obj -a(middle) Volumetric Rotational\nConnections\n0\n"));
  CHECK_THAT(fault_of([&] { read_scene(folder.path, {}); }),
             Contains("a.robot:2: expected com, surface or none, got 'middle'"));
  static_cast<void>(folder.write("a.robot", "1\nrod.obj -a(surface) Volumetric Rotational\nConnections\n0\n"));
  // Of a box the mean of the surface is that of the vertices.
  CHECK(scene_of(read_scene(folder.path, {}).problems.at(0)).robot.bounding_radius() == Approx(std::sqrt(4.5)));
}

TEST_CASE("PPL: what is not read is named with its line", "[reader][ppl]") {
  CHECK(fault_in(environment).empty());
  CHECK_THAT(fault_in(changed(environment, "Box", "Sphere")), Contains("a.env:2: a boundary of the shape 'sphere'"));
  CHECK_THAT(fault_in(changed(environment, "-10:10 ; -10:10 ;", "-10:10 ;")), !Contains("ranges"));
  CHECK_THAT(fault_in(changed(environment, "; -10:10 ; -10:10", "")),
             Contains("a.env:2: expected two or three ranges"));
  CHECK_THAT(fault_in(changed(environment, "-10:10", "10:-10")), Contains("xmin < xmax"));
  CHECK_THAT(fault_in(changed(environment, "\n3\n", "\n4\n")), Contains("a.env:18: the file ends before body 4 of 4"));
  CHECK_THAT(fault_in(changed(environment, "\n3\n", "\n3.5\n")), Contains("a.env:5: expected the number of bodies"));
  CHECK_THAT(fault_in(changed(environment, "\n3\n", "\n99999999999\n")), Contains("expected 1 to 1000000"));
  CHECK_THAT(fault_in(changed(environment, "\n1\n#", "\n2\n#")), Contains("a.env:8: a robot of 2 bodies; only rigid"));
  CHECK_THAT(fault_in(changed(environment, "Connections\n0", "Connections\n1")), Contains("a.env:12: 1 connections"));
  CHECK_THAT(fault_in(changed(environment, "Volumetric", "Joint")), Contains("a.env:10: expected 'Planar' or"));
  CHECK_THAT(fault_in(changed(environment, "0 0 -5 90", "0 0 x 90")), Contains("a.env:18: expected the position"));
  CHECK_THAT(fault_in(changed(environment, "0 0 -5 90 0 0", "0 0 -5 90 0 0 1")),
             Contains("a.env:18: expected the end"));
  CHECK_THAT(fault_in(changed(environment, "Passive", "Internal")),
             Contains("a.env:14: expected 'Active' or 'Passive'"));
  const std::string other = changed(changed(environment, "rod.obj", "a.obj"), "block.obj", "b.obj");
  CHECK_THAT(fault_in(other),
             Contains("a.env:10: 2 of the meshes that it names are not there: a.obj (line 10), b.obj (line 15)"));
  CHECK_THAT(fault_in(environment, "0 0 0\n"), Contains("a.query:1: expected 6 numbers"));
  CHECK_THAT(fault_in(environment, "1 0 0 0 0 0 0\n"), Contains("a.query:1: there is no robot 1"));
  CHECK_THAT(fault_in(environment, "0 0 0 0 0 nan\n"), Contains("a.query:1: expected a number, got 'nan'"));
  CHECK_THAT(fault_in(environment, "0 0 0 0 0 0\n"), Contains("a.query:1: a query needs a start and a goal"));
}

TEST_CASE("OMPL.app: meshes, bounds and poses of a configuration", "[reader][ompl]") {
  const std::string good =
      "[problem]\nname = my problem # comment\nworld=block.obj\nrobot = rod.obj\nstart.x=5\nstart.y=5\nstart.z=5\n"
      "start.theta=1.5707963\nstart.axis.x=0\nstart.axis.y=0\nstart.axis.z=2\ngoal.x=-5\ngoal.y=-5\ngoal.z=-5\ngoal."
      "theta=0\n"
      "goal.axis.x=0\ngoal.axis.y=0\ngoal.axis.z=0\nvolume.min.x=-9\nvolume.min.y=-9\nvolume.min.z=-9\nvolume.max.x=9\n"
      "volume.max.y=9\nvolume.max.z=9\n[benchmark]\ntime_limit=10\n[planner]\nrrt.range=2\n";
  const auto fault = [](const std::string& text) {
    const PplFolder folder("", "");
    const std::string path = folder.write("a.cfg", text);
    return fault_of([&] { read_scene(path, {}); });
  };
  const PplFolder folder("", "");
  const Problem problem = read_problems(folder.write("a.cfg", good), {}).at(0);
  CHECK(problem.name == "my problem");
  CHECK(scene_of(problem).world.contain() == Contain::reference);
  CHECK(scene_of(problem).world.surface());
  CHECK(scene_of(problem).robot.bounding_radius() == Approx(std::sqrt(4.5)));
  CHECK(problem.start[5] == Approx(std::sqrt(0.5)));
  CHECK(problem.goal() == Configuration{-5, -5, -5, 0, 0, 0, 1});
  CHECK(valid(problem, problem.start));
  CHECK(fault(changed(good, "name =", "sampler=obstacle_based\nname =")).empty());
  CHECK_THAT(fault(changed(good, "name =", "statespace=dubins\nname =")),
             Contains("a.cfg:2: 'statespace' is of robots in the plane"));
  const Problem placed =
      read_problems(folder.write("a.cfg", good), {.start_pose = Pose3{{4, 3, 2}, {0, 0, 1, 0}}}).at(0);
  CHECK(placed.start == Configuration{4, 3, 2, 0, 0, 1, 0});
  CHECK(placed.goal() == problem.goal());
  CHECK_THAT(fault(changed(good, "start.theta", "start.thetta")),
             Contains("a.cfg:8: unknown key 'start.thetta' in [problem] (did you mean 'start.theta'?)"));
  CHECK_THAT(fault(changed(good, "volume.max.z=9\n", "")), Contains("'volume.max.z' is missing"));
  CHECK_THAT(fault(changed(good, "goal.y=-5", "goal.y=a")), Contains("a.cfg:13: 'goal.y' needs a number, got 'a'"));
  CHECK_THAT(fault(changed(good, "goal.y=-5", "goal.x=1")),
             Contains("a.cfg:13: 'goal.x' a second time, after line 12"));
  CHECK_THAT(fault(changed(good, "start.axis.z=2", "start.axis.z=0")),
             Contains("the axis of the turn of the start has"));
  CHECK_THAT(fault(changed(good, "name =", "control = kinematic_car\nname =")),
             Contains("a.cfg:2: problems with controls"));
  CHECK_THAT(fault(changed(good, "start.z=5\n", "")), Contains("without start.z the robot moves in the plane"));
  CHECK_THAT(fault(changed(good, "[planner]", "[plan]")), Contains("expected [problem], [benchmark] or [planner]"));
  CHECK_THAT(fault(changed(good, "rod.obj", "rod.dae")),
             Contains("a.cfg:4: 1 of the meshes that it names is not there: rod.dae"));
}

namespace {

/// A box from the origin in COLLADA, 1 x 2 x 3 units, in which an axis points up. Its faces have normals of their own.
std::string collada_box(const std::string& up, const std::string& meter = "1") {
  std::string corners;
  for (const char* x : {"0", "1"}) {
    for (const char* y : {"0", "2"}) {
      for (const char* z : {"0", "3"}) corners += std::string(x) + " " + y + " " + z + " ";
    }
  }
  return "<?xml version=\"1.0\"?>\n<COLLADA xmlns=\"http://www.collada.org/2005/11/COLLADASchema\" "
         "version=\"1.4.1\">\n<asset><unit meter=\"" +
         meter + "\" name=\"some\"/>" + (up.empty() ? "" : "<up_axis>" + up + "</up_axis>") +
         "</asset>\n<library_geometries><geometry id=\"g\"><mesh><source id=\"p\"><float_array id=\"a\" count=\"24\">" +
         corners +
         "</float_array><technique_common><accessor source=\"#a\" count=\"8\" stride=\"3\"><param name=\"X\" "
         "type=\"float\"/><param name=\"Y\" type=\"float\"/><param name=\"Z\" type=\"float\"/></accessor>"
         "</technique_common></source><vertices id=\"v\"><input semantic=\"POSITION\" source=\"#p\"/></vertices>"
         "<triangles count=\"12\"><input semantic=\"VERTEX\" source=\"#v\" offset=\"0\"/><p>0 1 3 0 3 2 4 6 7 4 7 5 0 "
         "4 5 0 5 "
         "1 2 3 7 2 7 6 0 2 6 0 6 4 1 5 7 1 7 3</p></triangles></mesh></geometry></library_geometries>\n"
         "<library_visual_scenes><visual_scene id=\"s\"><node id=\"n\"><instance_geometry url=\"#g\"/></node>"
         "</visual_scene></library_visual_scenes><scene><instance_visual_scene url=\"#s\"/></scene></COLLADA>\n";
}

}  // namespace

TEST_CASE("OMPL.app: COLLADA is turned as assimp turns it", "[reader][ompl]") {
  const test::Folder folder;
  if (fault_of([&] { read_mesh(folder.write("probe.dae", "")); }).find("libassimp-dev") != std::string::npos) {
    WARN("SKIPPED: trellis-mesh was not built");
    return;
  }
  const std::string text =
      "[problem]\nname=a\nworld=wall.dae\nrobot=rod.dae\nsampler=uniform\nstart.x=5\nstart.y=5\nstart.z=5\nstart.theta="
      "0\n"
      "start.axis.x=0\nstart.axis.y=0\nstart.axis.z=1\ngoal.x=-5\ngoal.y=-5\ngoal.z=-5\ngoal.theta=0\ngoal.axis.x=0\n"
      "goal.axis.y=0\ngoal.axis.z=1\nvolume.min.x=-9\nvolume.min.y=-9\nvolume.min.z=-9\nvolume.max.x=9\nvolume.max.y="
      "9\n"
      "volume.max.z=9\n";
  struct Case {
    std::string up;
    Vec3 lo, hi;
    std::string note;
  };
  for (const auto& [up, lo, hi, note] :
       std::vector<Case>{{"Z_UP",
                          {0, 0, -2},
                          {1, 3, 0},
                          "wall.dae is COLLADA with z up, turned as by OMPL.app: (x, y, z) is (x, z, -y)"},
                         {"X_UP",
                          {-2, 0, 0},
                          {0, 1, 3},
                          "wall.dae is COLLADA with x up, turned as by OMPL.app: (x, y, z) is (-y, x, z)"},
                         {"Y_UP", {0, 0, 0}, {1, 2, 3}, ""},
                         {"", {0, 0, 0}, {1, 2, 3}, ""}}) {
    CAPTURE(up);
    static_cast<void>(folder.write("wall.dae", collada_box(up)));
    static_cast<void>(folder.write("rod.dae", collada_box(up)));
    const SceneFile file = read_scene(folder.write("a.cfg", text), {});
    const SpatialScene& scene = scene_of(file.problems.at(0));
    const Box3 wall = bounding_box(scene.world.obstacles().at(0).solid);
    CHECK(norm(wall.lo - lo) < 1e-6);
    CHECK(norm(wall.hi - hi) < 1e-6);
    // The robot's is about its mean.
    const Box3 rod = bounding_box(scene.robot.solids().at(0));
    CHECK(norm(rod.lo + rod.hi) < 1e-6);
    CHECK(norm(rod.hi - 0.5 * (hi - lo)) < 1e-6);
    CHECK(file.warnings.empty());
    CHECK(file.notes.size() == (note.empty() ? 0 : 2));
    if (!note.empty()) CHECK(file.notes.back() == note);
  }
}

TEST_CASE("COLLADA by itself keeps its axes and says them, and its unit", "[reader][mesh]") {
  const test::Folder folder;
  if (fault_of([&] { read_mesh(folder.write("probe.dae", "")); }).find("libassimp-dev") != std::string::npos) {
    WARN("SKIPPED: trellis-mesh was not built");
    return;
  }
  for (const auto& [up, axis] : {std::pair{"Z_UP", 'z'}, {"Y_UP", 'y'}, {"X_UP", 'x'}, {"", 'y'}}) {
    CAPTURE(up);
    const MeshFile file = read_mesh(folder.write("a.dae", collada_box(up, "0.5")));
    CHECK(norm(file.mesh->bounds().hi - Vec3{0.5, 1, 1.5}) < 1e-6);
    CHECK(file.up == axis);
    CHECK(file.metres_in_unit == 0.5);
    CHECK(file.unit_name == "some");
    CHECK(file.warnings.empty());
    if (axis == 'z') CHECK(file.up_warning.empty());
    if (axis == 'y') {
      CHECK_THAT(file.up_warning, Contains("in this file y is up (Y_UP), and its axes are kept") &&
                                      Contains("axis = {1, 0, 0}, angle = math.pi / 2"));
    }
    if (axis == 'x') CHECK_THAT(file.up_warning, Contains("x is up (X_UP)") && Contains("axis = {0, -1, 0}"));
  }
  // What the warning advises turns the axis up.
  const Quaternion from_y = rotation_of({pi / 2, 0, 0}), from_x = rotation_of({0, -pi / 2, 0});
  CHECK(norm(from_y(Vec3{0, 1, 0}) - Vec3{0, 0, 1}) < 1e-12);
  CHECK(norm(from_x(Vec3{1, 0, 0}) - Vec3{0, 0, 1}) < 1e-12);
  // Comments, other attributes and quotes change nothing; a file without <unit> is in metres.
  std::string text = collada_box("Z_UP", "0.25");
  text = changed(text, "<asset>", "<asset><!-- <up_axis>X_UP</up_axis> <unit meter=\"9\"/> --><revision>1</revision>");
  text = changed(text, "<unit meter=\"0.25\" name=\"some\"/>", "<unit\n name='quarter'\tmeter = '0.25'></unit>");
  const MeshFile quarter = read_mesh(folder.write("b.dae", text));
  CHECK(quarter.up == 'z');
  CHECK(quarter.metres_in_unit == 0.25);
  CHECK(quarter.unit_name == "quarter");
  CHECK(quarter.mesh->bounds().hi.x == Approx(0.25));
  // Its own unit makes it large: `unit` cannot help.
  const MeshFile large = read_mesh(folder.write("c.dae", collada_box("Z_UP", "1000")));
  REQUIRE(large.warnings.size() == 1);
  CHECK_THAT(large.warnings[0], EndsWith("c.dae: it extends 1000 x 2000 x 3000 m; 1 unit is 1000 m by its <unit>"));
}

TEST_CASE("rl: a plan with its kinematics and its scene in VRML", "[reader][rl]") {
  const test::Folder folder;
  const auto plan = [&](const std::string& q = "0") {
    return "<?xml version=\"1.0\"?>\n<rlplan>\n<prm>\n<goal><q>9</q><q>1</q><q>1</q><q>" + q +
           "</q><q>0</q><q>0</q><q>1</q></goal>\n<model><kinematics href=\"Box.xml\" type=\"mdl\"/><model>0</model>"
           "<scene "
           "href=\"scene.xml\"/></model>\n<start><q>1</q><q>1</q><q>1</q><q>0</q><q>0</q><q>0</q><q>1</q></start>\n"
           "</prm>\n</rlplan>\n";
  };
  const std::string kinematics =
      "<rlmdl><model><world id=\"world\"/>\n<sixDof id=\"j\"><frame><a idref=\"world\"/><b idref=\"body\"/></frame>"
      "<max>10</max><max>2</max><max>2</max><min>0</min><min>0</min><min>0</min></sixDof></model></rlmdl>\n";
  const std::string vrml =
      "#VRML V2.0 utf8\nTransform { children [\n DEF robot Transform { translation 7 7 7 children [\n"
      "  DEF body Transform { children [ Transform { translation 0.5 0 0 children Shape { appearance Appearance { "
      "material\n"
      "   Material { transparency 0.9 } } geometry Box { size 1 0.4 0.2 } } } ] } ] }\n"
      " DEF maze Inline { url \"inner.wrl\" } ] }\n";
  const std::string inner =
      "#VRML V2.0 utf8\nDEF wall Transform { children [ Shape { geometry Cylinder { height 4 radius 0.5 } } ]\n"
      " translation 5 1 1 rotation 1 0 0 1.5707963267948966 }\nShape { geometry Sphere { radius 0.25 } }\n";
  static_cast<void>(folder.write("box.xml", kinematics));
  const std::string models =
      "<rlsg><scene href=\"scene.wrl\"><model name=\"robot\"/><model name=\"maze\"/></scene></rlsg>\n";
  static_cast<void>(folder.write("scene.xml", models));
  static_cast<void>(folder.write("scene.wrl", vrml));
  static_cast<void>(folder.write("inner.wrl", inner));
  const auto fault = [&](const std::string& name, const std::string& text, const std::string& kept) {
    static_cast<void>(folder.write(name, text));
    const std::string path = folder.write("plan.xml", name == "plan.xml" ? text : plan());
    std::string found = fault_of([&] { read_scene(path, {}); });
    static_cast<void>(folder.write(name, kept));
    return found;
  };
  const Problem problem = read_problems(folder.write("plan.xml", plan()), {}).at(0);
  const SpatialScene& scene = scene_of(problem);
  CHECK(scene.world.bounds() == Box3{{0, 0, 0}, {10, 2, 2}});
  CHECK(scene.world.contain() == Contain::reference);
  REQUIRE(scene.robot.solids().size() == 1);
  CHECK(scene.robot.solids()[0].pose == Pose3{{0.5, 0, 0}, {}});
  CHECK(std::get<Cuboid>(scene.robot.solids()[0].shape).size == Vec3{1, 0.4, 0.2});
  REQUIRE(scene.world.obstacles().size() == 2);
  CHECK(scene.world.obstacles()[0].name == "obstacle 1 (wall)");
  // The cylinder's axis was y; the turn about x makes it z.
  const Box3 wall = bounding_box(scene.world.obstacles()[0].solid);
  CHECK(norm(wall.hi - wall.lo - Vec3{1, 1, 4}) < 1e-9);
  CHECK(problem.goal() == Configuration{9, 1, 1, 0, 0, 0, 1});
  CHECK(valid(problem, problem.start));
  CHECK(valid(problem, problem.goal()));
  CHECK_FALSE(valid(problem, Configuration{5, 1, 1, 0, 0, 0, 1}));

  CHECK_THAT(fault("plan.xml", plan("1"), plan()),
             Contains("plan.xml:4: <goal>: the last four numbers must be a quaternion"));
  CHECK_THAT(fault("plan.xml", changed(plan(), "<q>9</q>", ""), plan()),
             Contains("plan.xml:4: <goal> needs 7 elements <q>, got 6"));
  CHECK_THAT(fault("plan.xml", changed(plan(), "</prm>", ""), plan()), Contains("it is no XML file"));
  CHECK_THAT(fault("plan.xml", changed(plan(), "<model>0", "<model>2"), plan()), Contains("the scene has no model 2"));
  CHECK_THAT(fault("plan.xml", changed(plan(), "<model>0", "<model>1"), plan()),
             Contains("is not part of its body 'body'"));
  CHECK_THAT(fault("box.xml", changed(kinematics, "<sixDof", "<revolute/><sixDof"), kinematics),
             Contains("<revolute>: only a body with six degrees of freedom"));
  CHECK_THAT(fault("scene.wrl", changed(vrml, "Box { size 1 0.4 0.2 }", "Cone { }"), vrml),
             Contains("scene.wrl:5: the shape 'Cone' is not read; expected Box, Sphere or Cylinder"));
  CHECK_THAT(fault("scene.wrl", changed(vrml, "size 1 0.4", "size 1 -0.4"), vrml),
             Contains("scene.wrl:5: a shape: a box needs"));
  CHECK_THAT(fault("scene.wrl", changed(vrml, "translation 7 7 7", "scale 2 2 2"), vrml),
             Contains("'scale' of a Transform"));
  CHECK_THAT(fault("scene.wrl", vrml.substr(0, vrml.size() - 5), vrml), Contains("the file ends before ']'"));
  CHECK_THAT(fault("inner.wrl", "#VRML V2.0 utf8\nInline { url \"inner.wrl\" }", inner),
             Contains("files within more than 10"));
  CHECK_THAT(fault("inner.wrl", "wall", inner), Contains("inner.wrl:1: expected '#VRML V2.0 utf8'"));
}

TEST_CASE("real scenes of PPL", "[reader][ppl][real]") {
  const std::string hook = real("open_ppl/hook/hook.env");
  if (hook.empty()) return;
  const SceneFile file = read_scene(hook, {});
  REQUIRE(file.problems.size() == 1);
  const Problem& problem = file.problems[0];
  const SpatialScene& scene = scene_of(problem);
  CHECK(file.warnings.empty());
  CHECK(scene.world.bounds() == Box3{{-100, -100, -400}, {100, 100, 200}});
  REQUIRE(scene.world.obstacles().size() == 2);
  for (const auto& [solid, triangles] :
       {std::pair(scene.world.obstacles()[0].solid, 48), std::pair(scene.robot.solids()[0], 60)}) {
    const auto& mesh = std::get<std::shared_ptr<const Mesh>>(solid.shape);
    CHECK(mesh->triangles().size() == static_cast<std::size_t>(triangles));
    CHECK(mesh->closed());
  }
  // About the mean of its vertices: within the walls' plane, but not quite about their middle.
  const Box3 wall = bounding_box(scene.world.obstacles()[0].solid);
  CHECK(wall.lo.z == Approx(-2.5));
  CHECK(wall.hi.x - wall.lo.x == Approx(200));
  CHECK(problem.start == Configuration{0, 0, 120, 0, 0, 0, 1});
  CHECK(problem.goal() == Configuration{0, 0, -280, 0, 0, 0, 1});
  CHECK(valid(problem, problem.start));
  CHECK(valid(problem, problem.goal()));
  // Straight down it hits the walls.
  CHECK_FALSE(valid(problem, Configuration{60, 60, 0, 0, 0, 0, 1}));

  const Problem narrow = read_scene(real("open_ppl/narrow_obstacle1/obstacle.env"), {}).problems.at(0);
  REQUIRE(narrow.scene->planar() != nullptr);
  CHECK(narrow.scene->obstacle_count() == 2);
  CHECK(narrow.space.dimension() == 2);
  CHECK(narrow.start.empty());
  CHECK(valid(narrow, Configuration{0, 0}));
  CHECK_FALSE(valid(narrow, Configuration{12, 0}));
  CHECK_THAT(fault_of([&] { read_problems(real("open_ppl/narrow_obstacle1/obstacle.env"), {}); }),
             Contains("has no start and no goal"));

  const Problem planar = read_scene(real("open_ppl/2d/2d.env"), {}).problems.at(0);
  CHECK(planar.start == Configuration{-10, -10});
  CHECK(valid(planar, planar.start));
  CHECK(valid(planar, planar.goal()));

  CHECK_THAT(
      fault_of([&] { read_scene(real("open_ppl/assignment2/Topo.env"), {}); }),
      Contains("Topo.env:8: 2 of the meshes that it names are not there: ground.obj (line 13), icreate.obj (line 8)"));
  CHECK(read_mesh(real("open_ppl/assignment2/block1.obj")).mesh->volume() == Approx(4.5 * 9.5));
}

TEST_CASE("the box in a maze of rl", "[reader][rl][real]") {
  const std::string plan = real("rl/rlplan/box-6d-300505_maze_prm.mdl.sixDof.xml");
  if (plan.empty()) return;
  const SceneFile file = read_scene(plan, {});
  const Problem& problem = file.problems.at(0);
  const SpatialScene& scene = scene_of(problem);
  CHECK(problem.name == "box-6d-300505_maze_prm");
  CHECK(scene.world.bounds() == Box3{{0, 0, 0}, {30, 30, 2}});
  CHECK(scene.world.obstacles().size() == 25);
  CHECK(std::get<Cuboid>(scene.robot.solids().at(0).shape).size == Vec3{3, 0.5, 0.5});
  CHECK(problem.start == Configuration{2, 1, 1, 0, 0, 0, 1});
  CHECK(problem.goal()[5] == Approx(-problem.goal()[6]));
  CHECK(valid(problem, problem.start));
  CHECK(valid(problem, problem.goal()));
  // The same boxes as the mesh beside it, which was converted from the same file.
  const Mesh maze = *read_mesh(real("rl/obj/maze.obj")).mesh;
  double volume = 0.0;
  Box3 bounds = bounding_box(scene.world.obstacles()[0].solid);
  for (const Obstacle3& obstacle : scene.world.obstacles()) {
    const Vec3 size = std::get<Cuboid>(obstacle.solid.shape).size;
    volume += size.x * size.y * size.z;
    const Box3 box = bounding_box(obstacle.solid);
    bounds = {{std::min(bounds.lo.x, box.lo.x), std::min(bounds.lo.y, box.lo.y), std::min(bounds.lo.z, box.lo.z)},
              {std::max(bounds.hi.x, box.hi.x), std::max(bounds.hi.y, box.hi.y), std::max(bounds.hi.z, box.hi.z)}};
  }
  CHECK(maze.volume() == Approx(volume));
  CHECK(norm(bounds.lo - maze.bounds().lo) < 1e-6);
  CHECK(norm(bounds.hi - maze.bounds().hi) < 1e-6);
}

TEST_CASE("real meshes", "[reader][mesh][real]") {
  struct Expected {
    std::string name;
    std::size_t triangles;
    bool closed;
    bool warned;
  };
  for (const auto& [name, triangles, closed, warned] :
       std::vector<Expected>{{"fcl/env.obj", 2180, false, true},
                             {"fcl/rob.obj", 216, false, true},
                             {"rl/obj/box_and_maze.obj", 312, true, false},
                             {"rl/obj/planar2.obj", 220, true, false},
                             {"vamp_mbm/robots/fetch/meshes/base_link_collision_2.stl", 360, true, false},
                             {"vamp_mbm/robots/panda/meshes/collision/link6.obj", 1308, false, false}}) {
    const std::string path = real(name);
    if (path.empty()) return;
    INFO(name);
    const MeshFile file = read_mesh(path);
    CHECK(file.mesh->triangles().size() == triangles);
    CHECK(file.mesh->closed() == closed);
    CHECK(file.warnings.empty() != warned);
  }
  CHECK(read_mesh(real("fcl/rob.obj"), {"mm"}).mesh->bounds().hi.x == Approx(0.5));
}
