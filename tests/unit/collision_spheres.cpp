// SPDX-License-Identifier: GPL-3.0-or-later
// Manipulators as balls: other people's problems, and FCL as a second implementation.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include <trellis/base/random.hpp>
#include <trellis/collision/certificate.hpp>
#include <trellis/collision/checker.hpp>
#include <trellis/collision/planar/kernel.hpp>
#include <trellis/collision/spatial/sphere_scene.hpp>
#include <trellis/reader/robot_files.hpp>
#include <trellis/scene/spatial/manipulator_scene.hpp>
#include <trellis/scene/spatial/scene.hpp>

#include "support/catch.hpp"
#include "support/folder.hpp"
#include "support/scenes.hpp"
#include "support/six_arm.hpp"

using namespace trellis;
using test::drawn;
using test::six_arm;

namespace {

/// Primitives of all kinds about the robot, and a mesh if wanted: meshes are decided without the kernels.
World3 random_world(Stream& stream, bool mesh) {
  std::vector<Obstacle3> obstacles;
  const auto add = [&](Shape3 shape) {
    const Pose3 pose{drawn(stream, -1.2, 1.2), normalised(rotation_of(drawn(stream, -2.0, 2.0)))};
    obstacles.push_back({"obstacle " + std::to_string(obstacles.size() + 1), {std::move(shape), pose}});
  };
  for (int i = 0; i < 2; ++i) {
    add(Sphere{stream.uniform(0.05, 0.25)});
    add(Cuboid{drawn(stream, 0.05, 0.4)});
    add(Cylinder{stream.uniform(0.05, 0.2), stream.uniform(0.1, 0.6)});
    add(Capsule{stream.uniform(0.05, 0.1), stream.uniform(0.1, 0.6)});
  }
  if (mesh) {
    add(std::make_shared<const Mesh>(Mesh::hull({{0, 0, 0}, {0.3, 0, 0}, {0, 0.3, 0}, {0, 0, 0.3}}, "tetrahedron")));
  }
  return {{{-2, -2, -2}, {2, 2, 2}}, std::move(obstacles), Contain::none};
}

/// Whether no ball touches an obstacle, by FCL, nor another body's ball that it must not touch.
class BallByBall {
 public:
  BallByBall(const World3& world, const SphereModel& model) : model_(model) {
    for (const auto& balls : model.bodies()) {
      auto& own = checkers_.emplace_back();
      for (const BodySphere& ball : balls) {
        const auto scene = std::make_shared<SpatialScene>(world, Robot3("ball", {{Sphere{ball.radius}, {}}}, false));
        own.push_back(make_checker("fcl_plain", scene, scene->default_space(1.0), 0.05));
      }
    }
  }
  /// \param doubt  receives the least distance from contact of the balls that are free: where it is as small as
  ///     rounding, the answers may differ
  bool valid(View q, double& doubt) const {
    std::vector<Pose3> poses;
    model_.robot().poses(q, poses);
    bool free = true;
    std::vector<std::vector<Vec3>> centres(poses.size());
    for (std::size_t b = 0; b < poses.size(); ++b) {
      for (std::size_t i = 0; i < model_.bodies()[b].size(); ++i) {
        centres[b].push_back((model_.base() * poses[b])(model_.bodies()[b][i].centre));
        if (i == 0) continue;  // the ball about them all
        const Vec3& c = centres[b].back();
        const Configuration at = {c.x, c.y, c.z};
        free = checkers_[b][i]->valid(at) && free;
        doubt = std::min(doubt, checkers_[b][i]->valid(at) ? checkers_[b][i]->clearance(at) : doubt);
      }
    }
    // Link by link, whatever the bodies and their parts.
    for (std::size_t a = 0; a < centres.size(); ++a) {
      for (std::size_t b = a + 1; b < centres.size(); ++b) {
        for (std::size_t i = 1; i < centres[a].size(); ++i) {
          for (std::size_t j = 1; j < centres[b].size(); ++j) {
            if (!model_.checked(model_.link_of(a, i), model_.link_of(b, j))) continue;
            const double gap =
                norm(centres[a][i] - centres[b][j]) - model_.bodies()[a][i].radius - model_.bodies()[b][j].radius;
            doubt = std::min(doubt, std::abs(gap));
            free = free && gap > 0.0;
          }
        }
      }
    }
    return free;
  }

 private:
  const SphereModel& model_;
  std::vector<std::vector<std::unique_ptr<Checker>>> checkers_;
};

}  // namespace

TEST_CASE("starts and goals of the Panda's problems are valid", "[collision][robot]") {
  const std::string folder = test::scene("vamp_mbm").string();
  if (folder.empty()) return;
  ManipulatorFiles files;
  files.urdf = folder + "/robots/panda/panda_spherized.urdf";
  files.srdf = folder + "/robots/panda/panda.srdf";
  files.group = "panda_arm";
  std::vector<std::string> warnings;
  const SphereModel robot = read_manipulator(files, warnings);
  CHECK(robot.exact());
  int count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder + "/panda_samples")) {
    const std::string path = entry.path().string();
    if (path.find("_scene") == std::string::npos) continue;
    INFO(path);
    const MoveitFile file = read_moveit(path, robot);
    const auto scene = std::make_shared<ManipulatorScene>(file.world, file.robot);
    const auto checker = make_checker("spheres", scene, scene->default_space(1.0), 0.05);
    ++count;
    CHECK(checker->valid(file.start));
    CHECK(checker->valid(file.goals.at(0)));
  }
  CHECK(count == 7);
}

TEST_CASE("scenes of robowflex are read with their requests", "[collision][robot]") {
  const std::string folder = test::scene("robowflex_fetch").string();
  const std::string robots = test::scene("vamp_mbm/robots/fetch").string();
  if (folder.empty() || robots.empty()) return;
  ManipulatorFiles files;
  files.urdf = robots + "/fetch_spherized.urdf";
  files.srdf = robots + "/fetch.srdf";
  files.group = "arm_with_torso";
  std::vector<std::string> warnings;
  const SphereModel robot = read_manipulator(files, warnings);
  for (int i = 1; i <= 5; ++i) {
    const MoveitFile file = read_moveit(folder + "/scene_vicon000" + std::to_string(i) + ".yaml", robot);
    INFO("scene " << i);
    CHECK(file.world.obstacles().size() == 7);
    CHECK(file.start.size() == 8);
    CHECK(file.goals.at(0).size() == 8);
  }
}

TEST_CASE("what a manipulator touches is what FCL says of its balls one by one", "[collision][robot]") {
  const SphereModel robot = six_arm();
  Stream stream(1, "0", "balls");
  constexpr double rounding = 1e-9;
  int valid = 0;
  int invalid = 0;
  for (int w = 0; w < 20; ++w) {
    const bool mesh = w % 2 == 1;
    const World3 world = random_world(stream, mesh);
    const auto scene = std::make_shared<ManipulatorScene>(world, robot);
    const Space space = scene->default_space(1.0);
    const auto checker = make_checker("spheres", scene, space, 0.05);
    const BallByBall other(world, robot);
    Configuration q(space.dimension());
    for (int i = 0; i < 100; ++i) {
      space.sample_uniform(stream, q);
      double doubt = 1.0;
      const bool expected = other.valid(q, doubt);
      if (doubt < rounding) continue;
      INFO("world " << w << ", configuration " << i);
      REQUIRE(checker->valid(q) == expected);
      REQUIRE(checker->contact(q).has_value() != expected);
      (expected ? valid : invalid) += 1;
    }
  }
  CHECK(valid > 200);
  CHECK(invalid > 200);
}

TEST_CASE("a motion is valid where the configurations that it is checked at are, and certified only where all are",
          "[collision][robot]") {
  const SphereModel robot = six_arm();
  Stream stream(2, "0", "motions");
  int certified = 0;
  int refuted = 0;
  for (int w = 0; w < 10; ++w) {
    const auto scene = std::make_shared<ManipulatorScene>(random_world(stream, w % 2 == 1), robot);
    const Space space = scene->default_space(1.0);
    const auto checker = make_checker("spheres", scene, space, 0.05);
    Configuration a(space.dimension());
    Configuration b(space.dimension());
    Configuration q(space.dimension());
    for (int i = 0; i < 60; ++i) {
      space.sample_uniform(stream, a);
      for (std::size_t j = 0; j < b.size(); ++j) b[j] = a[j] + 0.8 * stream.normal();
      space.reflect(b);
      if (!checker->valid(a)) continue;
      constexpr int parts = 2000;
      bool all = true;
      double clearance = std::numeric_limits<double>::infinity();
      for (int k = 0; k <= parts; ++k) {
        space.interpolate(a, b, static_cast<double>(k) / parts, q);
        all = all && checker->valid(q);
        if (all && k % 20 == 0) clearance = std::min(clearance, checker->clearance(q));
      }
      const bool valid = checker->motion(a, b).valid;
      Certificate certificate{.tolerance = 1e-6 * 0.05};
      checker->certify(a, b, certificate);
      INFO("world " << w << ", motion " << i);
      // The check of a motion may miss contact between its configurations, the certificate must not.
      if (all) CHECK(valid);
      if (certificate.valid()) {
        CHECK(all);
        CHECK(certificate.clearance <= clearance + 1e-9);
      }
      if (!all) CHECK_FALSE(certificate.valid());
      certificate.valid() ? ++certified : ++refuted;
    }
  }
  CHECK(certified > 50);
  CHECK(refuted > 20);
}

TEST_CASE("a motion of a manipulator is invalid at the first invalid configuration of the bisection order",
          "[collision][robot]") {
  const SphereModel robot = six_arm();
  Stream stream(7, "0", "first");
  constexpr double resolution = 0.05;
  std::array<int, 4> invalid{};  // at the first, second and third configuration, and later
  int valid = 0;
  for (int w = 0; w < 10; ++w) {
    const World3 world = random_world(stream, false);
    const Contain contain = w % 2 == 0 ? Contain::none : Contain::robot;
    const auto scene = std::make_shared<ManipulatorScene>(World3(world.bounds(), world.obstacles(), contain), robot);
    const Space space = scene->default_space(1.0);
    const auto checker = make_checker("spheres", scene, space, resolution);
    Configuration a(space.dimension());
    Configuration b(space.dimension());
    Configuration q(space.dimension());
    for (int i = 0; i < 200; ++i) {
      space.sample_uniform(stream, a);
      if (!checker->valid(a)) continue;
      for (std::size_t j = 0; j < b.size(); ++j) b[j] = a[j] + 0.3 * stream.normal();
      space.reflect(b);
      space.difference(a, b, q);
      double displacement = 0.0;
      for (std::size_t body = 0; body < robot.bodies().size(); ++body) {
        if (robot.bodies()[body].empty()) continue;
        displacement = std::max(displacement, robot.robot().displacement_bound(body, q));
      }
      const auto n = static_cast<std::uint32_t>(std::max(1.0, std::ceil(displacement / resolution)));
      MotionReport expected{true, n, std::numeric_limits<double>::quiet_NaN()};
      const std::vector<std::uint32_t> order = bisection_order(n);
      for (std::uint32_t rank = 0; rank < n && expected.valid; ++rank) {
        const double share = static_cast<double>(order[rank]) / n;
        space.interpolate(a, b, share, q);
        if (!checker->valid(q)) expected = {false, rank + 1, share};
      }
      const MotionReport report = checker->motion(a, b);
      INFO("world " << w << ", motion " << i);
      REQUIRE(report.valid == expected.valid);
      REQUIRE(report.checks == expected.checks);
      if (report.valid) {
        ++valid;
        continue;
      }
      REQUIRE(report.invalid_at == expected.invalid_at);
      invalid[std::min<std::size_t>(report.checks, invalid.size()) - 1] += 1;
    }
  }
  CHECK(valid > 100);
  for (const int count : invalid) CHECK(count > 0);
}

namespace {

/// An arm on a rail, with a gripper whose fingers follow each other.
const char* const railed = R"(<robot name="railed">
  <link name="ground"/>
  <link name="cart"><collision><geometry><sphere radius="0.12"/></geometry></collision></link>
  <link name="upper"><collision><origin xyz="0 0 0.25"/><geometry><sphere radius="0.08"/></geometry></collision>
    <collision><origin xyz="0 0 0.45"/><geometry><sphere radius="0.07"/></geometry></collision></link>
  <link name="fore"><collision><origin xyz="0 0 0.2"/><geometry><sphere radius="0.06"/></geometry></collision>
    <collision><origin xyz="0 0 0.35"/><geometry><sphere radius="0.05"/></geometry></collision></link>
  <link name="left"><collision><origin xyz="0 0.02 0.05"/><geometry><sphere radius="0.02"/></geometry></collision></link>
  <link name="right"><collision><origin xyz="0 -0.02 0.05"/><geometry><sphere radius="0.02"/></geometry></collision></link>
  <joint name="rail" type="prismatic"><parent link="ground"/><child link="cart"/><axis xyz="1 0 0"/>
    <limit lower="-0.8" upper="0.8"/></joint>
  <joint name="turn" type="continuous"><parent link="cart"/><child link="upper"/><origin xyz="0 0 0.1" rpy="0.3 0 0"/>
    <axis xyz="0.2 1 0.1"/></joint>
  <joint name="elbow" type="revolute"><parent link="upper"/><child link="fore"/><origin xyz="0 0 0.5"/>
    <axis xyz="0 1 0"/><limit lower="-2.8" upper="2.8"/></joint>
  <joint name="open" type="prismatic"><parent link="fore"/><child link="left"/><origin xyz="0 0 0.4"/>
    <axis xyz="0 1 0"/><limit lower="0" upper="0.05"/></joint>
  <joint name="follow" type="prismatic"><parent link="fore"/><child link="right"/><origin xyz="0 0 0.4"/>
    <axis xyz="0 -1 0"/><limit lower="0" upper="0.05"/><mimic joint="open"/></joint>
</robot>)";

SphereModel read_railed() {
  const test::Folder folder;
  ManipulatorFiles files;
  files.urdf = folder.write("railed.urdf", railed);
  std::vector<std::string> warnings;
  return read_manipulator(files, warnings);
}

}  // namespace

TEST_CASE("the kernels of all instruction sets give the same bits for manipulators", "[collision][robot]") {
  unsigned count = 0;
  const kernel::Table* const* const tables = kernel::available(count);
  Stream stream(3, "0", "tables");
  for (const SphereModel& robot : {six_arm(), read_railed()}) {
    for (int w = 0; w < 4; ++w) {
      const ManipulatorScene scene(random_world(stream, false), robot);
      const SphereScene prepared(scene, 1e-12);
      REQUIRE(prepared.batched());
      const auto& chain = prepared.chain();
      const auto bodies = static_cast<unsigned>(chain.size());
      kernel::Scene3 what = prepared.kernel_scene();
      std::vector<double> change(robot.robot().dimension());
      std::vector<double> bend(bodies);
      std::vector<double> pair_bend(what.pair_count);
      std::vector<kernel::Lanes> values(change.size());
      const Space space = scene.default_space(1.0);
      Configuration q(space.dimension());
      for (int i = 0; i < 20; ++i) {
        what.bounded = i % 2 == 1;
        what.slack = i % 3 == 0 ? 1e-12 : 0.05;
        for (unsigned lane = 0; lane < kernel::lanes; ++lane) {
          space.sample_uniform(stream, q);
          for (std::size_t j = 0; j < q.size(); ++j) values[j].v[lane] = q[j];
        }
        for (double& value : change) value = 0.05 * stream.normal();
        for (std::size_t b = 0; b < bodies; ++b) bend[b] = prepared.bend(b, prepared.levers()[b].size(), change);
        std::fill(pair_bend.begin(), pair_bend.end(), 1e-4);
        std::string first;
        for (unsigned t = 0; t < count; ++t) {
          const kernel::Table& table = *tables[t];
          std::vector<kernel::Lanes> frames(12 * bodies), rates(6 * bodies), centres(3 * prepared.ball_count());
          frames[0].v[0] = 0.0;
          for (const std::size_t k : {0U, 4U, 8U}) std::fill(std::begin(frames[k].v), std::end(frames[k].v), 1.0);
          std::vector<unsigned> candidates(prepared.scratch_count());
          table.move_chain(chain.data(), bodies, values.data(), frames.data());
          table.rate_chain(chain.data(), bodies, frames.data(), change.data(), rates.data());
          const kernel::ChainMotion motion{change.data(), bend.data(), pair_bend.data()};
          std::array<unsigned, 2> bits{};
          bits[0] = table.meet_chain(chain.data(), bodies, frames.data(), what, centres.data(), candidates.data()) & 1U;
          bits[1] = table.approach_chain(chain.data(), bodies, frames.data(), rates.data(), what, motion,
                                         centres.data(), candidates.data());
          kernel::Lanes least{}, sure{};
          std::fill(std::begin(least.v), std::end(least.v), 10.0);
          sure = least;
          table.measure_chain(chain.data(), bodies, frames.data(), rates.data(), what, motion, centres.data(),
                              candidates.data(), least, sure);
          // One configuration at a time, after others that the memory still has traces of.
          ConfigurationMemory memory(prepared, {});
          std::vector<unsigned char> touches;
          for (unsigned k = 0; k <= kernel::lanes; ++k) {
            for (std::size_t j = 0; j < q.size(); ++j) q[j] = values[j].v[k % kernel::lanes];
            touches.push_back(table.touches(chain.data(), bodies, q.data(), what, memory.get()) ? 1 : 0);
          }
          CHECK(touches.front() == bits[0]);
          CHECK(touches.back() == bits[0]);
          std::string all(touches.begin(), touches.end());
          all.append(reinterpret_cast<const char*>(bits.data()), sizeof bits);
          all.append(reinterpret_cast<const char*>(frames.data()), frames.size() * sizeof(kernel::Lanes));
          all.append(reinterpret_cast<const char*>(rates.data()), rates.size() * sizeof(kernel::Lanes));
          all.append(reinterpret_cast<const char*>(&least), sizeof least);
          all.append(reinterpret_cast<const char*>(&sure), sizeof sure);
          INFO(table.name << ", world " << w << ", configurations " << i);
          if (t == 0) first = all;
          REQUIRE((all == first));
        }
      }
    }
  }
}

TEST_CASE("a certificate's clearance holds at every configuration of a motion, and is nine tenths of what was found",
          "[collision][robot]") {
  Stream stream(4, "0", "clearances");
  int certified = 0;
  int exact = 0;
  for (const SphereModel& robot : {six_arm(), read_railed()}) {
    for (int w = 0; w < 8; ++w) {
      const World3 world = random_world(stream, false);
      // Every second world bounds the robot too.
      const Contain contain = w % 2 == 0 ? Contain::none : Contain::robot;
      const auto scene = std::make_shared<ManipulatorScene>(World3(world.bounds(), world.obstacles(), contain), robot);
      const Space space = scene->default_space(1.0);
      const auto checker = make_checker("spheres", scene, space, 0.05);
      Configuration a(space.dimension());
      Configuration b(space.dimension());
      Configuration q(space.dimension());
      for (int i = 0; i < 40; ++i) {
        space.sample_uniform(stream, a);
        const double far = i % 4 == 0 ? 0.0 : 0.05 * (i % 16);
        for (std::size_t j = 0; j < b.size(); ++j) b[j] = a[j] + far * stream.normal();
        space.reflect(b);
        Certificate certificate{.tolerance = 1e-6 * 0.05};
        checker->certify(a, b, certificate);
        if (!certificate.valid()) continue;
        ++certified;
        constexpr int parts = 500;
        double clearance = std::numeric_limits<double>::infinity();
        for (int k = 0; k <= parts; ++k) {
          space.interpolate(a, b, static_cast<double>(k) / parts, q);
          clearance = std::min(clearance, checker->clearance(q));
        }
        INFO("world " << w << ", motion " << i);
        REQUIRE(certificate.clearance <= clearance + 1e-12);
        REQUIRE(certificate.nearest >= certificate.clearance - 1e-12);
        if (certificate.clearance >= 0.9 * certificate.nearest - 1e-12) ++exact;
      }
    }
  }
  CHECK(certified > 150);
  CHECK(exact > 0.95 * certified);
}
