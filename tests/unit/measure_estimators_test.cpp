// SPDX-License-Identifier: GPL-3.0-or-later
// Each estimator against known truth, and against the same formula written down a second time.
#include <algorithm>
#include <boost/math/special_functions/digamma.hpp>
#include <boost/math/special_functions/erf.hpp>
#include <boost/math/special_functions/gamma.hpp>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include <trellis/measure/efficiency.hpp>
#include <trellis/measure/low_discrepancy.hpp>

#include "support/catch.hpp"
#include "verify/measure_cases.hpp"

using namespace trellis;
using verify::Case;

namespace {

constexpr double pi = std::numbers::pi;
constexpr double infinity = std::numeric_limits<double>::infinity();

/// A figure of one estimator alone.
Efficiency by(const EstimatorSpec& spec, const Target& target, const Configurations& samples, std::size_t points = 0,
              const std::function<double(View)>& density = {}) {
  return efficiency(target, samples,
                    {.support = SampleSupport::anything, .estimators = {spec}, .density = density, .points = points});
}

EstimatorSpec knn_plain(std::int64_t k, bool boundary) {
  return EstimatorSpec::make("knn", {{"k", k}, {"k_all", k}, {"blend", false}, {"boundary", boundary}});
}
bool flagged(const Efficiency& e, const std::string& flag) {
  return std::find(e.flags.begin(), e.flags.end(), flag) != e.flags.end();
}

/// A bent tube in the plane or in SE(2), and samples that crowd towards one corner.
Target bent(const Space& space) {
  std::vector<Configuration> points = {{1, 1, 2.5}, {4, 3, -2.5}, {7, 6, 1}};
  for (auto& p : points) p.resize(space.dimension());
  TubeSettings settings;
  settings.distance = space.dimension() == 2 ? TubeSettings::Distance::planar : TubeSettings::Distance::full;
  settings.delta = 0.8;
  settings.points = 300;
  settings.pool = 4096;
  return {space, verify::path_of(points), {0, 1}, settings, verify::anywhere, 5};
}
Configurations crowded(const Space& space, std::size_t n, std::uint64_t seed) {
  Stream stream(seed, space.name(), "crowded");
  Configurations rows(space.dimension());
  Configuration x(space.dimension());
  for (std::size_t i = 0; i < n; ++i) {
    space.sample_uniform(stream, x);
    x[0] = 10.0 * std::pow(0.1 * x[0], 1.5);
    rows.push(x);
  }
  return rows;
}
const std::vector<Space>& spaces() {
  static const std::vector<Space> all = {Space::euclidean({{0, 10}, {0, 10}}), Space::se2({0, 10}, {0, 10})};
  return all;
}

/// The figures that the definitions give for log q at the evaluation points.
struct Figures {
  double value = 0.0;
  double unregularised = 0.0;
};
Figures figures_of(const Target& target, std::size_t points, const std::function<double(View)>& log_density) {
  Figures f;
  const double log_u = -target.space().log_volume();
  for (std::size_t i = 0; i < points; ++i) {
    const double log_q = log_density(target.pool()[i]);
    const double log_t = target.log_density(i);
    const double mixed = std::log(0.95 * std::exp(log_q) + 0.05 * std::exp(log_u));
    f.unregularised += (log_t - log_q) / static_cast<double>(points);
    f.value += (log_t - mixed) / static_cast<double>(points);
  }
  return f;
}

void check_same(const Efficiency& e, const Figures& expected, double tolerance = 1e-9) {
  CHECK(e.value == Approx(expected.value).epsilon(0).margin(tolerance));
  CHECK(e.unregularised == Approx(expected.unregularised).epsilon(0).margin(tolerance));
}

/// A Gaussian in a large square, as a target, its draws from a low-discrepancy sequence.
Target bell(const Space& space, double sd) {
  const auto log_density = [sd](View x) {
    return -0.5 * (x[0] * x[0] + x[1] * x[1]) / (sd * sd) - std::log(2 * pi * sd * sd);
  };
  Target::Distribution distribution{Configurations(2), log_density};
  measure::LowDiscrepancy sequence(2, {0.37, 0.61});
  std::vector<double> u(2);
  for (int i = 0; i < 8192; ++i) {
    sequence.next(u);
    const double r = sd * std::sqrt(-2 * std::log1p(-u[0]));
    distribution.samples.push(std::vector{r * std::cos(2 * pi * u[1]), r * std::sin(2 * pi * u[1])});
  }
  TargetSettings settings;
  settings.points = 8192;
  return Target::distribution(space, settings, distribution);
}

}  // namespace

TEST_CASE("Plain nearest neighbours are the textbook's formula") {
  for (const Space& space : spaces()) {
    const Target target = bent(space);
    const Configurations samples = crowded(space, 700, 1);
    for (const std::int64_t k : {1, 3, 8, 20}) {
      INFO(space.name() << ", k = " << k);
      const auto d = static_cast<double>(space.dimension());
      const auto log_q = [&](View x) {
        std::vector<double> distances;
        for (std::size_t i = 0; i < samples.size(); ++i) distances.push_back(space.distance(x, samples[i]));
        std::sort(distances.begin(), distances.end());
        return boost::math::digamma(static_cast<double>(k)) - boost::math::digamma(701.0) -
               log_unit_ball(space.dimension()) - d * std::log(distances[static_cast<std::size_t>(k - 1)]);
      };
      check_same(by(knn_plain(k, false), target, samples), figures_of(target, 300, log_q));
    }
  }
}

TEST_CASE("Blended nearest neighbours are the formula of the specification, balls measured on a fine grid") {
  const Space& space = spaces()[0];
  const Target target = bent(space);
  const Configurations samples = crowded(space, 700, 2);
  std::vector<std::size_t> inside;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (target.contains(samples[i])) inside.push_back(i);
  }
  const double share = static_cast<double>(inside.size()) / 700.0;
  const auto kth = [&](View x, bool all, std::size_t k) {
    std::vector<double> distances;
    for (std::size_t i = 0; i < samples.size(); ++i) {
      if (all || std::find(inside.begin(), inside.end(), i) != inside.end()) {
        distances.push_back(space.distance(x, samples[i]));
      }
    }
    std::sort(distances.begin(), distances.end());
    return distances[k - 1];
  };
  const auto volume = [](View x, double r, const std::function<bool(View)>& counts) {
    constexpr int n = 60;
    double found = 0.0;
    for (int i = 0; i < n; ++i) {
      for (int j = 0; j < n; ++j) {
        const double u = (2.0 * i + 1.0) / n - 1.0;
        const double v = (2.0 * j + 1.0) / n - 1.0;
        if (u * u + v * v <= 1.0 && counts(std::vector{x[0] + r * u, x[1] + r * v})) found += 1.0;
      }
    }
    return found * 4 * r * r / (n * n);
  };
  const double log_n = boost::math::digamma(701.0);
  const std::size_t points = 60;
  const auto log_q = [&](View x) {
    const double r = kth(x, true, 8);
    const double in_space = volume(x, r, [&](View y) { return space.contains(y); });
    const double in_r = kth(x, false, 3);
    const double in_target = volume(x, in_r, [&](View y) { return target.contains(y); });
    const double plain = boost::math::digamma(8.0) - log_n - std::log(in_space);
    const double tube = boost::math::digamma(3.0) - log_n - std::log(in_target);
    return share * tube + (1 - share) * plain;
  };
  check_same(by(EstimatorSpec::make("knn"), target, samples, points), figures_of(target, points, log_q), 0.02);
}

TEST_CASE("Mass and divergence of a product of 96 dimensions are those of its closed form") {
  constexpr std::size_t d = 96;
  constexpr double n = d - 1;  // dimensions across the path
  const Space space("many", std::vector<Axis>(d, Axis{"x", 0.0, 10.0, 1.0, false}));
  Configuration from(d, 5.0), to(d, 5.0);
  from[0] = 2.0;
  to[0] = 8.0;
  Configurations path(d);
  path.push(from);
  path.push(to);
  TubeSettings settings;
  settings.distance = TubeSettings::Distance::full;
  settings.delta = 1.0;
  settings.pool = settings.points = 4096;
  const Target target(
      space, path, {}, settings, [](View) { return true; }, 1);
  // Uniform along the path, normal across it.
  const double variance = 0.25;
  const auto density = [&](View x) {
    double squares = 0.0;
    for (std::size_t j = 1; j < d; ++j) squares += (x[j] - 5.0) * (x[j] - 5.0);
    return 0.1 * std::exp(-0.5 * squares / variance - 0.5 * n * std::log(2.0 * std::numbers::pi * variance));
  };
  // No sample lies in the target, so that counting says nothing.
  Configurations outside(d);
  for (int i = 0; i < 8; ++i) outside.push(Configuration(d, 1.0));
  const Efficiency e = by(EstimatorSpec::make("exact"), target, outside, 0, density);
  // The volumes of the cylinder and of the two half balls at its ends, and the means of the squared distance there.
  const auto log_ball = [](double k) { return 0.5 * k * std::log(std::numbers::pi) - std::lgamma(0.5 * k + 1.0); };
  const double cylinder = 6.0 * std::exp(log_ball(n) - log_ball(n + 1));
  const double log_volume = log_ball(n + 1) + std::log(cylinder + 1.0);
  const double squares = (cylinder * n / (n + 2.0) + n / (n + 3.0)) / (cylinder + 1.0);
  const double divergence =
      -log_volume - std::log(0.1) + 0.5 * squares / variance + 0.5 * n * std::log(2.0 * std::numbers::pi * variance);
  CHECK(e.unregularised == Approx(divergence).epsilon(0).margin(0.06));
  // The mass of the capsule: a chi-square probability, over the cylinder and at each distance beyond its ends.
  const auto within = [&](double square) { return boost::math::gamma_p(0.5 * n, 0.5 * square / variance); };
  double ends = 0.0;
  constexpr int steps = 2000;
  for (int i = 0; i < steps; ++i) {
    const double t = (i + 0.5) / steps;
    ends += within(1.0 - t * t) / steps;
  }
  const double mass = -std::log(0.6 * within(1.0) + 0.2 * ends);
  CHECK(e.unregularised_parts.mass == Approx(mass).epsilon(0).margin(0.06));
  // Uniform samples: the share of the capsule in the space.
  const double log_space = static_cast<double>(d) * std::log(10.0);
  const Efficiency uniform =
      by(EstimatorSpec::make("exact"), target, outside, 0, [&](View) { return std::exp(-log_space); });
  CHECK(uniform.unregularised == Approx(log_space - log_volume).epsilon(0).margin(0.06));
  CHECK(uniform.above_uniform == Approx(0.0).epsilon(0).margin(1e-9));
}

TEST_CASE("Known densities are integrated, not estimated", "[slow]") {
  const auto cases = verify::closed_cases();
  const auto& capsule = *cases.front().target;
  const double log_c = std::log(100.0);
  const double log_a = std::log(8 + 0.25 * pi);
  const EstimatorSpec exact = EstimatorSpec::make("exact");
  Configurations any(2);
  for (int i = 0; i < 50; ++i) any.push(std::vector{5.0, 0.2 * i});

  SECTION("uniform on the space, with an atom") {
    const Efficiency e = by(exact, capsule, any, 0, [](View) { return 0.9 / 100.0; });
    CHECK(e.estimator == "exact");
    CHECK(e.unregularised == Approx(log_c - log_a - std::log(0.9)).margin(0.005));
    CHECK(e.unregularised - e.uniform == Approx(-std::log(0.9)).epsilon(0).margin(1e-9));
    CHECK(e.above_uniform == Approx(std::log(0.95 * 0.9 + 0.05)).epsilon(0).margin(1e-9));
  }
  SECTION("the target itself") {
    const Efficiency e = by(exact, capsule, any, 0, [&](View) { return std::exp(-capsule.log_volume()); });
    CHECK(e.unregularised == Approx(0.0).epsilon(0).margin(1e-9));
    CHECK(e.value == Approx(verify::constant_regularised(log_a, log_c, std::exp(-log_a))).margin(0.005));
  }
  SECTION("nothing in the target") {
    const Efficiency e = by(exact, capsule, any, 0, [](View) { return 0.0; });
    CHECK(e.unregularised == infinity);
    CHECK(e.value == Approx(std::log(20.0) + e.uniform).epsilon(0).margin(1e-9));
    CHECK(e.above_uniform == Approx(-std::log(20.0)).epsilon(0).margin(1e-9));
  }
  SECTION("tree-like, against a fine integral") {
    for (const std::size_t d : {2U, 3U}) {
      for (const Case& c : verify::standard_cases(d)) {
        if (!c.name.starts_with("tree-like")) continue;
        const verify::TreeLike tree(c.target->space());
        Configurations some(d);
        some.push(c.target->pool()[0]);
        const Efficiency e = by(exact, *c.target, some, 0, [&](View x) { return tree.density(x); });
        INFO(c.name);
        CHECK(e.unregularised == Approx(c.d).margin(0.01));
        CHECK(e.value == Approx(c.d_regularised).margin(0.01));
      }
    }
  }
  SECTION("unknown") {
    const Efficiency e = by(exact, capsule, any);
    CHECK(std::isnan(e.value));
    CHECK_FALSE(e.reason.empty());
    // The next one that has a figure gives the headline.
    const Efficiency by_default = efficiency(capsule, any);
    CHECK(by_default.estimator == "knn");
    CHECK(by_default.others.empty());
    const Efficiency both = efficiency(capsule, any, {.density = [](View) { return 0.01; }});
    CHECK(both.estimator == "exact");
    REQUIRE(both.others.size() == 1);
    CHECK(both.others.front().estimator == "knn");
    CHECK(both.others.front().value == by_default.value);
  }
}

TEST_CASE("A Gaussian target has the divergences of the closed form") {
  const Space space = Space::euclidean({{-10, 10}, {-10, 10}});
  const double s0 = 0.8;
  const double s1 = 1.5;
  const double shift = 1.0;
  const Target target = bell(space, s0);
  CHECK_FALSE(target.is_uniform());
  CHECK(std::isnan(target.log_volume()));
  CHECK_FALSE(target.has_path());
  // log|C| less the entropy.
  CHECK(target.uniform() == Approx(std::log(400.0) - std::log(2 * pi * std::numbers::e * s0 * s0)).margin(0.005));

  const double truth = 2 * std::log(s1 / s0) + (2 * s0 * s0 + shift * shift) / (2 * s1 * s1) - 1;
  const auto density = [&](View x) {
    const double square = (x[0] - shift) * (x[0] - shift) + x[1] * x[1];
    return std::exp(-0.5 * square / (s1 * s1)) / (2 * pi * s1 * s1);
  };
  Stream stream(3, "", "test");
  Configurations samples(2);
  for (int i = 0; i < 1500; ++i) samples.push(std::vector{shift + s1 * stream.normal(), s1 * stream.normal()});
  const Efficiency e = efficiency(target, samples, {.density = density});
  CHECK(e.estimator == "exact");
  CHECK(e.unregularised == Approx(truth).margin(0.01));
  REQUIRE(e.others.size() == 1);
  CHECK(e.others.front().unregularised == Approx(truth).margin(0.08));
  CHECK(e.in_target == 1500);
  CHECK(e.mass == 0.0);
  CHECK(std::isnan(e.along.divergence));
  CHECK(e.along.target.empty());

  const Efficiency itself =
      efficiency(target, target.pool(), {.density = [&](View x) {
                   return std::exp(-0.5 * (x[0] * x[0] + x[1] * x[1]) / (s0 * s0)) / (2 * pi * s0 * s0);
                 }});
  CHECK(itself.unregularised == Approx(0.0).epsilon(0).margin(1e-9));

  const Efficiency no_path = by(EstimatorSpec::make("arc"), target, samples);
  CHECK(std::isnan(no_path.value));
  CHECK(no_path.reason == "the target has no path");
}

TEST_CASE("A target given by its region has the region's volume") {
  const Space space = Space::se2({0, 10}, {0, 10});
  TargetSettings settings;
  settings.delta = 0.3;
  settings.points = 1024;
  // A disc of radius 2 and a quarter of all headings.
  const auto disc = [](View x) { return std::hypot(x[0] - 4, x[1] - 6) < 2 && x[2] >= 0 && x[2] < 0.5 * pi; };
  const Target target = Target::region(space, settings, disc, 1);
  CHECK(std::exp(target.log_volume()) == Approx(4 * pi * 0.5).epsilon(0.01));
  CHECK(target.uniform() == Approx(std::log(200.0 / (2 * pi))).margin(0.01));
  CHECK(target.evaluation_points() == 1024);
  CHECK_FALSE(target.has_path());
  std::size_t outside = 0;
  for (std::size_t i = 0; i < target.pool().size(); ++i) outside += disc(target.pool()[i]) ? 0 : 1;
  CHECK(outside == 0);
  CHECK(target.contains(std::vector{4.0, 6.0, 1.0}));
  CHECK_FALSE(target.contains(std::vector{4.0, 6.0, -1.0}));
  CHECK_FALSE(target.contains(std::vector{4.0, 11.0, 1.0}));

  Configurations everywhere(3);
  Configurations within(3);
  Stream stream(1, "", "test");
  Configuration x(3);
  while (everywhere.size() < 4000 || within.size() < 1000) {
    space.sample_uniform(stream, x);
    if (everywhere.size() < 4000) everywhere.push(x);
    if (within.size() < 1000 && disc(x)) within.push(x);
  }
  CHECK(efficiency(target, everywhere).unregularised == Approx(target.uniform()).margin(0.15));
  CHECK(efficiency(target, within).unregularised == Approx(0.0).margin(0.1));

  const Target nowhere = Target::region(
      space, settings, [](View) { return false; }, 1);
  CHECK(nowhere.empty());
  const Efficiency none = efficiency(nowhere, within);
  CHECK(std::isnan(none.value));
  CHECK_THAT(none.reason, Catch::Contains("the target is empty"));
}

TEST_CASE("Projection loses divergence, and by as much as the coordinate that it drops") {
  const Space se2 = Space::se2({0, 10}, {0, 10});
  const Space plane = Space::euclidean({{0, 10}, {0, 10}});
  const Target whole(se2, verify::path_of({{1, 1, 0}, {7, 6, 1}}), {0, 1}, {}, verify::anywhere, 5);
  const Target shadow(plane, verify::path_of({{1, 1}, {7, 6}}), {0, 1}, {}, verify::anywhere, 5);
  // x falls off to the right, headings crowd about 0 as 1 + 0.8 cos.
  const auto of_x = [](View x) { return (1.5 - 0.1 * x[0]) / 100.0; };
  const auto of_heading = [](double theta) { return 0.5 * (1 + 0.8 * std::cos(theta)); };  // per metre of the metric
  const double lost = -std::log(0.5 * (1 + std::sqrt(1 - 0.64)));                          // mean of -log(1 + 0.8 cos)
  const EstimatorSpec exact = EstimatorSpec::make("exact");

  Stream stream(8, "", "test");
  Configurations samples(3);
  Configurations projected(2);
  Configuration x(3);
  while (samples.size() < 3000) {
    se2.sample_uniform(stream, x);
    if (stream.uniform() * 1.5 > 1.5 - 0.1 * x[0] || stream.uniform() * 0.9 > of_heading(x[2])) continue;
    samples.push(x);
    projected.push(View(x).first(2));
  }
  const double full = by(exact, whole, samples, 0, [&](View q) { return of_x(q) * of_heading(q[2]); }).unregularised;
  const double flat = by(exact, shadow, projected, 0, of_x).unregularised;
  CHECK(full - flat == Approx(lost).margin(0.005));
  const double full_knn = efficiency(whole, samples).unregularised;
  const double flat_knn = efficiency(shadow, projected).unregularised;
  CHECK(full_knn > flat_knn);
  CHECK(full_knn == Approx(full).margin(0.15));
  CHECK(flat_knn == Approx(flat).margin(0.1));
}

TEST_CASE("Every estimator comes near the truth where it is known, as near as is published", "[slow]") {
  struct Row {
    EstimatorSpec spec;
    double tolerance;  // of the regularised value at N = 1000
  };
  const std::vector<Row> rows = {{EstimatorSpec::make("knn"), 0.20}, {knn_plain(3, true), 0.35}};
  std::vector<Case> cases = verify::closed_cases();
  for (Case& c : verify::standard_cases(2)) cases.push_back(std::move(c));
  for (const Case& c : cases) {
    if (c.target->space().dimension() > 3) continue;  // cells of half a metre would be as large as the cube
    const Configurations samples = c.samples(1000, 1);
    const double bound = std::log(20.0) + c.target->uniform();
    for (const Row& row : rows) {
      const Efficiency e = by(row.spec, *c.target, samples, 512);
      INFO(c.name << ", " << row.spec.text() << ": " << e.value << ", truth " << c.d_regularised);
      CHECK(e.estimator == row.spec.text());
      CHECK(e.value <= bound + 1e-9);
      CHECK(e.above_uniform == Approx(e.uniform - e.value));
      if (c.mendable) CHECK(e.value == Approx(c.d_regularised).margin(row.tolerance));
    }
  }
}

TEST_CASE(
    "Samples that miss the target altogether are censored, and worse than uniform ones, whichever the estimator") {
  const std::vector<Case> cases = verify::closed_cases();
  const auto found = std::find_if(cases.begin(), cases.end(), [](const Case& c) { return c.name == "disjoint"; });
  REQUIRE(found != cases.end());
  const Configurations samples = found->samples(1000, 2);
  const double bound = std::log(20.0) + found->target->uniform();
  for (const EstimatorSpec& spec : {EstimatorSpec::make("knn"), knn_plain(3, true)}) {
    const Efficiency e = by(spec, *found->target, samples, 512);
    INFO(spec.text() << ": " << e.value << ", bound " << bound);
    CHECK(e.value <= bound + 1e-9);
    CHECK(e.value > e.uniform + 1.0);
    CHECK(e.unregularised == infinity);
    CHECK(flagged(e, "censored"));
    CHECK(e.mass == infinity);
  }
}
