// SPDX-License-Identifier: GPL-3.0-or-later
// Laws that every space keeps.
#include <cmath>
#include <numbers>
#include <vector>

#include <trellis/base/error.hpp>
#include <trellis/space/space.hpp>

#include "support/catch.hpp"

using namespace trellis;
using Catch::Matchers::Contains;

namespace {

std::vector<Space> spaces() {
  const auto r2 = Space::euclidean({{0, 10}, {-3, 4}});
  return {Space::euclidean({{-1, 1}}),
          r2,
          Space::so2(),
          Space::se2({0, 10}, {0, 10}),
          Space::se2({0, 10}, {0, 10}, 2.0),
          Space::product({{1.0, r2}, {0.5, Space::so2()}, {3.0, Space::so2()}}),
          Space::euclidean({{0, 1}, {0, 1}, {0, 1}, {0, 1}, {0, 1}, {0, 1}})};
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
    for (std::size_t j = 0; j < q.size(); ++j) {
      const auto& axis = space.axes()[j];
      CHECK(mean[j] == Approx(0.5 * (axis.lo + axis.hi)).margin(0.02 * (axis.hi - axis.lo)));
    }
  }
}

TEST_CASE("volumes are those of the metric coordinates", "[space]") {
  CHECK(Space::euclidean({{0, 10}, {-3, 4}}).log_volume() == Approx(std::log(70.0)));
  CHECK(Space::se2({0, 10}, {0, 10}).log_volume() == Approx(std::log(200.0)));
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
