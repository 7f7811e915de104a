// SPDX-License-Identifier: GPL-3.0-or-later
// The times of a path: on its polygon, within the limits, at rest where it bends, and no slower than a trapezoid.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <utility>
#include <vector>

#include <trellis/base/random.hpp>
#include <trellis/motion/timed_path.hpp>

#include "support/catch.hpp"

using namespace trellis;

namespace {

constexpr double pi = std::numbers::pi;

/// Two joints with limits, one without, and one that slides.
Space joints() {
  return {"joints", {{"a", -3, 3, 1, false}, {"b", -pi, pi, 1, true}, {"c", -3, 3, 1, false}, {"d", 0, 2, 1, false}}};
}

Configurations path_of(const std::vector<Configuration>& points) {
  Configurations path(points.front().size());
  for (const Configuration& q : points) path.push(q);
  return path;
}

/// The least time of one leg from rest to rest, from the formula of each coordinate by itself: that which needs longest
/// where all accelerate at their limits, and with the limits of speed scaled along the leg.
double least_time(const std::vector<double>& change, const RateLimits& limits) {
  double speed = 1e300;
  double acceleration = 1e300;
  for (std::size_t j = 0; j < change.size(); ++j) {
    if (change[j] == 0.0) continue;
    speed = std::min(speed, limits.velocity[j] / std::abs(change[j]));
    acceleration = std::min(acceleration, limits.acceleration[j] / std::abs(change[j]));
  }
  return speed * speed >= acceleration ? 2.0 / std::sqrt(acceleration) : 1.0 / speed + speed / acceleration;
}

}  // namespace

TEST_CASE("a timed path keeps the laws of its motion") {
  const Space space = joints();
  Stream stream(1, "test", "timed paths");
  for (int round = 0; round < 40; ++round) {
    CAPTURE(round);
    RateLimits limits;
    for (int j = 0; j < 4; ++j) {
      limits.velocity.push_back(stream.uniform(0.1, 3.0));
      limits.acceleration.push_back(stream.uniform(0.1, 5.0));
    }
    std::vector<Configuration> points(2 + stream.below(6), Configuration(4));
    for (Configuration& q : points) space.sample_uniform(stream, q);
    const Configurations path = path_of(points);
    const TimedPath timed(space, path, limits);
    REQUIRE(timed.times().size() == path.size());
    CHECK(timed.legs() == path.size() - 1);

    // The total is the sum of the least times of its legs.
    double total = 0.0;
    std::vector<double> change(4);
    for (std::size_t i = 1; i < path.size(); ++i) {
      space.difference(path[i - 1], path[i], change);
      CHECK(timed.times()[i - 1] == Approx(total).margin(1e-9));
      total += least_time(change, limits);
    }
    CHECK(timed.duration() == Approx(total));

    // At the points of the path it is there, and at rest.
    for (std::size_t i = 0; i < path.size(); ++i) {
      const TimedPath::Sample sample = timed.at(timed.times()[i]);
      Configuration wrapped = sample.position;
      space.normalise(wrapped);
      CHECK(space.distance(wrapped, path[i]) < 1e-6);
      for (const double v : sample.velocity) CHECK(std::abs(v) < 1e-6);
    }

    // In between it is on the segments, and finite differences keep the limits.
    const std::size_t steps = 400;
    const double dt = timed.duration() / static_cast<double>(steps);
    std::vector<TimedPath::Sample> all;
    for (std::size_t k = 0; k <= steps; ++k) all.push_back(timed.at(dt * static_cast<double>(k)));
    for (std::size_t k = 0; k <= steps; ++k) {
      Configuration wrapped = all[k].position;
      space.normalise(wrapped);
      double off = 1e300;
      for (std::size_t i = 1; i < path.size(); ++i) {
        const Foot foot = nearest_on_motion(space, path[i - 1], path[i], wrapped);
        off = std::min(off, foot.squared_distance);
      }
      CHECK(off < 1e-12);
      for (std::size_t j = 0; j < 4; ++j) {
        CHECK(std::abs(all[k].velocity[j]) <= limits.velocity[j] * (1 + 1e-9));
        if (k == 0) continue;
        // A continuous coordinate never jumps.
        CHECK(std::abs(all[k].position[j] - all[k - 1].position[j]) <= limits.velocity[j] * dt * (1 + 1e-9) + 1e-12);
        CHECK(std::abs(all[k].velocity[j] - all[k - 1].velocity[j]) <= limits.acceleration[j] * dt * (1 + 1e-6) + 1e-9);
      }
    }
  }
}

TEST_CASE("samples of a timed path give it by cubic splines") {
  const Space space = joints();
  const RateLimits limits{{1, 2, 1, 0.3}, {2, 2, 1, 1}};
  const TimedPath timed(space, path_of({{0, 3, 0, 0.5}, {1, -3, 0.5, 0.5}, {1, -1, 0.5, 1.5}}), limits);
  const auto samples = timed.samples(0.05);
  REQUIRE(samples.size() > 20);
  CHECK(samples.front().time == 0.0);
  CHECK(samples.back().time == timed.duration());
  for (std::size_t i = 1; i < samples.size(); ++i) {
    const auto& a = samples[i - 1];
    const auto& b = samples[i];
    const double h = b.time - a.time;
    CHECK(h > 0.0);
    CHECK(h <= 0.05 + 1e-9);
    for (const double u : {0.25, 0.5, 0.75}) {
      const TimedPath::Sample exact = timed.at(a.time + u * h);
      for (std::size_t j = 0; j < 4; ++j) {
        const double spline = (1 + 2 * u) * (1 - u) * (1 - u) * a.position[j] +
                              u * (1 - u) * (1 - u) * h * a.velocity[j] + u * u * (3 - 2 * u) * b.position[j] +
                              u * u * (u - 1) * h * b.velocity[j];
        CHECK(spline == Approx(exact.position[j]).margin(1e-9));
      }
    }
  }
}

TEST_CASE("a timed path passes points on a straight line without a stop, and wraps along the shorter arc") {
  const Space space = joints();
  const RateLimits limits{{1, 1, 1, 1}, {1, 1, 1, 1}};
  const TimedPath straight(space, path_of({{0, 0, 0, 0}, {0.5, 0, 0, 0}, {2, 0, 0, 0}}), limits);
  CHECK(straight.legs() == 1);
  CHECK(straight.duration() == Approx(3.0));  // 2 m at 1 m/s, and a second to speed up and slow down
  CHECK(straight.times()[1] == Approx(1.0));
  CHECK(straight.at(1.5).velocity[0] == Approx(1.0));
  // From 3 to -3 through pi, by 0.283 rad.
  const TimedPath turn(space, path_of({{0, 3, 0, 0}, {0, -3, 0, 0}}), limits);
  CHECK(turn.duration() == Approx(2.0 * std::sqrt(2.0 * pi - 6.0)));
  CHECK(turn.at(turn.duration()).position[1] == Approx(2.0 * pi - 3.0));
  const TimedPath still(space, path_of({{0, 1, 0, 0}, {0, 1, 0, 0}}), limits);
  CHECK(still.duration() == 0.0);
  CHECK(still.samples(0.05).size() == 1);
}
