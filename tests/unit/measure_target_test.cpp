// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include <trellis/measure/target.hpp>

#include "support/catch.hpp"

using namespace trellis;

namespace {

constexpr double pi = std::numbers::pi;

Configurations path_of(const std::vector<Configuration>& points) {
  Configurations path(points.front().size());
  for (const auto& p : points) path.push(p);
  return path;
}

bool anywhere(View) { return true; }

TubeSettings tube(const std::string& distance, double delta = 0.5) {
  TubeSettings settings;
  settings.distance = distance == "planar" ? TubeSettings::Distance::planar : TubeSettings::Distance::full;
  settings.delta = delta;
  return settings;
}

double volume(const Target& target) { return std::exp(target.log_volume()); }

/// The distance to a polyline by steps along it: independent and slow.
double stepped_distance(const Space& space, const Configurations& path, View x, const std::vector<std::size_t>& axes) {
  double best = std::numeric_limits<double>::infinity();
  Configuration at(space.dimension());
  Configuration delta(space.dimension());
  for (std::size_t i = 0; i + 1 < std::max<std::size_t>(path.size(), 2); ++i) {
    const View to = path[std::min(i + 1, path.size() - 1)];
    for (int step = 0; step <= 4000; ++step) {
      space.interpolate(path[i], to, step / 4000.0, at);
      space.difference(at, x, delta);
      double sum = 0.0;
      for (const std::size_t j : axes) sum += std::pow(delta[j] * space.axes()[j].weight, 2);
      best = std::min(best, std::sqrt(sum));
    }
  }
  return best;
}

}  // namespace

TEST_CASE("The volume of a capsule in the plane is 2 delta L + pi delta^2") {
  const Space plane = Space::euclidean({{0, 10}, {0, 10}});
  for (const double delta : {0.05, 0.5, 1.5}) {
    const Target target(plane, path_of({{2, 3}, {8, 7}}), {0, 1}, tube("planar", delta), anywhere, 1);
    const double length = std::hypot(6.0, 4.0);
    CHECK(volume(target) == Approx(2 * delta * length + pi * delta * delta).epsilon(0.004));
    CHECK(target.free_share() == 1.0);
    CHECK(target.pool().size() == 8192);
    CHECK(target.evaluation_points() == 2048);
    CHECK(target.uniform() == Approx(std::log(100.0) - target.log_volume()));
  }
  const Target disc(plane, path_of({{5, 5}, {5, 5 + 1e-6}}), {}, tube("planar"), anywhere, 1);
  CHECK(volume(disc) == Approx(pi * 0.25).epsilon(0.004));
  // A quarter disc in the corner and half the width at a wall.
  const Target corner(plane, path_of({{0, 0}, {1e-6, 0}}), {0, 1}, tube("planar"), anywhere, 1);
  CHECK(volume(corner) == Approx(pi / 16).epsilon(0.004));
  const Target wall(plane, path_of({{0, 2}, {0, 6}}), {0, 1}, tube("planar"), anywhere, 1);
  CHECK(volume(wall) == Approx(4 * 0.5 + pi / 8).epsilon(0.004));
  // More than the whole world.
  const Target all(plane, path_of({{2, 3}, {8, 7}}), {0, 1}, tube("planar", 50), anywhere, 1);
  CHECK(volume(all) == Approx(100.0).epsilon(1e-9));
}

TEST_CASE("The volume of a capsule of many dimensions is that of its cylinder and its ball") {
  for (const std::size_t d : {std::size_t{17}, std::size_t{96}}) {
    CAPTURE(d);
    std::vector<Axis> axes(d, Axis{"x", 0.0, 10.0, 1.0, false});
    // In metric coordinates all axes but these have the same length.
    axes[1] = {"wide", 0.0, 20.0, 0.5, false};
    axes[2] = {"turn", -20.0, 20.0, 1.0, true};
    const Space space("many", axes);
    Configuration from(d, 5.0), to(d, 5.0);
    from[0] = 2.0;
    to[0] = 8.0;
    from[1] = to[1] = 10.0;
    // The path crosses the end of the period.
    from[2] = 19.9;
    to[2] = -19.9;
    const double delta = 1.0;
    TubeSettings settings = tube("full", delta);
    settings.pool = settings.points = 2048;
    const Target target(space, path_of({from, to}), {}, settings, anywhere, 1);
    const auto log_ball = [](double n) { return 0.5 * n * std::log(pi) - std::lgamma(0.5 * n + 1.0); };
    const auto n = static_cast<double>(d);
    const double length = std::hypot(6.0, 0.2);
    const double expected = std::log(length * std::exp(log_ball(n - 1) - log_ball(n)) + 1.0) + log_ball(n);
    CHECK(target.log_volume() == Approx(expected).epsilon(0).margin(0.05));
    REQUIRE(target.evaluation_points() == 2048);
    // Uniform in the capsule: across the path, each coordinate has the variance delta^2 / (n + 1).
    double squares = 0.0;
    for (std::size_t i = 0; i < target.pool().size(); ++i) {
      const View x = target.pool()[i];
      REQUIRE(target.contains(x));
      squares += (x[d - 1] - 5.0) * (x[d - 1] - 5.0);
    }
    CHECK(squares / static_cast<double>(target.pool().size()) == Approx(delta * delta / (n + 1)).epsilon(0.1));
  }
}

TEST_CASE("A wall takes its part of the free tube, and support all leaves it there") {
  const Space plane = Space::euclidean({{0, 10}, {0, 10}});
  int calls = 0;
  int outside = 0;
  const Configurations path = path_of({{1, 5}, {9, 5}});
  const auto valid = [&](View x) {
    ++calls;
    outside += std::abs(x[1] - 5) > 0.5 ? 1 : 0;
    return x[1] >= 5 || x[0] < 5;
  };
  const Target target(plane, path, {0, 1}, tube("planar"), valid, 1);
  CHECK(volume(target) == Approx(8 + pi / 4 - 2 - pi / 16).epsilon(0.004));
  CHECK(target.free_share() == Approx((6 + 3 * pi / 16) / (8 + pi / 4)).epsilon(0.004));
  CHECK(calls < 50000);
  CHECK(outside == 0);
  CHECK(target.contains(std::vector{6.0, 5.3}));
  CHECK_FALSE(target.contains(std::vector{6.0, 4.7}));
  CHECK_FALSE(target.contains(std::vector{6.0, 5.6}));
  CHECK_FALSE(target.contains(std::vector{-1.0, 5.0}));

  calls = 0;
  TubeSettings settings = tube("planar");
  settings.support = TubeSettings::Support::all;
  const Target whole(plane, path, {0, 1}, settings, valid, 1);
  CHECK(volume(whole) == Approx(8 + pi / 4).epsilon(0.004));
  CHECK(whole.contains(std::vector{6.0, 4.7}));
  CHECK(calls == 0);
}

TEST_CASE("Tubes in SE(2): planar ones take every heading, full ones wrap") {
  const Space se2 = Space::se2({0, 10}, {0, 10});
  const double delta = 0.3;
  const Configurations path = path_of({{2, 5, 3.0}, {7, 5, 3.0}});
  const Target planar(se2, path, {0, 1}, tube("planar", delta), anywhere, 1);
  CHECK(volume(planar) == Approx(2 * (2 * delta * 5 + pi * delta * delta)).epsilon(0.004));
  CHECK(planar.contains(std::vector{3.0, 5.1, -1.0}));

  // theta = 3 lies 0.045 m off the seam: the tube crosses it.
  const double straight = pi * delta * delta * 5 + 4.0 / 3.0 * pi * std::pow(delta, 3);
  const Target full(se2, path, {0, 1}, tube("full", delta), anywhere, 1);
  CHECK(volume(full) == Approx(straight).epsilon(0.004));
  CHECK(full.contains(std::vector{3.0, 5.0, -3.1}));
  CHECK(full.distance(std::vector{3.0, 5.0, -3.1}) == Approx((2 * pi - 6.1) / pi));
  CHECK_FALSE(full.contains(std::vector{3.0, 5.0, 0.0}));

  // A leg from 3 to -3 takes the shorter direction, 0.28 rad; the tube is that of a straight leg of this length.
  const Target turning(se2, path_of({{2, 5, 3.0}, {7, 5, -3.0}}), {0, 1}, tube("full", delta), anywhere, 1);
  const double length = std::hypot(5.0, (2 * pi - 6.0) / pi);
  CHECK(volume(turning) == Approx(pi * delta * delta * length + 4.0 / 3.0 * pi * std::pow(delta, 3)).epsilon(0.004));

  // A ball of radius 1.5 in an angle of half period 1 meets itself: the slab |theta| <= 1 of the ball.
  const Target wide(se2, path_of({{5, 5, 3.0}, {5 + 1e-6, 5, 3.0}}), {0, 1}, tube("full", 1.5), anywhere, 1);
  CHECK(volume(wide) == Approx(pi * (2 * 1.5 * 1.5 - 2.0 / 3.0)).epsilon(0.004));
}

TEST_CASE("Tubes in more dimensions than the grid spans") {
  const Space space = Space::euclidean({{0, 4}, {0, 4}, {0, 4}, {0, 4}, {0, 4}, {0, 4}});
  const Configuration a(6, 1.0);
  const Configuration b = {3, 3, 1, 2, 3, 2};
  const Target target(space, path_of({a, b}), {}, tube("full", 0.5), anywhere, 1);
  const double length = space.distance(a, b);
  const double expected = std::exp(log_unit_ball(5)) * std::pow(0.5, 5) * length + std::exp(log_unit_ball(6)) / 64.0;
  CHECK(volume(target) == Approx(expected).epsilon(0.01));
  CHECK(target.pool().size() == 8192);

  const double w = 1.0 / pi;
  const Space arm("arm",
                  {{"a", -pi, pi, w, true}, {"b", -pi, pi, w, true}, {"c", -pi, pi, w, true}, {"d", -pi, pi, w, true}});
  const Target turn(arm, path_of({{3, -3, 3, -3}, {-2.5, 2, 3, 2.5}}), {}, tube("full", 0.2), anywhere, 1);
  const double turned = arm.distance(std::vector{3.0, -3.0, 3.0, -3.0}, std::vector{-2.5, 2.0, 3.0, 2.5});
  CHECK(volume(turn) ==
        Approx(std::exp(log_unit_ball(3)) * std::pow(0.2, 3) * turned + std::exp(log_unit_ball(4)) * std::pow(0.2, 4))
            .epsilon(0.01));
}

TEST_CASE("Membership and distance agree with a walk along the path") {
  const double w = 1.0 / pi;
  const std::vector<Space> spaces = {
      Space::se2({0, 10}, {0, 10}), Space::euclidean({{0, 10}, {0, 10}}),
      Space("arm",
            {{"a", -pi, pi, 2 * w, true}, {"b", -pi, pi, w, true}, {"c", 0, 1, 1, false}, {"d", 0, 1, w, true}})};
  for (const Space& space : spaces) {
    Stream stream(11, space.name(), "test");
    for (const std::string distance : {"planar", "full"}) {
      Configurations path(space.dimension());
      Configuration x(space.dimension());
      for (int i = 0; i < 6; ++i) {
        space.sample_uniform(stream, x);
        path.push(x);
      }
      const Target target(space, path, {0, 1}, tube(distance), anywhere, 5);
      std::vector<std::size_t> axes = {0, 1};
      for (std::size_t j = 2; distance == "full" && j < space.dimension(); ++j) axes.push_back(j);
      for (int i = 0; i < 150; ++i) {
        space.sample_uniform(stream, x);
        if (i % 2 == 0) {  // near the path, where it matters
          space.interpolate(path[i % 5], path[i % 5 + 1], stream.uniform(), x);
          for (std::size_t j = 0; j < x.size(); ++j) x[j] += 0.4 / space.axes()[j].weight * stream.normal();
          space.reflect(x);
        }
        const double expected = stepped_distance(space, path, x, axes);
        CHECK(target.distance(x) == Approx(expected).margin(2e-3));
        CHECK(target.distance(x) < expected + 1e-9);
        CHECK(target.contains(x) == (target.distance(x) < 0.5));
      }
      for (std::size_t i = 0; i < target.pool().size(); i += 37) {
        CHECK(space.contains(target.pool()[i]));
        CHECK(target.contains(target.pool()[i]));
      }
    }
  }
}

TEST_CASE("A densely interpolated path makes the same tube, and waypoints may repeat") {
  const Space se2 = Space::se2({0, 10}, {0, 10});
  const Configurations path = path_of({{1, 1, 0}, {4, 3, 2}, {7, 6, -2}});
  Configurations dense(3);
  Configuration x(3);
  for (std::size_t leg = 0; leg < 2; ++leg) {
    for (int i = 0; i <= 700; ++i) {
      se2.interpolate(path[leg], path[leg + 1], i / 700.0, x);
      dense.push(x);
    }
  }
  for (const std::string distance : {"planar", "full"}) {
    const Target a(se2, path, {0, 1}, tube(distance), anywhere, 1);
    const Target b(se2, dense, {0, 1}, tube(distance), anywhere, 1);
    CHECK(volume(b) == Approx(volume(a)).epsilon(0.004));
    for (std::size_t i = 0; i < 200; ++i)
      CHECK(b.distance(a.pool()[i]) == Approx(a.distance(a.pool()[i])).margin(1e-3));
  }
}

TEST_CASE("Targets repeat to the last bit and follow their seed") {
  const Space se2 = Space::se2({0, 10}, {0, 10});
  const Configurations path = path_of({{1, 1, 0}, {4, 3, 2}, {7, 6, -2}});
  const Target a(se2, path, {0, 1}, tube("full"), anywhere, 3);
  const Target b(se2, path, {0, 1}, tube("full"), anywhere, 3);
  const Target c(se2, path, {0, 1}, tube("full"), anywhere, 4);
  const auto va = a.pool().values();
  const auto vb = b.pool().values();
  CHECK(a.log_volume() == b.log_volume());
  CHECK(std::equal(va.begin(), va.end(), vb.begin(), vb.end()));
  CHECK(va[0] != c.pool().values()[0]);
  CHECK(volume(c) == Approx(volume(a)).epsilon(0.006));
}

TEST_CASE("Bad input is refused and an invalid tube is empty") {
  const Space plane = Space::euclidean({{0, 10}, {0, 10}});
  const Configurations path = path_of({{2, 3}, {8, 7}});
  const auto make = [&](const Configurations& p, const TubeSettings& settings) {
    return Target(plane, p, {0, 1}, settings, anywhere, 1);
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  CHECK_THROWS_AS(make(path, tube("planar", 0.0)), Error);
  CHECK_THROWS_AS(make(path, tube("planar", -1.0)), Error);
  CHECK_THROWS_AS(make(path, tube("planar", nan)), Error);
  CHECK_THROWS_AS(make(path_of({{2, 3}, {8, nan}}), tube("planar")), Error);
  CHECK_THROWS_AS(make(path_of({{2, 3}, {8, 11}}), tube("planar")), Error);
  CHECK_THROWS_AS(make(path_of({{2, 3, 1}}), tube("planar")), Error);
  CHECK_THROWS_AS(make(Configurations(2), tube("planar")), Error);
  CHECK_THROWS_AS(Target(plane, path, {0, 2}, tube("planar"), anywhere, 1), Error);
  CHECK_THROWS_AS(Target(plane, path, {0, 0}, tube("planar"), anywhere, 1), Error);
  CHECK_THROWS_WITH(make(path_of({{2, 3}}), tube("planar")), Catch::Contains("a single configuration"));
  CHECK_THROWS_WITH(make(path_of({{2, 3}, {2, 3}}), tube("planar")), Catch::Contains("no length"));
  // A turn on the spot has no length for the position, and some in the full metric.
  const Space turning = Space::se2({0, 10}, {0, 10});
  const auto turn = path_of({{2, 3, 0}, {2, 3, 1}});
  CHECK_THROWS_WITH(Target(turning, turn, {0, 1}, tube("planar"), anywhere, 1), Catch::Contains("no length"));
  CHECK_FALSE(Target(turning, turn, {0, 1}, tube("full"), anywhere, 1).empty());

  const Target empty(
      plane, path, {0, 1}, tube("planar"), [](View) { return false; }, 1);
  CHECK(empty.empty());
  CHECK(empty.evaluation_points() == 0);
  CHECK(empty.free_share() == 0.0);
  CHECK(empty.log_volume() == -std::numeric_limits<double>::infinity());

  // One valid part in two hundred still gives a pool to work with.
  const Target scarce(
      plane, path, {0, 1}, tube("planar"), [](View x) { return x[0] > 4 && x[0] < 4.04; }, 1);
  CHECK(scarce.pool().size() >= 700);
  CHECK(volume(scarce) == Approx(0.04 / (6 / std::hypot(6.0, 4.0))).epsilon(0.06));
}

TEST_CASE("The tube's options are registered with the defaults of its settings") {
  const auto& settings = tube_settings();
  CHECK(settings.component().name == "tube");
  const Options options = Options::validate(settings.component(), {{"delta", 0.25}, {"distance", std::string("full")}});
  const TubeSettings read = settings.read(options);
  CHECK(read.delta == 0.25);
  CHECK(read.distance == TubeSettings::Distance::full);
  CHECK(read.points == 2048);
  CHECK_THROWS_AS(Options::validate(settings.component(), {{"delta", 0.0}}), Error);
}
