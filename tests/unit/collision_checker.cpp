// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/collision/checker.hpp>

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <set>

#include <trellis/base/error.hpp>
#include <trellis/collision/planar/kernel.hpp>
#include <trellis/collision/planar/part_index.hpp>
#include <trellis/collision/planar/planar_checker.hpp>
#include <trellis/scene/planar/scene.hpp>
#include "collision_worlds.hpp"
#include "support/catch.hpp"

using namespace collision_test;

namespace {

constexpr double pi = std::numbers::pi;

const std::array<std::string, 2> backends = {"planar", "fcl"};

std::vector<const kernel::Table*> tables() {
  unsigned count = 0;
  const kernel::Table* const* first = kernel::available(count);
  return {first, first + count};
}

Case one_box(Robot robot, std::vector<Shape> shapes) {
  return make_case("one box", World({{0, 0}, {10, 10}}, {box(4, 2, 6, 5)}), std::move(robot), {std::move(shapes)});
}

}  // namespace

TEST_CASE("the bisection order starts at the end and halves from the left") {
  CHECK(bisection_order(0).empty());
  CHECK(bisection_order(1) == std::vector<std::uint32_t>{1});
  CHECK(bisection_order(2) == std::vector<std::uint32_t>{2, 1});
  CHECK(bisection_order(3) == std::vector<std::uint32_t>{3, 1, 2});
  CHECK(bisection_order(8) == std::vector<std::uint32_t>{8, 4, 2, 6, 1, 3, 5, 7});
  CHECK(bisection_order(10) == std::vector<std::uint32_t>{10, 5, 2, 7, 1, 3, 6, 8, 4, 9});
}

TEST_CASE("the bisection order visits each configuration once and leaves no wide gap") {
  for (std::uint32_t n = 1; n < 300; ++n) {
    std::set<std::uint32_t> visited = {0};
    const auto order = bisection_order(n);
    REQUIRE(order.size() == n);
    REQUIRE(order.front() == n);
    std::size_t level_end = 1;
    for (std::size_t i = 0; i < order.size(); ++i) {
      REQUIRE(order[i] >= 1);
      REQUIRE(order[i] <= n);
      REQUIRE(visited.insert(order[i]).second);
      // After 2^k configurations no gap is wider than n / 2^k, rounded up.
      if (i + 1 != level_end) continue;
      std::uint32_t previous = 0;
      for (const std::uint32_t v : visited) {
        REQUIRE(v - previous <= (n + level_end - 1) / level_end);
        previous = v;
      }
      level_end *= 2;
    }
  }
}

TEST_CASE("the kernels' sine and cosine are as good as the library's") {
  Stream stream(3, "test", "angles");
  for (const auto* table : tables()) {
    INFO(table->name);
    kernel::Line line;
    line.turns = true;
    kernel::Lanes shares{};
    kernel::Poses poses{};
    double worst = 0;
    for (int i = 0; i < 20000; ++i) {
      const double range = i % 2 == 0 ? 8.0 : kernel::largest_angle;
      for (double& share : shares.v) share = stream.uniform(-range, range);
      shares.v[0] = 0.5 * pi * std::floor(shares.v[0]);
      line.turn = 1.0;
      line.end_angle = 1.0;
      table->poses(line, shares.v, poses);
      for (unsigned lane = 0; lane < kernel::lanes; ++lane) {
        worst = std::max(worst, std::abs(poses.s.v[lane] - std::sin(shares.v[lane])));
        worst = std::max(worst, std::abs(poses.c.v[lane] - std::cos(shares.v[lane])));
      }
    }
    CHECK(worst < 3e-16);
  }
}

TEST_CASE("every instruction set gives the same bits") {
  const auto all = tables();
  Stream stream(4, "test", "kernels");
  kernel::Line line;
  line.turns = true;
  for (int i = 0; i < 2000; ++i) {
    kernel::Lanes shares{};
    for (double& share : shares.v) share = stream.uniform();
    shares.v[7] = 1.0;
    for (double* x : {&line.x, &line.y, &line.angle, &line.difference_x, &line.difference_y, &line.turn, &line.end_x,
                      &line.end_y, &line.end_angle, &line.joint_x, &line.joint_y}) {
      *x = stream.uniform(-10, 10);
    }
    kernel::Poses expected{};
    all.front()->poses(line, shares.v, expected);
    for (const auto* table : all) {
      kernel::Poses poses{};
      table->poses(line, shares.v, poses);
      for (unsigned lane = 0; lane < kernel::lanes; ++lane) {
        for (auto coordinate : {&kernel::Poses::x, &kernel::Poses::y, &kernel::Poses::c, &kernel::Poses::s}) {
          const double found = (poses.*coordinate).v[lane];
          REQUIRE(std::bit_cast<std::uint64_t>(found) == std::bit_cast<std::uint64_t>((expected.*coordinate).v[lane]));
        }
      }
    }
  }

  auto cases = paper_cases();
  for (auto& c : mixed_cases()) cases.push_back(std::move(c));
  for (const Case& c : cases) {
    INFO(c.name);
    std::vector<std::unique_ptr<Checker>> checkers;
    checkers.reserve(all.size());
    for (const auto* table : all) checkers.push_back(make_planar_checker(c.scene, c.space, 0.05, *table));
    Configuration a(c.space.dimension());
    Configuration b(c.space.dimension());
    for (int i = 0; i < 20000; ++i) {
      random_motion(stream, c.space, a, b);
      const MotionReport expected = checkers.front()->motion(a, b);
      const bool valid = checkers.front()->valid(b);
      for (const auto& checker : checkers) {
        REQUIRE(same(checker->motion(a, b), expected));
        REQUIRE(checker->valid(b) == valid);
      }
      // The end of a valid motion is valid, to the last bit.
      if (expected.valid) REQUIRE(valid);
      if (!valid) REQUIRE(expected.checks == 1);
    }
  }
}

TEST_CASE("touching an obstacle is a collision") {
  const Shape square = Box2{{-0.25, -0.25}, {0.25, 0.25}};
  const double away = 1e-9;
  for (const auto& backend : backends) {
    INFO(backend);
    const auto c = one_box(Robot::rigid({square}), {square});
    const auto checker = make_checker(backend, c.scene, c.space, 0.05);
    for (const double angle : {0.0, 0.5 * pi, -pi, -0.5 * pi}) {
      CHECK_FALSE(checker->valid(Configuration{3.75, 3, angle}));
      CHECK(checker->valid(Configuration{3.75 - away, 3, angle}));
      CHECK_FALSE(checker->valid(Configuration{5, 5.25, angle}));
      CHECK(checker->valid(Configuration{5, 5.25 + away, angle}));
      CHECK_FALSE(checker->valid(Configuration{6.25, 5.25, angle}));
      CHECK(checker->valid(Configuration{6.25 + away, 5.25 + away, angle}));
    }
    // A corner at an edge.
    const double half_diagonal = 0.25 * std::sqrt(2.0);
    CHECK_FALSE(checker->valid(Configuration{4 - half_diagonal, 3, 0.25 * pi}));
    CHECK(checker->valid(Configuration{4 - half_diagonal - away, 3, 0.25 * pi}));
    CHECK(checker->clearance(Configuration{3.75, 3, 0}) == 0.0);

    const auto d = one_box(Robot::disc(0.5), {Disc{{}, 0.5}});
    const auto disc = make_checker(backend, d.scene, d.space, 0.05);
    CHECK_FALSE(disc->valid(Configuration{3.5, 3}));
    CHECK(disc->valid(Configuration{3.5 - away, 3}));
    CHECK_FALSE(disc->valid(Configuration{6.3, 5.4}));
    CHECK(disc->valid(Configuration{6.3 + away, 5.4}));

    const auto p = one_box(Robot::point(), {Disc{}});
    const auto point = make_checker(backend, p.scene, p.space, 0.05);
    CHECK_FALSE(point->valid(Configuration{4, 2}));
    CHECK_FALSE(point->valid(Configuration{5, 5}));
    CHECK_FALSE(point->valid(Configuration{5, 3}));
    CHECK(point->valid(Configuration{4 - away, 2}));
    CHECK(point->valid(Configuration{5, 5 + away}));
  }
}

TEST_CASE("the robot may touch the boundary and not cross it") {
  const Shape square = Box2{{-0.25, -0.25}, {0.25, 0.25}};
  for (const auto& backend : backends) {
    INFO(backend);
    const auto c = one_box(Robot::rigid({square}), {square});
    const auto checker = make_checker(backend, c.scene, c.space, 0.05);
    CHECK(checker->valid(Configuration{0.25, 0.25, 0}));
    CHECK(checker->clearance(Configuration{0.25, 0.25, 0}) == Approx(0.0).margin(1e-12));
    CHECK_FALSE(checker->valid(Configuration{0.25 - 1e-9, 0.25, 0}));
    CHECK_FALSE(checker->valid(Configuration{0.25, 0.25 - 1e-9, 0}));
    CHECK(checker->valid(Configuration{9.75, 9.75, 0.5 * pi}));
    CHECK_FALSE(checker->valid(Configuration{9.75 + 1e-9, 9.75, 0}));
    CHECK_FALSE(checker->valid(Configuration{-5, 20, 0}));
    // A motion that leaves the world and comes back: turning in a corner.
    const auto turn = checker->motion(Configuration{0.25, 0.25, 0}, Configuration{0.25, 0.25, 0.5 * pi});
    CHECK_FALSE(turn.valid);
    CHECK(turn.checks == 2);
    CHECK(turn.invalid_at == 0.5);
  }
}

TEST_CASE("motions of length zero, and configurations that are no numbers") {
  const Shape square = Box2{{-0.25, -0.25}, {0.25, 0.25}};
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const auto& backend : backends) {
    INFO(backend);
    const auto c = one_box(Robot::rigid({square}), {square});
    const auto checker = make_checker(backend, c.scene, c.space, 0.05);
    const Configuration open = {1, 1, 0.5};
    const Configuration near = {3.6, 3, 0.0};
    const Configuration in = {5, 3, 0.5};
    for (const auto& q : {open, near}) {
      const auto report = checker->motion(q, q);
      CHECK(report.valid);
      CHECK(report.checks == 1);
      CHECK(std::isnan(report.invalid_at));
    }
    const auto stuck = checker->motion(in, in);
    CHECK_FALSE(stuck.valid);
    CHECK(stuck.checks == 1);
    CHECK(stuck.invalid_at == 1.0);
    // The caller has validated the start.
    CHECK(checker->motion(in, open).valid == false);
    const auto leaving = checker->motion(Configuration{3.75, 3, 0}, Configuration{3.75 - 0.04, 3, 0});
    CHECK(leaving.valid);
    CHECK(leaving.checks == 1);

    for (std::size_t axis = 0; axis < 3; ++axis) {
      Configuration q = near;
      q[axis] = nan;
      CHECK_FALSE(checker->valid(q));
      CHECK_FALSE(checker->motion(near, q).valid);
      CHECK(checker->clearance(q) == 0.0);
    }
  }
}

TEST_CASE("angles of any size") {
  const Shape bar = Box2{{-1, -0.1}, {1, 0.1}};
  for (const auto& backend : backends) {
    const auto c = one_box(Robot::rigid({bar}), {bar});
    const auto checker = make_checker(backend, c.scene, c.space, 0.05);
    for (const double turns : {0.0, 1e3, -1e6}) {
      CHECK(checker->valid(Configuration{3.5, 3, (2 * turns + 0.5) * pi}));
      CHECK_FALSE(checker->valid(Configuration{3.5, 3, 2 * turns * pi}));
    }
  }
}

TEST_CASE("a motion across the end of the angle's period takes the shorter direction") {
  // Pointing left, a little up and down; the longer direction would hit the box on the right.
  const Shape bar = Box2{{0, -0.05}, {1, 0.05}};
  for (const auto& backend : backends) {
    const auto c = one_box(Robot::rigid({bar}), {bar});
    const auto checker = make_checker(backend, c.scene, c.space, 0.05);
    const auto report = checker->motion(Configuration{3.5, 3, pi - 0.4}, Configuration{3.5, 3, -pi + 0.4});
    CHECK(report.valid);
    CHECK(report.checks == std::ceil(0.8 * std::hypot(1, 0.05) / 0.05));
    CHECK_FALSE(checker->motion(Configuration{3.5, 3, 0.5 * pi}, Configuration{3.5, 3, -0.4 * pi}).valid);
  }
}

TEST_CASE("positions on a torus jump at the border of the world") {
  const World world({{0, 0}, {10, 10}}, {box(4, 2, 6, 5)});
  const Space torus("torus", {{"x", 0, 10, 1, true}, {"y", 0, 10, 1, true}});
  const auto scene = std::make_shared<const PlanarScene>(world, Robot::point());
  for (const auto& backend : backends) {
    const auto checker = make_checker(backend, scene, torus, 0.05);
    CHECK(checker->motion(Configuration{1, 3}, Configuration{9, 3}).valid);
    CHECK(checker->motion(Configuration{1, 3}, Configuration{9, 3}).checks == 40);
    CHECK_FALSE(checker->motion(Configuration{3, 3}, Configuration{7, 3}).valid);
  }
}

TEST_CASE("clearance is the distance to what is nearest") {
  auto cases = paper_cases();
  for (auto& c : mixed_cases()) cases.push_back(std::move(c));
  for (const Case& c : cases) {
    INFO(c.name);
    const auto planar = make_planar_checker(c.scene, c.space, 0.05);
    const auto fcl = make_fcl_checker(c.scene, c.space, 0.05);
    Stream stream(5, c.name, "clearance");
    Configuration q(c.space.dimension());
    double worst = 0;
    double worst_fcl = 0;
    for (int i = 0; i < 5000; ++i) {
      c.space.sample_uniform(stream, q);
      const double exact = std::max(0.0, reference_clearance(c, q));
      const double ours = planar->clearance(q);
      REQUIRE((ours == 0.0) == !planar->valid(q));
      worst = std::max(worst, std::abs(ours - exact));
      worst_fcl = std::max(worst_fcl, std::abs(fcl->clearance(q) - exact));
    }
    CHECK(worst < 1e-12);
    CHECK(worst_fcl < 1e-5);
  }
}

TEST_CASE("the nearest obstacle is the one at the least distance, with its nearest point") {
  auto cases = paper_cases();
  for (auto& c : mixed_cases()) cases.push_back(std::move(c));
  for (const Case& c : cases) {
    INFO(c.name);
    const auto& obstacles = trellis::planar(*c.scene).world.obstacles();
    for (const auto& backend : backends) {
      INFO(backend);
      const auto checker = make_checker(backend, c.scene, c.space, 0.05);
      Stream stream(7, c.name, "nearest obstacle");
      Configuration q(c.space.dimension());
      std::vector<Pose2> poses(c.bodies.size());
      double worst = 0.0;
      for (int i = 0; i < 2000; ++i) {
        c.space.sample_uniform(stream, q);
        trellis::planar(*c.scene).robot.place(q, poses);
        const auto distance_of = [&](const Shape& obstacle) {
          double least = std::numeric_limits<double>::infinity();
          for (std::size_t body = 0; body < c.bodies.size(); ++body) {
            for (const Shape& part : c.bodies[body]) {
              least = std::min(least, reference_distance(moved(part, poses[body]), obstacle));
            }
          }
          return least;
        };
        double least = std::numeric_limits<double>::infinity();
        for (const Obstacle& obstacle : obstacles) least = std::min(least, distance_of(obstacle.shape));
        const std::optional<Proximity> nearest = checker->nearest_obstacle(q);
        REQUIRE(nearest);
        worst = std::max({worst, std::abs(nearest->distance - least),
                          std::abs(distance_of(obstacles.at(nearest->obstacle).shape) - least)});
        REQUIRE(nearest->point.has_value() == (nearest->distance > 0.0));
        if (!nearest->point) continue;
        const Shape point = Disc{{nearest->point->x, nearest->point->y}, 0.0};
        worst = std::max({worst, reference_distance(point, obstacles[nearest->obstacle].shape),
                          std::abs(distance_of(point) - least)});
        REQUIRE(nearest->point->z == 0.0);
      }
      CHECK(worst < 1e-12);
    }
  }
  const auto empty = std::make_shared<const PlanarScene>(World({{0, 0}, {1, 1}}, {}), Robot::disc(0.1));
  const auto checker = make_planar_checker(empty, empty->default_space(1.0), 0.05);
  CHECK_FALSE(checker->nearest_obstacle(Configuration{0.5, 0.5}));
}

TEST_CASE("a contact names the first body and obstacle that touch") {
  for (const Case& c : mixed_cases()) {
    INFO(c.name);
    const auto planar = make_planar_checker(c.scene, c.space, 0.05);
    const auto fcl = make_fcl_checker(c.scene, c.space, 0.05);
    Stream stream(6, c.name, "contact");
    Configuration q(c.space.dimension());
    std::vector<Pose2> poses(c.bodies.size());
    for (int i = 0; i < 5000; ++i) {
      c.space.sample_uniform(stream, q);
      trellis::planar(*c.scene).robot.place(q, poses);
      std::optional<Contact> expected;
      for (std::size_t body = 0; body < c.bodies.size() && !expected; ++body) {
        bool out = false;
        for (std::size_t o = 0; o < c.scene->obstacle_count() && !expected; ++o) {
          for (const Shape& part : c.bodies[body]) {
            const Shape shape = moved(part, poses[body]);
            out = out || reference_margin(shape, trellis::planar(*c.scene).world.bounds()) < 0;
            if (reference_distance(shape, trellis::planar(*c.scene).world.obstacles()[o].shape) == 0)
              expected = Contact{body, o};
          }
        }
        if (!expected && out) expected = Contact{body, std::nullopt};
      }
      for (const auto& [first, second] : trellis::planar(*c.scene).robot.pairs()) {
        if (expected) break;
        for (const Shape& part : c.bodies[first]) {
          for (const Shape& other : c.bodies[second]) {
            if (reference_distance(moved(part, poses[first]), moved(other, poses[second])) > 0) continue;
            expected = Contact{first, std::nullopt, second};
          }
        }
      }
      for (const auto* checker : {planar.get(), fcl.get()}) {
        const auto found = checker->contact(q);
        REQUIRE(found.has_value() == expected.has_value());
        REQUIRE(found.has_value() == !checker->valid(q));
        if (!found) continue;
        REQUIRE(found->body == expected->body);
        REQUIRE(found->obstacle == expected->obstacle);
        REQUIRE(found->other == expected->other);
      }
    }
  }
}

TEST_CASE("contacts in words") {
  const PlanarScene scene{World({{0, 0}, {10, 10}}, {{"obstacle 1 (box 4 2 6 5)", Box2{{4, 2}, {6, 5}}}}),
                          Robot::point()};
  CHECK(describe({0, 0}, scene) == "obstacle 1 (box 4 2 6 5)");
  CHECK(describe({0, std::nullopt}, scene) == "the world's boundary");
  const PlanarScene arm{World({{0, 0}, {10, 10}}, {}), Robot::arm({.links = {1, 1, 1}, .widths = {0.1, 0.1, 0.1}})};
  CHECK(describe({0, std::nullopt, 2}, arm) == "itself (link 1 meets link 3)");
}

TEST_CASE("an arm that folds upon itself is invalid, and one whose links may cross is not") {
  Arm arm{.links = {1, 1, 1}, .widths = {0.1, 0.1, 0.1}, .base = {5, 5}};
  const Configuration folded = {0, 2.5, 2.5};
  const Configuration stretched = {0, 0.3, 0.3};
  for (const auto& backend : backends) {
    for (const bool kept_apart : {true, false}) {
      INFO(backend << kept_apart);
      arm.self_collision = kept_apart;
      const auto scene = std::make_shared<const PlanarScene>(World({{0, 0}, {10, 10}}, {}), Robot::arm(arm));
      const auto checker = make_checker(backend, scene, scene->default_space(0.3), 0.05);
      CHECK(checker->valid(stretched));
      CHECK(checker->valid(folded) == !kept_apart);
      CHECK(checker->motion(stretched, folded).valid == !kept_apart);
      CHECK(checker->contact(folded).has_value() == kept_apart);
      CHECK((checker->clearance(folded) == 0.0) == kept_apart);
    }
  }
}

TEST_CASE("the index finds the boxes that overlap and no others") {
  Stream stream(7, "test", "index");
  for (const std::size_t count : {0U, 1U, 20U, 64U, 65U, 700U, 5000U}) {
    INFO(count);
    std::vector<kernel::Box> boxes;
    for (std::size_t i = 0; i < count; ++i) {
      const double x = stream.uniform(-5, 5);
      const double y = stream.uniform(-50, 5);
      boxes.push_back({x, x + stream.uniform(0, 2), y, y + stream.uniform(0, 2)});
    }
    const PartIndex index(boxes);
    std::vector<unsigned> found(count);
    for (int i = 0; i < 2000; ++i) {
      kernel::Box q{stream.uniform(-8, 8), 0, stream.uniform(-60, 10), 0};
      q.xhi = q.xlo + stream.uniform(0, 4);
      q.yhi = q.ylo + stream.uniform(0, i % 50 == 0 ? 40 : 4);
      // Some that only touch.
      if (count > 0 && i % 3 == 0) q.xlo = std::min(boxes[stream.below(count)].xhi, q.xhi);
      std::vector<unsigned> expected;
      for (unsigned k = 0; k < count; ++k) {
        const auto& b = boxes[k];
        if (b.xlo <= q.xhi && q.xlo <= b.xhi && b.ylo <= q.yhi && q.ylo <= b.yhi) expected.push_back(k);
      }
      const unsigned n = index.query(q, found.data());
      REQUIRE(std::vector<unsigned>(found.begin(), found.begin() + n) == expected);
      // The nearest box, whatever is visited before it.
      if (count == 0) continue;
      const Box2 from{{q.xlo, q.ylo}, {q.xhi, q.yhi}};
      double least = std::numeric_limits<double>::infinity(), nearest = least;
      const auto to = [&](std::size_t k) {
        return box_distance(from, {{boxes[k].xlo, boxes[k].ylo}, {boxes[k].xhi, boxes[k].yhi}});
      };
      for (std::size_t k = 0; k < count; ++k) least = std::min(least, to(k));
      index.nearest(from, nearest, [&](std::size_t k) { nearest = std::min(nearest, to(k)); });
      REQUIRE(nearest == least);
    }
  }
}

TEST_CASE("a world without obstacles has only its boundary") {
  const auto scene = std::make_shared<const PlanarScene>(World({{0, 0}, {1, 1}}, {}), Robot::disc(0.25));
  const auto space = Space::euclidean({{0, 1}, {0, 1}});
  for (const auto& backend : backends) {
    const auto checker = make_checker(backend, scene, space, 0.05);
    CHECK(checker->valid(Configuration{0.5, 0.5}));
    CHECK_FALSE(checker->valid(Configuration{0.5, 0.2}));
    CHECK(checker->clearance(Configuration{0.5, 0.4}) == Approx(0.15));
    CHECK(checker->motion(Configuration{0.3, 0.3}, Configuration{0.7, 0.7}).valid);
    CHECK(checker->motion(Configuration{0.5, 0.5}, Configuration{0.5, 0.0}).invalid_at == 1.0);
    CHECK_FALSE(checker->contact(Configuration{0.1, 0.5})->obstacle.has_value());
  }
}

TEST_CASE("a checker refuses what it cannot check") {
  const auto c = one_box(Robot::rigid({Box2{{-0.25, -0.25}, {0.25, 0.25}}}), {});
  const auto flat = Space::euclidean({{0, 10}, {0, 10}});
  for (const auto& backend : backends) {
    CHECK_THROWS_AS(make_checker(backend, c.scene, flat, 0.05), Error);
    CHECK_THROWS_AS(make_checker(backend, c.scene, c.space, 0.0), Error);
    CHECK_THROWS_AS(make_checker(backend, c.scene, c.space, std::nan("")), Error);
    const auto fine = make_checker(backend, c.scene, c.space, 1e-9);
    CHECK_THROWS_AS(fine->motion(Configuration{1, 1, 0}, Configuration{2, 1, 0}), Error);
  }
  CHECK_THROWS_WITH(make_checker("planer", c.scene, c.space, 0.05), Catch::Contains("did you mean 'planar'?"));
}
