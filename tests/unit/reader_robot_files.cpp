// SPDX-License-Identifier: GPL-3.0-or-later
// What URDF and SRDF files of others have: packages, scaled meshes, faults in parts that do not move, followers,
// groups and states; and that what is not read is named.
#include <algorithm>
#include <cstdlib>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include <trellis/base/error.hpp>
#include <trellis/reader/robot_files.hpp>
#include <trellis/reader/robot_root.hpp>
#include <trellis/reader/unused.hpp>

#include "support/catch.hpp"
#include "support/fault.hpp"
#include "support/folder.hpp"

using namespace trellis;
using Catch::Matchers::Contains;

namespace {

const char* const plate =
    "v 0 0 0\nv 1 0 0\nv 1 0.2 0\nv 0 0.2 0\nv 0 0 0.1\nv 1 0 0.1\nv 1 0.2 0.1\nv 0 0.2 0.1\n"
    "f 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";

/// A joint from a to b, in the line that it stands in.
std::string joint(const std::string& name, const std::string& type, const std::string& parent, const std::string& child,
                  const std::string& inside = "") {
  return "<joint name=\"" + name + "\" type=\"" + type + "\"><parent link=\"" + parent + "\"/><child link=\"" + child +
         "\"/>" + inside + "</joint>\n";
}

std::string limit(const std::string& lower, const std::string& upper) {
  return "<limit lower=\"" + lower + "\" upper=\"" + upper + "\"/>";
}

std::string shape(const std::string& name, const std::string& geometry) {
  return "<link name=\"" + name + "\"><collision><geometry>" + geometry + "</geometry></collision></link>\n";
}

std::string robot(const std::string& inside) { return "<robot name=\"r\">\n" + inside + "</robot>\n"; }

/// A robot with a link a, and a link b of some geometry that turns about a.
std::string turning(const std::string& geometry) {
  return robot("<link name=\"a\"/>\n" + shape("b", geometry) + joint("j", "continuous", "a", "b"));
}

UrdfFile read(const std::string& text, const UrdfOptions& options = {}) {
  const test::Folder folder;
  return read_urdf(folder.write("robot.urdf", text), options);
}

std::string fault_of(const std::string& text) {
  return test::fault_of([&] { static_cast<void>(read(text)); });
}

const Joint& joint_of(const UrdfFile& file, const std::string& name) {
  return file.tree.joints()[file.tree.find_joint(name).value()];
}

/// The only warning with a text; "" without one.
std::string warning_with(const std::vector<std::string>& warnings, const std::string& part) {
  std::string found;
  for (const std::string& warning : warnings) {
    if (warning.find(part) == std::string::npos) continue;
    CHECK(found.empty());
    found = warning;
  }
  return found;
}

const Solid& solid_of(const UrdfFile& file, const std::string& link) {
  const auto& solids = file.tree.links()[file.tree.find_link(link).value()].solids;
  REQUIRE(solids.size() == 1);
  return solids.front();
}

struct Moving {
  std::optional<SphereModel> robot;
  std::vector<std::string> warnings;
  std::string fault;
};

ManipulatorFiles of_group(const std::string& group) {
  ManipulatorFiles files;
  files.group = group;
  return files;
}

ManipulatorFiles of_joints(const std::vector<std::string>& joints) {
  ManipulatorFiles files;
  files.joints = joints;
  return files;
}

Moving moving(const std::string& urdf, const std::string& srdf = "", const ManipulatorFiles& options = {}) {
  const test::Folder folder;
  ManipulatorFiles files = options;
  files.urdf = folder.write("robot.urdf", urdf);
  if (!srdf.empty()) files.srdf = folder.write("robot.srdf", srdf);
  Moving read;
  read.fault = test::fault_of([&] { read.robot = read_manipulator(files, read.warnings); });
  return read;
}

std::vector<std::string> names_of(const SphereModel& model) {
  std::vector<std::string> names;
  for (const Axis& axis : joint_axes(model.robot(), {}, 1.0)) names.push_back(axis.name);
  return names;
}

SrdfFile srdf_of(const UrdfFile& urdf, const std::string& text) {
  const test::Folder folder;
  return read_srdf(folder.write("robot.srdf", text), urdf.tree);
}

/// A chain l0, l1, l2, l3 of revolute joints j1, j2, j3.
const std::string chain = robot("<link name=\"l0\"/><link name=\"l1\"/><link name=\"l2\"/><link name=\"l3\"/>\n" +
                                joint("j1", "revolute", "l0", "l1", limit("-2", "2")) +
                                joint("j2", "revolute", "l1", "l2", limit("-2", "2")) +
                                joint("j3", "revolute", "l2", "l3", limit("-2", "2")));

}  // namespace

TEST_CASE("entries that a reader did not use are named once a kind, with their lines", "[reader][robot]") {
  const SourceText text{"f.xml", {}};
  CHECK(unused_warnings(text, {}).empty());
  CHECK(unused_warnings(text, {{"octomap", 40}, {"plane", 13}, {"octomap", 12}, {"octomap", 61}}) ==
        std::vector<std::string>{"f.xml:12: 'octomap' is not read (2 more: lines 40, 61)",
                                 "f.xml:13: 'plane' is not read"});
  CHECK(unused_warnings(text, {{"a", 1}, {"a", 2}, {"a", 3}, {"a", 4}, {"a", 5}, {"a", 6}, {"a", 7}}) ==
        std::vector<std::string>{"f.xml:1: 'a' is not read (6 more: lines 2, 3, 4, 5, 6, ...)"});
  CHECK(unused_warnings(text, {{"a", 3}, {"a", 3}, {"a", 4}}) ==
        std::vector<std::string>{"f.xml:3: 'a' is not read (2 more: lines 3, 4)"});
}

TEST_CASE("elements and attributes of URDF files that are not read are named", "[reader][robot]") {
  // Planning does without these.
  const UrdfFile quiet = read(
      robot("<material name=\"red\"><color rgba=\"1 0 0 1\"/></material><gazebo reference=\"b\"><x/></gazebo>"
            "<transmission name=\"t\"><type>x</type></transmission>\n"
            "<link name=\"a\"><inertial><mass value=\"1\"/><inertia ixx=\"1\"/></inertial></link>"
            "<link name=\"b\"><visual><geometry><ball/></geometry></visual><collision name=\"c\"><geometry><sphere "
            "radius=\"1\"/></geometry></collision></link>\n" +
            joint("j", "revolute", "a", "b",
                  "<limit lower=\"0\" upper=\"1\" effort=\"1\" velocity=\"2\"/><dynamics damping=\"1\"/>"
                  "<calibration rising=\"0\"/>")));
  CHECK(quiet.warnings.empty());
  const UrdfFile loud =
      read(robot("<link name=\"a\"/><link name=\"b\"/><loop_joint name=\"l\"/>\n<loop_joint name=\"m\"/>\n" +
                 joint("j", "continuous", "a", "b", limit("-1", "1"))));
  CHECK_THAT(warning_with(loud.warnings, "loop_joint"),
             Contains("robot.urdf:2: 'loop_joint' is not read (1 more: line 3)"));
  CHECK_THAT(warning_with(loud.warnings, "'lower' of 'limit'"),
             Contains("robot.urdf:4: 'lower' of 'limit' is not read"));
}

TEST_CASE("a link with visual geometry and no collision geometry is named, as in MoveIt", "[reader][robot]") {
  const std::string seen = "<visual><geometry><box size=\"1 1 1\"/></geometry></visual></link>\n";
  const UrdfFile file =
      read(robot("<link name=\"a\">" + seen + "<link name=\"b\">" + seen + joint("j", "continuous", "a", "b")));
  CHECK_THAT(
      warning_with(file.warnings, "visual"),
      Contains("robot.urdf:2: link 'a' has visual geometry and no collision geometry") && Contains("(1 more: line 3)"));
}

TEST_CASE("faulty masses, limits and leaders of joints that do not move do not refuse a robot", "[reader][robot]") {
  const auto inertial = [](const std::string& mass) {
    return robot("<link name=\"a\"><inertial><mass value=\"" + mass + "\"/></inertial></link>\n");
  };
  CHECK(read(inertial("1")).warnings.empty());
  CHECK_THAT(warning_with(read(inertial("nan")).warnings, "mass"),
             Contains("robot.urdf:2: 'value' of 'mass' is 'nan', expected a finite number; planning needs no masses"));
  const auto beside = [](const std::string& kind, const std::string& inside) {
    return robot("<link name=\"a\"/><link name=\"b\"/><link name=\"c\"/>\n" +
                 joint("j", "revolute", "a", "b", limit("-1", "1")) + joint("k", kind, "b", "c", inside));
  };
  struct Case {
    std::string kind;
    std::string inside;
    std::string fault;
  };
  for (const auto& [kind, inside, fault] : std::vector<Case>{
           {"revolute", "", "robot.urdf:4: joint 'k' is revolute and has no 'limit'"},
           {"revolute", limit("1", "0"), "robot.urdf:4: the lower limit of joint 'k', 1, is above the upper, 0"},
           {"revolute", limit("nan", "0"), "robot.urdf:4: 'lower' of 'limit' is 'nan', expected a finite number"},
           {"revolute", limit("-1e16", "0"), "robot.urdf:4: the limits of joint 'k' are not within 100000 rad of 0"},
           {"prismatic", limit("-1e16", "1e16"), "robot.urdf:4: the limits of joint 'k' are not within 1e+09 m of 0"},
           {"continuous", "<axis xyz=\"0 0 0\"/>", "robot.urdf:4: the axis of joint 'k' has no direction"},
           {"continuous", "<mimic joint=\"l\"/>", "robot.urdf:4: joint 'k' follows 'l', which is no joint"}}) {
    CAPTURE(kind, inside);
    const std::string text = beside(kind, inside);
    const UrdfFile file = read(text);
    CHECK_THAT(warning_with(file.warnings, "the joint stays where it is"), Contains(fault));
    CHECK(joint_of(file, "k").locked);
    CHECK_FALSE(joint_of(file, "k").plans());
    const Moving all = moving(text);
    REQUIRE(all.fault.empty());
    CHECK(names_of(*all.robot) == std::vector<std::string>{"j"});
    CHECK(moving(text, "", of_joints({"j"})).fault.empty());
    CHECK_THAT(moving(text, "", of_joints({"k"})).fault, Contains(fault));
    const std::string groups = robot(
        "<group name=\"one\"><joint name=\"j\"/></group>"
        "<group name=\"two\"><joint name=\"j\"/><joint name=\"k\"/></group>");
    CHECK(moving(text, groups, of_group("one")).fault.empty());
    CHECK_THAT(moving(text, groups, of_group("two")).fault, Contains(fault));
  }
}

TEST_CASE("a joint whose limits leave no range stays where it is", "[reader][robot]") {
  const std::string fixed = limit("0.3", "0.3");
  const std::string text = robot("<link name=\"a\"/><link name=\"b\"/><link name=\"c\"/><link name=\"d\"/>\n" +
                                 joint("j", "revolute", "a", "b", limit("-1", "1")) +
                                 joint("k", "revolute", "b", "c", "<limit effort=\"1\" velocity=\"1\"/>") +
                                 joint("l", "prismatic", "c", "d", fixed));
  const Moving all = moving(text);
  REQUIRE(all.fault.empty());
  CHECK(names_of(*all.robot) == std::vector<std::string>{"j"});
  CHECK_THAT(warning_with(all.warnings, "'k'"),
             Contains("robot.urdf:4: joint 'k' has the limits 0 and 0: it cannot move; it stays where it is"));
  CHECK(norm(all.robot->robot().pose_of(3, Configuration{0.0}).position - Vec3{0.3, 0, 0}) < 1e-12);
  CHECK_THAT(moving(text, "", of_joints({"k"})).fault, Contains("robot.urdf:4: joint 'k' has the limits 0 and 0"));
  const std::string lone =
      robot("<link name=\"a\"/><link name=\"b\"/>\n" + joint("k", "revolute", "a", "b", limit("0", "0")));
  CHECK_THAT(moving(lone).fault, Contains("robot 'r' has no joint that moves") &&
                                     Contains("robot.urdf:3: joint 'k' has the limits 0 and 0"));
  // Beyond what a joint may turn on both sides, it is continuous.
  const UrdfFile huge =
      read(robot("<link name=\"a\"/><link name=\"b\"/>\n" + joint("k", "revolute", "a", "b", limit("-1e16", "1e16"))));
  CHECK(joint_of(huge, "k").kind == Joint::Kind::continuous);
  CHECK_THAT(warning_with(huge.warnings, "continuous"),
             Contains("robot.urdf:3: joint 'k' has limits of -1e+16 and 1e+16 rad"));
}

TEST_CASE("planar and floating joints inside a robot stay where they are", "[reader][robot]") {
  const std::string text = robot("<link name=\"a\"/><link name=\"b\"/><link name=\"c\"/><link name=\"d\"/>\n" +
                                 joint("j", "revolute", "a", "b", limit("-1", "1")) + joint("f", "floating", "b", "c") +
                                 joint("p", "planar", "c", "d"));
  const Moving all = moving(text);
  REQUIRE(all.fault.empty());
  CHECK(names_of(*all.robot) == std::vector<std::string>{"j"});
  CHECK_THAT(warning_with(all.warnings, "'f'"), Contains("robot.urdf:4: joint 'f' is floating"));
  CHECK_THAT(warning_with(all.warnings, "'p'"), Contains("robot.urdf:5: joint 'p' is planar"));
  CHECK_THAT(moving(text, "", of_joints({"f"})).fault, Contains("robot.urdf:4: joint 'f' is floating"));
}

TEST_CASE("a joint that follows a follower follows its leader", "[reader][robot]") {
  const auto follower = [](const std::string& leader, const std::string& numbers) {
    return limit("0", "1") + "<mimic joint=\"" + leader + "\" " + numbers + "/>";
  };
  const std::string links = "<link name=\"a\"/><link name=\"b\"/><link name=\"c\"/><link name=\"d\"/>\n";
  const UrdfFile file =
      read(robot(links + joint("j3", "prismatic", "c", "d", follower("j2", "multiplier=\"2\"")) +
                 joint("j2", "prismatic", "b", "c", follower("j1", "multiplier=\"0.5\" offset=\"0.1\"")) +
                 joint("j1", "prismatic", "a", "b", limit("0", "1"))));
  const Joint& last = joint_of(file, "j3");
  REQUIRE(last.mimic);
  CHECK(file.tree.joints()[last.mimic->joint].name == "j1");
  CHECK(last.mimic->multiplier == Approx(1.0));
  CHECK(last.mimic->offset == Approx(0.2));
  // 0.25 + (0.5 0.25 + 0.1) + (0.25 + 0.2) along x.
  const Manipulator arm(file.tree, {file.tree.find_joint("j1").value()});
  CHECK(arm.pose_of(3, Configuration{0.25}).position.x == Approx(0.25 + 0.225 + 0.45));
  // Its own limits do not bind it: at 1 it is at 1.2.
  CHECK_THAT(warning_with(file.warnings, "own limits"),
             Contains("robot.urdf:3: joint 'j3' follows 'j1' from 0.2 to 1.2, beyond its own limits of 0 and 1"));
  CHECK_THAT(fault_of(robot(links + joint("j1", "prismatic", "a", "b", follower("j2", "")) +
                            joint("j2", "prismatic", "b", "c", follower("j1", "")) + joint("j3", "fixed", "c", "d"))),
             Contains("robot.urdf:3: joint 'j1' follows 'j2' in a cycle of joints that follow each other"));
  CHECK_THAT(fault_of(robot(links + joint("j1", "prismatic", "a", "b", follower("j1", "")) +
                            joint("j2", "fixed", "b", "c") + joint("j3", "fixed", "c", "d"))),
             Contains("robot.urdf:3: joint 'j1' follows 'j1' in a cycle"));
  CHECK_THAT(fault_of(robot(links + joint("j1", "prismatic", "a", "b", limit("0", "1")) +
                            joint("j2", "prismatic", "b", "c", follower("j1", "multiplier=\"900\"")) +
                            joint("j3", "prismatic", "c", "d", follower("j2", "multiplier=\"900\"")))),
             Contains("robot.urdf:5: joint 'j3' follows 'j1' by more than 1000 times"));
  // A leader that does not move, at its nearest limit; and a fixed one.
  const UrdfFile still =
      read(robot(links + joint("j0", "revolute", "a", "b", limit("-1", "1")) +
                 joint("j1", "prismatic", "b", "c", limit("0.4", "1")) +
                 joint("j2", "prismatic", "c", "d", limit("0", "9") + "<mimic joint=\"j1\" multiplier=\"2\"/>")));
  const Manipulator one(still.tree, {still.tree.find_joint("j0").value()});
  CHECK(one.pose_of(3, Configuration{0.0}).position.x == Approx(0.4 + 0.8));
  const Moving fixed =
      moving(robot(links + joint("j0", "revolute", "a", "b", limit("-1", "1")) + joint("j1", "fixed", "b", "c") +
                   joint("j2", "prismatic", "c", "d", follower("j1", "offset=\"0.7\""))));
  REQUIRE(fixed.fault.empty());
  CHECK(fixed.robot->robot().pose_of(3, Configuration{0.0}).position.x == Approx(0.7));
  CHECK_THAT(warning_with(fixed.warnings, "'j2' follows"), Contains("which is fixed: it stays at 0.7"));
}

TEST_CASE("a continuous joint whose followers are elsewhere after a turn has no seam to cross", "[reader][robot]") {
  const auto geared = [](const std::string& type, const std::string& multiplier) {
    return read(robot("<link name=\"a\"/><link name=\"b\"/><link name=\"c\"/>\n" + joint("w", "continuous", "a", "b") +
                      joint("g", type, "a", "c",
                            (type == "prismatic" ? limit("-9", "9") : "") + "<mimic joint=\"w\" multiplier=\"" +
                                multiplier + "\"/>")));
  };
  const UrdfFile half = geared("continuous", "0.5");
  CHECK(joint_of(half, "w").kind == Joint::Kind::revolute);
  CHECK(joint_of(half, "w").lo == -std::numbers::pi);
  CHECK(joint_of(half, "w").hi == std::numbers::pi);
  CHECK_THAT(warning_with(half.warnings, "turn"),
             Contains("robot.urdf:3: joint 'w' is continuous") && Contains("from -pi to pi"));
  CHECK_FALSE(joint_axes(Manipulator(half.tree, {half.tree.find_joint("w").value()}), {}, 1.0).front().periodic);
  CHECK(joint_of(geared("continuous", "-2"), "w").kind == Joint::Kind::continuous);
  CHECK(joint_of(geared("continuous", "0"), "w").kind == Joint::Kind::continuous);
  CHECK(joint_of(geared("prismatic", "1"), "w").kind == Joint::Kind::revolute);
}

TEST_CASE("soft limits bind by an option, and a warning names them without it", "[reader][robot]") {
  const std::string soft =
      limit("-1", "1") + "<safety_controller k_velocity=\"1\" soft_lower_limit=\"-0.5\" soft_upper_limit=\"0.8\"/>";
  const std::string text = robot("<link name=\"a\"/><link name=\"b\"/>\n" + joint("j", "revolute", "a", "b", soft));
  CHECK(joint_of(read(text), "j").lo == -1.0);
  CHECK_THAT(warning_with(read(text).warnings, "soft"),
             Contains("robot.urdf:3: the soft limits of joint 'j' are not used; soft_limits = true"));
  const UrdfFile bound = read(text, {.soft_limits = true});
  CHECK(joint_of(bound, "j").lo == -0.5);
  CHECK(joint_of(bound, "j").hi == 0.8);
  CHECK(bound.warnings.empty());
}

TEST_CASE("meshes of a package are found in that package alone", "[reader][robot]") {
  const test::Folder folder;
  const auto mesh = [](const std::string& uri) { return turning("<mesh filename=\"" + uri + "\"/>"); };
  static_cast<void>(folder.write("arm_description/meshes/base.obj", plate));
  const std::string urdf = folder.write("arm_description/urdf/arm.urdf", mesh("package://gripper/meshes/base.obj"));
  const std::string fault = test::fault_of([&] { static_cast<void>(read_urdf(urdf)); });
  CHECK_THAT(fault, Contains("arm.urdf: 1 mesh is not found") &&
                        Contains("line 3: package://gripper/meshes/base.obj of link 'b'") &&
                        Contains("packages = { gripper = \"FOLDER\" }") &&
                        Contains("arm_description/meshes/base.obj is the file, write packages = { gripper = \"") &&
                        Contains("missing_meshes = \"leave_out\""));
  // The folder is called as the package, or its package.xml names it, or the folder of the package is beside.
  const auto found_in = [&](const UrdfFile& file) {
    return std::filesystem::relative(file.meshes.at(0).path, folder.path()).string();
  };
  const std::string own =
      folder.write("arm_description/urdf/own.urdf", mesh("package://arm_description/meshes/base.obj"));
  CHECK(found_in(read_urdf(own)) == "arm_description/meshes/base.obj");
  static_cast<void>(folder.write("gripper/meshes/base.obj", plate));
  CHECK(found_in(read_urdf(urdf)) == "gripper/meshes/base.obj");
  static_cast<void>(
      folder.write("renamed/package.xml", "<?xml version=\"1.0\"?><package><name> tool </name></package>"));
  static_cast<void>(folder.write("renamed/meshes/base.obj", plate));
  const std::string tool = folder.write("renamed/urdf/tool.urdf", mesh("package://tool/meshes/base.obj"));
  CHECK(found_in(read_urdf(tool)) == "renamed/meshes/base.obj");
  const std::string third = folder.write("arm_description/urdf/third.urdf", mesh("package:///gripper/meshes/base.obj"));
  CHECK(found_in(read_urdf(third)) == "gripper/meshes/base.obj");
  // The option comes first, and nothing else counts then.
  static_cast<void>(folder.write("elsewhere/meshes/base.obj", plate));
  CHECK(found_in(read_urdf(urdf, {.packages = {{"gripper", folder.file("elsewhere")}}})) ==
        "elsewhere/meshes/base.obj");
  CHECK_THAT(test::fault_of([&] {
               static_cast<void>(read_urdf(urdf, {.packages = {{"gripper", folder.file("renamed/urdf")}}}));
             }),
             Contains("package 'gripper' is " + folder.file("renamed/urdf") + ", which lacks the file"));
  // ROS_PACKAGE_PATH has folders that are packages or contain them.
  static_cast<void>(folder.write("ws/src/stack/camera_v2/package.xml", "<package><name>camera</name></package>"));
  static_cast<void>(folder.write("ws/src/stack/camera_v2/lens.obj", plate));
  const std::string camera = folder.write("c.urdf", mesh("package://camera/lens.obj"));
  CHECK_THAT(test::fault_of([&] { static_cast<void>(read_urdf(camera)); }), Contains("'camera'"));
  ::setenv("ROS_PACKAGE_PATH", (folder.file("nowhere") + ":" + folder.file("ws/src")).c_str(), 1);
  CHECK(found_in(read_urdf(camera)) == "ws/src/stack/camera_v2/lens.obj");
  ::unsetenv("ROS_PACKAGE_PATH");
  // Links may lack their meshes by an option.
  const UrdfFile without = read_urdf(camera, {.leave_out_missing = true});
  CHECK(without.tree.links()[1].solids.empty());
  CHECK_THAT(warning_with(without.warnings, "of link 'b'"),
             Contains("c.urdf:3: the mesh package://camera/lens.obj of link 'b' is not found"));
}

TEST_CASE("meshes are mirrored and stretched by their scale", "[reader][robot]") {
  const test::Folder folder;
  static_cast<void>(folder.write("plate.obj", plate));
  const auto mesh = [&](const std::string& scale) {
    const std::string path = folder.write("r.urdf", turning("<mesh filename=\"plate.obj\" scale=\"" + scale + "\"/>"));
    return std::get<std::shared_ptr<const Mesh>>(solid_of(read_urdf(path), "b").shape);
  };
  CHECK(mesh("1 1 1")->bounds() == Box3{{0, 0, 0}, {1, 0.2, 0.1}});
  CHECK(mesh("1 -1 1")->bounds() == Box3{{0, -0.2, 0}, {1, 0, 0.1}});
  CHECK(mesh("1 1 2")->bounds() == Box3{{0, 0, 0}, {1, 0.2, 0.2}});
  CHECK(mesh("-1 -1 1")->bounds() == Box3{{-1, -0.2, 0}, {0, 0, 0.1}});
  for (const char* scale : {"1 1 1", "1 -1 1", "-1 -1 -1", "1 -1 2"}) {
    CAPTURE(scale);
    CHECK(mesh(scale)->closed());
    CHECK(mesh(scale)->volume() > 0.0);
    CHECK(contains(*mesh(scale), 0.5 * (mesh(scale)->bounds().lo + mesh(scale)->bounds().hi)));
  }
  // The triangles of an open mesh keep their outer side, too.
  static_cast<void>(folder.write("plate.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"));
  const auto normal = [](const Mesh& one) {
    const auto& v = one.vertices();
    const Triangle& t = one.triangles().front();
    return cross(v[t[1]] - v[t[0]], v[t[2]] - v[t[0]]);
  };
  CHECK(normal(*mesh("1 1 1")).z > 0.0);
  CHECK(normal(*mesh("1 -1 1")).z > 0.0);
  CHECK_THAT(test::fault_of([&] { static_cast<void>(mesh("1 0 1")); }),
             Contains("r.urdf:3: ") && Contains("must not be 0, got 1 0 1"));
}

TEST_CASE("points are left out, and flat shapes are thin", "[reader][robot]") {
  const auto shapes = [](const std::string& geometry) { return read(turning(geometry)); };
  for (const char* geometry :
       {"<sphere radius=\"0\"/>", "<box size=\"0 0 0\"/>", "<cylinder radius=\"0\" length=\"0\"/>"}) {
    CAPTURE(geometry);
    const UrdfFile file = shapes(geometry);
    CHECK(file.tree.links()[1].solids.empty());
    CHECK_THAT(warning_with(file.warnings, "point"),
               Contains("robot.urdf:3: the ") && Contains("of link 'b' is a point: it is left out"));
  }
  const UrdfFile box = shapes("<box size=\"0.1 0 0.1\"/>");
  CHECK(std::get<Cuboid>(solid_of(box, "b").shape).size == Vec3{0.1, 1e-4, 0.1});
  CHECK_THAT(warning_with(box.warnings, "extent"), Contains("robot.urdf:3: the box of link 'b' has an extent of 0"));
  const auto line = std::get<Cylinder>(solid_of(shapes("<cylinder radius=\"0\" length=\"1\"/>"), "b").shape);
  CHECK(line.radius == 5e-5);
  CHECK(std::get<Cylinder>(solid_of(shapes("<cylinder radius=\"1\" length=\"0\"/>"), "b").shape).length == 1e-4);
  CHECK(std::get<Sphere>(solid_of(shapes("<capsule radius=\"1\" length=\"0\"/>"), "b").shape).radius == 1.0);
  CHECK_THAT(fault_of(turning("<box/>")), Contains("robot.urdf:3: 'box' lacks 'size'"));
  CHECK_THAT(fault_of(turning("<box size=\"1 -1 1\"/>")), Contains("robot.urdf:3: a shape of link 'b'"));
}

TEST_CASE("files that are mistaken for URDF and SRDF files are named", "[reader][robot]") {
  const std::string space = " xmlns:xacro=\"http://www.ros.org/wiki/xacro\"";
  const std::string links = "<link name=\"a\"/>\n";
  CHECK_THAT(
      fault_of("<robot name=\"r\"" + space + ">\n" + links + "<xacro:arm parent=\"a\"/></robot>"),
      Contains("robot.urdf:3: a xacro file: expand it first: xacro ") && Contains("robot.urdf > robot_expanded.urdf"));
  CHECK_THAT(fault_of(turning("<sphere radius=\"${r}\"/>")), Contains("robot.urdf:3: a xacro file"));
  CHECK(fault_of("<robot name=\"r\"" + space + ">" + links + "</robot>").empty());
  CHECK(xacro_command("a/arm.urdf.xacro") == "xacro a/arm.urdf.xacro > arm.urdf");
  CHECK_THAT(fault_of("<sdf version=\"1.6\"/>"),
             Contains("robot.urdf:1: the outermost element is no 'robot' but 'sdf': "
                      "it is an SDF file"));
  CHECK_THAT(fault_of("<mujoco/>"), Contains("it is a model of MuJoCo (MJCF); a URDF file is expected"));
  CHECK_THAT(fault_of(robot("<group name=\"arm\"/>")), Contains("it is an SRDF file"));
  const UrdfFile file = read(chain);
  CHECK_THAT(test::fault_of([&] { static_cast<void>(srdf_of(file, chain)); }), Contains("it is a URDF file"));
  CHECK_THAT(test::fault_of([&] { static_cast<void>(srdf_of(file, robot("<xacro:group name=\"a\"/>"))); }),
             Contains("robot.srdf:2: a xacro file") && Contains("robot_expanded.srdf"));
}

TEST_CASE("the pairs of a SRDF file are those of srdfdom", "[reader][robot]") {
  const UrdfFile file = read(chain);
  using Pairs = std::vector<std::pair<std::size_t, std::size_t>>;
  const std::string all = "<disable_default_collisions link=\"l1\"/>";
  CHECK(srdf_of(file, robot(all)).disabled == Pairs{{0, 1}, {1, 2}, {1, 3}});
  CHECK(srdf_of(file, robot("<enable_collisions link1=\"l3\" link2=\"l1\"/>" + all)).disabled == Pairs{{0, 1}, {1, 2}});
  // What is disabled by itself stays so.
  CHECK(srdf_of(file, robot(all + "<enable_collisions link1=\"l1\" link2=\"l3\"/>"
                                  "<disable_collisions link1=\"l3\" link2=\"l1\" reason=\"never\"/>"))
            .disabled == Pairs{{0, 1}, {1, 2}, {1, 3}});
  const SrdfFile other = srdf_of(file, robot("<disable_default_collisions link=\"hand\"/>"
                                             "<disable_collisions link1=\"hat\" link2=\"l1\"/>"));
  CHECK(other.disabled.empty());
  CHECK_THAT(warning_with(other.warnings, "lacks"), Contains("hand, hat"));
}

TEST_CASE("a named state is that of the group", "[reader][robot]") {
  const auto state = [](const std::string& name, const std::string& group, const std::vector<double>& values) {
    std::string text = "<group_state name=\"" + name + "\" group=\"" + group + "\">";
    for (std::size_t i = 0; i < values.size(); ++i) {
      text += "<joint name=\"j" + std::to_string(i + 1) + "\" value=\"" + std::to_string(values[i]) + "\"/>";
    }
    return text + "</group_state>\n";
  };
  const std::string text = robot(
      "<group name=\"all\"><chain base_link=\"l0\" tip_link=\"l3\"/></group>\n"
      "<group name=\"low\"><joint name=\"j1\"/><joint name=\"j2\"/></group>\n" +
      state("home", "all", {1.0, 1.25, 0.5}) + state("home", "low", {0.125, 0.25}) +
      state("up", "all", {0.5, 0.5, 0.5}) + state("out", "low", {9.0, 0.0}));
  const auto home = [&](const ManipulatorFiles& options, const std::string& name) {
    const Moving read = moving(chain, text, options);
    REQUIRE(read.robot);
    for (const SphereModel::State& one : read.robot->states()) {
      if (one.name == name) return one.q;
    }
    return Configuration{};
  };
  CHECK(home(of_group("low"), "home") == Configuration{0.125, 0.25});
  CHECK(home(of_group("all"), "home") == Configuration{1.0, 1.25, 0.5});
  CHECK(home(of_joints({"j1", "j2"}), "home") == Configuration{0.125, 0.25});
  CHECK(home({}, "home") == Configuration{1.0, 1.25, 0.5});
  CHECK(home(of_group("low"), "up") == Configuration{0.5, 0.5});
  CHECK_THAT(warning_with(moving(chain, text, of_group("low")).warnings, "'out'"),
             Contains("robot.srdf:7: in state 'out' joint 'j1' is 9, outside of its limits [-2, 2]"));
}

TEST_CASE("a faulty group or state of a SRDF file is left out, unless it is asked for", "[reader][robot]") {
  const std::string text = robot(
      "<group name=\"good\"><joint name=\"j1\"/></group>\n"
      "<group name=\"bad\"><joint name=\"finger\"/></group>\n"
      "<group name=\"good\"><joint name=\"j2\"/></group>\n"
      "<group_state name=\"home\" group=\"bad\"/>\n"
      "<group_state name=\"odd\" group=\"good\"><joint name=\"thumb\" value=\"0\"/></group_state>\n"
      "<group name=\"arm\"><joint name=\"j1\"/><joint name=\"j2\"/></group>\n");
  const Moving arm = moving(chain, text, of_group("arm"));
  REQUIRE(arm.fault.empty());
  CHECK(names_of(*arm.robot) == std::vector<std::string>{"j1", "j2"});
  CHECK_THAT(warning_with(arm.warnings, "'finger'"),
             Contains("robot.srdf:3: the robot has no joint 'finger'") && Contains("the group is left out"));
  CHECK_THAT(warning_with(arm.warnings, "second group"), Contains("robot.srdf:4: "));
  CHECK_THAT(warning_with(arm.warnings, "no group 'bad'"),
             Contains("robot.srdf:5: ") && Contains("the state is left out"));
  CHECK_THAT(warning_with(arm.warnings, "'thumb'"), Contains("robot.srdf:6: ") && Contains("the value is left out"));
  CHECK_THAT(moving(chain, text, of_group("bad")).fault, Contains("robot.srdf:3: the robot has no joint 'finger'"));
  CHECK_THAT(moving(chain, text, of_group("good")).fault, Contains("robot.srdf:4: a second group is called 'good'"));
}

TEST_CASE("elements of SRDF files that are not read are named", "[reader][robot]") {
  const std::string text = robot(
      "<virtual_joint name=\"w\" type=\"fixed\" parent_frame=\"world\" child_link=\"l0\"/>\n"
      "<group name=\"arm\"><joint name=\"w\"/><joint name=\"j1\"/><joint name=\"j2\"/></group>\n"
      "<end_effector name=\"e\" parent_link=\"l3\" group=\"arm\"/>\n"
      "<passive_joint name=\"j2\"/>\n"
      "<link_sphere_approximation link=\"l1\"><sphere/></link_sphere_approximation>\n");
  const SrdfFile file = srdf_of(read(chain), text);
  CHECK(file.warnings.size() == 1);
  CHECK_THAT(file.warnings.at(0), Contains("robot.srdf:6: 'link_sphere_approximation' is not read"));
  REQUIRE(file.passive.size() == 1);
  CHECK_THAT(warning_with(moving(chain, text, of_group("arm")).warnings, "passive"),
             Contains("robot.srdf:5: joint 'j2' is passive, without a motor, and moves here"));
  CHECK(warning_with(moving(chain, text, of_joints({"j1"})).warnings, "passive").empty());
}

TEST_CASE("the outline of a SRDF file needs no robot", "[reader][robot]") {
  const test::Folder folder;
  const SrdfOutline outline = read_srdf_outline(folder.write(
      "a.srdf", robot("<group name=\"arm\"><chain base_link=\"l0\" tip_link=\"l3\"/><joint name=\"k\"/></group>"
                      "<group_state name=\"home\" group=\"arm\"><joint name=\"k\" value=\"0.5\"/></group_state>"
                      "<disable_collisions link1=\"a\" link2=\"b\"/><disable_default_collisions link=\"c\"/>")));
  CHECK(outline.robot == "r");
  REQUIRE(outline.groups.size() == 1);
  CHECK(outline.groups[0].of == std::vector<std::string>{"chain l0 to l3", "joint k"});
  REQUIRE(outline.states.size() == 1);
  CHECK(outline.states[0].of == std::vector<std::string>{"k 0.5"});
  CHECK(outline.disabled == 1);
  CHECK(outline.default_links == std::vector<std::string>{"c"});
}
