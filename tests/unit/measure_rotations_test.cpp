// SPDX-License-Identifier: GPL-3.0-or-later
// The measure in every space, those with rotations included: tubes, balls and estimators against closed forms, uniform
// samples and known truth.
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include <trellis/measure/cut_ball.hpp>
#include <trellis/measure/efficiency.hpp>
#include <trellis/space/nearest.hpp>

#include "support/catch.hpp"
#include "verify/measure_cases.hpp"

using namespace trellis;
using Catch::Matchers::Contains;

namespace {

constexpr double pi = std::numbers::pi;

Space se3() { return Space::se3({{{0, 2}, {0, 2}, {0, 2}}}, 0.4); }
Space product() {
  return Space::product(
      {{1.0, Space::euclidean({{0, 2}, {0, 2}, {0, 2}})}, {1.0, Space::so3(0.4)}, {1.0, Space::so2(0.2)}});
}

std::vector<Space> spaces() {
  return {Space::euclidean({{0, 2}, {0, 2}}),
          Space::so2(0.8),
          Space::se2({0, 2}, {0, 2}, 0.4),
          Space::so3(0.8),
          se3(),
          product()};
}

/// A bent path: three waypoints, each leg a metre long at most.
Configurations bent_path(const Space& space, std::uint64_t seed = 1) {
  Stream stream(seed, space.name(), "bent path");
  Configurations path(space.dimension());
  Configuration q(space.dimension());
  Configuration next(space.dimension());
  space.sample_uniform(stream, q);
  path.push(q);
  while (path.size() < 3) {
    space.sample_uniform(stream, next);
    const double length = space.distance(q, next);
    if (length < 0.3) continue;
    space.interpolate(q, next, std::min(1.0, 1.0 / length), next);
    q = next;
    path.push(q);
  }
  return path;
}

/// The least distance from x to points close together along a path.
double least_distance(const Space& space, const Configurations& path, View x) {
  double least = std::numeric_limits<double>::infinity();
  Configuration q(space.dimension());
  for (std::size_t i = 1; i < path.size(); ++i) {
    for (int k = 0; k <= 400; ++k) {
      space.interpolate(path[i - 1], path[i], k / 400.0, q);
      least = std::min(least, space.distance(q, x));
    }
  }
  return least;
}

TubeSettings full(double delta) {
  TubeSettings settings;
  settings.distance = TubeSettings::Distance::full;
  settings.delta = delta;
  return settings;
}

Target tube(const Space& space, const Configurations& path, double delta, std::uint64_t seed = 3) {
  return {space, path, {}, full(delta), verify::anywhere, seed};
}

bool equal(const Configurations& a, const Configurations& b) {
  if (a.size() != b.size()) return false;
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (!std::equal(a[i].begin(), a[i].end(), b[i].begin())) return false;
  }
  return true;
}

/// The volume of a ball of rotations, where a turn by an angle has that angle as its length.
double ball_of_rotations(double angle) { return 8.0 * pi * (angle - std::sin(angle)); }

/// An integral by Simpson's rule.
template <class F>
double integral(double lo, double hi, const F& f) {
  constexpr int parts = 2000;
  const double h = (hi - lo) / parts;
  double sum = f(lo) + f(hi);
  for (int i = 1; i < parts; ++i) sum += (i % 2 == 1 ? 4.0 : 2.0) * f(lo + i * h);
  return sum * h / 3.0;
}

}  // namespace

TEST_CASE("a tube's volume is that of the uniform samples in it, and its points are uniform, in every space",
          "[measure][laws]") {
  for (const Space& space : spaces()) {
    CAPTURE(space.name());
    const Configurations path = bent_path(space);
    const double delta = 0.5;
    const Target target = tube(space, path, delta);
    REQUIRE_FALSE(target.empty());
    Stream stream(5, space.name(), "uniform");
    Configuration x(space.dimension());
    const std::size_t tries = 200000;
    double inside = 0.0;
    double sum = 0.0;
    double squares = 0.0;
    for (std::size_t i = 0; i < tries; ++i) {
      space.sample_uniform(stream, x);
      if (!target.contains(x)) continue;
      const double f = space.distance(path[0], x);
      inside += 1.0;
      sum += f;
      squares += f * f;
    }
    REQUIRE(inside > 500.0);
    const double share = inside / static_cast<double>(tries);
    const double error = std::hypot(std::sqrt((1.0 - share) / inside), target.log_volume_error());
    CHECK(target.log_volume() == Approx(space.log_volume() + std::log(share)).margin(4.0 * error));
    CHECK(target.log_volume_error() < 0.01);
    // The mean of a function over the pool is that over the uniform samples in the tube.
    double mean = 0.0;
    for (std::size_t i = 0; i < target.pool().size(); ++i) {
      mean += space.distance(path[0], target.pool()[i]) / static_cast<double>(target.pool().size());
    }
    const double sd = std::sqrt(std::max(0.0, squares / inside - std::pow(sum / inside, 2)));
    const double both = 1.0 / inside + 1.0 / static_cast<double>(target.pool().size());
    CHECK(mean == Approx(sum / inside).margin(4.0 * sd * std::sqrt(both)));
  }
}

TEST_CASE("membership, distance and arc length of a tube are those of its path, in every space", "[measure][laws]") {
  for (const Space& space : spaces()) {
    CAPTURE(space.name());
    const Configurations path = bent_path(space, 2);
    const double delta = 0.4;
    const Target target = tube(space, path, delta);
    const double length = path_length(space, path);
    CHECK(target.length() == Approx(length));
    Stream stream(6, space.name(), "anywhere");
    Configuration x(space.dimension());
    Configuration foot(space.dimension());
    const double step = 1.0 / 400.0;  // between the points of least_distance, at most
    for (int i = 0; i < 300; ++i) {
      if (i % 2 == 0) {
        space.sample_uniform(stream, x);
      } else {
        const View from = target.pool()[static_cast<std::size_t>(i) * 7];
        std::copy(from.begin(), from.end(), x.begin());
      }
      const double d = least_distance(space, path, x);
      CHECK(target.distance(x) <= d + 1e-3 * delta);
      CHECK(target.distance(x) >= d - step);
      if (d < delta - 2e-3 * delta) CHECK(target.contains(x));
      if (d > delta + step) CHECK_FALSE(target.contains(x));
      // The point of the path at that arc length is as near.
      double arc = target.along(x);
      REQUIRE(arc >= 0.0);
      REQUIRE(arc <= length + 1e-12);
      std::size_t leg = 1;
      while (leg + 1 < path.size() && arc > space.distance(path[leg - 1], path[leg])) {
        arc -= space.distance(path[leg - 1], path[leg]);
        ++leg;
      }
      const double t = std::min(1.0, arc / space.distance(path[leg - 1], path[leg]));
      space.interpolate(path[leg - 1], path[leg], t, foot);
      CHECK(space.distance(foot, x) == Approx(target.distance(x)).margin(2e-3 * delta));
    }
    for (std::size_t i = 0; i < target.pool().size(); i += 16) REQUIRE(space.contains(target.pool()[i]));
  }
}

TEST_CASE("tubes with rotations have the volumes of their closed forms", "[measure][slow]") {
  const double w = 0.7;
  SECTION("about a turn: a cylinder and a ball of rotations") {
    const Space space = Space::so3(w);
    for (const double angle : {0.01, 0.8, 2.0}) {
      for (const double delta : {0.2, 0.6}) {
        CAPTURE(angle, delta);
        Configurations path(4);
        path.push(std::vector{0.0, 0.0, 0.0, 1.0});
        path.push(std::vector{0.0, std::sin(0.5 * angle), 0.0, std::cos(0.5 * angle)});
        const double a = delta / w;
        const double volume = w * w * w * (2.0 * pi * angle * (1.0 - std::cos(a)) + ball_of_rotations(a));
        const Target target = tube(space, path, delta);
        CHECK(target.log_volume() == Approx(std::log(volume)).margin(4.0 * target.log_volume_error()));
        CHECK(target.uniform() ==
              Approx(space.log_volume() - std::log(volume)).margin(4.0 * target.log_volume_error()));
      }
    }
  }
  const Space space = Space::se3({{{0, 10}, {0, 10}, {0, 10}}}, w);
  Configurations path(7);
  path.push(std::vector{2.0, 5.0, 5.0, 0.0, 0.0, 0.0, 1.0});
  path.push(std::vector{6.0, 5.0, 5.0, 0.0, 0.0, 0.0, 1.0});
  const auto around = [](double r) { return pi * r * r * 4.0 + 4.0 / 3.0 * pi * r * r * r; };
  SECTION("about a translation, by the space's metric") {
    const double delta = 0.9;
    const double volume = w * w * w * integral(0.0, delta / w, [&](double turn) {
                            const double rest = std::max(0.0, delta * delta - w * w * turn * turn);
                            return 8.0 * pi * (1.0 - std::cos(turn)) * around(std::sqrt(rest));
                          });
    const Target target = tube(space, path, delta);
    CHECK(target.log_volume() == Approx(std::log(volume)).margin(4.0 * target.log_volume_error()));
  }
  SECTION("about a translation, by the position alone: all rotations belong to it") {
    const Target target(space, path, {0, 1, 2}, TubeSettings{}, verify::anywhere, 3);
    const double volume = around(0.5) * 8.0 * pi * pi * w * w * w;
    CHECK(target.log_volume() == Approx(std::log(volume)).margin(4.0 * target.log_volume_error()));
    CHECK(target.length() == Approx(4.0));
    CHECK(target.contains(std::vector{3.0, 5.4, 5.0, 1.0, 0.0, 0.0, 0.0}));
    CHECK_FALSE(target.contains(std::vector{3.0, 5.6, 5.0, 0.0, 0.0, 0.0, 1.0}));
  }
  SECTION("of many waypoints it is the same tube, and draws are not lost") {
    const Configurations dense = evenly_spread(space, path, 400);
    Configurations shaken(7);
    Stream stream(1, "", "shaken");
    Configuration q(7);
    for (std::size_t i = 0; i < dense.size(); ++i) {
      std::copy(dense[i].begin(), dense[i].end(), q.begin());
      q[1] += 0.004 * stream.uniform(-1.0, 1.0);
      shaken.push(q);
    }
    const double once = tube(space, path, 0.5).log_volume();
    CHECK(tube(space, dense, 0.5).log_volume() == Approx(once).margin(0.02));
    CHECK(tube(space, shaken, 0.5).log_volume() == Approx(once).margin(0.05));
  }
}

TEST_CASE("a tube with rotations depends on its seed alone", "[measure][slow]") {
  const Space space = se3();
  const Configurations path = bent_path(space);
  CHECK(equal(tube(space, path, 0.5, 3).pool(), tube(space, path, 0.5, 3).pool()));
  CHECK_FALSE(equal(tube(space, path, 0.5, 3).pool(), tube(space, path, 0.5, 4).pool()));
  Stream one(1, "", "draw");
  Stream two(1, "", "draw");
  const Target target = tube(space, path, 0.5);
  const Configurations drawn = target.draw(500, one);
  CHECK(drawn.size() == 500);
  CHECK(equal(drawn, target.draw(500, two)));
  for (std::size_t i = 0; i < drawn.size(); ++i) CHECK(target.contains(drawn[i]));
}

TEST_CASE("trees and balls of every space agree with brute force", "[measure][laws]") {
  for (const Space& space : spaces()) {
    CAPTURE(space.name());
    const measure::Frame frame(space);
    Stream stream(2, space.name(), "points");
    Configuration x(space.dimension());
    std::vector<double> y(space.dimension());
    Configurations points(space.dimension());
    std::vector<double> rows;
    for (int i = 0; i < 20000; ++i) {
      space.sample_uniform(stream, x);
      points.push(x);
      frame.to_metric(x, y);
      rows.insert(rows.end(), y.begin(), y.end());
    }
    const NearestIndex tree(frame.rows(), rows);
    const measure::CutBall ball(frame, 4096);
    std::vector<double> all(points.size());
    std::vector<double> found(5);
    for (int query = 0; query < 30; ++query) {
      space.sample_uniform(stream, x);
      frame.to_metric(x, y);
      for (std::size_t i = 0; i < points.size(); ++i) all[i] = space.squared_distance(x, std::as_const(points)[i]);
      std::sort(all.begin(), all.end());
      tree.nearest_distances(y, found);
      for (std::size_t k = 0; k < found.size(); ++k) CHECK(found[k] == Approx(all[k]).margin(1e-12));
      for (const double r : {0.3, 0.7, 1.5}) {
        // The margin is rounding: coordinates of flat spaces are scaled before distances.
        const auto within = [&](double s) { return std::upper_bound(all.begin(), all.end(), s) - all.begin(); };
        const auto count = static_cast<std::ptrdiff_t>(tree.count_within(y, r * r));
        CHECK(count >= within(r * r - 1e-12));
        CHECK(count <= within(r * r + 1e-12));
        // The ball's volume in the space is its share of uniform samples.
        const double share = std::exp(ball.log_volume(y, r) - space.log_volume());
        const auto n = static_cast<double>(points.size());
        CHECK(static_cast<double>(count) / n == Approx(share).epsilon(0.06).margin(4.0 * std::sqrt(share / n)));
        const auto half = [&](View at) { return at[0] < y[0]; };
        CHECK(ball.log_volume(y, r, half) < ball.log_volume(y, r));
      }
    }
  }
}

TEST_CASE("estimates in spaces with rotations are near the truth", "[measure][chain][slow]") {
  const auto regularised = [](const Target& target, double density) {
    return verify::constant_regularised(target.log_volume(), target.space().log_volume(), density);
  };
  SECTION("three degrees of freedom: nearest neighbours") {
    const Space space = Space::so3(1.0);
    const Target target = tube(space, bent_path(space), 0.5);
    Stream stream(3, "", "draws");
    const Efficiency itself = efficiency(target, target.draw(2000, stream));
    CHECK(itself.estimator == "knn");
    CHECK(itself.value == Approx(regularised(target, std::exp(-target.log_volume()))).margin(0.05));
    Configurations anywhere(4);
    Configuration x(4);
    for (int i = 0; i < 3000; ++i) {
      space.sample_uniform(stream, x);
      anywhere.push(x);
    }
    const Efficiency blind = efficiency(target, anywhere);
    CHECK(blind.value == Approx(target.uniform()).margin(0.12));
    CHECK(std::find(blind.flags.begin(), blind.flags.end(), "indicative") == blind.flags.end());
    // Perfectly known densities.
    const double u = std::exp(-space.log_volume());
    const Efficiency exact = efficiency(target, anywhere, {.density = [u](View) { return u; }});
    CHECK(exact.estimator == "exact");
    CHECK(exact.value == Approx(target.uniform()).margin(1e-9));
  }
  SECTION("six and seven: the bound by mass and arc length, within 0.1 from 300 samples in the target on") {
    for (const Space& space : {se3(), product()}) {
      CAPTURE(space.name());
      const Target target = tube(space, bent_path(space), 0.4);
      // 30 % from the target, of these 80 % in the first half along the path.
      const double middle = 0.5 * target.length();
      double first = 0.0;
      for (std::size_t i = 0; i < target.pool().size(); ++i)
        first += target.along(target.pool()[i]) < middle ? 1.0 : 0.0;
      first /= static_cast<double>(target.pool().size());
      Stream stream(4, space.name(), "mixture");
      const Configurations pool = target.draw(20000, stream);
      Configurations samples(space.dimension());
      Configuration x(space.dimension());
      std::size_t next = 0;
      while (samples.size() < 1200) {
        if (stream.uniform() >= 0.3) {
          space.sample_uniform(stream, x);
          samples.push(x);
          continue;
        }
        const bool early = stream.uniform() < 0.8;
        while ((target.along(pool[next]) < middle) != early) ++next;
        samples.push(pool[next++]);
      }
      const double u = std::exp(-space.log_volume());
      const double t = std::exp(-target.log_volume());
      const double low = 0.7 * u + 0.3 * t * 0.2 / (1.0 - first);
      const double high = 0.7 * u + 0.3 * t * 0.8 / first;
      const double truth = first * regularised(target, high) + (1.0 - first) * regularised(target, low);
      const Efficiency e =
          efficiency(target, samples, {.estimators = {EstimatorSpec::make("arc"), EstimatorSpec::make("knn")}});
      REQUIRE(e.in_target >= 300);
      CHECK(e.estimator == "arc");
      CHECK(e.value == Approx(truth).margin(0.1));
      CHECK(std::find(e.flags.begin(), e.flags.end(), "lower bound") != e.flags.end());
      REQUIRE(e.others.size() == 1);
      CHECK(std::isfinite(e.others.front().value));
      const Efficiency knn = efficiency(target, samples, {.estimators = {EstimatorSpec::make("knn")}});
      CHECK(std::find(knn.flags.begin(), knn.flags.end(), "indicative") != knn.flags.end());
    }
  }
}

TEST_CASE("regions and distributions of spaces with rotations", "[measure]") {
  const Space space = Space::so3(1.0);
  const std::vector<double> one = {0.0, 0.0, 0.0, 1.0};
  const Target region = Target::region(
      space, TargetSettings{}, [&](View x) { return space.distance(one, x) < 1.2; }, 5);
  CHECK(region.log_volume() == Approx(std::log(ball_of_rotations(1.2))).margin(4.0 * region.log_volume_error()));
  Stream stream(1, "", "draws");
  const Efficiency itself = efficiency(region, region.draw(1500, stream));
  CHECK(itself.value == Approx(itself.perfect).margin(0.05));

  // A distribution with the density of the region, and the same samples scored on it.
  const double log_t = -region.log_volume();
  const Target same = Target::distribution(
      space, TargetSettings{},
      {region.pool(), [&](View x) { return region.contains(x) ? log_t : -std::numeric_limits<double>::infinity(); }});
  CHECK(same.uniform() == Approx(region.uniform()));
  CHECK(efficiency(same, region.draw(1500, stream)).value == Approx(itself.perfect).margin(0.1));
}
