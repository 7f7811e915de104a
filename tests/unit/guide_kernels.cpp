// SPDX-License-Identifier: GPL-3.0-or-later
// Mixtures of balls along paths against what they are made of.
#include <cmath>
#include <memory>
#include <numbers>
#include <utility>
#include <vector>

#include <trellis/guide/kernels.hpp>

#include "support/catch.hpp"

using namespace trellis;

namespace {

std::vector<Space> spaces() {
  return {Space::euclidean({{0, 4}, {-1, 1}}), Space::se2({0, 3}, {0, 2}), Space::so2(2.0),
          Space::product({{1.5, Space::so2(1.0)}, {0.7, Space::so2(1.0)}, {2.0, Space::euclidean({{0, 1}})}}),
          Space::euclidean({{0, 1}, {0, 1}, {0, 1}, {0, 1}, {0, 1}, {0, 1}})};
}

Configurations random_path(const Space& space, std::size_t points, Stream& stream) {
  Configurations path(space.dimension());
  Configuration q(space.dimension());
  for (std::size_t i = 0; i < points; ++i) {
    space.sample_uniform(stream, q);
    path.push(q);
  }
  return path;
}

/// A point near the path, where the tube has a density.
Configuration near(const Space& space, const Tube& tube, Stream& stream) {
  Configuration q(space.dimension());
  tube.point(stream.uniform(0.0, tube.length()), q);
  Configuration out(q.size());
  BallKernel(space, 1.5 * tube.ball().radius()).sample(q, stream, out);
  return out;
}

}  // namespace

TEST_CASE("a tube's density is the mean of its balls'", "[guide][kernel][slow]") {
  for (const auto& space : spaces()) {
    CAPTURE(space.name());
    Stream stream(1, space.name(), "tubes");
    const Tube tube(space, random_path(space, 6, stream), 0.2 * space.diameter());
    TubeKernel kernel(space, tube.path(), tube.ball().radius());
    const std::vector<std::pair<double, double>> stretches = {{0.1 * tube.length(), 0.25 * tube.length()},
                                                              {0.5 * tube.length(), 0.9 * tube.length()}};
    kernel.activate(stretches);
    const double active = 0.55 * tube.length();
    Configuration centre(space.dimension());
    for (int i = 0; i < 30; ++i) {
      const Configuration q = near(space, tube, stream);
      double sum = 0.0;
      constexpr int steps = 20000;
      for (const auto& [from, to] : stretches) {
        for (int k = 0; k < steps; ++k) {
          tube.point(from + (k + 0.5) / steps * (to - from), centre);
          sum += tube.ball().density(centre, q) * (to - from) / active / steps;
        }
      }
      // A step of the sum may be wrong wherever the path enters or leaves the ball about q or one of its images.
      CHECK(kernel.density(q) ==
            Approx(sum).margin(1e-12).epsilon(1e-9).margin(64.0 / steps * std::exp(-tube.ball().log_volume())));
    }
  }
}

TEST_CASE("the sum of tubes' densities is one density, whatever overlaps", "[guide][kernel]") {
  for (const auto& space : spaces()) {
    CAPTURE(space.name());
    Stream stream(2, space.name(), "sums");
    const double radius = 0.15 * space.diameter();
    std::vector<Density::Term> terms;
    std::vector<TubeKernel> kernels;
    for (int path = 0; path < 3; ++path) {
      kernels.emplace_back(space, random_path(space, path == 2 ? 1 : 5, stream), radius);
      for (int i = 0; i < 40; ++i) {
        std::vector<double> cuts(4);
        for (double& cut : cuts) cut = stream.uniform(0.0, kernels.back().length());
        std::sort(cuts.begin(), cuts.end());
        kernels.back().activate({{cuts[0], cuts[1]}, {cuts[2], cuts[3]}});
        terms.push_back({kernels.back().density(), stream.uniform(0.0, 3.0)});
      }
    }
    for (const auto& term : terms) CHECK(terms.front().density->mergeable(*term.density));
    const auto whole = terms.front().density->sum(terms);
    // A sum may be summed again.
    const auto twice = whole->sum({{whole, 0.5}, {terms.front().density, 2.0}});
    double reached = 0.0;
    for (int i = 0; i < 200; ++i) {
      Configuration q = near(space, Tube(space, kernels[i % 3].path(), radius), stream);
      if (i % 5 == 0) space.sample_uniform(stream, q);
      double sum = 0.0;
      for (const auto& term : terms) sum += term.weight * term.density->at(q);
      CHECK(whole->at(q) == Approx(sum).epsilon(1e-10).margin(1e-300));
      CHECK(twice->at(q) == Approx(0.5 * sum + 2.0 * terms.front().density->at(q)).epsilon(1e-10).margin(1e-300));
      reached += sum > 0.0 ? 1.0 : 0.0;
    }
    CHECK(reached > 50);
  }
}

TEST_CASE("tubes of another radius or space have no common sum", "[guide][kernel]") {
  const auto space = Space::euclidean({{0, 1}, {0, 1}});
  Stream stream(3, "", "kin");
  const auto path = random_path(space, 3, stream);
  const TubeKernel a(space, path, 0.1);
  CHECK_FALSE(a.density()->mergeable(*TubeKernel(space, path, 0.2).density()));
  CHECK_FALSE(a.density()->mergeable(*TubeKernel(Space::euclidean({{0, 2}, {0, 1}}), path, 0.1).density()));
}

TEST_CASE("what no stretch covers has no mass at all", "[guide][kernel]") {
  const auto space = Space::euclidean({{0, 10}, {0, 10}});
  Configurations path(2);
  path.push(Configuration{1, 5});
  path.push(Configuration{9, 5});
  TubeKernel kernel(space, path, 0.1);
  std::vector<Density::Term> terms;
  for (const double from : {0.1, 0.3, 0.7}) {
    kernel.activate({{from, from + 1.1}, {from + 5.0, from + 5.9}});
    terms.push_back({kernel.density(), 1.0 / 3.0});
  }
  const auto sum = terms.front().density->sum(terms);
  CHECK(sum->at(Configuration{1.0 + 3.0, 5}) == 0.0);
  CHECK(sum->at(Configuration{1.0 + 1.0, 5}) > 0.0);
  CHECK(sum->at(Configuration{1.0 + 7.5, 5}) == 0.0);
}
