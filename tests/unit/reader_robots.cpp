// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <trellis/base/error.hpp>
#include <trellis/base/random.hpp>
#include <trellis/reader/robot_files.hpp>

#include "support/catch.hpp"
#include "support/fault.hpp"
#include "support/folder.hpp"
#include "support/scenes.hpp"

#ifdef TRELLIS_KDL
#include <kdl/chainfksolverpos_recursive.hpp>
#include <kdl_parser/kdl_parser.hpp>
#endif

using namespace trellis;
using Catch::Matchers::Contains;

namespace {

std::vector<std::size_t> movable(const KinematicTree& tree) {
  std::vector<std::size_t> all;
  for (std::size_t j = 0; j < tree.joints().size(); ++j) {
    if (tree.joints()[j].width() > 0) all.push_back(j);
  }
  return all;
}

Configuration drawn(const Manipulator& arm, Stream& stream) {
  Configuration q;
  for (const std::size_t j : arm.moving()) {
    const Joint& joint = arm.tree().joints()[j];
    q.push_back(joint.lo + stream.uniform() * (joint.hi - joint.lo));
  }
  return q;
}

const char* const head = R"(<robot name="r"><link name="a"/><link name="b"/>)";

/// The message about a URDF text.
std::string fault_of(const std::string& text) {
  const test::Folder folder;
  const std::string path = folder.write("robot.urdf", text);
  return test::fault_of([&] { static_cast<void>(read_urdf(path)); });
}

}  // namespace

TEST_CASE("forward kinematics of other people's robots agrees with KDL", "[reader][robot]") {
#ifdef TRELLIS_KDL
  for (const std::string name :
       {"panda/panda_spherized", "fetch/fetch_spherized", "baxter/baxter_spherized", "ur5/ur5_spherized"}) {
    const std::string path = test::scene("vamp_mbm/robots/" + name + ".urdf").string();
    if (path.empty()) return;
    CAPTURE(name);
    const UrdfFile file = read_urdf(path);
    const Manipulator arm(file.tree, movable(file.tree));
    KDL::Tree tree;
    REQUIRE(kdl_parser::treeFromFile(path, tree));
    Stream stream(1, "0", name);
    double worst = 0.0;
    for (std::size_t i = 0; i < file.tree.links().size(); ++i) {
      const std::string& link = file.tree.links()[i].name;
      KDL::Chain chain;
      if (!tree.getChain(file.tree.links()[file.tree.base()].name, link, chain)) continue;
      KDL::ChainFkSolverPos_recursive solver(chain);
      for (int k = 0; k < 500; ++k) {
        const Configuration q = drawn(arm, stream);
        KDL::JntArray values(chain.getNrOfJoints());
        unsigned column = 0;
        for (const KDL::Segment& segment : chain.segments) {
          if (segment.getJoint().getType() == KDL::Joint::None) continue;
          const auto j = file.tree.find_joint(segment.getJoint().getName());
          REQUIRE(j);
          const auto at = std::find(arm.moving().begin(), arm.moving().end(), *j) - arm.moving().begin();
          values(column++) = q[static_cast<std::size_t>(at)];
        }
        KDL::Frame frame;
        REQUIRE(solver.JntToCart(values, frame) >= 0);
        const Pose3 pose = arm.pose_of(i, q);
        for (const Vec3 p : {Vec3{0, 0, 0}, Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}}) {
          const KDL::Vector theirs = frame * KDL::Vector(p.x, p.y, p.z);
          const Vec3 ours = pose(p);
          worst = std::max(worst, norm(ours - Vec3{theirs.x(), theirs.y(), theirs.z()}));
        }
      }
    }
    CHECK(worst < 1e-9);
  }
#else
  WARN("SKIPPED: built without KDL (libkdl-parser-dev)");
#endif
}

TEST_CASE("no point of a body moves farther than the bound of its displacement", "[reader][robot]") {
  for (const std::string name :
       {"panda/panda_spherized", "fetch/fetch_spherized", "baxter/baxter_spherized", "ur5/ur5_spherized"}) {
    const std::string path = test::scene("vamp_mbm/robots/" + name + ".urdf").string();
    if (path.empty()) return;
    CAPTURE(name);
    const UrdfFile file = read_urdf(path);
    const Manipulator arm(file.tree, movable(file.tree));
    Stream stream(1, "0", name);
    std::vector<Pose3> before;
    std::vector<Pose3> after;
    for (int k = 0; k < 2000; ++k) {
      const Configuration a = drawn(arm, stream);
      Configuration b = a;
      const double far = stream.uniform();
      Configuration change(a.size());
      for (std::size_t j = 0; j < a.size(); ++j) {
        change[j] = far * (2.0 * stream.uniform() - 1.0);
        b[j] += change[j];
      }
      arm.poses(a, before);
      arm.poses(b, after);
      for (std::size_t i = 0; i < arm.bodies().size(); ++i) {
        const double bound = arm.displacement_bound(i, change);
        for (const Solid& solid : arm.bodies()[i].solids) {
          const Vec3 p = solid.pose.position;
          REQUIRE(norm(after[i](p) - before[i](p)) <= bound + 1e-12);
        }
      }
    }
  }
}

TEST_CASE("groups, states and disabled pairs of SRDF files", "[reader][robot]") {
  const std::string folder = test::scene("vamp_mbm/robots/panda").string();
  if (folder.empty()) return;
  const UrdfFile file = read_urdf(folder + "/panda_spherized.urdf");
  const SrdfFile srdf = read_srdf(folder + "/panda.srdf", file.tree);
  REQUIRE_FALSE(srdf.groups.empty());
  CHECK(srdf.groups.front().name == "panda_arm");
  CHECK(srdf.groups.front().joints.size() == 7);
  REQUIRE_FALSE(srdf.states.empty());
  CHECK(srdf.states.front().name == "ready");
  CHECK(srdf.states.front().values.size() == 7);
  CHECK(srdf.disabled.size() > 20);
}

TEST_CASE("faults of URDF files name file, line and what is meant", "[reader][robot]") {
  const std::string joint = R"(<joint name="j" type="revolute"><parent link="a"/><child link="b"/>)";
  const std::string limit = R"(<limit lower="-1" upper="1"/></joint>)";
  CHECK(fault_of(head + joint + limit + "</robot>").empty());
  CHECK_THAT(fault_of("<robot>\n<link>"), Contains("robot.urdf:2: no XML that can be read"));
  CHECK_THAT(fault_of("<sdf/>"), Contains("robot.urdf:1: the outermost element is no 'robot'"));
  CHECK_THAT(fault_of(std::string(head) + "\n" + R"(<joint name="j" type="revolut"/></robot>)"),
             Contains("robot.urdf:2: no joint is 'revolut' (did you mean 'revolute'?)"));
  CHECK_THAT(fault_of(std::string(head) +
                      R"(<joint name="j" type="fixed"><parent link="a"/><child link="c"/></joint></robot>)"),
             Contains("no link is called 'c'"));
  CHECK_THAT(
      fault_of(
          R"(<robot><link name="a"><collision><geometry><sphere radius="nan"/></geometry></collision></link></robot>)"),
      Contains("'radius' of 'sphere' is 'nan', expected a finite number"));
  CHECK_THAT(
      fault_of(
          R"(<robot><link name="a"><collision><geometry><sphere radius="-1"/></geometry></collision></link></robot>)"),
      Contains("a shape of link 'a'"));
  CHECK_THAT(fault_of(std::string(head) + R"(<link name="a"/></robot>)"), Contains("a second link is called 'a'"));
  CHECK_THAT(fault_of(std::string(head) + "</robot>"), Contains("no joint leads to 'a' nor to 'b'"));
  CHECK_THAT(fault_of(head + joint + limit +
                      R"(<joint name="k" type="fixed"><parent link="b"/><child link="a"/></joint></robot>)"),
             Contains("robot.urdf:1: the joints of robot 'r' make a cycle through 'k': it has no base"));
  // A cycle beside a base, and the line of a joint on it.
  CHECK_THAT(fault_of(std::string(head) + "<link name=\"c\"/>\n" + joint + R"(<limit lower="0" upper="0"/></joint>)" +
                      "\n" + R"(<joint name="k" type="fixed"><parent link="d"/><child link="c"/></joint>)" + "\n" +
                      R"(<joint name="l" type="fixed"><parent link="c"/><child link="d"/></joint>)" + "\n" +
                      R"(<joint name="m" type="fixed"><parent link="d"/><child link="e"/></joint>)" +
                      R"(<link name="d"/><link name="e"/></robot>)"),
             Contains("robot.urdf:3: link 'c' is on a cycle of joints: 'k' leads to it"));
  CHECK_THAT(fault_of(head + joint + "\n" + R"(<origin xyz="0 -1e308 0"/>)" + limit + "</robot>"),
             Contains("robot.urdf:2: the origin of joint 'j' is not within"));
  CHECK_THAT(fault_of(head + joint + limit +
                      R"(<joint name="k" type="fixed"><parent link="a"/><child link="b"/></joint></robot>)"),
             Contains("robot.urdf:1: link 'b' is the child of two joints, 'j' and 'k'"));
  // All faults at once, and every mesh that is missing.
  const std::string mesh = R"(<collision><geometry><mesh filename="package://robot/)";
  const std::string many =
      fault_of(std::string("<robot>\n<link name=\"a\">\n") + mesh + "one.stl\"/></geometry></collision>\n" + mesh +
               "two.stl\"/></geometry></collision>\n</link>\n</robot>");
  CHECK_THAT(many, Contains("2 meshes are not found") && Contains("line 3: package://robot/one.stl") &&
                       Contains("line 4: package://robot/two.stl"));
}

TEST_CASE("joints that cannot move a robot are refused with file and line", "[reader][robot]") {
  const test::Folder folder;
  ManipulatorFiles files;
  files.urdf = folder.write(
      "f.urdf", head + std::string("\n") +
                    R"(<joint name="j" type="floating"><parent link="a"/><child link="b"/></joint></robot>)");
  std::vector<std::string> warnings;
  // Under the base it carries the robot.
  CHECK(read_manipulator(files, warnings).robot().dimension() == 7);
  files.urdf = folder.write(
      "g.urdf", head + std::string("<link name=\"c\"/>\n") +
                    R"(<joint name="i" type="fixed"><parent link="a"/><child link="b"/></joint>)" + "\n" +
                    R"(<joint name="j" type="floating"><parent link="b"/><child link="c"/></joint></robot>)");
  CHECK_THROWS_WITH(read_manipulator(files, warnings), Contains("g.urdf:3: joint 'j' is floating and does not move"));
}

TEST_CASE("robots of 100000 links are refused, and groups within groups are read", "[reader][robot]") {
  std::string many = "<robot name=\"r\">\n";
  for (int i = 0; i < 100000; ++i) {
    many += "<link name=\"l" + std::to_string(i) + "\"/>\n";
    if (i == 0) continue;
    many += "<joint name=\"j" + std::to_string(i) + "\" type=\"fixed\"><parent link=\"l" + std::to_string(i - 1) +
            "\"/><child link=\"l" + std::to_string(i) + "\"/></joint>\n";
  }
  CHECK_THAT(fault_of(many + "</robot>"), Contains("robot.urdf:2001: more than 1000 links"));
  // Each group contains the one before twice: 2^40 paths lead to the first.
  std::string groups = "<robot>\n<group name=\"g0\"><joint name=\"j\"/></group>\n";
  for (int i = 1; i < 40; ++i) {
    const std::string inner = "<group name=\"g" + std::to_string(i - 1) + "\"/>";
    groups += "<group name=\"g" + std::to_string(i) + "\">" + inner + inner + "</group>\n";
  }
  const test::Folder folder;
  const std::string tree = R"(<joint name="j" type="continuous"><parent link="a"/><child link="b"/></joint></robot>)";
  const UrdfFile file = read_urdf(folder.write("r.urdf", head + tree));
  const SrdfFile srdf = read_srdf(folder.write("r.srdf", groups + "</robot>"), file.tree);
  CHECK(srdf.groups.size() == 40);
  CHECK(srdf.groups.back().joints == std::vector<std::size_t>{0});
  const std::string knot =
      R"(<robot><group name="arm"><group name="hand"/></group><group name="hand"><group name="arm"/></group></robot>)";
  CHECK_THAT(read_srdf(folder.write("k.srdf", knot), file.tree).faults.at("arm"),
             Contains("group 'arm' contains itself"));
  const std::string wrong = R"(<robot><group name="arm"><group name="hnad"/></group><group name="hand"/></robot>)";
  CHECK_THAT(read_srdf(folder.write("w.srdf", wrong), file.tree).faults.at("arm"),
             Contains("w.srdf:1: there is no group 'hnad' (did you mean 'hand'?)"));
}
