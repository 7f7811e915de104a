// SPDX-License-Identifier: GPL-3.0-or-later
// Clouds of points as obstacles, compared with as many balls.
#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <trellis/base/random.hpp>
#include <trellis/collision/certificate.hpp>
#include <trellis/collision/checker.hpp>
#include <trellis/collision/planar/kernel.hpp>
#include <trellis/collision/spatial/cloud_grid.hpp>
#include <trellis/collision/spatial/sphere_scene.hpp>
#include <trellis/reader/robot_files.hpp>
#include <trellis/scene/spatial/manipulator_scene.hpp>
#include <trellis/scene/spatial/point_cloud.hpp>
#include <trellis/scene/spatial/scene.hpp>

#include "support/catch.hpp"
#include "support/six_arm.hpp"

using namespace trellis;
using Catch::Matchers::WithinAbs;
using test::drawn;
using test::six_arm;

namespace {

/// Points on some planes, and single ones.
std::vector<Vec3> random_points(Stream& stream, std::size_t count) {
  std::vector<Vec3> points;
  Vec3 from, along, across;
  for (std::size_t i = 0; i < count; ++i) {
    if (i % 100 == 0)
      from = drawn(stream, -1.2, 1.2), along = drawn(stream, -0.5, 0.5), across = drawn(stream, -0.5, 0.5);
    const bool single = i % 10 == 0;
    points.push_back(single ? drawn(stream, -1.5, 1.5)
                            : from + stream.uniform(0, 1) * along + stream.uniform(0, 1) * across);
  }
  return points;
}

/// The same obstacles twice: as a cloud, and as balls.
struct Worlds {
  World3 cloud, balls;
};

Worlds random_worlds(Stream& stream, std::size_t count, bool mesh, Contain contain = Contain::none) {
  const auto points = random_points(stream, count);
  const double radius = stream.uniform(0.005, 0.05);
  const Pose3 pose{drawn(stream, -0.1, 0.1), normalised(rotation_of(drawn(stream, -2.0, 2.0)))};
  std::vector<Obstacle3> one{{"box", {Cuboid{{0.2, 0.3, 0.1}}, {drawn(stream, -1.2, 1.2), {}}}}};
  if (mesh) {
    const auto hull = Mesh::hull({{0, 0, 0}, {0.3, 0, 0}, {0, 0.3, 0}, {0, 0, 0.3}}, "tetrahedron");
    one.push_back({"mesh", {std::make_shared<const Mesh>(hull), {drawn(stream, -1.2, 1.2), {}}}});
  }
  std::vector<Obstacle3> many = one;
  one.push_back({"scan", {std::make_shared<const PointCloud>(points, radius, "scan"), pose}});
  for (const Vec3& p : points) many.push_back({"", {Sphere{radius}, {pose(p), {}}}});
  const Box3 bounds{{-2, -2, -2}, {2, 2, 2}};
  return {{bounds, std::move(one), contain}, {bounds, std::move(many), contain}};
}

}  // namespace

TEST_CASE("the cells of a cloud know a bound on the distance of its points", "[collision]") {
  Stream stream(1, "0", "cells");
  for (const std::size_t count : {1U, 3U, 100U, 5000U}) {
    const auto points = random_points(stream, count);
    const CloudGrid grid(points, 0.01);
    const kernel::Cloud3& cloud = grid.data();
    CHECK(cloud.begin[std::size_t{cloud.count[0]} * cloud.count[1] * cloud.count[2]] == count);
    double loosest = 0.0;
    for (int i = 0; i < 500; ++i) {
      std::array<unsigned, 3> cell{};
      Vec3 p;
      for (std::size_t k = 0; k < 3; ++k) {
        const double at = std::min(stream.uniform(0, 1) * (cloud.hi[k] - cloud.lo[k]), cloud.hi[k] - cloud.lo[k]);
        cell[k] = std::min(static_cast<unsigned>(at * cloud.per_metre), cloud.count[k] - 1);
        (k == 0 ? p.x : k == 1 ? p.y : p.z) = cloud.lo[k] + at;
      }
      double least = 1e300;
      for (const Vec3& q : points) least = std::min(least, norm(q - p));
      const auto clear =
          static_cast<double>(cloud.clear[(cell[2] * cloud.count[1] + cell[1]) * cloud.count[0] + cell[0]]);
      REQUIRE(clear <= least);
      loosest = std::max(loosest, least - clear);
    }
    // At most two diagonals of a cell less.
    CHECK(loosest <= 2.0 * std::sqrt(3.0) * cloud.cell * 1.001);
  }
}

TEST_CASE("an arm touches a cloud where it touches one of as many balls, at the same distance", "[collision][robot]") {
  const SphereModel robot = six_arm();
  Stream stream(2, "0", "arms");
  int hits = 0;
  int free = 0;
  for (int w = 0; w < 10; ++w) {
    // Every third world is decided without the kernels.
    const Worlds worlds = random_worlds(stream, 5UL << static_cast<unsigned>(w), w % 3 == 2);
    const auto scene = std::make_shared<ManipulatorScene>(worlds.cloud, robot);
    const auto other = std::make_shared<ManipulatorScene>(worlds.balls, robot);
    const Space space = scene->default_space(1.0);
    const auto checker = make_checker("spheres", scene, space, 0.05);
    const auto expected = make_checker("spheres", other, space, 0.05);
    Configuration a(space.dimension());
    Configuration b(space.dimension());
    for (int i = 0; i < 150; ++i) {
      space.sample_uniform(stream, a);
      for (std::size_t j = 0; j < b.size(); ++j) b[j] = a[j] + 0.4 * stream.normal();
      space.reflect(b);
      INFO("world " << w << ", configuration " << i);
      const bool valid = expected->valid(a);
      valid ? ++free : ++hits;
      REQUIRE(checker->valid(a) == valid);
      REQUIRE_THAT(checker->clearance(a), WithinAbs(expected->clearance(a), 1e-9));
      const auto near = checker->nearest_obstacle(a);
      const auto near_ball = expected->nearest_obstacle(a);
      REQUIRE_THAT(near->distance, WithinAbs(near_ball->distance, 1e-9));
      REQUIRE(near->obstacle == std::min(near_ball->obstacle, worlds.cloud.obstacles().size() - 1));
      REQUIRE(checker->contact(a).has_value() == expected->contact(a).has_value());
      const MotionReport motion = checker->motion(a, b);
      const MotionReport same = expected->motion(a, b);
      REQUIRE(motion.valid == same.valid);
      REQUIRE(motion.checks == same.checks);
      if (i % 5 != 0) continue;
      Certificate certificate{.tolerance = 1e-6 * 0.05};
      Certificate of_balls = certificate;
      checker->certify(a, b, certificate);
      expected->certify(a, b, of_balls);
      REQUIRE(certificate.valid() == of_balls.valid());
      if (!certificate.valid()) continue;
      double clearance = 1e300;
      Configuration q(space.dimension());
      for (int k = 0; k <= 200; ++k) {
        space.interpolate(a, b, k / 200.0, q);
        clearance = std::min(clearance, expected->clearance(q));
      }
      REQUIRE(certificate.clearance <= clearance + 1e-9);
    }
  }
  CHECK(hits > 150);
  CHECK(free > 100);
}

TEST_CASE("the kernels of all instruction sets give the same bits for clouds", "[collision][robot]") {
  unsigned count = 0;
  const kernel::Table* const* const tables = kernel::available(count);
  Stream stream(3, "0", "tables");
  const SphereModel robot = six_arm();
  for (int w = 0; w < 4; ++w) {
    const ManipulatorScene scene(random_worlds(stream, 300, false).cloud, robot);
    const SphereScene prepared(scene, 1e-12);
    REQUIRE(prepared.batched());
    const auto& chain = prepared.chain();
    const auto bodies = static_cast<unsigned>(chain.size());
    kernel::Scene3 what = prepared.kernel_scene();
    const Space space = scene.default_space(1.0);
    Configuration q(space.dimension());
    std::vector<double> change(space.dimension());
    const std::vector<double> bend(bodies, 1e-3);
    const std::vector<double> pair_bend(what.pair_count, 1e-3);
    std::vector<kernel::Lanes> values(change.size());
    for (int i = 0; i < 20; ++i) {
      what.slack = i % 3 == 0 ? 1e-12 : 0.05;
      what.cloud_lanes = i % 2 == 0 ? 0xffU : 0x15U;
      for (unsigned lane = 0; lane < kernel::lanes; ++lane) {
        space.sample_uniform(stream, q);
        for (std::size_t j = 0; j < q.size(); ++j) values[j].v[lane] = q[j];
      }
      for (double& value : change) value = 0.05 * stream.normal();
      std::string first;
      for (unsigned t = 0; t < count; ++t) {
        const kernel::Table& table = *tables[t];
        std::vector<kernel::Lanes> frames(12 * bodies), rates(6 * bodies), centres(3 * prepared.ball_count());
        for (const std::size_t k : {0U, 4U, 8U}) std::fill(std::begin(frames[k].v), std::end(frames[k].v), 1.0);
        std::vector<unsigned> candidates(prepared.scratch_count());
        table.move_chain(chain.data(), bodies, values.data(), frames.data());
        table.rate_chain(chain.data(), bodies, frames.data(), change.data(), rates.data());
        const kernel::ChainMotion motion{change.data(), bend.data(), pair_bend.data()};
        std::array<unsigned, 2> bits{};
        bits[0] = table.meet_chain(chain.data(), bodies, frames.data(), what, centres.data(), candidates.data());
        bits[1] = table.approach_chain(chain.data(), bodies, frames.data(), rates.data(), what, motion, centres.data(),
                                       candidates.data());
        kernel::Lanes least{}, sure{};
        std::fill(std::begin(least.v), std::end(least.v), 10.0);
        sure = least;
        table.measure_chain(chain.data(), bodies, frames.data(), rates.data(), what, motion, centres.data(),
                            candidates.data(), least, sure);
        ConfigurationMemory memory(prepared, {});
        for (std::size_t j = 0; j < q.size(); ++j) q[j] = values[j].v[0];
        CHECK(table.touches(chain.data(), bodies, q.data(), what, memory.get()) == ((bits[0] & 1U) != 0));
        std::string all(reinterpret_cast<const char*>(bits.data()), sizeof bits);
        all.append(reinterpret_cast<const char*>(&least), sizeof least);
        all.append(reinterpret_cast<const char*>(&sure), sizeof sure);
        INFO(table.name << ", world " << w << ", configurations " << i);
        if (t == 0) first = all;
        REQUIRE((all == first));
      }
    }
  }
}

TEST_CASE("a rigid body touches a cloud where it touches one of as many balls, at the same distance", "[collision]") {
  Stream stream(4, "0", "bodies");
  const auto hull = std::make_shared<const Mesh>(
      Mesh::hull({{-0.2, -0.1, -0.1}, {0.3, 0, 0}, {0, 0.3, 0}, {0, 0, 0.3}, {-0.1, 0.2, 0.2}}, "hull"));
  const std::vector<std::vector<Solid>> bodies = {{{Sphere{0.2}, {}}},
                                                  {{Cuboid{{0.5, 0.2, 0.1}}, {}}, {Sphere{0.1}, {{0.3, 0, 0}, {}}}},
                                                  {{Cylinder{0.1, 0.5}, {}}},
                                                  {{Capsule{0.1, 0.4}, {}}},
                                                  {{hull, {}}},
                                                  {{Sphere{0.0}, {}}}};
  int hits = 0;
  int free = 0;
  for (std::size_t w = 0; w < 12; ++w) {
    const Worlds worlds = random_worlds(stream, 150, false, w < 6 ? Contain::none : Contain::robot);
    const Robot3 robot = w % 6 == 5 ? Robot3::point() : Robot3("body", bodies[w % 6], true);
    const auto scene = std::make_shared<SpatialScene>(worlds.cloud, robot);
    const auto other = std::make_shared<SpatialScene>(worlds.balls, robot);
    const Space space = scene->default_space(0.3);
    const auto checker = make_checker("fcl", scene, space, 0.05);
    const auto expected = make_checker("fcl", other, space, 0.05);
    Configuration a(space.dimension());
    Configuration b(space.dimension());
    Configuration q(space.dimension());
    for (int i = 0; i < 60; ++i) {
      space.sample_uniform(stream, a);
      space.sample_uniform(stream, b);
      space.interpolate(a, b, 0.2, q);
      b = q;
      INFO("world " << w << ", configuration " << i);
      const bool valid = expected->valid(a);
      valid ? ++free : ++hits;
      REQUIRE(checker->valid(a) == valid);
      // FCL's distances end at a tolerance.
      const double clearance = expected->clearance(a);
      REQUIRE_THAT(checker->clearance(a), WithinAbs(clearance, 1e-4 * clearance + 1e-5));
      const auto near = checker->nearest_obstacle(a);
      REQUIRE(near.has_value());
      REQUIRE_THAT(near->distance, WithinAbs(expected->nearest_obstacle(a)->distance, 1e-4 * near->distance + 1e-5));
      const MotionReport motion = checker->motion(a, b);
      const MotionReport same = expected->motion(a, b);
      REQUIRE(motion.valid == same.valid);
      REQUIRE(motion.checks == same.checks);
      Certificate certificate{.tolerance = 1e-6 * 0.05};
      Certificate of_balls = certificate;
      checker->certify(a, b, certificate);
      expected->certify(a, b, of_balls);
      REQUIRE(certificate.valid() == of_balls.valid());
      for (int k = 0; certificate.valid() && k <= 50; ++k) {
        space.interpolate(a, b, k / 50.0, q);
        REQUIRE(certificate.clearance <= checker->clearance(q) + 1e-9);
      }
    }
  }
  CHECK(hits > 50);
  CHECK(free > 100);
}
