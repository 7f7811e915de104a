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

constexpr int uniform_draws = 400'000;
constexpr int draws = 20'000;

/// Checks that a density integrates to one and is that of its samples: both give the same mean distance from a
/// configuration.
/// \param sample  draws into a configuration
template <class DensityAt, class Sample>
void check_density(const Space& space, View from, Stream& stream, const DensityAt& density, const Sample& sample) {
  Configuration q(space.dimension());
  const double volume = std::exp(space.log_volume());
  double mass = 0.0, by_density = 0.0, mean = 0.0;
  for (int i = 0; i < uniform_draws; ++i) {
    space.sample_uniform(stream, q);
    const double share = density(q) * volume / uniform_draws;
    mass += share;
    if (share > 0.0) by_density += share * space.distance(from, q);
  }
  for (int i = 0; i < draws; ++i) {
    sample(q);
    CHECK(space.contains(q));
    CHECK(density(q) > 0.0);
    mean += space.distance(from, q) / draws;
  }
  CHECK(mass == Approx(1.0).epsilon(0.08));
  CHECK(by_density == Approx(mean).epsilon(0.08));
}

}  // namespace

TEST_CASE("a ball's density integrates to one and is that of its samples, with rotations", "[guide][kernels]") {
  for (const Space& space : spaces()) {
    Stream stream(1, "ball", space.name());
    Configuration centre(space.dimension());
    space.sample_uniform(stream, centre);
    // Near a bound, so that samples are reflected.
    if (space.factors().front().kind == Factor::Kind::line) centre[0] = 0.2;
    const BallKernel ball(space, 0.7);
    INFO(space.name());
    check_density(
        space, centre, stream, [&](View x) { return ball.density(centre, x); },
        [&](MutableView x) { ball.sample(centre, stream, x); });
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
      INFO(space.name() << whole);
      check_density(
          space, path[0], stream, [&](View x) { return tube.density(x); },
          [&](MutableView x) { tube.sample(stream, x); });
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
