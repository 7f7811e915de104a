// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <vector>

#include <trellis/measure/cut_ball.hpp>
#include <trellis/measure/frame.hpp>
#include <trellis/measure/point_tree.hpp>

#include "support/catch.hpp"

using namespace trellis;
using measure::Frame;
using measure::PointTree;

namespace {

std::vector<Space> spaces() {
  const Space torus("torus", {{"a", 0.0, 1.0, 2.0, true}, {"b", -3.0, 3.0, 0.5, true}});
  return {Space::so2(), Space::euclidean({{0, 4}, {-1, 1}}), torus, Space::se2({0, 10}, {-5, 5}, 0.7),
          Space::euclidean({{0, 1}, {0, 2}, {0, 1}, {0, 1}, {0, 1}})};
}

double log_ball(double r, std::size_t d) { return log_unit_ball(d) + static_cast<double>(d) * std::log(r); }

}  // namespace

TEST_CASE("Nearest neighbours and counts agree with brute force, across the wrap too") {
  for (const Space& space : spaces()) {
    const Frame frame(space);
    const std::size_t d = space.dimension();
    for (const std::size_t n : {0U, 1U, 2U, 15U, 16U, 17U, 33U, 500U, 3000U}) {
      Stream stream(n, space.name(), "points");
      Configurations points(d);
      std::vector<double> rows;
      Configuration x(d);
      std::vector<double> y(d);
      for (std::size_t i = 0; i < n; ++i) {
        space.sample_uniform(stream, x);
        // Clusters and ties stress the splits.
        if (i % 3 == 0) x[0] = space.axes()[0].lo;
        points.push(x);
        frame.to_metric(x, y);
        rows.insert(rows.end(), y.begin(), y.end());
      }
      const PointTree tree(frame, rows);
      REQUIRE(tree.size() == n);
      for (int query = 0; query < 100; ++query) {
        space.sample_uniform(stream, x);
        if (query % 5 == 0) x[d - 1] = space.axes()[d - 1].lo;
        frame.to_metric(x, y);
        std::vector<double> expected;
        for (std::size_t i = 0; i < n; ++i) expected.push_back(space.squared_distance(x, points[i]));
        std::sort(expected.begin(), expected.end());
        std::vector<double> found(3);
        tree.nearest(y, found);
        for (std::size_t k = 0; k < 3; ++k) {
          if (k < n) {
            CHECK(found[k] == Approx(expected[k]).epsilon(1e-9).margin(1e-12));
          } else {
            CHECK(std::isinf(found[k]));
          }
        }
        // Halfway between two distances no rounding can move a point over the border.
        for (const std::size_t m : {std::size_t{1}, n / 3, n / 2, n - 1}) {
          if (m == 0 || m >= n || expected[m] - expected[m - 1] < 1e-9) continue;
          const double between = 0.5 * (expected[m - 1] + expected[m]);
          CHECK(tree.count_within(y, between) == m);
        }
        CHECK(tree.count_within(y, 1e6) == n);
      }
    }
  }
}

TEST_CASE("A radius that is exactly a distance counts its point") {
  const Space space = Space::se2({0, 10}, {0, 10});
  const Frame frame(space);
  Stream stream(3, "", "points");
  std::vector<double> rows;
  Configuration x(3);
  std::vector<double> y(3);
  for (int i = 0; i < 700; ++i) {
    space.sample_uniform(stream, x);
    frame.to_metric(x, y);
    rows.insert(rows.end(), y.begin(), y.end());
  }
  const PointTree tree(frame, rows);
  for (int query = 0; query < 200; ++query) {
    space.sample_uniform(stream, x);
    frame.to_metric(x, y);
    std::vector<double> found(20);
    tree.nearest(y, found);
    for (std::size_t k = 0; k < found.size(); ++k) CHECK(tree.count_within(y, found[k]) == k + 1);
  }
}

TEST_CASE("Balls cut to the space have the volumes of geometry") {
  const Space plane = Space::euclidean({{0, 10}, {0, 4}});
  const measure::CutBall ball(Frame(plane), 256);
  const double pi = std::numbers::pi;
  const auto volume = [&](std::vector<double> y, double r) { return std::exp(ball.log_volume(y, r)); };
  CHECK(volume({5.0, 2.0}, 1.0) == Approx(pi));
  CHECK(volume({0.0, 2.0}, 1.0) == Approx(0.5 * pi).epsilon(0.01));
  CHECK(volume({0.0, 0.0}, 1.0) == Approx(0.25 * pi).epsilon(0.03));
  CHECK(volume({5.0, 2.0}, 100.0) == Approx(40.0));
  // A strip of half height 2 of a disc of radius 3.
  const double strip = 2.0 * (2.0 * std::sqrt(5.0) + 9.0 * std::asin(2.0 / 3.0));
  CHECK(volume({5.0, 2.0}, 3.0) == Approx(strip).epsilon(0.06));

  // A ball wider than the period of an axis meets itself and is cut to one period.
  const Space se2 = Space::se2({0, 20}, {0, 20});
  const measure::CutBall round(Frame(se2), 256);
  const double r = 3.0;
  CHECK(round.log_volume(std::vector{10.0, 10.0, 0.9}, 0.9) == Approx(log_ball(0.9, 3)));
  const double slab = pi * (2.0 * r * r - 2.0 / 3.0);  // |theta| <= 1 of the ball
  CHECK(std::exp(round.log_volume(std::vector{10.0, 10.0, 0.9}, r)) == Approx(slab).epsilon(0.03));
  CHECK(round.log_volume(std::vector{10.0, 10.0, 0.9}, 1000.0) == Approx(se2.log_volume()));
  const auto half = [](View at) { return at[0] < 10.0; };
  CHECK(std::exp(round.log_volume(std::vector{10.0, 10.0, 0.9}, r, half)) == Approx(0.5 * slab).epsilon(0.03));
  CHECK(round.log_volume(std::vector{10.0, 10.0, 0.9}, r, [](View) { return false; }) ==
        -std::numeric_limits<double>::infinity());
}
