// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <vector>

#include <trellis/measure/cut_ball.hpp>
#include <trellis/measure/frame.hpp>

#include "support/catch.hpp"

using namespace trellis;
using measure::Frame;

namespace {

double log_ball(double r, std::size_t d) { return log_unit_ball(d) + static_cast<double>(d) * std::log(r); }

}  // namespace

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
