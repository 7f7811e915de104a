// SPDX-License-Identifier: GPL-3.0-or-later
// Hitting and the bottleneck of samples in balls along a path.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <thread>
#include <vector>

#include <trellis/base/random.hpp>
#include <trellis/measure/hitting.hpp>
#include <trellis/measure/statistics.hpp>
#include <trellis/space/space.hpp>

#include "support/catch.hpp"

using namespace trellis;

namespace {

constexpr double delta = 0.5;
const std::vector<std::size_t> plane = {0, 1};

Configurations path_of(const std::vector<Configuration>& rows) {
  Configurations path(rows.front().size());
  for (const Configuration& row : rows) path.push(row);
  return path;
}

Configurations bent_path() { return path_of({{2.0, 2.0, 0.0}, {7.0, 2.0, 0.5}, {7.0, 8.0, 1.5}}); }

Configurations uniform(const Space& space, std::size_t count, Stream& stream) {
  Configurations rows(space.dimension());
  Configuration x(space.dimension());
  for (std::size_t i = 0; i < count; ++i) {
    space.sample_uniform(stream, x);
    rows.push(x);
  }
  return rows;
}

/// Samples about the straight path from (1, 5) to (9, 5): a share of them along it, in its middle fifth `middle` of
/// them, at headings about `heading`; the others uniform.
struct Guide {
  double share = 0.95;
  double middle = 1.0;
  double heading = 0.0;
};
Configurations straight_path() { return path_of({{1.0, 5.0, 0.0}, {9.0, 5.0, 0.0}}); }
Configurations proposals(const Space& space, const Guide& guide, std::size_t count, Stream& stream) {
  Configurations rows(space.dimension());
  Configuration x(space.dimension());
  while (rows.size() < count) {
    space.sample_uniform(stream, x);
    if (stream.uniform() < guide.share) {
      const double t = stream.uniform();
      if (std::abs(t - 0.5) < 0.1 && stream.uniform() > guide.middle) continue;
      x = {1.0 + 8.0 * t, 5.0 + 0.1 * stream.normal(), guide.heading + 0.2 * stream.normal()};
      space.normalise(x);
      if (!space.contains(x)) continue;
    }
    rows.push(x);
  }
  return rows;
}

/// The definition, by all pairs of balls and samples.
BallHits by_definition(const measure::Balls& balls, const Space& part, const std::vector<Configuration>& centres,
                       const std::vector<Configuration>& samples, double radius) {
  const auto n = static_cast<double>(samples.size());
  double uniform = 0.0;
  double these = 0.0;
  BallHits result;
  for (std::size_t i = 0; i < centres.size(); ++i) {
    double c = 0.0;
    for (const Configuration& sample : samples) c += part.distance(centres[i], sample) <= radius ? 1.0 : 0.0;
    const double u = std::exp(balls.log_share(i));
    const double q = (c + 1.0) / (n + 1.0 / u);
    uniform += 1.0 / u;
    these += 1.0 / q;
    if (i == 0 || std::log(q / u) < result.bottleneck) {
      result.bottleneck = std::log(q / u);
      result.at = balls.arc(i);
    }
  }
  result.hitting = std::log(uniform) - std::log(these);
  return result;
}

}  // namespace

TEST_CASE("Hitting is that of its definition", "[hitting]") {
  const Space se2 = Space::se2({0, 10}, {0, 10});
  const Space position = se2.part(plane, "position");
  const Configurations path = bent_path();
  const PathBalls balls(se2, path, plane, delta);
  CHECK(balls.position().length() == Approx(11.0));
  // The balls are at most half a radius apart, and no two of them farther.
  CHECK(balls.position().size() == 44);
  CHECK(balls.position().arc(0) == Approx(0.125));
  const double pi = std::numbers::pi;
  CHECK(std::exp(balls.position().log_share(20)) == Approx(pi * 0.25 / 100.0));
  const double r = full_radius * delta;
  CHECK(std::exp(balls.full().log_share(20)) == Approx(4.0 / 3.0 * pi * r * r * r / (100.0 * 2.0)));

  Stream stream(1, "0", "samples");
  Configurations samples = uniform(se2, 400, stream);
  for (int i = 0; i < 200; ++i) {
    const double t = stream.uniform();
    samples.push(std::vector{2.0 + 5.0 * t, 2.0 + 0.3 * stream.normal(), 0.3 * stream.normal()});
  }
  std::vector<Configuration> rows;
  std::vector<Configuration> places;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const View x = std::as_const(samples)[i];
    rows.emplace_back(x.begin(), x.end());
    places.push_back({x[0], x[1]});
  }
  const auto on_path = [&](const Space& space, const measure::Balls& of, bool all) {
    std::vector<Configuration> centres;
    const double first = all ? se2.distance(path[0], path[1]) : 5.0;
    const double second = all ? se2.distance(path[1], path[2]) : 6.0;
    for (std::size_t i = 0; i < of.size(); ++i) {
      const std::size_t leg = of.arc(i) <= first ? 0 : 1;
      Configuration x(3);
      se2.interpolate(path[leg], path[leg + 1], leg == 0 ? of.arc(i) / first : (of.arc(i) - first) / second, x);
      if (!all) x.resize(2);
      CHECK(space.contains(x));
      centres.push_back(x);
    }
    return centres;
  };
  const Hitting found = balls.hitting(samples, {});
  const BallHits flat =
      by_definition(balls.position(), position, on_path(position, balls.position(), false), places, delta);
  CHECK(found.position.hitting == Approx(flat.hitting));
  CHECK(found.position.bottleneck == Approx(flat.bottleneck));
  CHECK(found.position.at == Approx(flat.at));
  const BallHits whole = by_definition(balls.full(), se2, on_path(se2, balls.full(), true), rows, r);
  CHECK(found.full.hitting == Approx(whole.hitting));
  CHECK(found.samples == 600);

  // Samples at the goal do not count, those outside of C count in N alone.
  Configurations more = samples;
  for (int i = 0; i < 50; ++i) more.push(path.back());
  CHECK(balls.hitting(more, path.back()).position.hitting == found.position.hitting);
  CHECK(balls.hitting(more, {}).samples == 650);
  more = samples;
  for (int i = 0; i < 50; ++i) more.push(std::vector{2.0, 2.0, 40.0});
  CHECK(balls.hitting(more, {}).position.hitting < found.position.hitting);
}

TEST_CASE("Hitting is 0 of no samples' evidence, and NaN without samples", "[hitting]") {
  const Space se2 = Space::se2({0, 10}, {0, 10});
  const PathBalls balls(se2, bent_path(), plane, delta);
  CHECK(std::isnan(balls.hitting(Configurations(3), {}).position.hitting));
  const Configurations one = path_of({{0.1, 9.9, 0.0}});
  CHECK(balls.hitting(one, {}).position.hitting == Approx(0.0).margin(0.01));
  // A path without length has one ball.
  const PathBalls still(se2, path_of({{3.0, 3.0, 0.0}, {3.0, 3.0, 1.0}}), plane, delta);
  CHECK(still.position().size() == 1);
  CHECK(still.full().size() == 2);
}

TEST_CASE("Uniform samples have a hitting near 0 for any number of them", "[hitting]") {
  const Space se2 = Space::se2({0, 10}, {0, 10});
  const PathBalls balls(se2, bent_path(), plane, delta);
  for (const std::size_t n : {60, 200, 600, 2000, 6000}) {
    CAPTURE(n);
    std::vector<double> position;
    std::vector<double> full;
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
      Stream stream(seed, "0", "uniform");
      const Hitting hitting = balls.hitting(uniform(se2, n, stream), {}, false);
      position.push_back(hitting.position.hitting);
      full.push_back(hitting.full.hitting);
    }
    CHECK(std::abs(student_interval(position).value) < 0.3);
    CHECK(std::abs(student_interval(full).value) < 0.3);
  }
}

TEST_CASE("Hitting orders guides: thin and even first, then with a gap, uniform, beside the path", "[hitting]") {
  const Space se2 = Space::se2({0, 10}, {0, 10});
  const PathBalls balls(se2, straight_path(), plane, delta);
  const auto score = [&](const Guide& guide) {
    Stream stream(3, "0", "proposals");
    return balls.hitting(proposals(se2, guide, 800, stream), {});
  };
  const Hitting even = score({});
  const Hitting rare = score({.share = 0.3});
  const Hitting gap = score({.middle = 0.0});
  const Hitting none = score({.share = 0.0});
  CHECK(even.position.hitting > rare.position.hitting + 0.3);
  CHECK(rare.position.hitting > none.position.hitting + 0.3);
  CHECK(gap.position.hitting < even.position.hitting - 0.3);
  // The gap is the bottleneck: the middle fifth of 8 m, from 3.2 to 4.8 m.
  CHECK(gap.position.at > 3.2);
  CHECK(gap.position.at < 4.8);
  CHECK(gap.position.bottleneck < even.position.bottleneck);
  // By position a wrong heading scores as a right one, in the full metric not above uniform samples.
  const Hitting wrong = score({.heading = std::numbers::pi});
  CHECK(wrong.position.hitting > 1.0);
  CHECK(wrong.full.hitting <= 0.0);
  CHECK(even.full.hitting > 1.0);
}

TEST_CASE("Hitting does not depend on the unit of length, nor on the threads", "[hitting]") {
  const auto score = [](double unit) {
    const Space se2 = Space::se2({0, 10 * unit}, {0, 10 * unit}, unit / std::numbers::pi);
    Configurations path(3);
    const Configurations metres = straight_path();
    for (std::size_t i = 0; i < metres.size(); ++i) {
      path.push(std::vector{unit * metres[i][0], unit * metres[i][1], metres[i][2]});
    }
    Stream stream(5, "0", "proposals");
    const Configurations drawn = proposals(Space::se2({0, 10}, {0, 10}), {.middle = 0.2}, 500, stream);
    Configurations samples(3);
    for (std::size_t i = 0; i < drawn.size(); ++i) {
      const View x = std::as_const(drawn)[i];
      samples.push(std::vector{unit * x[0], unit * x[1], x[2]});
    }
    return PathBalls(se2, path, plane, unit * delta).hitting(samples, {});
  };
  const Hitting metres = score(1.0);
  const Hitting binary = score(1024.0);
  CHECK(binary.position.hitting == Approx(metres.position.hitting));
  CHECK(binary.full.hitting == Approx(metres.full.hitting));
  CHECK(binary.position.at == Approx(1024.0 * metres.position.at));

  const Space se2 = Space::se2({0, 10}, {0, 10});
  const PathBalls balls(se2, straight_path(), plane, delta);
  Stream stream(5, "0", "proposals");
  const Configurations samples = proposals(se2, {.middle = 0.2}, 500, stream);
  std::array<Hitting, 4> found;
  std::vector<std::thread> threads;
  for (Hitting& one : found) threads.emplace_back([&] { one = balls.hitting(samples, {}); });
  for (std::thread& thread : threads) thread.join();
  for (const Hitting& one : found) {
    CHECK(one.position.hitting == found.front().position.hitting);
    CHECK(one.full.bottleneck_hi == found.front().full.bottleneck_hi);
  }
}

TEST_CASE("Hitting works for bodies in space, arms and teams", "[hitting]") {
  const Space se3 = Space::se3({{{0, 10}, {0, 10}, {0, 10}}}, 0.5);
  const Configurations path = path_of({{1.0, 5.0, 5.0, 0.0, 0.0, 0.0, 1.0}, {9.0, 5.0, 5.0, 0.0, 0.0, 0.0, 1.0}});
  const PathBalls body(se3, path, {0, 1, 2}, delta);
  const double pi = std::numbers::pi;
  CHECK(std::exp(body.position().log_share(10)) == Approx(4.0 / 3.0 * pi * 0.125 / 1000.0));
  Stream stream(7, "0", "samples");
  Configurations near(7);
  for (int i = 0; i < 300; ++i) near.push(std::vector{1.0 + 8.0 * stream.uniform(), 5.0, 5.0, 0.0, 0.0, 0.0, 1.0});
  const Hitting along = body.hitting(near, {});
  CHECK(along.position.hitting > 2.0);
  CHECK(along.full.hitting > 1.0);
  CHECK(along.full.bottleneck >= along.full.bottleneck_lo);
  CHECK(std::abs(body.hitting(uniform(se3, 600, stream), {}).position.hitting) < 0.5);

  // An arm has no position: both are in the space of its joints.
  const Space arm("R^3", {{"a", -pi, pi, 1.0, true}, {"b", -2.0, 2.0, 1.0, false}, {"c", -2.0, 2.0, 1.0, false}});
  const PathBalls joints(arm, path_of({{3.0, 0.0, 0.0}, {-3.0, 1.0, 0.0}}), {}, delta);
  CHECK(joints.position().length() == Approx(std::hypot(2.0 * pi - 6.0, 1.0)));
  CHECK(joints.hitting(path_of({{3.1, 0.2, 0.0}, {-3.1, 0.8, 0.0}}), {}).position.hitting > 0.0);

  const Space team = Space::product({{1.0, Space::se2({0, 10}, {0, 10})}, {1.0, Space::se2({0, 10}, {0, 10})}});
  const PathBalls two(team, path_of({{1, 1, 0, 9, 9, 0}, {9, 1, 0, 1, 9, 0}}), {0, 1, 3, 4}, delta);
  CHECK(two.position().length() == Approx(8.0 * std::sqrt(2.0)));
  CHECK(std::abs(two.hitting(uniform(team, 600, stream), {}).position.hitting) < 0.3);
}

TEST_CASE("The interval of the bottleneck holds the truth in 95 % of repetitions", "[hitting]") {
  const Space square = Space::euclidean({{0, 10}, {0, 10}});
  const Configurations path = path_of({{1.0, 5.0}, {9.0, 5.0}});
  const PathBalls balls(square, path, {0, 1}, delta);
  for (const auto& [share, middle] : {std::pair{0.0, 1.0}, std::pair{0.3, 1.0}, std::pair{0.9, 0.1}}) {
    CAPTURE(share);
    const auto draw = [&, share = share, middle = middle](std::size_t count, Stream& stream) {
      Configurations rows(2);
      Configuration x(2);
      while (rows.size() < count) {
        square.sample_uniform(stream, x);
        if (stream.uniform() < share) {
          const double t = stream.uniform();
          if (std::abs(t - 0.5) < 0.05 && stream.uniform() > middle) continue;
          x = {1.0 + 8.0 * t, 4.8 + 0.4 * stream.uniform()};
        }
        rows.push(x);
      }
      return rows;
    };
    Stream many(1, "0", "truth");
    const double truth = balls.hitting(draw(400000, many), {}, false).position.bottleneck;
    for (const std::size_t n : {100, 600, 3000}) {
      CAPTURE(n);
      std::size_t held = 0;
      constexpr std::size_t repetitions = 200;
      for (std::uint64_t seed = 0; seed < repetitions; ++seed) {
        Stream stream(seed, "0", "proposals");
        const BallHits hits = balls.hitting(draw(n, stream), {}).position;
        held += hits.bottleneck_lo <= truth && truth <= hits.bottleneck_hi ? 1 : 0;
        CHECK(hits.bottleneck_lo <= hits.bottleneck);
        CHECK(hits.bottleneck <= hits.bottleneck_hi);
      }
      CHECK(held >= repetitions * 95 / 100);
    }
  }
}

TEST_CASE("The mean over paths has the place on the first", "[hitting]") {
  std::array<Hitting, 3> hits;
  hits[1].position = {.hitting = 1.0, .hitting_lo = 0.5, .hitting_hi = 1.5, .bottleneck = 0.2, .at = 3.0};
  hits[1].length = 9.0;
  hits[1].samples = 700;
  hits[2].position = {.hitting = 2.0, .bottleneck = -0.4, .at = 1.0};
  hits[2].samples = 600;
  const Hitting both = mean(hits);
  CHECK(both.position.hitting == 1.5);
  CHECK(std::isnan(both.position.hitting_lo));
  CHECK(both.position.at == 3.0);
  CHECK(both.length == 9.0);
  CHECK(both.samples == 600);
  CHECK(std::isnan(mean(std::span<const Hitting>{}).position.hitting));
}

TEST_CASE("As many uniform samples in place of the guides' show no rank correlation with costs", "[hitting]") {
  // Whether the numbers of samples alone, which are costs themselves, rank the guides: at equal numbers they do not.
  const Space se2 = Space::se2({0, 10}, {0, 10});
  constexpr std::size_t worlds = 21;
  constexpr std::size_t guides = 14;
  std::vector<double> correlations;
  for (std::uint64_t world = 0; world < worlds; ++world) {
    Stream stream(world, "0", "world");
    const Configurations path =
        path_of({{1.0, 1.0, 0.0}, {stream.uniform(1.0, 9.0), stream.uniform(1.0, 9.0), 0.5}, {9.0, 9.0, 0.0}});
    const PathBalls balls(se2, path, plane, delta);
    std::vector<double> costs;
    std::vector<double> hitting;
    for (std::size_t guide = 0; guide < guides; ++guide) {
      costs.push_back(static_cast<double>(guide));
      hitting.push_back(balls.hitting(uniform(se2, 600, stream), {}, false).position.hitting);
    }
    correlations.push_back(rank_correlation(hitting, costs));
  }
  CHECK(std::abs(student_interval(correlations).value) < 0.15);
}
