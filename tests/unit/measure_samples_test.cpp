// SPDX-License-Identifier: GPL-3.0-or-later
// Sets of samples: their content, their coverage, invalid input, and invariances.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include <trellis/measure/efficiency.hpp>
#include <trellis/measure/samples.hpp>

#include "support/catch.hpp"
#include "support/fault.hpp"
#include "verify/measure_cases.hpp"

using namespace trellis;
using verify::path_of;

namespace {

constexpr double pi = std::numbers::pi;
constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();

const Space& plane() {
  static const Space space = Space::euclidean({{0, 10}, {0, 10}});
  return space;
}
const Space& se2() {
  static const Space space = Space::se2({0, 10}, {0, 10});
  return space;
}

/// The tube of radius 0.5 about the straight line from (1, 5) to (9, 5).
const Target& capsule() {
  static const Target target(plane(), path_of({{1, 5}, {9, 5}}), {0, 1}, {}, verify::anywhere, 3);
  return target;
}

/// Samples of the plane, a third of them near the capsule, denser to the left.
Configurations cloud(std::size_t n, std::uint64_t seed) {
  Stream stream(seed, "", "cloud");
  Configurations rows(2);
  for (std::size_t i = 0; i < n; ++i) {
    const double x = 10.0 * std::pow(stream.uniform(), 1.5);
    rows.push(std::vector{x, stream.uniform() < 0.3 ? stream.uniform(4.4, 5.6) : stream.uniform(0, 10)});
  }
  return rows;
}

std::vector<EstimatorSpec> all_kinds() {
  std::vector<EstimatorSpec> all;
  for (const auto& kind : measure::estimator_kinds()) {
    // By default it is asked from five dimensions on.
    const bool arc = kind.component->name == "arc";
    all.push_back(arc ? EstimatorSpec::make("arc", {{"dimension", std::int64_t{1}}})
                      : EstimatorSpec::make(kind.component->name));
  }
  return all;
}

Efficiency by(const EstimatorSpec& spec, const Target& target, const Configurations& samples, std::size_t points = 0) {
  return efficiency(target, samples,
                    {.support = SampleSupport::anything, .estimators = {spec}, .density = {}, .points = points});
}

bool flagged(const Efficiency& e, const std::string& flag) {
  return std::find(e.flags.begin(), e.flags.end(), flag) != e.flags.end();
}

/// Every figure of an efficiency in a row.
std::vector<double> figures(const Efficiency& e) {
  std::vector<double> row = {e.uniform,          e.mass,         e.mass_lower95,     e.coverage,
                             e.free_share,       e.value,        e.unregularised,    e.above_uniform,
                             e.along.divergence, e.along.length, e.along.empty_share};
  for (const auto& shares : {e.along.target, e.along.samples}) row.insert(row.end(), shares.begin(), shares.end());
  for (const Estimate& other : e.others) {
    row.insert(row.end(), {other.value, other.unregularised, other.above_uniform});
  }
  return row;
}

void check_same(const Efficiency& a, const Efficiency& b, double tolerance) {
  const auto x = figures(a);
  const auto y = figures(b);
  REQUIRE(x.size() == y.size());
  for (std::size_t i = 0; i < x.size(); ++i) {
    CAPTURE(i);
    if (std::isfinite(x[i])) {
      CHECK(x[i] == Approx(y[i]).epsilon(0).margin(tolerance));
    } else {
      CHECK((x[i] == y[i] || (std::isnan(x[i]) && std::isnan(y[i]))));
    }
  }
  CHECK(a.flags == b.flags);
  CHECK(a.in_target == b.in_target);
}

/// A figure made by hand.
Efficiency made(double value, double unregularised, std::size_t in_target) {
  Efficiency e;
  e.value = value;
  e.unregularised = unregularised;
  e.uniform = 2.5;
  e.above_uniform = 2.5 - value;
  e.samples = 100;
  e.in_target = in_target;
  return e;
}

}  // namespace

TEST_CASE("The order of the samples does not matter, to the last bit") {
  Configurations samples = cloud(400, 1);
  for (int i = 0; i < 20; ++i) samples.push(i % 2 == 0 ? std::vector{9.0, 5.0} : std::vector{1.0, 5.0});
  const Scoring scoring{.support = SampleSupport::anything,
                        .estimators = all_kinds(),
                        .density = [](View x) { return 0.01 + 1e-4 * x[0]; },
                        .points = 512};
  const Efficiency before = efficiency(capsule(), samples, scoring);
  CHECK(before.others.size() == all_kinds().size() - 1);
  Stream stream(1, "", "shuffle");
  for (std::size_t i = samples.size(); i > 1; --i) {
    const std::size_t j = stream.below(i);
    for (std::size_t axis = 0; axis < 2; ++axis) std::swap(samples[i - 1][axis], samples[j][axis]);
  }
  const Efficiency after = efficiency(capsule(), samples, scoring);
  check_same(before, after, 0.0);
}

TEST_CASE("Samples that were made ready are scored as they are, on one target after the other") {
  Configurations samples = cloud(400, 5);
  for (int i = 0; i < 3; ++i) samples.push(std::vector{9.0, 5.0});
  const Target near = capsule();
  const PreparedSamples ready(near.space(), samples);
  CHECK(ready.total() == 403);
  CHECK(ready.tree().size() == 400);
  CHECK(ready.copies() == std::vector<std::size_t>{3});
  const Target everywhere = Target::region(
      near.space(), TargetSettings{}, [](View) { return true; }, 1);
  const Scoring scoring{.estimators = all_kinds(), .density = [](View) { return 0.01; }, .points = 256};
  for (const Target* target : {&near, &everywhere, &near}) {
    check_same(efficiency(*target, ready, scoring), efficiency(*target, samples, scoring), 0.0);
  }

  Scoring brief = scoring;
  brief.brief = true;
  const Efficiency few = efficiency(near, ready, brief);
  CHECK(few.value == efficiency(near, ready, scoring).value);
  for (const Estimate& other : few.others) CHECK(other.estimator == "knn");

  const PreparedSamples elsewhere(Space::euclidean({{0, 1}, {0, 1}}), Configurations(2));
  CHECK_THROWS_AS(efficiency(near, elsewhere), Error);
}

TEST_CASE("A configuration that occurs more than once carries mass and no density, whatever the estimator") {
  const Configurations base = cloud(950, 2);
  Configurations inside = base;
  Configurations outside = base;
  for (int i = 0; i < 50; ++i) {
    inside.push(std::vector{9.0, 5.0});
    outside.push(std::vector{5.0, 9.0});
  }
  for (const EstimatorSpec& spec : all_kinds()) {
    if (spec.name() == "exact") continue;  // it has no samples
    INFO(spec.text());
    const Efficiency without = by(spec, capsule(), base, 512);
    const Efficiency with = by(spec, capsule(), inside, 512);
    const Efficiency away = by(spec, capsule(), outside, 512);
    CHECK(with.unregularised == Approx(away.unregularised).epsilon(0).margin(1e-12));
    CHECK(with.value == Approx(away.value).epsilon(0).margin(1e-12));
    // 950 of 1000 are left to the density.
    CHECK(with.unregularised - without.unregularised == Approx(-std::log(0.95)).margin(2e-4));
    CHECK(with.in_target == without.in_target + 50);
    CHECK(away.in_target == without.in_target);
    CHECK(with.mass == Approx(-std::log(static_cast<double>(without.in_target + 50) / 1000.0)));
  }
  // Twice is enough, and a third place is another atom.
  Configurations twice = base;
  for (const double x : {5.0, 5.0, 6.0, 6.0}) twice.push(std::vector{x, 5.0});
  const EstimatorSpec knn = EstimatorSpec::make("knn");
  CHECK(by(knn, capsule(), twice).unregularised - by(knn, capsule(), base).unregularised ==
        Approx(std::log(954.0 / 950.0)).epsilon(0).margin(1e-5));
}

TEST_CASE("Translation and scale change no divergence") {
  const Configurations samples = cloud(800, 3);
  Configurations twice(2);
  Configurations shifted(2);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    twice.push(std::vector{2 * samples[i][0], 2 * samples[i][1]});
    shifted.push(std::vector{samples[i][0] - 16, samples[i][1] + 32});
  }
  TubeSettings settings;
  settings.delta = 1.0;
  const Target large(Space::euclidean({{0, 20}, {0, 20}}), path_of({{2, 10}, {18, 10}}), {0, 1}, settings,
                     verify::anywhere, 3);
  const Target moved(Space::euclidean({{-16, -6}, {32, 42}}), path_of({{-15, 37}, {-7, 37}}), {0, 1}, {},
                     verify::anywhere, 3);
  const std::vector<EstimatorSpec> kinds = {EstimatorSpec::make("knn"),
                                            EstimatorSpec::make("arc", {{"dimension", std::int64_t{1}}})};
  const auto score = [](const Target& target, const Configurations& rows, const std::vector<EstimatorSpec>& specs) {
    return efficiency(target, rows,
                      {.support = SampleSupport::anything, .estimators = specs, .density = {}, .points = 512});
  };
  const Efficiency here = score(capsule(), samples, kinds);
  check_same(here, score(moved, shifted, kinds), 1e-9);
  Efficiency there = score(large, twice, kinds);
  CHECK(there.along.length == Approx(16.0));
  there.along.length *= 0.5;
  check_same(here, there, 1e-9);
}

TEST_CASE("Where a turn begins does not matter: across the wrap is as in the middle") {
  // A distribution, so that both are asked at the same points: a box of headings about 0, and about a half turn.
  Target::Distribution middle{
      Configurations(3), [](View x) {
        return std::hypot(x[0] - 5, x[1] - 5) < 2 && std::abs(x[2]) < 1 ? -std::log(4 * pi * 2 / pi) : -infinity;
      }};
  Target::Distribution across{
      Configurations(3), [](View x) {
        return std::hypot(x[0] - 5, x[1] - 5) < 2 && std::abs(x[2]) > pi - 1 ? -std::log(4 * pi * 2 / pi) : -infinity;
      }};
  const auto turned = [](View x) {
    Configuration y(x.begin(), x.end());
    y[2] += x[2] < 0 ? pi : -pi;
    return y;
  };
  Stream stream(4, "", "wrap");
  Configuration x(3);
  Configurations samples(3);
  Configurations turned_samples(3);
  while (middle.samples.size() < 1024) {
    se2().sample_uniform(stream, x);
    if (samples.size() < 450) {
      samples.push(x);
      turned_samples.push(turned(x));
    }
    x[2] = stream.uniform(-1, 1);
    if (middle.log_density(x) == -infinity) continue;
    middle.samples.push(x);
    across.samples.push(turned(x));
  }
  TargetSettings settings;
  settings.points = 512;
  const Target a = Target::distribution(se2(), settings, middle);
  const Target b = Target::distribution(se2(), settings, across);
  for (const EstimatorSpec& spec : all_kinds()) {
    INFO(spec.text());
    check_same(by(spec, a, samples), by(spec, b, turned_samples), 1e-9);
  }

  // A tube about a path that wraps around the angle, with its own evaluation points.
  TubeSettings full;
  full.distance = TubeSettings::Distance::full;
  const Target inner(se2(), path_of({{2, 5, -0.5}, {8, 5, 0.5}}), {}, full, verify::anywhere, 3);
  const Target outer(se2(), path_of({{2, 5, pi - 0.5}, {8, 5, 0.5 - pi}}), {}, full, verify::anywhere, 3);
  CHECK(outer.length() == Approx(inner.length()).epsilon(0).margin(1e-9));
  CHECK(outer.log_volume() == Approx(inner.log_volume()).margin(0.004));
  const Efficiency e = efficiency(inner, samples);
  const Efficiency f = efficiency(outer, turned_samples);
  CHECK(e.in_target == f.in_target);
  CHECK(e.value == Approx(f.value).margin(0.03));
  CHECK(e.along.divergence == Approx(f.along.divergence).margin(0.02));
}

TEST_CASE("Coverage is the share of the target near a sample, by brute force") {
  TubeSettings settings;
  settings.distance = TubeSettings::Distance::full;
  settings.points = 400;
  settings.pool = 1024;
  const Target target(se2(), path_of({{1, 1, 2.5}, {4, 3, -2.5}, {7, 6, 1}}), {}, settings, verify::anywhere, 5);
  Stream stream(6, "", "coverage");
  Configurations samples(3);
  Configuration x(3);
  for (int i = 0; i < 500; ++i) {
    se2().sample_uniform(stream, x);
    if (i % 3 == 0) {
      const View p = target.pool()[stream.below(target.pool().size())];
      std::copy(p.begin(), p.end(), x.begin());
    }
    samples.push(x);
    if (i % 50 == 0) samples.push(x);
  }
  double whole = 0.0;
  for (std::size_t i = 0; i < 400; ++i) {
    double nearest = infinity;
    for (std::size_t j = 0; j < samples.size(); ++j) {
      nearest = std::min(nearest, se2().distance(target.pool()[i], samples[j]));
    }
    whole += nearest <= 0.5 ? 1.0 / 400 : 0.0;
  }
  const Efficiency e = efficiency(target, samples);
  CHECK(e.coverage == Approx(whole).epsilon(0).margin(1e-9));
}

TEST_CASE("Along the path the samples are counted in bins of equal length") {
  // 8 m by 0.5 m allow for 16 bins, 400 samples for 80.
  const Configurations samples = cloud(1200, 7);
  const Efficiency e = efficiency(capsule(), samples);
  const Along& along = e.along;
  CHECK(along.length == Approx(8.0));
  REQUIRE(along.target.size() == 16);
  REQUIRE(along.samples.size() == 16);
  std::vector<double> target(16);
  std::vector<double> counts(16);
  const auto bin = [](View x) { return static_cast<std::size_t>(std::clamp((x[0] - 1.0) / 0.5, 0.0, 15.0)); };
  const std::size_t points = capsule().evaluation_points();
  for (std::size_t i = 0; i < points; ++i) target[bin(capsule().pool()[i])] += 1.0 / static_cast<double>(points);
  double n = 0.0;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (!capsule().contains(samples[i])) continue;
    counts[bin(samples[i])] += 1.0;
    n += 1.0;
  }
  REQUIRE(n == static_cast<double>(e.in_target));
  double divergence = 0.0;
  double sum = 0.0;
  for (std::size_t j = 0; j < 16; ++j) {
    CAPTURE(j);
    CHECK(along.target[j] == Approx(target[j]).epsilon(0).margin(1e-3));  // points on the border of two bins
    CHECK(along.samples[j] == Approx(counts[j] / n).epsilon(0).margin(1e-9));
    divergence += target[j] * std::log(target[j] / ((counts[j] + 0.5) / (n + 8)));
    sum += along.samples[j];
  }
  CHECK(sum == Approx(1.0));
  CHECK(along.divergence == Approx(divergence).epsilon(0).margin(1e-3));
  CHECK(along.divergence > 0.05);
  CHECK(along.empty_share == 0.0);
}

TEST_CASE("Half of the path without a sample shows along it") {
  Stream stream(8, "", "half");
  Configurations both(2);
  Configurations left(2);
  for (int i = 0; i < 2000; ++i) {
    both.push(std::vector{stream.uniform(1, 9), stream.uniform(4.5, 5.5)});
    left.push(std::vector{stream.uniform(1, 5), stream.uniform(4.5, 5.5)});
  }
  const Efficiency whole = efficiency(capsule(), both);
  CHECK(whole.along.divergence == Approx(0.0).margin(0.02));
  CHECK(whole.along.empty_share == 0.0);
  const Efficiency half = efficiency(capsule(), left);
  CHECK(half.along.empty_share == Approx(0.5).margin(0.005));
  CHECK(half.along.divergence > 1.5);
  CHECK(flagged(half, "partial"));
  CHECK_FALSE(flagged(half, "censored"));
  for (std::size_t j = 8; j < 16; ++j) CHECK(half.along.samples.at(j) == 0.0);

  // Ten samples make two bins, four none, and without any all of it is empty.
  const auto first = [&](std::size_t n, double y) {
    Configurations rows(2);
    for (std::size_t i = 0; i < n; ++i) rows.push(std::vector{both[i][0], both[i][1] + y});
    return efficiency(capsule(), rows).along;
  };
  CHECK(first(10, 0).target.size() == 2);
  CHECK(first(10, 0).target.front() == Approx(0.5).margin(0.001));
  CHECK(first(4, 0).target.empty());
  CHECK(std::isnan(first(4, 0).divergence));
  CHECK(std::isnan(first(4, 0).empty_share));
  CHECK(first(10, 2).empty_share == 1.0);
  CHECK(std::isnan(first(10, 2).divergence));
}

TEST_CASE("The bound by the mass in the target is Clopper and Pearson's") {
  const auto bound = [](std::size_t inside, std::size_t total) {
    Stream stream(9, "", "bound");
    Configurations rows(2);
    for (std::size_t i = 0; i < total; ++i) {
      rows.push(std::vector{stream.uniform(1, 9), i < inside ? stream.uniform(4.5, 5.5) : stream.uniform(6, 9)});
    }
    const Efficiency e = efficiency(capsule(), rows);
    CHECK(e.in_target == inside);
    CHECK(e.mass == -std::log(static_cast<double>(inside) / static_cast<double>(total)));
    return std::exp(-e.mass_lower95);
  };
  // No hit: 1 - 0.05^(1/N), about 3 / N.
  for (const std::size_t n : {20U, 59U, 300U, 1000U}) {
    CHECK(bound(0, n) == Approx(1 - std::pow(0.05, 1.0 / static_cast<double>(n))).epsilon(1e-9));
  }
  CHECK(bound(0, 300) == Approx(3.0 / 300).epsilon(0.01));
  // As R's qbeta(0.95, n + 1, N - n) has them.
  CHECK(bound(1, 20) == Approx(0.216106164206847).epsilon(1e-9));
  CHECK(bound(7, 50) == Approx(0.246935201731209).epsilon(1e-9));
  CHECK(bound(30, 1000) == Approx(0.0404722372808662).epsilon(1e-9));
  CHECK(bound(199, 200) == Approx(0.999743566412777).epsilon(1e-9));
  // All of them: no more than all.
  CHECK(bound(50, 50) == 1.0);
}

TEST_CASE("Results of too few samples are flagged") {
  // As many uniform samples would put 10 into the capsule at N = 114.
  const double needed = 10.0 * std::exp(capsule().uniform());
  CHECK(needed == Approx(10 * 100 / (8 + pi / 4)).epsilon(0.01));
  CHECK(flagged(efficiency(capsule(), cloud(static_cast<std::size_t>(needed) - 1, 1)), "underpowered"));
  CHECK_FALSE(flagged(efficiency(capsule(), cloud(static_cast<std::size_t>(needed) + 1, 1)), "underpowered"));

  // Fewer neighbours than k: a reason, and no figure but those that hold whatever the samples are.
  const Configurations eleven = cloud(11, 1);
  for (const std::int64_t k : {11, 12, 40}) {
    const Efficiency e = by(EstimatorSpec::make("knn", {{"k", k}}), capsule(), eleven);
    CAPTURE(k, e.reason);
    CHECK(std::isnan(e.value) == (k > 11));
    CHECK(std::isnan(e.unregularised) == (k > 11));
    CHECK(std::isnan(e.above_uniform) == (k > 11));
    CHECK(flagged(e, "too few samples") == (k > 11));
    CHECK_FALSE(std::isnan(e.coverage));
    CHECK_FALSE(std::isnan(e.mass_lower95));
    if (k > 11) CHECK(e.reason == "too few samples: 11 that occur once, k = " + std::to_string(k) + " are needed");
  }

  // All the same: no estimator of a density has a number.
  Configurations equal(2);
  for (int i = 0; i < 100; ++i) equal.push(std::vector{5.0, 5.0});
  {
    const Efficiency e = by(EstimatorSpec::make("knn"), capsule(), equal);
    CAPTURE(e.reason);
    CHECK(std::isnan(e.value));
    CHECK(std::isnan(e.unregularised));
    CHECK_FALSE(e.reason.empty());
    CHECK(flagged(e, "too few samples"));
    CHECK(e.mass == 0.0);
  }
  Configurations one(2);
  one.push(std::vector{5.0, 5.0});
  CHECK(std::isnan(by(EstimatorSpec::make("knn"), capsule(), one).value));

  // A figure below its bound is called wrong: a recorded density that the samples contradict makes one.
  Configurations rows(2);
  for (int i = 0; i < 400; ++i) rows.push(std::vector{4 + 0.01 * i, i < 2 ? 5.0 : 8.0});
  const Efficiency coarse = efficiency(capsule(), rows,
                                       {.estimators = {EstimatorSpec::make("exact")},
                                        .density = [](View) { return std::exp(-capsule().log_volume()); }});
  CHECK(coarse.unregularised < coarse.mass_lower95);
  CHECK(flagged(coarse, "below mass bound"));
}

TEST_CASE("Input that makes no figure is refused with what is wrong and what was expected") {
  Configurations bad = cloud(5, 1);
  bad.push(std::vector{1.0, not_a_number});
  CHECK(test::fault_of([&] { efficiency(capsule(), bad); }) == "measure: sample 6 has a coordinate that is not finite");
  Configurations endless(2);
  endless.push(std::vector{-infinity, 1.0});
  CHECK(test::fault_of([&] { efficiency(capsule(), endless); }) ==
        "measure: sample 1 has a coordinate that is not finite");
  Configurations flat(3);
  flat.push(std::vector{1.0, 2.0, 3.0});
  CHECK(test::fault_of([&] { efficiency(capsule(), flat); }) ==
        "measure: the samples have 3 coordinates, the target's space R^2 has 2");

  const auto tube = [&](const Configurations& path, double delta) {
    return test::fault_of([&] {
      TubeSettings settings;
      settings.delta = delta;
      Target(plane(), path, {0, 1}, settings, verify::anywhere, 1);
    });
  };
  const Configurations path = path_of({{1, 5}, {9, 5}});
  CHECK(tube(path, 0.0) == "tube: delta must be greater than 0, in m, got 0");
  CHECK(tube(path, -1.5) == "tube: delta must be greater than 0, in m, got -1.5");
  CHECK_THAT(tube(path, not_a_number), Catch::Contains("delta must be greater than 0, in m, got nan"));
  CHECK(tube(path_of({{1, 5}}), 0.5) == "tube: the path is a single configuration; a tube needs two at least");
  CHECK(tube(path_of({{1, 5}, {1, 5}, {1, 5}}), 0.5) == "tube: the path has no length");
  CHECK(tube(Configurations(2), 0.5) == "tube: the path is empty");
  CHECK(tube(path_of({{1, 5, 0}, {2, 5, 0}}), 0.5) == "tube: the path has 3 coordinates, the space R^2 has 2");
  CHECK(tube(path_of({{1, 5}, {11, 5}, {2, 2}}), 0.5) == "tube: waypoint 2 of the path lies outside of the space R^2");
  CHECK(tube(path_of({{1, 5}, {2, not_a_number}}), 0.5) == "tube: waypoint 2 of the path is not finite");
  CHECK_THAT(test::fault_of([&] { Target(plane(), path, {0, 1}, {}, {}, 1); }), Catch::Contains("needs a validity"));

  // A tube without a valid configuration has a reason and no number.
  const Target invalid(
      plane(), path, {0, 1}, {}, [](View) { return false; }, 1);
  for (const EstimatorSpec& spec : all_kinds()) {
    const Efficiency e = by(spec, invalid, cloud(100, 1));
    CHECK(e.reason == "the target is empty: no valid configuration lies in it");
    for (const double figure : {e.value, e.unregularised, e.above_uniform, e.mass, e.uniform, e.coverage}) {
      CHECK(std::isnan(figure));
    }
  }
}

TEST_CASE("A target given by a distribution is checked draw by draw") {
  Target::Distribution good{Configurations(2), [](View) { return -std::log(100.0); }};
  Stream stream(10, "", "draws");
  for (int i = 0; i < 64; ++i) good.samples.push(std::vector{stream.uniform(0, 10), stream.uniform(0, 10)});
  const auto refusal = [](const Target::Distribution& given, double delta = 0.5) {
    return test::fault_of([&] {
      TargetSettings settings;
      settings.delta = delta;
      Target::distribution(plane(), settings, given);
    });
  };
  CHECK(refusal(good).empty());
  CHECK_THAT(refusal(good, 0.0), Catch::Contains("delta must be greater than 0"));

  auto few = good;
  few.samples = Configurations(2);
  for (int i = 0; i < 63; ++i) few.samples.push(good.samples[0]);
  CHECK(refusal(few) == "target: 63 draws; at least 64 are needed");
  auto outside = good;
  outside.samples[2][1] = 10.5;
  CHECK(refusal(outside) == "target: draw 3 lies outside of the space R^2");
  auto unknown = good;
  unknown.samples[4][0] = not_a_number;
  CHECK_THAT(refusal(unknown), Catch::Contains("draw 5"));
  auto flat = good;
  flat.samples = Configurations(1);
  for (int i = 0; i < 64; ++i) flat.samples.push(std::vector{1.0});
  CHECK(refusal(flat) == "target: the draws have 1 coordinates, the space R^2 has 2");
  for (const double wrong : {not_a_number, infinity, -infinity}) {
    auto density = good;
    density.log_density = [wrong](View) { return wrong; };
    CHECK_THAT(refusal(density), Catch::Contains("at draw 1, expected a finite number"));
  }
  CHECK_THAT(test::fault_of([] {
               TargetSettings settings;
               settings.delta = -1.0;
               Target::region(plane(), settings, verify::anywhere, 1);
             }),
             Catch::Contains("region: delta must be greater than 0, in m, got -1"));
}

TEST_CASE("Figures of several targets are averaged over those that have them, and infinity stays infinite") {
  Efficiency a = made(1.0, 1.2, 20);
  Efficiency b = made(2.0, infinity, 0);
  Efficiency c;
  c.samples = 100;
  c.reason = "the target is empty";
  a.flags = {"underpowered"};
  b.flags = {"censored", "underpowered"};
  c.flags = {"empty target", "underpowered"};
  a.others = {Estimate{.estimator = "arc", .value = 1.5, .unregularised = 3.0}};
  b.others = {Estimate{.estimator = "arc", .value = 2.5, .unregularised = 4.0},
              Estimate{.estimator = "knn", .value = 40.0, .unregularised = 40.0}};
  const std::vector<Efficiency> all = {c, a, b};
  const Efficiency m = mean(all);
  CHECK(m.value == 1.5);
  CHECK(m.unregularised == infinity);
  CHECK(m.above_uniform == 1.0);
  CHECK(m.uniform == 2.5);
  CHECK(m.samples == 100);
  CHECK(m.in_target == 7);
  CHECK(m.reason.empty());
  // Flags that half of them raised at least.
  CHECK(m.flags == std::vector<std::string>{"underpowered"});
  REQUIRE_FALSE(m.others.empty());
  CHECK(m.others.front().estimator == "arc");
  CHECK(m.others.front().value == 2.0);
  CHECK(m.others.front().unregularised == 3.5);

  const std::vector<Efficiency> finite = {a, made(2.0, 2.2, 40)};
  CHECK(mean(finite).unregularised == Approx(1.7));
  CHECK(mean(finite).in_target == 30);
  CHECK(mean(finite).flags == std::vector<std::string>{"underpowered"});

  const std::vector<Efficiency> absent = {c, c};
  CHECK(std::isnan(mean(absent).value));
  CHECK(mean(absent).reason == "the target is empty");
  CHECK_FALSE(mean(std::vector<Efficiency>{}).reason.empty());
  const std::vector<Efficiency> single = {a};
  CHECK(mean(single).value == a.value);
  CHECK(mean(single).unregularised == a.unregularised);
}

TEST_CASE("Profiles of several targets are averaged over the least number of bins, shares kept") {
  Efficiency a = made(1.0, 1.0, 10);
  Efficiency b = made(1.0, 1.0, 10);
  Efficiency none = made(1.0, 1.0, 0);
  a.along.target = {0.25, 0.25, 0.25, 0.25};
  a.along.samples = {0.5, 0.5, 0.0, 0.0};
  a.along.divergence = 0.4;
  a.along.empty_share = 0.5;
  a.along.length = 4;
  b.along.target = {0.2, 0.3, 0.5};
  b.along.samples = {0.0, 0.3, 0.7};
  b.along.divergence = 0.6;
  b.along.empty_share = 0.2;
  b.along.length = 6;
  none.along.empty_share = 1.0;
  const std::vector<Efficiency> all = {a, none, b};
  const Along m = mean(all).along;
  CHECK(m.divergence == Approx(0.5));
  CHECK(m.empty_share == Approx(1.7 / 3));
  CHECK(m.length == Approx(5.0));
  REQUIRE(m.target.size() == 3);
  REQUIRE(m.samples.size() == 3);
  // Four bins over three: a third of the second goes to the first.
  CHECK(m.samples[0] == Approx(0.5 * (0.5 + 0.5 / 3)));
  CHECK(m.samples[1] == Approx(0.5 * (0.5 * 2 / 3 + 0.3)));
  CHECK(m.samples[2] == Approx(0.5 * 0.7));
  CHECK(m.target[0] + m.target[1] + m.target[2] == Approx(1.0));
}
