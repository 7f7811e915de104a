// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/instance/nearest_valid.hpp>

#include <cmath>
#include <numbers>

#include <trellis/collision/checker.hpp>

#include "support/catch.hpp"
#include "support/worlds.hpp"

using namespace trellis;

TEST_CASE("the nearest valid configuration is valid as it is written, and about as near as there is", "[instance]") {
  const Space plane = Space::euclidean({{0, 10}, {0, 10}});
  // Outside of a disc of radius 2 about (5, 5), the nearest is on the disc's edge.
  const auto outside = [](View q) { return std::hypot(q[0] - 5, q[1] - 5) > 2.0; };
  for (const auto& q : {Configuration{6, 5}, Configuration{5.5, 4.2}, Configuration{5, 6.99}}) {
    const auto found = nearest_valid(plane, q, outside);
    REQUIRE(found);
    INFO(found->text);
    const double least = 2.0 - std::hypot(q[0] - 5, q[1] - 5);
    CHECK(outside(found->q));
    CHECK(found->distance == Approx(plane.distance(q, found->q)));
    CHECK(found->distance >= least);
    CHECK(found->distance <= 1.2 * least + 0.02);
    CHECK(found->text.size() <= std::string("(1.234, 5.678)").size());
  }
  CHECK(nearest_valid(plane, Configuration{6, 5}, outside)->text ==
        nearest_valid(plane, Configuration{6, 5}, outside)->text);
  CHECK_FALSE(nearest_valid(plane, Configuration{6, 5}, [](View) { return false; }));
}

TEST_CASE("what lies out of bounds is brought in", "[instance]") {
  const auto always = [](View) { return true; };
  const Space plane = Space::euclidean({{0, 10}, {0, 10}});
  CHECK(nearest_valid(plane, Configuration{-1, 5}, always)->text == "(0, 5)");
  CHECK(nearest_valid(plane, Configuration{3, 12.5}, always)->distance == Approx(2.5));
}

TEST_CASE("a robot's pose is moved and turned to where it is valid", "[instance]") {
  const Problem cup = test::cup_problem();
  const auto checker = make_planar_checker(cup.scene, cup.space, cup.resolution);
  int found_one = 0;
  Stream stream(1, "", "test");
  Configuration q(3);
  for (int i = 0; i < 200; ++i) {
    cup.space.sample_uniform(stream, q);
    if (checker->valid(q)) continue;
    const auto found = nearest_valid(cup.space, q, [&](View x) { return checker->valid(x); });
    REQUIRE(found);
    CHECK(checker->valid(found->q));
    CHECK(found->distance < 2.0);
    ++found_one;
  }
  CHECK(found_one > 10);
}

TEST_CASE("small worlds have small decimals", "[instance]") {
  const Space small = Space::euclidean({{0, 0.01}, {0, 0.01}});
  const auto right = [](View q) { return q[0] > 0.005; };
  const auto found = nearest_valid(small, Configuration{0.004, 0.005}, right);
  REQUIRE(found);
  CHECK(right(found->q));
  CHECK(found->distance < 0.0012);
}
