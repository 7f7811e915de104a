// SPDX-License-Identifier: GPL-3.0-or-later
// Divergence by the chain rule, mass and spread; what is shown where an estimate is impossible; perfect guidance.
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include <trellis/measure/efficiency.hpp>
#include <trellis/measure/statistics.hpp>

#include "support/catch.hpp"
#include "verify/measure_cases.hpp"

using namespace trellis;

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

/// A straight tube of length 8 and radius 1 across the middle of a box, which is as narrow as the tube in many
/// dimensions: else uniform samples would never lie in it.
Target straight(std::size_t dimension, std::uint64_t seed = 1) {
  const double half = dimension < most_across ? 5.0 : 1.0;
  std::vector<std::pair<double, double>> bounds = {{0, 10}};
  for (std::size_t j = 1; j < dimension; ++j) bounds.emplace_back(5.0 - half, 5.0 + half);
  const Space space = Space::euclidean(bounds);
  Configuration from(dimension, 5.0);
  Configuration to(dimension, 5.0);
  from[0] = 1.0;
  to[0] = 9.0;
  TubeSettings settings;
  settings.distance = TubeSettings::Distance::full;
  settings.delta = 1.0;
  settings.points = 1024;
  return {space, verify::path_of({from, to}), {}, settings, verify::anywhere, seed};
}

/// A share of the samples are draws of T, of these a share `early` with a first coordinate below 5; the others are
/// uniform in C.
Configurations mixture(const Target& target, std::size_t count, double in_target, double early, std::uint64_t seed) {
  Stream stream(seed, "", "mixture");
  const Configurations pool = target.draw(3 * count, stream);
  Configurations rows(target.space().dimension());
  Configuration x(target.space().dimension());
  std::size_t next = 0;
  while (rows.size() < count) {
    if (stream.uniform() >= in_target) {
      target.space().sample_uniform(stream, x);
      rows.push(x);
      continue;
    }
    const bool before = stream.uniform() < early;
    while ((pool[next][0] < 5.0) != before) ++next;
    rows.push(pool[next++]);
  }
  return rows;
}

void check_sums(const Estimate& e) {
  CAPTURE(e.estimator);
  CHECK(e.parts.mass + e.parts.spread == Approx(e.value));
  CHECK(e.unregularised_parts.mass + e.unregularised_parts.spread == Approx(e.unregularised));
}

}  // namespace

TEST_CASE("the parts of a divergence sum to it, and are those of the closed form", "[chain]") {
  const Target target = straight(2);
  const double u = target.uniform();
  // Uniform sampling: all of it is mass.
  const double uniform_density = std::exp(-target.space().log_volume());
  const Configurations anywhere = mixture(target, 2000, 0.0, 0.5, 1);
  const Efficiency blind = efficiency(target, anywhere, {.density = [&](View) { return uniform_density; }});
  CHECK(blind.estimator == "exact");
  CHECK(blind.parts.mass == Approx(u).margin(1e-6));
  CHECK(blind.parts.spread == Approx(0.0).margin(1e-6));
  CHECK(blind.unregularised_parts.mass == Approx(u).margin(1e-6));
  check_sums(blind);
  for (const Estimate& other : blind.others) check_sums(other);

  // 40 % in the target, of these 80 % in its first half: mass -log Q(A), spread log 2 - H(0.8).
  const double inside = 0.4 + 0.6 * std::exp(-u);
  const double early = (0.4 * 0.8 + 0.6 * std::exp(-u) * 0.5) / inside;
  const double spread = -0.5 * std::log(2 * early) - 0.5 * std::log(2 * (1 - early));
  const auto density = [&](View x) {
    const double share = x[0] < 5.0 ? 0.8 : 0.2;
    return 0.6 * uniform_density + (target.contains(x) ? 0.4 * 2 * share * std::exp(-target.log_volume()) : 0.0);
  };
  const Efficiency e = efficiency(target, mixture(target, 6000, 0.4, 0.8, 2), {.density = density});
  CHECK(e.unregularised_parts.mass == Approx(-std::log(inside)).margin(0.01));
  CHECK(e.unregularised_parts.spread == Approx(spread).margin(0.01));
  check_sums(e);
  CHECK(e.mass_lo < -std::log(inside));
  CHECK(e.mass_hi > -std::log(inside));
  REQUIRE_FALSE(e.others.empty());
  const Estimate& knn = e.others.back();
  CHECK(knn.unregularised_parts.mass == Approx(-std::log(inside)).margin(0.05));
  CHECK(knn.unregularised_parts.spread == Approx(spread).margin(0.06));
  // All of that spread lies along the path, nothing across it.
  CHECK(e.unregularised_parts.along == Approx(spread).margin(0.04));
  CHECK(e.unregularised_parts.across == Approx(0.0).margin(0.04));
  CHECK(e.parts.along + e.parts.across == Approx(e.parts.spread));
}

TEST_CASE("a thin guide wins mass and loses spread", "[chain]") {
  const Target target = straight(2);
  // Uniform within a quarter of the radius of the path.
  Stream stream(4, "", "thin");
  Configurations rows(2);
  for (int i = 0; i < 3000; ++i) rows.push(std::vector{stream.uniform(1, 9), stream.uniform(4.75, 5.25)});
  const Efficiency e = efficiency(target, rows);
  CHECK(e.parts.mass == Approx(e.perfect));
  CHECK(e.parts.spread > 0.5);
  CHECK(e.parts.along < 0.05);
  CHECK(e.parts.across == Approx(e.parts.spread).margin(0.06));
}

TEST_CASE("without a sample in the target all of it is mass", "[chain]") {
  const Target target = straight(2);
  Configurations rows(2);
  Stream stream(4, "", "none");
  for (int i = 0; i < 200; ++i) rows.push(std::vector{stream.uniform(0, 0.0001), stream.uniform(5.9, 6)});
  const Efficiency e = shown(efficiency(target, rows));
  REQUIRE(e.in_target == 0);
  CHECK(e.unregularised == infinity);
  CHECK(e.unregularised_parts.mass == infinity);
  CHECK(std::isnan(e.unregularised_parts.spread));
  CHECK(e.parts.mass == Approx(e.value).margin(1e-9));
  CHECK(e.mass_hi == infinity);
  CHECK(e.mass_lo == Approx(-std::log(1 - std::pow(0.025, 1.0 / 200))));
}

TEST_CASE("nothing impossible is shown", "[chain]") {
  Efficiency e;
  e.estimator = "knn";
  e.uniform = 2.0;
  e.perfect = regularised_mass(0.0, 2.0);
  e.mass = 0.5;
  e.mass_lower95 = 0.4;
  e.unregularised = -0.3;
  e.unregularised_parts = {.mass = 0.5, .spread = -0.8, .along = 0.1, .across = -0.9};
  e.value = 0.01;
  e.parts = {.mass = 0.53, .spread = -0.52, .along = 0.1, .across = -0.62};
  const Efficiency s = shown(e);
  CHECK(s.unregularised == 0.4);
  CHECK(s.value == Approx(regularised_mass(0.4, 2.0)));
  CHECK(s.above_uniform == Approx(2.0 - s.value));
  for (const ChainRule* parts : {&s.parts, &s.unregularised_parts}) {
    CHECK(parts->mass >= 0.0);
    CHECK(parts->spread >= 0.0);
    CHECK(parts->along >= 0.0);
    CHECK(parts->across >= 0.0);
    CHECK(parts->along + parts->across == Approx(parts->spread));
  }
  check_sums(s);
}

TEST_CASE("perfect guidance scores 0 and uniform sampling its own divergence, within the interval over runs",
          "[chain][slow]") {
  const Space se2 = Space::se2({0, 10}, {0, 10});
  TubeSettings settings;
  settings.points = 1024;
  const auto bent = [&](std::uint64_t seed) {
    return Target(
        se2, verify::path_of({{1, 1, 2.5}, {4, 3, -2.5}, {7, 6, 1}}), {0, 1}, settings,
        [](View x) { return x[1] < 5.0 || x[0] > 6.0; }, seed);
  };
  struct Made {
    std::string name;
    std::function<Target(std::uint64_t)> target;
  };
  const std::vector<Made> made = {{"R^2", [](std::uint64_t seed) { return straight(2, seed); }},
                                  {"SE(2)", bent},
                                  {"R^7", [](std::uint64_t seed) { return straight(7, seed); }}};
  for (const Made& one : made) {
    std::vector<double> oracle;
    std::vector<double> exact;
    std::vector<double> value;
    std::vector<double> blind;
    for (std::uint64_t run = 1; run <= 15; ++run) {
      const Target target = one.target(run);
      Stream stream(run, "", "oracle");
      const Configurations rows = target.draw(1000, stream);
      REQUIRE(rows.size() == 1000);
      for (std::size_t i = 0; i < rows.size(); ++i) REQUIRE(target.contains(rows[i]));
      const Efficiency e = efficiency(target, rows);
      oracle.push_back(e.unregularised);
      value.push_back(e.value - e.perfect);
      const auto known = [&](View x) { return target.contains(x) ? std::exp(-target.log_volume()) : 0.0; };
      exact.push_back(efficiency(target, rows, {.density = known}).unregularised);
      Configurations anywhere(target.space().dimension());
      Configuration x(target.space().dimension());
      for (int i = 0; i < 1000; ++i) {
        target.space().sample_uniform(stream, x);
        anywhere.push(x);
      }
      const Efficiency b = efficiency(target, anywhere);
      blind.push_back(b.value - b.uniform);
    }
    CAPTURE(one.name);
    // 99 %, and what estimators err by where the truth is 0 (docs/measure.md).
    constexpr double accuracy = 0.01;
    for (const auto& [what, values] : {std::pair{"D", oracle}, {"SE", value}, {"exact", exact}, {"uniform", blind}}) {
      const Interval interval = student_interval(values, 0.99);
      CAPTURE(what, interval.value, interval.lo, interval.hi);
      CHECK(interval.lo <= accuracy);
      CHECK(interval.hi >= -accuracy);
      CHECK(std::abs(interval.value) < 0.1);
    }
  }
}

TEST_CASE("from five dimensions the headline is the bound by mass and arc length", "[chain]") {
  const Target target = straight(7);
  const double u = target.uniform();
  const double inside = 0.3 + 0.7 * std::exp(-u);
  const double early = (0.3 * 0.75 + 0.7 * std::exp(-u) * 0.5) / inside;
  // T has as much before the middle as behind it, and nothing is lost across: the bound is the divergence.
  const double truth = -std::log(inside) - 0.5 * std::log(2 * early) - 0.5 * std::log(2 * (1 - early));
  double bound = 0.0;
  double knn = 0.0;
  constexpr int repetitions = 20;
  for (int r = 0; r < repetitions; ++r) {
    const Efficiency e = efficiency(target, mixture(target, 1000, 0.3, 0.75, 100 + static_cast<std::uint64_t>(r)));
    REQUIRE(e.estimator == "arc");
    CHECK(std::find(e.flags.begin(), e.flags.end(), "lower bound") != e.flags.end());
    CHECK(std::isnan(e.parts.across));
    check_sums(e);
    REQUIRE(e.others.size() == 1);
    bound += (e.unregularised - truth) * (e.unregularised - truth) / repetitions;
    knn += (e.others.front().unregularised - truth) * (e.others.front().unregularised - truth) / repetitions;
  }
  CHECK(std::sqrt(bound) < 0.08);
  CHECK(std::sqrt(knn) > 2.0 * std::sqrt(bound));

  const Efficiency asked =
      efficiency(target, mixture(target, 1000, 0.3, 0.75, 1), {.estimators = {EstimatorSpec::make("knn")}});
  CHECK(std::find(asked.flags.begin(), asked.flags.end(), "indicative") != asked.flags.end());
  // In the plane it is not asked unless by its option.
  const Target plane = straight(2);
  CHECK(efficiency(plane, mixture(plane, 500, 0.3, 0.75, 1)).estimator == "knn");
  const EstimatorSpec everywhere = EstimatorSpec::make("arc", {{"dimension", std::int64_t{2}}});
  CHECK(efficiency(plane, mixture(plane, 500, 0.3, 0.75, 1), {.estimators = {everywhere}}).estimator ==
        "arc { dimension = 2 }");
}
