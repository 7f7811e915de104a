// SPDX-License-Identifier: GPL-3.0-or-later
// Laws that every space keeps.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include <trellis/base/error.hpp>
#include <trellis/space/rotation.hpp>
#include <trellis/space/space.hpp>

#include "support/catch.hpp"

using namespace trellis;
using Catch::Matchers::Contains;

namespace {

std::vector<Space> spaces() {
  const auto r2 = Space::euclidean({{0, 10}, {-3, 4}});
  return {
      Space::euclidean({{-1, 1}}),
      r2,
      Space::so2(),
      Space::se2({0, 10}, {0, 10}),
      Space::se2({0, 10}, {0, 10}, 2.0),
      Space::product({{1.0, r2}, {0.5, Space::so2()}, {3.0, Space::so2()}}),
      Space::euclidean({{0, 1}, {0, 1}, {0, 1}, {0, 1}, {0, 1}, {0, 1}}),
      Space::so3(),
      Space::se3({{{0, 10}, {-3, 4}, {0, 2}}}, 0.7),
      Space::product({{1.0, Space::euclidean({{0, 1}, {0, 1}, {0, 1}})}, {2.0, Space::so3()}, {0.5, Space::so2()}})};
}

}  // namespace

TEST_CASE("the metric of every space is a metric", "[space][laws]") {
  for (const auto& space : spaces()) {
    CAPTURE(space.name());
    Stream stream(1, space.name(), "metric");
    Configuration a(space.dimension());
    Configuration b(space.dimension());
    Configuration c(space.dimension());
    for (int i = 0; i < 2000; ++i) {
      space.sample_uniform(stream, a);
      space.sample_uniform(stream, b);
      space.sample_uniform(stream, c);
      CHECK(space.distance(a, a) == 0.0);
      CHECK(space.distance(a, b) == Approx(space.distance(b, a)).epsilon(1e-14));
      CHECK(space.distance(a, c) <= space.distance(a, b) + space.distance(b, c) + 1e-12);
      CHECK(space.distance(a, b) <= space.diameter() + 1e-12);
      CHECK(space.squared_distance(a, b) == Approx(std::pow(space.distance(a, b), 2)).epsilon(1e-12));
    }
  }
}

TEST_CASE("interpolation takes the shortest motion at constant speed and ends exactly", "[space][laws]") {
  for (const auto& space : spaces()) {
    CAPTURE(space.name());
    Stream stream(2, space.name(), "interpolation");
    Configuration a(space.dimension());
    Configuration b(space.dimension());
    Configuration q(space.dimension());
    for (int i = 0; i < 1000; ++i) {
      space.sample_uniform(stream, a);
      space.sample_uniform(stream, b);
      const double t = stream.uniform();
      space.interpolate(a, b, t, q);
      CHECK(space.contains(q));
      CHECK(space.distance(a, q) == Approx(t * space.distance(a, b)).margin(1e-9));
      CHECK(space.distance(q, b) == Approx((1 - t) * space.distance(a, b)).margin(1e-9));
      space.interpolate(a, b, 1.0, q);
      CHECK(q == b);
      const auto foot = nearest_on_motion(space, a, b, q);
      CHECK(foot.squared_distance == Approx(0.0).margin(1e-12));
    }
  }
}

TEST_CASE("the nearest point of a motion is nearest", "[space][laws]") {
  for (const auto& space : spaces()) {
    CAPTURE(space.name());
    Stream stream(5, space.name(), "foot");
    Configuration a(space.dimension());
    Configuration b(space.dimension());
    Configuration q(space.dimension());
    Configuration p(space.dimension());
    for (int i = 0; i < 300; ++i) {
      space.sample_uniform(stream, a);
      space.sample_uniform(stream, b);
      space.interpolate(a, b, 0.2, b);  // short enough not to wrap around
      space.sample_uniform(stream, q);
      space.interpolate(a, q, 0.2, q);
      const auto foot = nearest_on_motion(space, a, b, q);
      space.interpolate(a, b, foot.t, p);
      CHECK(space.squared_distance(p, q) == Approx(foot.squared_distance).margin(1e-9));
      for (int k = 0; k <= 20; ++k) {
        space.interpolate(a, b, k / 20.0, p);
        CHECK(space.squared_distance(p, q) >= foot.squared_distance - 1e-9);
      }
    }
  }
}

TEST_CASE("exp and log are inverse, and the length of a tangent vector is the distance", "[space][laws]") {
  for (const auto& space : spaces()) {
    CAPTURE(space.name());
    Stream stream(6, space.name(), "tangent");
    Configuration a(space.dimension());
    Configuration b(space.dimension());
    Configuration end(space.dimension());
    std::vector<double> v(space.degrees());
    std::vector<double> back(space.degrees());
    for (int i = 0; i < 1000; ++i) {
      space.sample_uniform(stream, a);
      space.sample_uniform(stream, b);
      space.log(a, b, v);
      double squared = 0.0;
      for (const double x : v) squared += x * x;
      CHECK(std::sqrt(squared) == Approx(space.distance(a, b)).margin(1e-12));
      space.exp(a, v, end);
      CHECK(space.distance(end, b) == Approx(0.0).margin(1e-9));
      // Along v at constant speed: half of it leads to the middle of the motion.
      for (double& x : v) x *= 0.5;
      space.exp(a, v, end);
      space.interpolate(a, b, 0.5, b);
      CHECK(space.distance(end, b) == Approx(0.0).margin(1e-9));
      space.log(a, end, back);
      for (std::size_t j = 0; j < v.size(); ++j) CHECK(back[j] == Approx(v[j]).margin(1e-9));
    }
  }
}

TEST_CASE("a ball of tangent vectors has the volume that log_jacobian says", "[space][laws]") {
  // The share of uniform configurations in a ball about a centre, and the same from vectors uniform in the ball.
  for (const auto& space : spaces()) {
    if (space.flat()) continue;
    CAPTURE(space.name());
    Stream stream(7, space.name(), "ball");
    const double radius = 0.6 * space.injectivity_radius();
    Configuration centre(space.dimension());
    Configuration q(space.dimension());
    space.from_unit(std::vector<double>(space.degrees(), 0.5), centre);
    constexpr int n = 200000;
    int inside = 0;
    for (int i = 0; i < n; ++i) {
      space.sample_uniform(stream, q);
      if (space.distance(centre, q) <= radius) ++inside;
    }
    double factor = 0.0;
    int within = 0;
    std::vector<double> v(space.degrees());
    for (int i = 0; i < n; ++i) {
      double squared = 0.0;
      for (double& x : v) {
        x = stream.normal();
        squared += x * x;
      }
      const double d = static_cast<double>(space.degrees());
      const double length = radius * std::pow(stream.uniform(), 1.0 / d) / std::sqrt(squared);
      for (double& x : v) x *= length;
      space.exp(centre, v, q);
      if (space.contains(q)) ++within;
      if (space.contains(q)) factor += std::exp(space.log_jacobian(v));
    }
    const double d = static_cast<double>(space.degrees());
    const double ball = std::exp(log_unit_ball(space.degrees()) + d * std::log(radius) - space.log_volume());
    const double expected = ball * factor / n;
    CHECK(within > 0);
    // Four standard deviations of the count.
    CHECK(static_cast<double>(inside) / n == Approx(expected).margin(4.0 * std::sqrt(expected / n) + 0.01 * expected));
  }
}

TEST_CASE("from_unit fills the space evenly", "[space][laws]") {
  for (const auto& space : spaces()) {
    CAPTURE(space.name());
    Stream stream(8, space.name(), "unit");
    Configuration q(space.dimension());
    std::vector<double> u(space.degrees());
    constexpr int n = 20000;
    std::vector<double> angles;
    for (int i = 0; i < n; ++i) {
      for (double& x : u) x = stream.uniform();
      space.from_unit(u, q);
      REQUIRE(space.contains(q));
      for (const Factor& factor : space.factors()) {
        if (factor.kind != Factor::Kind::rotation) continue;
        const double* row = q.data() + factor.column;
        angles.push_back(norm(rotation_vector({row[0], row[1], row[2], row[3]})));
      }
    }
    // The angle of a uniform rotation has the distribution function (angle - sin(angle)) / pi.
    std::sort(angles.begin(), angles.end());
    double worst = 0.0;
    for (std::size_t i = 0; i < angles.size(); ++i) {
      const double truth = (angles[i] - std::sin(angles[i])) / std::numbers::pi;
      worst = std::max(worst, std::abs(truth - (static_cast<double>(i) + 0.5) / static_cast<double>(angles.size())));
    }
    CHECK(worst < 2.0 / std::sqrt(static_cast<double>(n)));
  }
}

TEST_CASE("a space with rotations has no axes to ask for", "[space][errors]") {
  const Space space = Space::se3({{{0, 1}, {0, 1}, {0, 1}}}, 0.5);
  CHECK(space.name() == "SE(3)");
  CHECK(space.dimension() == 7);
  CHECK(space.degrees() == 6);
  CHECK_FALSE(space.flat());
  CHECK_THROWS_AS(space.axes(), Fault);
  Configuration q(7);
  CHECK_THROWS_AS(space.difference(q, q, q), Fault);
  CHECK_FALSE(space.contains(Configuration{0.5, 0.5, 0.5, 0, 0, 0, 0}));
  CHECK_FALSE(space.contains(Configuration{0.5, 0.5, 0.5, 0, 0, std::nan(""), 1}));
  CHECK(space.contains(Configuration{0.5, 0.5, 0.5, 0, 0, 0, 1}));
}

TEST_CASE("angles wrap", "[space]") {
  const double pi = std::numbers::pi;
  const auto space = Space::se2({0, 10}, {0, 10});
  const Configuration a = {5, 5, pi - 0.1};
  const Configuration b = {5, 5, -pi + 0.1};
  CHECK(space.distance(a, b) == Approx(0.2 / pi));
  Configuration q(3);
  space.interpolate(a, b, 0.5, q);
  CHECK(std::abs(std::abs(q[2]) - pi) < 1e-12);
  q = {5, 5, 7.0};
  space.normalise(q);
  CHECK(q[2] == Approx(7.0 - 2 * pi));
  // A half turn costs 1 by default, the Parasol convention.
  CHECK(space.distance(Configuration{5, 5, 0}, Configuration{5, 5, -pi}) == Approx(1.0));
}

TEST_CASE("uniform samples lie in the space and fill it evenly, reflection keeps them in", "[space]") {
  for (const auto& space : spaces()) {
    CAPTURE(space.name());
    Stream stream(3, space.name(), "uniform");
    Configuration q(space.dimension());
    std::vector<double> mean(space.dimension(), 0.0);
    constexpr int n = 20000;
    for (int i = 0; i < n; ++i) {
      space.sample_uniform(stream, q);
      REQUIRE(space.contains(q));
      for (std::size_t j = 0; j < q.size(); ++j) mean[j] += q[j] / n;
      for (std::size_t j = 0; j < q.size(); ++j) q[j] += stream.normal() * 3.0;
      space.reflect(q);
      REQUIRE(space.contains(q));
    }
    for (const Factor& factor : space.factors()) {
      if (factor.kind == Factor::Kind::rotation) continue;
      const Axis& axis = factor.axis;
      CHECK(mean[factor.column] == Approx(0.5 * (axis.lo + axis.hi)).margin(0.02 * (axis.hi - axis.lo)));
    }
  }
}

TEST_CASE("volumes are those of the metric coordinates", "[space]") {
  CHECK(Space::euclidean({{0, 10}, {-3, 4}}).log_volume() == Approx(std::log(70.0)));
  CHECK(Space::se2({0, 10}, {0, 10}).log_volume() == Approx(std::log(200.0)));
  CHECK(Space::so3(2.0).log_volume() == Approx(std::log(8.0 * 8.0 * std::numbers::pi * std::numbers::pi)));
  CHECK(Space::so3().diameter() == Approx(1.0));
  CHECK(std::exp(log_unit_ball(2)) == Approx(std::numbers::pi));
  CHECK(std::exp(log_unit_ball(3)) == Approx(4.0 / 3.0 * std::numbers::pi));
}

TEST_CASE("a product multiplies its factors' metrics by their weights and keeps names apart", "[space]") {
  const auto space =
      Space::product({{1.0, Space::euclidean({{0, 1}, {0, 1}})}, {2.0, Space::so2(1.0)}, {3.0, Space::so2(1.0)}});
  CHECK(space.name() == "R^2 x SO(2) x SO(2)");
  CHECK(space.axes()[3].name == "theta2");
  CHECK(space.distance(Configuration{0, 0, 0, 0}, Configuration{0, 0, 0.5, 0}) == Approx(1.0));
  CHECK(space.distance(Configuration{0, 0, 0, 0}, Configuration{0, 0, 0, 0.5}) == Approx(1.5));
}

TEST_CASE("a malformed space is refused", "[space][errors]") {
  CHECK_THROWS_WITH(Space::euclidean({{1, 0}}), Contains("lo < hi"));
  CHECK_THROWS_WITH(Space::euclidean({{0, std::nan("")}}), Contains("finite bounds"));
  CHECK_THROWS_WITH(Space::so2(0.0), Contains("weight"));
}
