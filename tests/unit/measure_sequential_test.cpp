// SPDX-License-Identifier: GPL-3.0-or-later
// The sequential test of pairs: its e-value and interval against brute force, its errors and coverage at any stop.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>
#include <vector>

#include <trellis/base/random.hpp>
#include <trellis/measure/sequential_test.hpp>

#include "support/catch.hpp"

using namespace trellis;

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

CensoredCost solved(double spent) { return {spent, true}; }
CensoredCost failed(double spent) { return {spent, false}; }
CensoredCost cut_off(double spent) { return {spent, false, true}; }

RatioBracket exactly(double ratio) { return {ratio, ratio}; }
std::vector<RatioBracket> repeated(double ratio, std::size_t n) { return std::vector(n, exactly(ratio)); }

SequentialDecision decided(const std::vector<RatioBracket>& ratios) {
  return decide_in_rounds(std::vector<std::vector<RatioBracket>>{ratios})[0];
}

bool equals(const RatioBracket& a, double lo, double hi) { return a.lo == lo && a.hi == hi; }

/// A pair whose median ratio is `median`, from runs without that end at twice the cost of the run with.
RatioBracket drawn(Stream& stream, double median) {
  const double ratio = median * std::exp(0.8 * stream.normal());
  return ratio_bracket(solved(1.0), ratio < 0.5 ? cut_off(2.0) : solved(1.0 / ratio));
}

}  // namespace

TEST_CASE("a run that was cut off leaves a bracket of the ratio", "[sequential]") {
  CHECK(equals(ratio_bracket(solved(50), solved(100)), 0.5, 0.5));
  CHECK(equals(ratio_bracket(solved(50), solved(50)), 1.0, 1.0));
  CHECK(equals(ratio_bracket(solved(50), cut_off(100)), 0.0, 0.5));
  CHECK(equals(ratio_bracket(solved(50), failed(100)), 0.0, 0.0));
  CHECK(equals(ratio_bracket(failed(50), solved(100)), infinity, infinity));
  CHECK(equals(ratio_bracket(failed(50), failed(100)), 1.0, 1.0));
  CHECK(equals(ratio_bracket(failed(50), cut_off(100)), 1.0, infinity));
  CHECK(equals(ratio_bracket(cut_off(50), solved(100)), 0.5, infinity));
  CHECK(equals(ratio_bracket(cut_off(50), failed(100)), 0.0, 1.0));
  CHECK(equals(ratio_bracket(cut_off(50), cut_off(100)), 0.0, infinity));
  CHECK(equals(ratio_bracket(solved(0), solved(0)), 1.0, 1.0));
  CHECK(equals(solved_bracket(solved(50), solved(100)), 1.0, 1.0));
  CHECK(equals(solved_bracket(solved(50), failed(100)), 0.0, 0.0));
  CHECK(equals(solved_bracket(solved(50), cut_off(100)), 0.0, 1.0));

  const PairCounts counts =
      count_pairs(std::vector{exactly(0.5), RatioBracket{0.0, 0.5}, exactly(1.0), RatioBracket{1.0, infinity},
                              exactly(1.1), RatioBracket{0.0, 1.1}, exactly(1.3)});
  CHECK(counts.pairs == 7);
  CHECK(counts.less == 2);
  CHECK(counts.greater == 2);
  CHECK(counts.equal == 1);
  CHECK(counts.below == 5);
  CHECK(counts.above == 4);
}

TEST_CASE("the e-value is the wealth of the bets, and a martingale of fair signs", "[sequential]") {
  for (std::size_t n = 0; n <= 12; ++n) {
    double expected = 0.0;
    for (std::size_t signs = 0; signs < (std::size_t{1} << n); ++signs) {
      std::size_t wins = 0;
      double sum = 0.0;
      for (std::size_t i = 0; i < n; ++i) wins += (signs >> i) & 1U;
      for (const double stake : {0.2, 0.4, 0.6, 0.8, 1.0}) {
        double wealth = 1.0;
        for (std::size_t i = 0; i < n; ++i) wealth *= ((signs >> i) & 1U) != 0 ? 1.0 + stake : 1.0 - stake;
        sum += wealth;
      }
      CHECK(e_value(wins, n - wins) == Approx(sum / 5.0).epsilon(1e-12));
      expected += e_value(wins, n - wins) / std::ldexp(1.0, static_cast<int>(n));
    }
    CHECK(expected == Approx(1.0).epsilon(1e-12));
  }
  // The probability to reach a threshold within 300 fair signs, by all paths.
  for (const double threshold : {20.0, 40.0, 80.0, 240.0}) {
    std::vector<double> open = {1.0};
    double reached = 0.0;
    for (std::size_t n = 1; n <= 300; ++n) {
      std::vector<double> next(n + 1, 0.0);
      for (std::size_t wins = 0; wins < n; ++wins) {
        for (const std::size_t more : {0U, 1U}) {
          const bool hit = e_value(wins + more, n - wins - more) >= threshold;
          (hit ? reached : next[wins + more]) += 0.5 * open[wins];
        }
      }
      open = std::move(next);
    }
    CAPTURE(threshold);
    CHECK(reached <= 1.0 / threshold);
    CHECK(reached > 0.2 / threshold);
  }
}

TEST_CASE("the first of a family that decides lowers the threshold of the others", "[sequential]") {
  using Decision = SequentialDecision;
  const auto of = [](const std::vector<std::pair<std::size_t, std::size_t>>& signs) {
    std::vector<PairCounts> counts;
    for (const auto& [less, greater] : signs) {
      counts.push_back({.pairs = less + greater, .less = less, .greater = greater});
    }
    std::vector<Decision> decisions(signs.size(), Decision::open);
    decide(counts, decisions);
    return decisions;
  };
  // Seven wins have 53, eight 85, nine 161.
  CHECK(of({{6, 0}}) == std::vector{Decision::open});
  CHECK(of({{7, 0}}) == std::vector{Decision::less});
  CHECK(of({{0, 7}}) == std::vector{Decision::greater});
  CHECK(of({{7, 0}, {7, 0}}) == std::vector{Decision::open, Decision::open});
  CHECK(of({{7, 0}, {0, 8}}) == std::vector{Decision::less, Decision::greater});
  CHECK(of({{7, 0}, {0, 8}, {8, 0}}) == std::vector{Decision::open, Decision::open, Decision::open});
  CHECK(of({{7, 0}, {0, 8}, {9, 0}}) == std::vector{Decision::less, Decision::greater, Decision::less});
  // A test without pairs does not count.
  CHECK(of({{7, 0}, {0, 0}}) == std::vector{Decision::less, Decision::open});
}

TEST_CASE("a part that changes nothing ends its test", "[sequential]") {
  using Decision = SequentialDecision;
  CHECK(decided(repeated(1.0, 7)) == Decision::no_difference);
  CHECK(decided(repeated(1.0, 6)) == Decision::open);
  CHECK(decide_in_rounds(std::vector{repeated(1.0, 8), repeated(1.0, 8)})[1] == Decision::no_difference);
  CHECK(decide_in_rounds(std::vector{repeated(1.0, 8), repeated(1.0, 8), repeated(1.0, 8)})[1] == Decision::open);
  // A decision stays, whatever the pairs after it are.
  std::vector<RatioBracket> late = repeated(0.5, 7);
  for (const RatioBracket& one : repeated(2.0, 30)) late.push_back(one);
  CHECK(decided(late) == Decision::less);
  CHECK(decide_in_rounds(std::vector<std::vector<RatioBracket>>(1))[0] == Decision::open);
}

TEST_CASE("the interval has the medians that the test does not reject", "[sequential]") {
  Stream stream(7, "0", "interval");
  for (std::size_t n = 1; n <= 60; ++n) {
    std::vector<RatioBracket> ratios;
    for (std::size_t i = 0; i < n; ++i) ratios.push_back(exactly(std::exp(stream.normal())));
    const RatioBracket interval = median_ratio(ratios).interval;
    // Between two neighbouring ratios all medians have the same signs.
    std::vector<double> sorted;
    for (const RatioBracket& one : ratios) sorted.push_back(one.lo);
    std::sort(sorted.begin(), sorted.end());
    for (std::size_t below = 0; below <= n; ++below) {
      const double lo = below == 0 ? 0.5 * sorted.front() : sorted[below - 1];
      const double median = below == n ? 2.0 * sorted.back() : 0.5 * (lo + sorted[below]);
      const bool rejected = e_value(below, n - below) >= 40.0 || e_value(n - below, below) >= 40.0;
      CAPTURE(n, below, interval.lo, interval.hi);
      CHECK((median >= interval.lo && median <= interval.hi) == !rejected);
    }
  }
  CHECK(equals(median_ratio(repeated(0.5, 6)).interval, 0.0, infinity));
  CHECK(equals(median_ratio(repeated(0.5, 7)).interval, 0.5, 0.5));
  CHECK(equals(median_ratio({}).interval, 0.0, infinity));
  // Cut-off runs have an upper end only.
  const MedianRatio cut = median_ratio(std::vector<RatioBracket>(9, {0.0, 0.5}));
  CHECK(equals(cut.median, 0.0, 0.5));
  CHECK(equals(cut.interval, 0.0, 0.5));
}

TEST_CASE("at most 5 % of families without a difference ever get a direction", "[sequential][slow]") {
  constexpr std::size_t families = 1500;
  Stream stream(11, "0", "null");
  for (const std::size_t tests : {1U, 2U, 3U, 6U}) {
    std::size_t wrong = 0;
    for (std::size_t f = 0; f < families; ++f) {
      // The two runs of each pair are swapped at random, so that neither is cheaper. Some pairs are equal.
      std::vector<std::vector<RatioBracket>> ratios(tests);
      for (auto& of : ratios) {
        const double ties = 0.5 * stream.uniform();
        for (std::size_t i = 0; i < 200; ++i) {
          const double cost = 1.0 + stream.uniform();
          const double other = stream.uniform() < ties ? cost : 3.0 * cost;
          const bool swapped = stream.uniform() < 0.5;
          const CensoredCost with = solved(swapped ? other : cost);
          const double without = swapped ? cost : other;
          of.push_back(ratio_bracket(with, without > 2.0 * with.spent ? cut_off(2.0 * with.spent) : solved(without)));
        }
      }
      const auto decisions = decide_in_rounds(ratios);
      wrong += std::any_of(decisions.begin(), decisions.end(), [](SequentialDecision one) {
        return one == SequentialDecision::less || one == SequentialDecision::greater;
      });
    }
    CAPTURE(tests, wrong);
    CHECK(static_cast<double>(wrong) <= 0.05 * families);
    CHECK(wrong > 0);
  }
}

TEST_CASE("at most 5 % of differences of 1.25 are called none", "[sequential][slow]") {
  constexpr std::size_t trials = 1500;
  Stream stream(13, "0", "futility");
  for (const double median : {least_difference, 1.0 / least_difference}) {
    std::size_t wrong = 0;
    for (std::size_t t = 0; t < trials; ++t) {
      std::vector<std::vector<RatioBracket>> ratios(1);
      for (std::size_t i = 0; i < 100; ++i) ratios[0].push_back(exactly(median * std::exp(0.1 * stream.normal())));
      wrong += decide_in_rounds(ratios)[0] == SequentialDecision::no_difference ? 1 : 0;
    }
    CAPTURE(median, wrong);
    CHECK(static_cast<double>(wrong) <= 0.05 * trials);
  }
}

TEST_CASE("the interval covers the median in 95 % where the test stops", "[sequential][slow]") {
  constexpr std::size_t trials = 800;
  Stream stream(17, "0", "coverage");
  for (const double median : {0.1, 0.5, 0.9, 1.0, 1.2, 2.0}) {
    std::size_t missed = 0;
    for (std::size_t t = 0; t < trials; ++t) {
      std::vector<std::vector<RatioBracket>> ratios(1);
      while (ratios[0].size() < 40 && decide_in_rounds(ratios)[0] == SequentialDecision::open) {
        ratios[0].push_back(drawn(stream, median));
      }
      const RatioBracket interval = median_ratio(ratios[0]).interval;
      missed += median < interval.lo || median > interval.hi ? 1 : 0;
    }
    CAPTURE(median, missed);
    CHECK(static_cast<double>(missed) <= 0.05 * trials);
  }
}

TEST_CASE("a forecast comes true in 80 % where each share of wins is as likely", "[sequential][slow]") {
  Stream stream(19, "0", "forecast");
  const double threshold = decisive_e_value(2);
  std::size_t forecasts = 0;
  std::size_t decided = 0;
  for (std::size_t t = 0; t < 3000; ++t) {
    const double share = stream.uniform();
    PairCounts counts;
    const auto open = [&] {
      return std::max(e_value(counts.less, counts.greater), e_value(counts.greater, counts.less)) < threshold;
    };
    const auto draw = [&] { counts.add(exactly(stream.uniform() < share ? 0.5 : 2.0)); };
    while (counts.pairs < 10 && open()) draw();
    if (!open()) continue;
    const std::size_t pairs = forecast_pairs(counts, threshold);
    CHECK((pairs == 0 || (pairs > counts.pairs && pairs <= most_forecast)));
    if (pairs == 0) continue;
    ++forecasts;
    while (counts.pairs < pairs && open()) draw();
    decided += open() ? 0 : 1;
  }
  CAPTURE(forecasts, decided);
  CHECK(forecasts > 100);
  CHECK(static_cast<double>(decided) >= 0.75 * static_cast<double>(forecasts));
  CHECK(forecast_pairs(count_pairs(repeated(1.0, 20)), threshold) == 0);
}
