// SPDX-License-Identifier: GPL-3.0-or-later
// A pair permission is a statement about two links: which joints move, and where the others are, changes no answer.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include <trellis/base/random.hpp>
#include <trellis/collision/certificate.hpp>
#include <trellis/collision/checker.hpp>
#include <trellis/reader/robot_files.hpp>
#include <trellis/scene/spatial/manipulator_scene.hpp>

#include "support/catch.hpp"
#include "support/folder.hpp"
#include "support/scenes.hpp"
#include "support/six_arm.hpp"

using namespace trellis;
using Catch::Matchers::Contains;
using test::drawn;

namespace {

World3 empty_world() { return {{{-9, -9, -9}, {9, 9, 9}}, {}, Contain::none}; }

std::unique_ptr<Checker> checker_of(const SphereModel& model, const World3& world = empty_world()) {
  const auto scene = std::make_shared<ManipulatorScene>(world, model);
  return make_checker("spheres", scene, scene->default_space(1.0), 0.05);
}

/// A robot with joints of all kinds, of which some links have no geometry.
KinematicTree random_tree(Stream& stream) {
  const auto count = 8 + static_cast<std::size_t>(stream.uniform() * 8.0);
  std::vector<Link> links;
  std::vector<Joint> joints;
  for (std::size_t i = 0; i < count; ++i) {
    Link link{"link" + std::to_string(i), {}};
    const auto solids = static_cast<int>(stream.uniform() * 3.0);
    for (int k = 0; k < solids; ++k) {
      const Pose3 pose{drawn(stream, -0.2, 0.2), normalised(rotation_of(drawn(stream, -2.0, 2.0)))};
      if (stream.uniform() < 0.8) {
        link.solids.push_back({Sphere{stream.uniform(0.03, 0.12)}, pose});
      } else {
        link.solids.push_back({Cuboid{drawn(stream, 0.05, 0.2)}, pose});
      }
    }
    links.push_back(std::move(link));
    if (i == 0) continue;
    Joint joint{.name = "joint" + std::to_string(i), .child = i};
    // Chains with branches.
    joint.parent = stream.uniform() < 0.7 ? i - 1 : static_cast<std::size_t>(stream.uniform() * static_cast<double>(i));
    joint.origin = {drawn(stream, -0.25, 0.25), normalised(rotation_of(drawn(stream, -2.0, 2.0)))};
    const Vec3 axis = drawn(stream, -1.0, 1.0);
    joint.axis = (1.0 / norm(axis)) * axis;
    const double kind = stream.uniform();
    joint.kind = kind < 0.2   ? Joint::Kind::fixed
                 : kind < 0.6 ? Joint::Kind::revolute
                 : kind < 0.8 ? Joint::Kind::continuous
                              : Joint::Kind::prismatic;
    joint.lo = -stream.uniform(0.1, 2.0);
    joint.hi = stream.uniform(0.1, 2.0);
    if (joint.kind == Joint::Kind::prismatic) joint.lo *= 0.1, joint.hi *= 0.1;
    joints.push_back(std::move(joint));
  }
  // One joint follows another.
  std::vector<std::size_t> own;
  for (std::size_t j = 0; j < joints.size(); ++j) {
    if (joints[j].kind != Joint::Kind::fixed) own.push_back(j);
  }
  if (own.size() > 3) joints[own[2]].mimic = Joint::Mimic{own[0], 0.5, 0.1};
  return {"random", std::move(links), std::move(joints)};
}

std::vector<std::size_t> all_moving(const KinematicTree& tree) {
  std::vector<std::size_t> moving;
  for (std::size_t j = 0; j < tree.joints().size(); ++j) {
    if (tree.joints()[j].width() > 0) moving.push_back(j);
  }
  return moving;
}

double drawn_value(Stream& stream, const Joint& joint) {
  if (joint.kind != Joint::Kind::continuous) return stream.uniform(joint.lo, joint.hi);
  return stream.uniform(-std::numbers::pi, std::numbers::pi);
}

/// A URDF file of a robot with two joints about z. Its links a, b and c have a ball each: that of b is at the second
/// joint, that of c at a place along x from there.
std::string folding_arm(double place, const std::string& more = "") {
  return fmt::format(
      R"(<robot name="r"><link name="a"><collision><geometry><sphere radius="0.1"/></geometry></collision></link>
<link name="b"><collision><origin xyz="0.5 0 0"/><geometry><sphere radius="0.1"/></geometry></collision></link>
<link name="c"><collision><origin xyz="{} 0 0"/><geometry><sphere radius="0.1"/></geometry></collision></link>
<joint name="j" type="revolute"><parent link="a"/><child link="b"/><axis xyz="0 0 1"/><limit lower="-3" upper="3"/></joint>
<joint name="k" type="revolute"><parent link="b"/><child link="c"/><origin xyz="0.5 0 0"/><axis xyz="0 0 1"/><limit lower="-3.2" upper="3.2"/></joint>{}</robot>)",
      place, more);
}

struct Count {
  int valid = 0;
  int invalid = 0;
  int differences = 0;
};

/// Compares random groups of a robot's joints, with random values of the others, with all joints moving.
Count compare(const SphereModel& whole, Stream& stream, int groups, int configurations) {
  const KinematicTree& tree = whole.robot().tree();
  const std::vector<std::size_t>& all = whole.robot().moving();
  const auto of_whole = checker_of(whole);
  Count count;
  for (int g = 0; g < groups; ++g) {
    std::vector<std::size_t> moving;
    std::vector<std::vector<double>> values(tree.joints().size());
    Configuration q(all.size());
    const double share = stream.uniform();
    for (std::size_t k = 0; k < all.size(); ++k) {
      if (stream.uniform() < share || (k + 1 == all.size() && moving.empty())) {
        moving.push_back(all[k]);
      } else {
        q[k] = drawn_value(stream, tree.joints()[all[k]]);
        values[all[k]] = {q[k]};
      }
    }
    const SphereModel group(Manipulator(tree, moving, values), whole.covers(), whole.may_touch());
    const auto of_group = checker_of(group);
    for (int i = 0; i < configurations; ++i) {
      Configuration own;
      for (std::size_t k = 0; k < all.size(); ++k) {
        if (!std::binary_search(moving.begin(), moving.end(), all[k])) continue;
        q[k] = drawn_value(stream, tree.joints()[all[k]]);
        own.push_back(q[k]);
      }
      const bool valid = of_whole->valid(q);
      ++(valid ? count.valid : count.invalid);
      // Without pairs both are infinite.
      const double clearance = of_whole->clearance(q);
      const double own_clearance = of_group->clearance(own);
      const bool same = of_group->valid(own) == valid && of_group->contact(own).has_value() != valid &&
                        (clearance == own_clearance || std::abs(clearance - own_clearance) < 1e-9);
      if (!same) ++count.differences;
    }
  }
  return count;
}

}  // namespace

TEST_CASE("a group of joints is valid where the robot with all joints is", "[collision][robot]") {
  Stream stream(7, "0", "links");
  Count sum;
  for (int r = 0; r < 20; ++r) {
    INFO("robot " << r);
    const KinematicTree tree = random_tree(stream);
    SphereModel::Pairs may_touch;
    for (std::size_t a = 0; a < tree.links().size(); ++a) {
      for (std::size_t b = a + 1; b < tree.links().size(); ++b) {
        if (stream.uniform() < 0.5) may_touch.emplace_back(a, b);
      }
    }
    const Count count = compare(SphereModel(Manipulator(tree, all_moving(tree)), may_touch), stream, 10, 100);
    CHECK(count.differences == 0);
    sum.valid += count.valid;
    sum.invalid += count.invalid;
  }
  CHECK(sum.valid > 1000);
  CHECK(sum.invalid > 1000);
}

TEST_CASE("groups of other people's robots are valid where these robots are", "[collision][robot]") {
  const std::string folder = test::scene("vamp_mbm").string();
  if (folder.empty()) return;
  Stream stream(8, "0", "links");
  for (const std::string name : {"panda", "ur5", "fetch", "baxter"}) {
    INFO(name);
    ManipulatorFiles files;
    files.urdf = folder + "/robots/" + name + "/" + name + "_spherized.urdf";
    files.srdf = folder + "/robots/" + name + "/" + name + ".srdf";
    std::vector<std::string> warnings;
    const Count count = compare(read_manipulator(files, warnings), stream, 10, 100);
    CHECK(count.differences == 0);
    CHECK(count.invalid > 0);
  }
}

TEST_CASE("motions of a group are certified where those of the robot with all joints are", "[collision][robot]") {
  Stream stream(9, "0", "links");
  int certified = 0;
  int refuted = 0;
  for (int r = 0; r < 20; ++r) {
    INFO("robot " << r);
    const KinematicTree tree = random_tree(stream);
    const std::vector<std::size_t> all = all_moving(tree);
    const SphereModel whole(Manipulator(tree, all), {});
    const auto of_whole = checker_of(whole);
    const std::vector<std::size_t> moving(all.begin(), all.begin() + static_cast<std::ptrdiff_t>((all.size() + 1) / 2));
    std::vector<std::vector<double>> values(tree.joints().size());
    Configuration a(all.size());
    for (std::size_t k = 0; k < all.size(); ++k) {
      a[k] = drawn_value(stream, tree.joints()[all[k]]);
      if (k >= moving.size()) values[all[k]] = {a[k]};
    }
    const auto of_group = checker_of(SphereModel(Manipulator(tree, moving, values), whole.covers(), {}));
    for (int i = 0; i < 20; ++i) {
      Configuration b = a;
      for (std::size_t k = 0; k < moving.size(); ++k) {
        a[k] = drawn_value(stream, tree.joints()[all[k]]);
        b[k] = a[k] + 0.05 * stream.normal();
      }
      Certificate one{.tolerance = 1e-6};
      Certificate other{.tolerance = 1e-6};
      of_whole->certify(a, b, one);
      const auto part = [&](const Configuration& q) {
        return Configuration(q.begin(), q.begin() + static_cast<std::ptrdiff_t>(moving.size()));
      };
      of_group->certify(part(a), part(b), other);
      CHECK(one.valid() == other.valid());
      ++(one.valid() ? certified : refuted);
      if (one.valid()) CHECK(other.clearance <= of_group->clearance(part(a)) + 1e-9);
    }
  }
  CHECK(certified > 10);
  CHECK(refuted > 10);
}

TEST_CASE("links of one body that touch leave no valid configuration", "[collision][robot]") {
  const test::Folder folder;
  const std::string text =
      folding_arm(0.5, R"(<link name="d"><collision><geometry><sphere radius="0.05"/></geometry></collision></link>
<joint name="l" type="prismatic"><parent link="c"/><child link="d"/><origin xyz="0.7 0 0"/><axis xyz="1 0 0"/><limit lower="0" upper="0.2"/></joint>)");
  ManipulatorFiles files;
  files.urdf = folder.write("r.urdf", text);
  files.joints = {"l"};
  std::vector<std::string> warnings;
  // Folded: link c lies on link a.
  files.values = {{"k", std::numbers::pi}};
  const SphereModel folded = read_manipulator(files, warnings);
  REQUIRE(warnings.size() == 1);
  CHECK_THAT(warnings.front(),
             Contains("'a' meets 'c' at the values of the joints that do not move: no configuration"));
  REQUIRE(folded.standing());
  CHECK(folded.standing()->gap < 0.0);
  const auto checker = checker_of(folded);
  const Configuration q = {0.1};
  CHECK_FALSE(checker->valid(q));
  CHECK(checker->clearance(q) == 0.0);
  CHECK_FALSE(checker->motion(q, q).valid);
  Certificate certificate{.tolerance = 1e-6};
  checker->certify(q, q, certificate);
  CHECK_FALSE(certificate.valid());
  const ManipulatorScene scene(empty_world(), folded);
  CHECK(describe(*checker->contact(q), scene) == "itself (a meets c)");
  warnings.clear();
  files.values = {{"k", 0.5}};
  CHECK(checker_of(read_manipulator(files, warnings))->valid(q));
  CHECK(warnings.empty());
}

TEST_CASE("links of one body whose covers touch are compared by their shapes", "[collision][robot]") {
  // Boxes of link a and link c, whose sides are 4 mm from each other where k is at 0.
  const std::string text = R"(<robot name="r">
<link name="a"><collision><geometry><box size="0.1 0.1 0.1"/></geometry></collision></link>
<link name="b"/>
<link name="c"><collision><origin xyz="0 0 0.104"/><geometry><box size="0.1 0.1 0.1"/></geometry></collision></link>
<link name="d"><collision><geometry><sphere radius="0.05"/></geometry></collision></link>
<joint name="j" type="revolute"><parent link="a"/><child link="b"/><axis xyz="0 0 1"/><limit lower="-1" upper="1"/></joint>
<joint name="i" type="fixed"><parent link="b"/><child link="e"/></joint>
<link name="e"><collision><origin xyz="0.5 0 0"/><geometry><sphere radius="0.01"/></geometry></collision></link>
<joint name="k" type="prismatic"><parent link="e"/><child link="c"/><axis xyz="0 0 1"/><limit lower="-0.1" upper="1"/></joint>
<joint name="l" type="prismatic"><parent link="c"/><child link="d"/><origin xyz="0.7 0 0"/><axis xyz="1 0 0"/><limit lower="0" upper="0.2"/></joint>
</robot>)";
  const test::Folder folder;
  ManipulatorFiles files;
  files.urdf = folder.write("r.urdf", text);
  files.joints = {"l"};
  const auto standing = [&](double k, bool of_covers) {
    files.values = {{"k", k}};
    std::vector<std::string> warnings;
    const SphereModel robot = read_manipulator(files, warnings);
    if (of_covers) return SphereModel(robot.robot(), robot.covers(), robot.may_touch()).standing()->gap;
    CHECK(checker_of(robot)->valid(Configuration{0.1}) == (robot.standing()->gap > 0.0));
    CHECK((!warnings.empty() && warnings.back().find("no configuration is valid") != std::string::npos) ==
          (robot.standing()->gap <= 0.0));
    return robot.standing()->gap;
  };
  CHECK(standing(0.0, true) < 0.0);
  CHECK(standing(0.0, false) == Approx(0.004).epsilon(0.01));
  CHECK(standing(-0.01, false) < 0.0);
}

TEST_CASE("a pair that touches at zero alone is checked", "[robot]") {
  const test::Folder folder;
  const std::string text = folding_arm(-0.5);
  ManipulatorFiles files;
  files.urdf = folder.write("r.urdf", text);
  std::vector<std::string> warnings;
  const SphereModel robot = read_manipulator(files, warnings);
  CHECK(warnings.empty());
  CHECK_FALSE(checker_of(robot)->valid(Configuration{0.0, 0.0}));
  CHECK(checker_of(robot)->valid(Configuration{0.0, 2.0}));
}

TEST_CASE("permissions of a link concern no link that is fixed to it", "[robot]") {
  const test::Folder folder;
  // A coarse cover is fixed to link b, and may touch the base; b itself may not.
  const std::string text =
      R"(<robot name="r"><link name="base"><collision><geometry><sphere radius="0.1"/></geometry></collision></link>
<link name="a"/><link name="b"><collision><origin xyz="0.55 0 0"/><geometry><sphere radius="0.05"/></geometry></collision></link>
<link name="coarse"><collision><origin xyz="0.6 0 0"/><geometry><sphere radius="0.4"/></geometry></collision></link>
<link name="m"><collision><geometry><sphere radius="0.05"/></geometry></collision></link>
<joint name="j" type="revolute"><parent link="base"/><child link="m"/><origin xyz="0 0 0.3"/><axis xyz="0 0 1"/><limit lower="-3" upper="3"/></joint>
<joint name="i" type="fixed"><parent link="m"/><child link="a"/></joint>
<joint name="k" type="revolute"><parent link="a"/><child link="b"/><origin xyz="0.5 0 -0.3"/><axis xyz="0 0 1"/><limit lower="-3.2" upper="3.2"/></joint>
<joint name="f" type="fixed"><parent link="b"/><child link="coarse"/></joint></robot>)";
  ManipulatorFiles files;
  files.urdf = folder.write("r.urdf", text);
  files.srdf = folder.write("r.srdf", R"(<robot name="r">
<disable_collisions link1="coarse" link2="base"/><disable_collisions link1="coarse" link2="m"/></robot>)");
  std::vector<std::string> warnings;
  const auto valid = [&](const SphereModel& robot, const Configuration& q) { return checker_of(robot)->valid(q); };
  const SphereModel robot = read_manipulator(files, warnings);
  // Here coarse meets the base, and b does not; there b meets it, too.
  const Configuration here = {0.0, 2.4};
  const Configuration there = {0.0, 3.1};
  CHECK(valid(robot, here));
  CHECK_FALSE(valid(robot, there));
  const ManipulatorScene permitted(empty_world(), robot);
  CHECK(describe(*checker_of(robot)->contact(there), permitted) == "itself (base meets b)");
  files.srdf = folder.write("s.srdf", R"(<robot name="r"><disable_collisions link1="coarse" link2="m"/></robot>)");
  const SphereModel strict = read_manipulator(files, warnings);
  CHECK_FALSE(valid(strict, here));
  const ManipulatorScene scene(empty_world(), strict);
  CHECK(describe(*checker_of(strict)->contact(here), scene) == "itself (base meets coarse)");
}

TEST_CASE("what an attached shape may touch is a permission of the shape alone", "[robot]") {
  const test::Folder folder;
  const std::string text = folding_arm(0.5);
  ManipulatorFiles files;
  files.urdf = folder.write("r.urdf", text);
  std::vector<std::string> warnings;
  const SphereModel arm = read_manipulator(files, warnings);
  const std::size_t a = *arm.robot().tree().find_link("a");
  const std::size_t c = *arm.robot().tree().find_link("c");
  const Solid ball{Sphere{0.1}, {{0.45, 0.3, 0}, {}}};
  const Configuration near = {0.0, 2.55};  // the carried ball meets the base, the link that carries it does not
  const Configuration folded = {0.0, 3.1};
  const SphereModel strict = arm.attached("ball", ball, c, {});
  const SphereModel held = arm.attached("ball", ball, c, {a});
  CHECK(checker_of(arm)->valid(near));
  CHECK_FALSE(checker_of(arm)->valid(folded));
  CHECK(checker_of(held)->valid(near));
  CHECK_FALSE(checker_of(held)->valid(folded));
  CHECK(checker_of(strict)->valid(Configuration{0.0, 0.0}));
  CHECK_FALSE(checker_of(strict)->valid(near));
  CHECK_FALSE(checker_of(strict)->valid(folded));
}
