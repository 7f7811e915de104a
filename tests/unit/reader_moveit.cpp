// SPDX-License-Identifier: GPL-3.0-or-later
// Planning scenes of MoveIt: in YAML with their requests, and as the text of RViz.
#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include <trellis/base/error.hpp>
#include <trellis/collision/checker.hpp>
#include <trellis/reader/readers.hpp>
#include <trellis/reader/robot_files.hpp>
#include <trellis/scene/spatial/manipulator_scene.hpp>
#include <trellis/scene/visit.hpp>

#include "support/catch.hpp"
#include "support/fault.hpp"
#include "support/folder.hpp"

using namespace trellis;
using Catch::Matchers::Contains;

namespace {

/// An arm of balls: two links of 0.5 m, which turn about y, and a finger that slides along z.
constexpr const char* arm = R"(<robot name="arm">
 <link name="base"><collision><geometry><sphere radius="0.2"/></geometry></collision></link>
 <link name="upper"><collision><origin xyz="0 0 0.25"/><geometry><sphere radius="0.1"/></geometry></collision></link>
 <link name="lower"><collision><origin xyz="0 0 0.25"/><geometry><sphere radius="0.1"/></geometry></collision></link>
 <link name="finger"><collision><geometry><sphere radius="0.05"/></geometry></collision></link>
 <joint name="lift" type="revolute"><parent link="base"/><child link="upper"/><origin xyz="0 0 0.2"/><axis xyz="0 1 0"/>
  <limit lower="-3" upper="3" effort="1" velocity="1"/></joint>
 <joint name="elbow" type="revolute"><parent link="upper"/><child link="lower"/><origin xyz="0 0 0.5"/>
  <axis xyz="0 1 0"/><limit lower="-3" upper="3" effort="1" velocity="1"/></joint>
 <joint name="grip" type="prismatic"><parent link="lower"/><child link="finger"/><origin xyz="0 0 0.5"/>
  <axis xyz="0 0 1"/><limit lower="0" upper="0.3" effort="1" velocity="1"/></joint>
</robot>)";
constexpr const char* groups = R"(<robot name="arm">
 <virtual_joint name="fixed_base" type="floating" parent_frame="room" child_link="base"/>
 <group name="both"><joint name="lift"/><joint name="elbow"/></group>
 <group name="all"><joint name="lift"/><joint name="elbow"/><joint name="grip"/></group>
</robot>)";

constexpr const char* request = R"(start_state:
  joint_state: {name: [lift, elbow], position: [0, 0]}
goal_constraints:
  - joint_constraints:
      - {joint_name: lift, position: 1}
      - {joint_name: elbow, position: 0.5}
)";

/// A box of 0.1 m in a frame, with more keys.
std::string box(const std::string& id, const std::string& frame, const std::string& position,
                const std::string& more = "") {
  return "    - {id: " + id + ", header: {frame_id: " + frame +
         "}, primitives: [{type: box, dimensions: [0.1, 0.1, 0.1]}], primitive_poses: [{position: " + position +
         ", orientation: [0, 0, 0, 1]}]" + more + "}\n";
}

std::string world_of(const std::string& objects) { return "world:\n  collision_objects:\n" + objects; }

class Files {
 public:
  [[nodiscard]] SphereModel robot(const std::string& group = "both", bool mobile = false) const {
    ManipulatorFiles files;
    files.urdf = folder_.write("arm.urdf", arm);
    files.srdf = folder_.write("arm.srdf", groups);
    files.group = group;
    if (mobile) files.base = Joint::Kind::planar;
    std::vector<std::string> warnings;
    return read_manipulator(files, warnings);
  }
  MoveitFile read(const std::string& scene, const MoveitOptions& options = {}, const std::string& asked = request) {
    if (!asked.empty()) folder_.write("request.yaml", asked);
    return read_moveit(folder_.write("scene.yaml", scene), robot(), options);
  }
  std::string fault(const std::string& scene, const MoveitOptions& options = {}, const std::string& asked = request) {
    return test::fault_of([&] { static_cast<void>(read(scene, options, asked)); });
  }
  [[nodiscard]] const test::Folder& folder() const { return folder_; }

 private:
  test::Folder folder_;
};

Vec3 place(const MoveitFile& file, const std::string& name) {
  for (const Obstacle3& obstacle : file.world.obstacles()) {
    if (obstacle.name.ends_with("(" + name + ")")) return obstacle.solid.pose.position;
  }
  FAIL("no object " + name);
  return {};
}

bool near(const Vec3& a, const Vec3& b) { return norm(a - b) < 1e-9; }

bool valid(const MoveitFile& file, const Configuration& q) {
  const auto scene = std::make_shared<ManipulatorScene>(file.world, file.robot);
  return make_checker("spheres", scene, scene->default_space(1.0), 0.05)->valid(q);
}

}  // namespace

TEST_CASE("objects of MoveIt are in the frames that their headers name", "[reader][moveit]") {
  Files files;
  const MoveitFile file = files.read(
      "fixed_frame_transforms:\n"
      "  - {header: {frame_id: base}, child_frame_id: table, transform: {translation: [1, 0, 0], rotation: [0, 0, 0, "
      "1]}}\n"
      // As MoveIt writes it: the robot's frame is the child.
      "  - {header: {frame_id: shelf}, child_frame_id: base, transform: {translation: [0, 0, 2]}}\n"
      "  - {header: {frame_id: table}, child_frame_id: tray, transform: {translation: [0, 0, 0.5]}}\n" +
      world_of(box("a", "base", "[0, 1, 0]") + box("b", "table", "[0, 1, 0]") + box("c", "lower", "[0, 1, 0]") +
               box("d", "shelf", "[0, 1, 0]") + box("e", "tray", "[0, 1, 0]") + box("f", "room", "[0, 1, 0]") +
               box("g", "/table", "{x: 0, y: 1, z: 0}") + box("h", "b", "[0, 0, 1]") +
               box("i", "\"\"", "[0, 2, 0]", ", subframe_names: [top], subframe_poses: [{position: [0, 0, 0.1]}]") +
               box("j", "i/top", "[0, 0, 0]")));
  CHECK(file.warnings.empty());
  CHECK(near(place(file, "a"), {0, 1, 0}));
  CHECK(near(place(file, "b"), {1, 1, 0}));
  CHECK(near(place(file, "c"), {0, 1, 0.7}));
  CHECK(near(place(file, "d"), {0, 1, 2}));
  CHECK(near(place(file, "e"), {1, 1, 0.5}));
  CHECK(near(place(file, "f"), {0, 1, 0}));
  CHECK(near(place(file, "g"), {1, 1, 0}));
  CHECK(near(place(file, "h"), {1, 1, 1}));
  CHECK(near(place(file, "j"), {0, 2, 0.1}));
  const std::string unknown = files.fault("is_diff: false\n" + world_of(box("a", "lowr", "[0, 1, 0]")));
  CHECK_THAT(unknown, Contains("scene.yaml:4: the frame 'lowr' is not known (did you mean 'lower'?)"));
  // The frame of a link that moves needs a start.
  CHECK_THAT(files.fault(world_of(box("a", "lower", "[0, 1, 0]")), {},
                         "goal_constraints: [{joint_constraints: [{joint_name: lift, position: 1}, {joint_name: elbow, "
                         "position: 1}]}]\n"),
             Contains("is a link that moves"));
}

TEST_CASE("a plane of MoveIt is the half-space where the robot is not", "[reader][moveit]") {
  Files files;
  const auto plane = [&](const std::string& coefficients) {
    return files.read(world_of("    - {id: floor, header: {frame_id: base}, planes: [{coef: " + coefficients +
                               "}], plane_poses: [{position: [0, 0, 0], orientation: [0, 0, 0, 1]}]}\n"));
  };
  const MoveitFile floor = plane("[0, 0, 1, 0.3]");
  REQUIRE(floor.world.obstacles().size() == 1);
  const Box3 box = bounding_box(floor.world.obstacles()[0].solid);
  const double reach = floor.robot.bounding_radius();
  CHECK(std::abs(box.hi.z + 0.3) < 1e-9);
  CHECK(box.lo.z < -reach);
  CHECK(box.lo.x < -2 * reach);
  CHECK(box.hi.y > 2 * reach);
  CHECK(valid(floor, {0, 0}));
  CHECK(valid(floor, {1.5, 0}));
  CHECK(!valid(floor, {2.5, 0}));
  CHECK(floor.world.bounds().lo.z >= -reach);
  // A ceiling, with its normal to either side.
  for (const char* coefficients : {"[0, 0, 1, -1.2]", "[0, 0, -2, 2.4]"}) {
    const MoveitFile ceiling = plane(coefficients);
    CHECK(std::abs(bounding_box(ceiling.world.obstacles()[0].solid).lo.z - 1.2) < 1e-9);
    CHECK(!valid(ceiling, {0, 0}));
    CHECK(valid(ceiling, {1.2, 0}));
  }
  CHECK_THAT(test::fault_of([&] { plane("[0, 0, 0, 1]"); }), Contains("the plane has no direction"));
}

TEST_CASE("objects of MoveIt are added, removed, appended and moved", "[reader][moveit]") {
  Files files;
  for (const std::string remove : {"remove", "1", "REMOVE", "\"\\x01\"", "!!binary AQ=="}) {
    CAPTURE(remove);
    const MoveitFile file = files.read(world_of(box("a", "base", "[0, 1, 0]") + box("b", "base", "[0, 2, 0]") +
                                                "    - {id: a, operation: " + remove + "}\n"));
    REQUIRE(file.world.obstacles().size() == 1);
    CHECK(file.world.obstacles()[0].name == "obstacle 1 (b)");
    CHECK(file.warnings.empty());
  }
  const MoveitFile file =
      files.read(world_of(box("a", "base", "[0, 1, 0]", ", operation: 0") +
                          box("a", "base", "[0, 2, 0]", ", operation: append") + box("b", "base", "[0, 3, 0]") +
                          "    - {id: b, operation: 3, header: {frame_id: base}, pose: {position: [0, 4, 0]}}\n" +
                          box("c", "base", "[0, 5, 0]") + box("c", "base", "[0, 6, 0]", ", operation: add") +
                          "    - {id: d, operation: remove}\n"));
  CHECK(file.world.obstacles().size() == 4);
  CHECK(near(place(file, "a"), {0, 1, 0}));
  CHECK(near(file.world.obstacles()[1].solid.pose.position, {0, 2, 0}));
  CHECK(near(place(file, "b"), {0, 4, 0}));
  CHECK(near(place(file, "c"), {0, 6, 0}));
  REQUIRE(file.warnings.size() == 1);
  CHECK_THAT(file.warnings[0], Contains("scene.yaml:9: object 'd' is removed and was not there"));
  CHECK(files.read(world_of(box("a", "base", "[0, 1, 0]") + "    - {id: \"\", operation: remove}\n"))
            .world.obstacles()
            .empty());
  CHECK_THAT(files.fault(world_of(box("a", "base", "[0, 1, 0]", ", operation: delete"))),
             Contains("the operation 'delete' is not known"));
}

TEST_CASE("ROS' spellings of poses and of primitives", "[reader][moveit]") {
  Files files;
  const MoveitFile file = files.read(world_of(
      "    - header: {seq: 0, stamp: {secs: 0, nsecs: 0}, frame_id: base}\n      id: a\n      type: {key: '', db: ''}\n"
      "      pose: {position: {x: 0, y: 1, z: 0}, orientation: {x: 0, y: 0, z: 0, w: 0}}\n"
      "      primitives: [{type: 1, dimensions: [0.1, 0.2, 0.3]}, {type: 2, dimensions: [0.1]}, {type: 3, dimensions: "
      "[0.4, 0.1]}]\n      primitive_poses: []\n"));
  CHECK(file.warnings.empty());
  const auto& obstacles = file.world.obstacles();
  REQUIRE(obstacles.size() == 3);
  CHECK(std::get<Cuboid>(obstacles[0].solid.shape) == Cuboid{{0.1, 0.2, 0.3}});
  CHECK(std::get<Sphere>(obstacles[1].solid.shape) == Sphere{0.1});
  CHECK(std::get<Cylinder>(obstacles[2].solid.shape) == Cylinder{0.1, 0.4});
  CHECK(near(obstacles[2].solid.pose.position, {0, 1, 0}));
  CHECK_THAT(files.fault(world_of("    - {id: a, primitives: [{type: 4, dimensions: [0.1, 0.1]}]}\n")),
             Contains("scene.yaml:3: a primitive 'cone' is not read"));
}

TEST_CASE("meshes of MoveIt are obstacles", "[reader][moveit]") {
  Files files;
  const MoveitFile file = files.read(world_of(
      "    - {id: m, header: {frame_id: base}, meshes: [{triangles: [{vertex_indices: [0, 1, 2]}, [0, 2, 3]], "
      "vertices: "
      "[{x: 0, y: 0, z: 0}, {x: 1, y: 0, z: 0}, [1, 1, 0], [0, 1, 0]]}], mesh_poses: [{position: [0, 0, 1.5]}]}\n"));
  CHECK(file.warnings.empty());
  REQUIRE(file.world.obstacles().size() == 1);
  const Box3 bounds = bounding_box(file.world.obstacles()[0].solid);
  CHECK(near(bounds.lo, {0, 0, 1.5}));
  CHECK(near(bounds.hi, {1, 1, 1.5}));
  CHECK_THAT(
      files.fault(world_of("    - {id: m, meshes: [{triangles: [[0, 1, 7]], vertices: [[0, 0, 0], [1, 0, 0]]}]}\n")),
      Contains("scene.yaml:3: "));
}

TEST_CASE("attached objects of MoveIt move with their links", "[reader][moveit]") {
  Files files;
  const auto attached = [&](const std::string& more, const std::string& head = "") {
    return files.read("robot_state:\n  attached_collision_objects:\n    - link_name: lower\n      object: {id: rod, " +
                      head +
                      "primitives: [{type: sphere, dimensions: [0.1]}], primitive_poses: [{position: [0, 0, 0.9]}]}\n" +
                      more + world_of(box("wall", "base", "[1.5, 0, 0.2]")));
  };
  const MoveitFile file = attached("");
  CHECK(file.warnings.empty());
  CHECK(file.robot.robot().tree().find_link("rod"));
  CHECK(valid(file, {0, 0}));
  CHECK(!valid(file, {1.5707963, 0}));  // the rod reaches the wall
  // In another frame it is where it is at the start.
  const MoveitFile other = attached("", "header: {frame_id: base}, ");
  const auto rod = *other.robot.robot().tree().find_link("rod");
  CHECK(near(other.robot.robot().pose_of(rod, Configuration{0, 0}).position, {0, 0, 0.7}));
  CHECK_THAT(test::fault_of([&] { attached("      touch_links: [uper]\n"); }),
             Contains("scene.yaml:5: no link is called 'uper' (did you mean 'upper'?)"));
  // An object of the world that a link takes is no obstacle.
  const MoveitFile taken =
      files.read("robot_state:\n  attached_collision_objects: [{link_name: lower, object: {id: a, operation: add}}]\n" +
                 world_of(box("a", "base", "[0, 0, 1.6]") + box("b", "base", "[0, 2, 0]")));
  CHECK(taken.world.obstacles().size() == 1);
  CHECK(taken.robot.robot().tree().find_link("a"));
}

TEST_CASE("padding grows links towards obstacles, not towards each other", "[reader][moveit]") {
  Files files;
  const std::string world = world_of(box("wall", "base", "[0.25, 0, 0.45]"));
  CHECK(valid(files.read(world), {0, 0}));
  CHECK(!valid(files.read("link_padding: [{link_name: upper, padding: 0.11}]\n" + world), {0, 0}));
  CHECK(valid(files.read("link_padding: [{link_name: upper, padding: 0.09}]\n" + world), {0, 0}));
  CHECK(!valid(files.read("link_scale: [{link_name: upper, scale: 2.1}]\n" + world), {0, 0}));
  // A padded finger would meet the upper arm.
  const std::string far = world_of(box("far", "base", "[9, 0, 0]"));
  CHECK(valid(files.read(far), {0, 1.6}));
  CHECK(valid(files.read("link_padding: [{link_name: finger, padding: 0.5}]\n" + far), {0, 1.6}));
  CHECK_THAT(files.fault("link_padding: [{link_name: uper, padding: 0.1}]\n" + world),
             Contains("scene.yaml:1: no link is called 'uper' (did you mean 'upper'?)"));
}

TEST_CASE("the matrix of allowed collisions decides pairs of links", "[reader][moveit]") {
  Files files;
  const std::string world = world_of(box("wall", "base", "[3, 0, 0]"));
  const Configuration folded{0, 2.9, 0};  // the finger meets the base
  const auto matrix = [&](const std::string& names, const std::string& rows, const std::string& more = "") {
    return "allowed_collision_matrix: {entry_names: [" + names + "], entry_values: [" + rows + "]" + more + "}\n" +
           world;
  };
  const auto permits = [&](const std::string& scene) {
    const test::Folder folder;
    return valid(read_moveit(folder.write("scene.yaml", scene), files.robot("all")), folded);
  };
  CHECK(!permits(world));
  CHECK(permits(matrix("base, finger", "[false, true], [true, false]")));
  CHECK(permits(matrix("base, finger", "{enabled: [0, 1]}, {enabled: [1, 0]}")));
  CHECK(!permits(matrix("base, finger", "[false, false], [false, false]")));
  CHECK(permits(matrix("", "", ", default_entry_names: [finger], default_entry_values: [true]")));
  CHECK(!permits(matrix("base, finger", "[false, false], [false, false]",
                        ", default_entry_names: [finger], default_entry_values: [true]")));
  // What the robot's own file permits stays permitted: the matrix is of another model of the robot.
  const std::string forbidding = matrix("base, upper, finger",
                                        "[false, false, false], [false, false, false], "
                                        "[false, false, false]");
  std::vector<std::string> own;
  const MoveitFile kept = [&] {
    const test::Folder folder;
    ManipulatorFiles robot;
    robot.urdf = folder.write("arm.urdf", arm);
    robot.srdf = folder.write("arm.srdf",
                              "<robot name='arm'><group name='all'><joint name='lift'/><joint name='elbow'/>"
                              "<joint name='grip'/></group><disable_collisions link1='base' "
                              "link2='finger' reason='Never'/></robot>");
    robot.group = "all";
    return read_moveit(folder.write("scene.yaml", forbidding), read_manipulator(robot, own), {});
  }();
  CHECK(valid(kept, folded));
  REQUIRE(kept.warnings.size() == 1);
  CHECK_THAT(kept.warnings[0],
             Contains("scene.yaml:1: the matrix forbids some pairs of links to touch; the robot's files "
                      "permit it, so they may: 'base' and 'finger'"));
  CHECK(files.read(forbidding).warnings.empty());
  // Pairs of a link and an object are not read.
  const std::string pair = matrix("upper, wall", "[false, true], [true, false]");
  CHECK_THAT(files.fault(pair),
             Contains("scene.yaml:1: the matrix permits that link 'upper' and object 'wall' touch") &&
                 Contains("ignore = { \"allowed_collision_matrix\" }"));
  const MoveitFile ignored = files.read(pair, {.ignore = {"allowed_collision_matrix"}});
  REQUIRE(ignored.warnings.size() == 1);
  CHECK_THAT(ignored.warnings[0], Contains("'wall' touch") && Contains("left out"));
  CHECK(files.read(matrix("upper, wall", "[false, false], [false, false]")).warnings.empty());
}

TEST_CASE("what changes validity and is not read is an error, or a warning where the caller ignores it",
          "[reader][moveit]") {
  Files files;
  const std::string octomap = "world:\n  octomap: {header: {frame_id: base}, octomap: {id: OcTree, data: [1, 2]}}\n";
  CHECK_THAT(files.fault(octomap),
             Contains("scene.yaml:2: an octomap is not read") && Contains("ignore = { \"octomap\" }"));
  CHECK(files.read(octomap, {.ignore = {"octomap"}}).warnings.size() == 1);
  CHECK(files.read("world:\n  octomap: {octomap: {id: OcTree, data: []}}\n").warnings.empty());
  const std::string constrained =
      request + std::string("path_constraints:\n  orientation_constraints: [{link_name: lower}]\n");
  const std::string world = world_of(box("a", "base", "[0, 1, 0]"));
  CHECK_THAT(files.fault(world, {}, constrained), Contains("request.yaml:8: constraints of the path are not read"));
  CHECK_THAT(files.read(world, {.ignore = {"path_constraints"}}, constrained).warnings.at(0),
             Contains("request.yaml:8:"));
  CHECK(files.read(world, {}, request + std::string("path_constraints: {name: '', joint_constraints: []}\n"))
            .warnings.empty());
  CHECK_THAT(files.fault(world, {.ignore = {"octomp"}}), Contains("'octomp'") && Contains("did you mean 'octomap'?"));
  // What no reader asks for is named with its line, once a kind.
  const MoveitFile file = files.read("colour_of_sky: blue\n" + world_of(box("a", "base", "[0, 1, 0]", ", mass: 1") +
                                                                        box("b", "base", "[0, 2, 0]", ", mass: 2")));
  REQUIRE(file.warnings.size() == 2);
  CHECK_THAT(file.warnings[0], Contains("scene.yaml:1: 'colour_of_sky' is not read"));
  CHECK_THAT(file.warnings[1], Contains("scene.yaml:4: 'mass' is not read (1 more: line 5)"));
}

TEST_CASE("the state of a scene places the joints that do not move, and the base", "[reader][moveit]") {
  Files files;
  const std::string world = world_of(box("wall", "room", "[0, 0, 1.5]"));
  CHECK(valid(files.read(world), {0, 0}));
  const MoveitFile open =
      files.read("robot_state:\n  joint_state: {name: [grip, lift], position: [0.25, 2]}\n" + world);
  CHECK(open.start == Configuration{0, 0});
  CHECK(!valid(open, {0, 0}));  // the finger is out
  // The request's state counts more.
  const std::string closed = "start_state:\n  joint_state: {name: [lift, grip, elbow], position: [0, 0, 0]}\n" +
                             std::string(request).substr(std::string(request).find("goal"));
  CHECK(
      valid(files.read("robot_state:\n  joint_state: {name: [grip], position: [0.25]}\n" + world, {}, closed), {0, 0}));
  const MoveitFile unknown = files.read("robot_state:\n  joint_state: {name: [wheel], position: [1]}\n" + world);
  REQUIRE(unknown.warnings.size() == 1);
  CHECK_THAT(unknown.warnings[0], Contains("not read: wheel"));
  // The virtual joint.
  const MoveitFile moved = files.read(
      "robot_state:\n  multi_dof_joint_state: {header: {frame_id: room}, joint_names: [fixed_base], transforms: "
      "[{translation: [0, 0, 0.3], rotation: [0, 0, 0, 1]}]}\n" +
      world + box("beside", "base", "[1, 0, 0]"));
  CHECK(near(moved.robot.base().position, {0, 0, 0.3}));
  CHECK(near(place(moved, "beside"), {1, 0, 0.3}));
  CHECK(!valid(moved, {0, 0}));
  // A base that moves starts there.
  files.folder().write("request.yaml",
                       "start_state:\n  joint_state: {name: [lift, elbow], position: [0.1, 0.2]}\n"
                       "  multi_dof_joint_state: {joint_names: [fixed_base], transforms: [{translation: [1, 2, 0], "
                       "rotation: [0, 0, 1, 0]}]}\n"
                       "goal_constraints: [{joint_constraints: [{joint_name: lift, position: 0}, {joint_name: "
                       "elbow, position: 0}, {joint_name: base/x, position: 3}]}]\n");
  const MoveitFile driven = read_moveit(files.folder().write("scene.yaml", world), files.robot("both", true));
  REQUIRE(driven.start.size() == 5);
  CHECK(driven.start[0] == 1);
  CHECK(driven.start[1] == 2);
  CHECK(std::abs(std::abs(driven.start[2]) - 3.14159265) < 1e-6);
  CHECK(driven.goals.at(0)[0] == 3);
}

TEST_CASE("goals of MoveIt: joints, several goals, and poses by inverse kinematics", "[reader][moveit]") {
  Files files;
  const std::string world = world_of(box("wall", "room", "[0, 3, 0]"));
  const std::string start =
      "start_state:\n  joint_state: {name: [lift, elbow], position: [0.1, 0.1]}\ngoal_constraints:\n";
  const auto joint = [](const char* lift, const char* elbow) {
    return std::string("  - joint_constraints: [{joint_name: lift, position: ") + lift +
           ", tolerance_above: 0.01, weight: 1}, {joint_name: elbow, position: " + elbow + "}]\n";
  };
  const MoveitFile several = files.read(world, {}, start + joint("1", "0.5") + joint("-1", "3.00001"));
  CHECK(several.warnings.empty());
  CHECK(several.goals == std::vector<Configuration>{{1, 0.5}, {-1, 3}});
  CHECK_THAT(files.fault(world, {}, start + "  - joint_constraints: [{joint_name: lift, position: 1}]\n"),
             Contains("request.yaml:4: the goal lacks joint 'elbow'"));
  CHECK_THAT(files.fault(world, {},
                         start + "  - joint_constraints: [{joint_name: lift, position: 1}, {joint_name: elbow, "
                                 "position: 1}, {joint_name: grip, position: 0.2}]\n"),
             Contains("the goal has joint 'grip' at 0.2"));

  const std::string region =
      "  - position_constraints: [{header: {frame_id: base}, link_name: finger, constraint_region: {primitives: "
      "[{type: "
      "sphere, dimensions: [0.01]}], primitive_poses: [{position: [0.6, 0, 0.5], orientation: [0, 0, 0, 1]}]}, weight: "
      "1}]\n";
  files.folder().write("request.yaml", start + region);
  ReadOptions options;
  options.manipulator = std::make_shared<const SphereModel>(files.robot());
  const Problem near_place = read_problems(files.folder().file("scene.yaml"), options).at(0);
  const SphereModel& robot = near_place.scene->manipulator()->robot;
  const std::size_t finger = *robot.robot().tree().find_link("finger");
  REQUIRE(!near_place.goals.empty());
  for (const Configuration& goal : near_place.goals) {
    CHECK(norm(robot.robot().pose_of(finger, goal).position - Vec3{0.6, 0, 0.5}) < 0.01);
  }
  // Of the two elbows, one has this orientation.
  const Configuration& first = near_place.goals.front();
  const double half = 0.5 * (first[0] + first[1]);
  files.folder().write("request.yaml",
                       start + region +
                           "    orientation_constraints: [{header: {frame_id: base}, link_name: finger, "
                           "orientation: {x: 0, y: " +
                           std::to_string(std::sin(half)) + ", z: 0, w: " + std::to_string(std::cos(half)) +
                           "}, absolute_x_axis_tolerance: 0.1, absolute_y_axis_tolerance: 0.1, "
                           "absolute_z_axis_tolerance: 0.1}]\n");
  std::vector<std::string> warnings;
  const Problem turned = read_problems(files.folder().file("scene.yaml"), options, &warnings).at(0);
  CHECK(warnings.empty());
  REQUIRE(!turned.goals.empty());
  for (const Configuration& goal : turned.goals) CHECK(std::abs(goal[0] + goal[1] - 2 * half) < 0.1);
  // Out of reach, and goals that cannot be read.
  files.folder().write("request.yaml",
                       start + region.substr(0, region.find("[0.6")) + "[6" + region.substr(region.find("[0.6") + 4));
  CHECK_THAT(test::fault_of([&] { read_problems(files.folder().file("scene.yaml"), options); }),
             Contains("request.yaml:4: ") && Contains("likely out of reach"));
  CHECK_THAT(files.fault(world, {}, start + "  - orientation_constraints: [{link_name: finger}]\n"),
             Contains("an orientation without a position is not read") && Contains("reach {"));
  // A goal of the caller's stands for the request's.
  options.goal = {0.5, 0.5};
  CHECK(read_problems(files.folder().file("scene.yaml"), options).at(0).goals ==
        std::vector<Configuration>{{0.5, 0.5}});
}

TEST_CASE("scenes of RViz as text, in both versions", "[reader][moveit]") {
  Files files;
  ReadOptions options;
  options.manipulator = std::make_shared<const SphereModel>(files.robot());
  options.start = {0, 0};
  options.goal = {1, 0.5};
  const auto read = [&](const std::string& text) {
    return read_scene(files.folder().write("room.scene", text), options);
  };
  const auto world = [](const SceneFile& file) { return file.problems.at(0).scene->manipulator()->world; };
  const SceneFile old = read(
      "(noname)+\n* big table\n1\nbox\n1 0.6 0.05\n0.6 0 0.3\n0 0 0 1\n0 0 0 0\n* can\n2\ncylinder\n0.1 0.4\n0 1 0\n0 "
      "0 0 1\n"
      "0 0 0 0\nsphere\n0.2\n0 2 0\n0 0 0 1\n1 0 0 1\n.\n");
  CHECK(old.warnings.empty());
  REQUIRE(world(old).obstacles().size() == 3);
  CHECK(world(old).obstacles()[0].name == "obstacle 1 (big table)");
  CHECK(near(world(old).obstacles()[0].solid.pose.position, {0.6, 0, 0.3}));
  CHECK(std::get<Cylinder>(world(old).obstacles()[1].solid.shape) == Cylinder{0.1, 0.4});
  const SceneFile current = read(
      "room\n* a\n0.5 0 0.25\n0 0 0 1\n2\nbox\n0.1 0.1 0.5\n0 0 1\n0 0 0 1\n0 0 0 0\nmesh\n3 1\n0 0 0\n1 0 0\n0 1 0\n0 "
      "1 2\n0 0 "
      "0\n0 0 0 1\n0 0 0 0\n1\ntop\n0 0 0.5\n0 0 0 1\n* floor\n0 0 0\n0 0 0 1\n1\nplane\n0 0 1 0.2\n0 0 0\n0 0 0 1\n0 "
      "0 0 "
      "0\n0\n.\n");
  CHECK(current.warnings.empty());
  REQUIRE(world(current).obstacles().size() == 3);
  CHECK(near(world(current).obstacles()[0].solid.pose.position, {0.5, 0, 1.25}));
  CHECK(std::abs(bounding_box(world(current).obstacles()[2].solid).hi.z + 0.2) < 1e-9);
  const auto fault = [&](const std::string& text) { return test::fault_of([&] { read(text); }); };
  CHECK_THAT(fault("a\n* b\n1\ncone\n0.1 0.2\n0 0 0\n0 0 0 1\n0 0 0 0\n.\n"),
             Contains("room.scene:4: a shape 'cone' is not read"));
  CHECK_THAT(fault("a\n* b\n1\nbox\n1 1\n.\n"), Contains("room.scene:6: object 'b' ends here, expected z"));
  CHECK_THAT(fault("a\nbox\n.\n"), Contains("room.scene:2: 'box' is here, expected an object"));
  CHECK(read("a\n* b\n1\nsphere\n0.2\n0 2 0\n0 0 0 1\n1 0 0 1\n").warnings.size() == 1);
}

TEST_CASE("a scene of MoveIt is described without its robot", "[reader][moveit]") {
  const test::Folder folder;
  ReadOptions options;
  options.describe = true;
  const SceneFile file = read_scene(
      folder.write("scene.yaml", "robot_model_name: arm\n" + world_of(box("a", "base", "[0, 1, 0]"))), options);
  CHECK(file.format == "planning scene of MoveIt");
  CHECK(file.robot == "arm, not in the file");
  CHECK(file.problems.at(0).scene->obstacle_count() == 1);
  const std::string notes = file.notes.at(0) + file.notes.back();
  CHECK_THAT(notes, Contains("frames of the robot, drawn at the origin: base") &&
                        Contains("scenes.load(\"scene.yaml\", { robot = robot.urdf("));
  const SceneFile text =
      read_scene(folder.write("room.scene", "a\n* b\n1\nsphere\n0.2\n0 2 0\n0 0 0 1\n1 0 0 1\n.\n"), options);
  CHECK(text.problems.at(0).scene->obstacle_count() == 1);
  options.describe = false;
  CHECK_THAT(test::fault_of([&] { read_scene(folder.file("scene.yaml"), options); }),
             Contains("names its robot and does not contain it: give robot = robot.urdf("));
}
