// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include <trellis/measure/efficiency.hpp>

#include "support/catch.hpp"

using namespace trellis;

namespace {

constexpr double pi = std::numbers::pi;

bool anywhere(View) { return true; }

Configurations path_in(const Space& space) {
  Configurations path(space.dimension());
  const std::vector<Configuration> points = space.dimension() == 2
                                                ? std::vector<Configuration>{{1, 1}, {4, 3}, {7, 6}}
                                                : std::vector<Configuration>{{1, 1, 0}, {4, 3, 2}, {7, 6, -2}};
  for (const auto& p : points) path.push(p);
  return path;
}

TubeSettings tube(const std::string& distance) {
  TubeSettings settings;
  settings.distance = distance == "planar" ? TubeSettings::Distance::planar : TubeSettings::Distance::full;
  return settings;
}

Target make(const Space& space, const std::string& distance, const Target::Valid& valid = anywhere) {
  return {space, path_in(space), {0, 1}, tube(distance), valid, 7};
}

Configurations uniform_samples(const Space& space, std::size_t n, std::uint64_t seed) {
  Stream stream(seed, space.name(), "samples");
  Configurations samples(space.dimension());
  Configuration x(space.dimension());
  for (std::size_t i = 0; i < n; ++i) {
    space.sample_uniform(stream, x);
    samples.push(x);
  }
  return samples;
}

Configurations target_samples(const Target& target, std::size_t n, std::uint64_t seed) {
  Stream stream(seed, "", "samples");
  Configurations samples(target.space().dimension());
  Configuration x(target.space().dimension());
  while (samples.size() < n) {
    target.space().sample_uniform(stream, x);
    if (target.contains(x)) samples.push(x);
  }
  return samples;
}

bool flagged(const Efficiency& e, const std::string& flag) {
  return std::find(e.flags.begin(), e.flags.end(), flag) != e.flags.end();
}

/// A broad Gaussian reflected at the walls and wrapped, with its density: what a tree grown from the start looks like
/// from afar.
struct Blob {
  Space space;
  Configuration centre;
  double sd;

  void draw(Stream& stream, MutableView x) const {
    for (std::size_t j = 0; j < x.size(); ++j) x[j] = centre[j] + sd / space.axes()[j].weight * stream.normal();
    space.reflect(x);
  }
  [[nodiscard]] double density(View x) const {
    double product = 1.0;
    for (std::size_t j = 0; j < x.size(); ++j) {
      const Axis& axis = space.axes()[j];
      const auto normal = [&](double u) {
        u *= axis.weight / sd;
        return std::exp(-0.5 * u * u) / (sd * std::sqrt(2 * pi));
      };
      double sum = 0.0;
      for (int k = -8; k <= 8; ++k) {
        const double shift = k * axis.period() * (axis.periodic ? 1.0 : 2.0);
        sum += normal(x[j] - centre[j] + shift);
        if (!axis.periodic) sum += normal(2 * axis.lo - x[j] - centre[j] + shift);
      }
      product *= sum;
    }
    return product;
  }
};

/// The regularised divergence for a known density, by quasi Monte Carlo.
template <class Density>
double truth(const Target& target, const Density& density) {
  const double uniform = std::exp(-target.space().log_volume());
  const double eps = uniform_mix;
  double sum = 0.0;
  for (std::size_t i = 0; i < target.evaluation_points(); ++i) {
    sum += std::log((1 - eps) * density(target.pool()[i]) + eps * uniform);
  }
  return -target.log_volume() - sum / static_cast<double>(target.evaluation_points());
}

}  // namespace

TEST_CASE("Over four samplers with known divergence the error stays near what is published", "[slow]") {
  struct Row {
    std::size_t n;
    double plane, se2;  // RMSE over the four cases, with room for the few repetitions
  };
  const std::vector<Row> rows = {{300, 0.20, 0.26}, {1000, 0.12, 0.15}, {3000, 0.09, 0.12}};
  const int repetitions = 6;
  for (const std::size_t d : {2U, 3U}) {
    const Space space = d == 2 ? Space::euclidean({{0, 10}, {0, 10}}) : Space::se2({0, 10}, {0, 10});
    const auto valid = [](View x) { return !(x[0] > 3.5 && x[0] < 4.5 && x[1] > 3.1 && x[1] < 4.0); };
    const Target target = make(space, "planar", valid);
    const double c = std::exp(-space.log_volume());
    const Blob blob{space, Configuration(d, 2.0), 3.0};
    const auto elsewhere = [&](View x) { return c * (0.5 + (x[0] > 7 ? 0.5 / 0.3 : 0.0)); };
    const double true_blob = truth(target, [&](View x) { return blob.density(x); });
    const double true_elsewhere = truth(target, elsewhere);
    const double true_target = truth(target, [&](View) { return std::exp(-target.log_volume()); });
    for (const Row& row : rows) {
      double squares = 0.0;
      for (int r = 0; r < repetitions; ++r) {
        const auto seed = static_cast<std::uint64_t>(100 + r);
        const auto add = [&](const Configurations& samples, double expected) {
          const double error = efficiency(target, samples).value - expected;
          squares += error * error;
        };
        add(uniform_samples(space, row.n, seed), target.uniform());
        add(target_samples(target, row.n, seed), true_target);
        Stream stream(seed, "", "blob");
        Configurations around(d);
        Configurations away(d);
        Configuration x(d);
        for (std::size_t i = 0; i < row.n; ++i) {
          blob.draw(stream, x);
          around.push(x);
          space.sample_uniform(stream, x);
          if (stream.uniform() < 0.5) x[0] = stream.uniform(7, 10);
          away.push(x);
        }
        add(around, true_blob);
        add(away, true_elsewhere);
      }
      const double rmse = std::sqrt(squares / (4 * repetitions));
      INFO("d = " << d << ", N = " << row.n << ", RMSE " << rmse);
      CHECK(rmse < (d == 2 ? row.plane : row.se2));
    }
  }
}

TEST_CASE("Uniform sampling has no gain and the target itself no divergence, planar and full") {
  const Space space = Space::se2({0, 10}, {0, 10});
  for (const std::string distance : {"planar", "full"}) {
    const Target target = make(space, distance);
    const Efficiency uniform = efficiency(target, uniform_samples(space, 20000, 1));
    CHECK(uniform.uniform == target.uniform());
    CHECK(uniform.value == Approx(uniform.uniform).margin(0.12));
    CHECK(uniform.above_uniform == uniform.uniform - uniform.value);
    CHECK(uniform.estimator == "knn");
    CHECK(uniform.samples == 20000);
    const Efficiency self = efficiency(target, target_samples(target, 2000, 1));
    CHECK(self.unregularised == Approx(0.0).margin(0.03));
    CHECK(self.value == Approx(-std::log(0.95)).margin(0.03));
    CHECK(self.in_target == 2000);
    CHECK(self.flags.empty());
  }
}

TEST_CASE("Samples that never reach A are censored, with a value near its bound") {
  const Space plane = Space::euclidean({{0, 10}, {0, 10}});
  Configurations path(2);
  path.push(std::vector{1.0, 2.0});
  path.push(std::vector{9.0, 2.0});
  const Target target(plane, path, {0, 1}, tube("planar"), anywhere, 1);
  Configurations samples = uniform_samples(plane, 1000, 1);
  for (std::size_t i = 0; i < samples.size(); ++i) samples[i][1] = 5 + 0.5 * samples[i][1];
  const Efficiency e = efficiency(target, samples);
  CHECK(e.unregularised == std::numeric_limits<double>::infinity());
  CHECK(flagged(e, "censored"));
  CHECK(flagged(e, "partial"));
  CHECK(e.in_target == 0);
  CHECK(e.coverage == 0.0);
  CHECK(e.value < std::log(1 / 0.05) + e.uniform);
  CHECK(e.value == Approx(std::log(1 / 0.05) + e.uniform).margin(0.2));
  CHECK(e.above_uniform < 0);
}

TEST_CASE("An atom at the goal costs its mass and nothing else") {
  const Space space = Space::se2({0, 10}, {0, 10});
  const Target target = make(space, "planar");
  const Configurations path = path_in(space);
  const Configurations base = uniform_samples(space, 1900, 5);
  Configurations with_atom = base;
  for (int i = 0; i < 100; ++i) with_atom.push(path.back());
  const Efficiency without = efficiency(target, base);
  const Efficiency with = efficiency(target, with_atom);
  CHECK(with.samples == 2000);
  CHECK(with.in_target == without.in_target + 100);
  // psi(2001) - psi(1901) is log(2000 / 1900) to the fourth decimal.
  CHECK(with.unregularised - without.unregularised == Approx(-std::log(0.95)).margin(1e-4));

  // Copies that differ by a whole turn are copies.
  Configurations turned = base;
  turned.push(std::vector{7.0, 6.0, -2.0});
  turned.push(std::vector{7.0, 6.0, -2.0 + 2 * pi});
  Configurations twice = base;
  twice.push(std::vector{7.0, 6.0, -2.0});
  twice.push(std::vector{7.0, 6.0, -2.0});
  CHECK(efficiency(target, turned).in_target == efficiency(target, twice).in_target);

  // The order of the samples does not matter.
  Configurations reversed(3);
  for (std::size_t i = with_atom.size(); i-- > 0;) reversed.push(with_atom[i]);
  CHECK(efficiency(target, reversed).value == with.value);
}

TEST_CASE("Few samples, equal samples and none give a reason and no number") {
  const Space space = Space::se2({0, 10}, {0, 10});
  const Target target = make(space, "planar");
  const Efficiency none = efficiency(target, Configurations(3));
  CHECK(std::isnan(none.value));
  CHECK(std::isnan(none.unregularised));
  CHECK(std::isnan(none.above_uniform));
  CHECK(none.uniform == target.uniform());
  CHECK(flagged(none, "too few samples"));
  CHECK(std::isnan(efficiency(target, Configurations()).value));

  const double bound = std::log(1 / 0.05) + target.uniform();
  Configurations equal(3);
  for (int i = 0; i < 50; ++i) equal.push(path_in(space).front());
  const Efficiency same = efficiency(target, equal);
  CHECK(std::isnan(same.value));
  CHECK(std::isnan(same.unregularised));
  CHECK(same.in_target == 50);
  CHECK(flagged(same, "too few samples"));
  CHECK_THAT(same.reason, Catch::Contains("occur more than once"));
  CHECK(same.coverage > 0.0);

  for (const std::size_t n : {1U, 2U, 3U, 5U, 20U}) {
    for (const bool inside : {true, false}) {
      const Efficiency e =
          efficiency(target, inside ? target_samples(target, n, n) : uniform_samples(space, n, n + 40));
      INFO("N = " << n << " inside " << inside);
      CHECK(flagged(e, "underpowered"));
      CHECK(flagged(e, "too few samples") == (n < 3));
      CHECK(std::isnan(e.value) == (n < 3));
      CHECK(e.reason.empty() == (n >= 3));
      if (n < 3) continue;
      CHECK(std::isfinite(e.value));
      CHECK(e.value <= bound + 1e-9);
      CHECK(e.value > -0.6);
      // A few samples of the target itself cannot look much worse than uniform ones.
      if (inside) CHECK(e.value < target.uniform());
    }
  }
}

TEST_CASE(
    "Coverage counts what lies within delta of a sample, and is flagged where uniform sampling would reach more") {
  const Space plane = Space::euclidean({{0, 10}, {0, 10}});
  Configurations path(2);
  path.push(std::vector{1.0, 5.0});
  path.push(std::vector{9.0, 5.0});
  const Target target(plane, path, {0, 1}, tube("planar"), anywhere, 1);
  // One sample in the middle of the tube covers a disc of the tube's width.
  Configurations one(2);
  one.push(std::vector{5.0, 5.0});
  const Efficiency e = efficiency(target, one);
  CHECK(e.coverage == Approx(pi * 0.25 / std::exp(target.log_volume())).epsilon(0.02));
  // As an atom it covers the same.
  one.push(std::vector{5.0, 5.0});
  CHECK(efficiency(target, one).coverage == e.coverage);

  double mean = 0.0;
  for (std::uint64_t seed = 0; seed < 30; ++seed) {
    const Efficiency u = efficiency(target, uniform_samples(plane, 150, seed));
    mean += u.coverage / 30;
  }
  // Where every ball lies in the space: 1 - (1 - |ball| / |C|)^N.
  CHECK(mean == Approx(1 - std::pow(1 - pi * 0.25 / 100, 150)).margin(0.04));

  // Half the tube unvisited.
  Configurations half = uniform_samples(plane, 1000, 1);
  for (std::size_t i = 0; i < half.size(); ++i) half[i][0] *= 0.5;
  const Efficiency h = efficiency(target, half);
  CHECK(flagged(h, "partial"));
  CHECK(h.coverage == Approx(0.55).margin(0.05));
}

TEST_CASE("Samples outside of the space count but reach nothing, unusable ones are refused") {
  const Space plane = Space::euclidean({{0, 10}, {0, 10}});
  Configurations path(2);
  path.push(std::vector{0.2, 1.0});
  path.push(std::vector{0.2, 9.0});
  const Target target(plane, path, {0, 1}, tube("planar"), anywhere, 1);
  const Configurations base = uniform_samples(plane, 1000, 2);
  Configurations more = base;
  for (int i = 0; i < 1000; ++i) more.push(std::vector{-0.1, i / 100.0});
  const Efficiency a = efficiency(target, base);
  const Efficiency b = efficiency(target, more);
  CHECK(b.samples == 2000);
  CHECK(b.in_target == a.in_target);
  CHECK(b.unregularised - a.unregularised == Approx(std::log(2.0)).margin(1e-3));

  Configurations bad(2);
  bad.push(std::vector{1.0, std::numeric_limits<double>::quiet_NaN()});
  CHECK_THROWS_AS(efficiency(target, bad), Error);
  CHECK_THROWS_AS(efficiency(target, uniform_samples(Space::se2({0, 1}, {0, 1}), 3, 1)), Error);
}

TEST_CASE("An empty target scores nothing") {
  const Space plane = Space::euclidean({{0, 10}, {0, 10}});
  const Target target = make(plane, "planar", [](View) { return false; });
  const Efficiency e = efficiency(target, uniform_samples(plane, 100, 1));
  CHECK(std::isnan(e.value));
  CHECK(std::isnan(e.unregularised));
  CHECK(std::isnan(e.uniform));
  CHECK(std::isnan(e.coverage));
  CHECK(flagged(e, "empty target"));
  CHECK(e.samples == 100);
}

TEST_CASE("Efficiencies repeat to the last bit") {
  const Space space = Space::se2({0, 10}, {0, 10});
  for (const std::size_t n : {50U, 3000U}) {
    const Efficiency a = efficiency(make(space, "full"), uniform_samples(space, n, 1));
    const Efficiency b = efficiency(make(space, "full"), uniform_samples(space, n, 1));
    CHECK(a.value == b.value);
    CHECK(a.unregularised == b.unregularised);
    CHECK(a.coverage == b.coverage);
  }
}

TEST_CASE("A tree cannot reach the invalid part of a target with the support \"all\": its divergence is infinite") {
  const Space space = Space::euclidean({{0, 10}, {0, 10}});
  const auto half = [](View x) { return x[0] < 4.0; };
  TubeSettings settings = tube("full");
  settings.support = TubeSettings::Support::all;
  const Target target(space, path_in(space), {}, settings, half, 7);
  Configurations valid(2);
  const Configurations drawn = uniform_samples(space, 2000, 3);
  for (std::size_t i = 0; i < drawn.size(); ++i) {
    if (half(drawn[i])) valid.push(drawn[i]);
  }
  const Efficiency tree = efficiency(target, valid, {.support = SampleSupport::valid_only});
  CHECK(std::isinf(tree.unregularised));
  CHECK(std::find(tree.flags.begin(), tree.flags.end(), "cannot reach") != tree.flags.end());
  // The regularised value stays finite, and pays log(1/eps) for the share that is out of reach.
  CHECK(std::isfinite(tree.value));
  CHECK(tree.value > efficiency(target, drawn).value + 1.0);
  // With the support "free" the same tree has nothing that it cannot reach.
  settings.support = TubeSettings::Support::free;
  CHECK(std::isfinite(
      efficiency(Target(space, path_in(space), {}, settings, half, 7), valid, {.support = SampleSupport::valid_only})
          .unregularised));
}
