// SPDX-License-Identifier: GPL-3.0-or-later
// Balls and tubes in spaces with rotations: their densities are those of their samples.
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include <trellis/base/random.hpp>
#include <trellis/guide/kernels.hpp>

#include "support/catch.hpp"

using namespace trellis;

namespace {

std::vector<Space> spaces() {
  const Space se3 = Space::se3({{{0, 2}, {0, 1.5}, {0, 2}}}, 0.5);
  return {Space::so3(0.5), se3, Space::product({{1.0, se3}, {1.0, Space::so2(0.3)}})};
}

/// What the kernel's density says of the mean of f, and of the total mass, from uniform configurations.
struct Integral {
  double mass = 0.0;
  double mean = 0.0;
};
template <class DensityAt, class F>
Integral integral(const Space& space, int n, Stream& stream, const DensityAt& density, const F& f) {
  Integral sum;
  Configuration q(space.dimension());
  const double volume = std::exp(space.log_volume());
  for (int i = 0; i < n; ++i) {
    space.sample_uniform(stream, q);
    const double share = density(q) * volume / n;
    sum.mass += share;
    if (share > 0.0) sum.mean += share * f(q);
  }
  return sum;
}

constexpr int uniform_draws = 400'000;
constexpr int draws = 20'000;

}  // namespace

TEST_CASE("a ball's density integrates to one and is that of its samples, with rotations", "[guide][kernels]") {
  for (const Space& space : spaces()) {
    Stream stream(1, "ball", space.name());
    Configuration centre(space.dimension()), q(space.dimension());
    space.sample_uniform(stream, centre);
    // Near a bound, so that samples are reflected.
    if (space.factors().front().kind == Factor::Kind::line) centre[0] = 0.2;
    const BallKernel ball(space, 0.7);
    const auto distance = [&](View x) { return space.distance(centre, x); };
    const auto by_density = integral(
        space, uniform_draws, stream, [&](View x) { return ball.density(centre, x); }, distance);
    double mean = 0.0;
    for (int i = 0; i < draws; ++i) {
      ball.sample(centre, stream, q);
      CHECK(space.contains(q));
      CHECK(ball.density(centre, q) > 0.0);
      mean += distance(q) / draws;
    }
    INFO(space.name());
    CHECK(by_density.mass == Approx(1.0).epsilon(0.08));
    CHECK(by_density.mean == Approx(mean).epsilon(0.08));
  }
}

TEST_CASE("a tube's density integrates to one and is that of its samples, with rotations", "[guide][kernels][slow]") {
  for (const Space& space : spaces()) {
    Stream stream(2, "tube", space.name());
    Configurations path(space.dimension());
    Configuration q(space.dimension());
    for (int i = 0; i < 3; ++i) {
      space.sample_uniform(stream, q);
      path.push(q);
    }
    TubeKernel tube(space, path, 0.6);
    for (const bool whole : {true, false}) {
      if (!whole)
        tube.activate({{0.1 * tube.length(), 0.3 * tube.length()}, {0.7 * tube.length(), 0.75 * tube.length()}});
      const auto distance = [&](View x) { return space.distance(path[0], x); };
      const auto by_density = integral(
          space, uniform_draws, stream, [&](View x) { return tube.density(x); }, distance);
      double mean = 0.0;
      for (int i = 0; i < draws; ++i) {
        tube.sample(stream, q);
        CHECK(space.contains(q));
        CHECK(tube.density(q) > 0.0);
        mean += distance(q) / draws;
      }
      INFO(space.name() << whole);
      CHECK(by_density.mass == Approx(1.0).epsilon(0.08));
      CHECK(by_density.mean == Approx(mean).epsilon(0.08));
    }
  }
}

TEST_CASE("the sum of tube densities is their weighted sum, with rotations", "[guide][kernels]") {
  for (const Space& space : spaces()) {
    Stream stream(3, "sum", space.name());
    Configurations path(space.dimension());
    Configuration q(space.dimension());
    for (int i = 0; i < 3; ++i) {
      space.sample_uniform(stream, q);
      path.push(q);
    }
    TubeKernel tube(space, path, 0.6);
    const auto whole = tube.density();
    tube.activate(0.25 * tube.length(), 0.5 * tube.length());
    const auto part = tube.density();
    REQUIRE(whole->mergeable(*part));
    const auto sum = whole->sum({{whole, 0.3}, {part, 0.7}});
    for (int i = 0; i < 500; ++i) {
      tube.sample(stream, q);
      CHECK(sum->at(q) == Approx(0.3 * whole->at(q) + 0.7 * part->at(q)).epsilon(1e-9));
    }
  }
}
