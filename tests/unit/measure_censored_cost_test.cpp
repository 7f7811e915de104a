// SPDX-License-Identifier: GPL-3.0-or-later
// Costs of runs some of which found no path: one rule, and intervals with the nominal coverage.
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <trellis/base/error.hpp>
#include <trellis/base/random.hpp>
#include <trellis/measure/censored_cost.hpp>
#include <trellis/measure/median_bound.hpp>

#include "support/catch.hpp"

using namespace trellis;

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();

CensoredCost solved(double spent) { return {spent, true}; }
CensoredCost failed(double spent) { return {spent, false}; }

}  // namespace

TEST_CASE("an unsolved run costs infinitely much, and two are a tie", "[censored]") {
  CHECK(cost_ratio(solved(50), solved(100)) == 0.5);
  CHECK(cost_ratio(failed(50), solved(100)) == infinity);
  CHECK(cost_ratio(solved(50), failed(10)) == 0.0);
  CHECK(cost_ratio(failed(50), failed(10)) == 1.0);
  CHECK(cost_ratio(solved(0), solved(0)) == 1.0);
  CHECK(std::isnan(cost_ratio(solved(not_a_number), solved(1))));
  CHECK(cost_difference(failed(50), failed(10)) == 0.0);
  CHECK(cost_difference(failed(50), solved(10)) == infinity);
  CHECK(cost_difference(solved(50), failed(10)) == -infinity);
}

TEST_CASE("what is claimed is never helped by a run that was cut off", "[censored]") {
  CHECK(cost_ratio(solved(50), failed(10), Claim::less) == 5.0);
  CHECK(cost_ratio(failed(50), failed(10), Claim::less) == infinity);
  CHECK(cost_ratio(failed(50), solved(10), Claim::less) == infinity);
  CHECK(cost_ratio(failed(50), solved(10), Claim::more) == 5.0);
  CHECK(cost_ratio(solved(50), failed(10), Claim::more) == 0.0);
  CHECK(cost_ratio(failed(50), failed(10), Claim::more) == 0.0);
}

TEST_CASE("a strategy that gives up early on most seeds is not cheap", "[censored]") {
  // It fails 16 of 20 runs after 62 checks, where the reference finds a path for 100.
  std::vector<CensoredCost> mine(16, failed(62));
  mine.resize(20, solved(62));
  const std::vector<CensoredCost> reference(20, solved(100));
  const PairedCosts pairs = paired_costs(mine, reference);
  CHECK(pairs.pairs == 20);
  CHECK(pairs.solved == 4);
  CHECK(pairs.reference_solved == 20);
  CHECK(pairs.both_solved == 4);
  CHECK(pairs.ratio.value == infinity);
  // The interval at 95 % begins at the 6th of 20, which is unsolved.
  CHECK(pairs.ratio.lo == infinity);
  CHECK(pairs.ratio.hi == infinity);
  CHECK(pairs.difference.value == infinity);
  CHECK(pairs.median.value == infinity);
  CHECK(pairs.reference_median.value == 100.0);
  CHECK(pairs.less == 4);
  CHECK(pairs.greater == 16);
  CHECK(pairs.sign_p < 0.02);
  CHECK(pairs.effect == Approx(-0.6));
  // Turned round it says the same.
  const PairedCosts turned = paired_costs(reference, mine);
  CHECK(turned.ratio.value == 0.0);
  CHECK(turned.ratio.lo == 0.0);
  CHECK(turned.ratio.hi == 0.0);
  CHECK(turned.sign_p == pairs.sign_p);
  CHECK(turned.effect == Approx(0.6));
}

TEST_CASE("where both fail on most seeds nothing is shown", "[censored]") {
  std::vector<CensoredCost> mine(16, failed(1000));
  mine.resize(20, solved(62));
  std::vector<CensoredCost> reference(16, failed(1000));
  reference.resize(20, solved(100));
  const PairedCosts pairs = paired_costs(mine, reference);
  CHECK(pairs.ratio.value == 1.0);
  CHECK(pairs.equal == 16);
  CHECK(pairs.sign_p == Approx(0.125));
}

TEST_CASE("fewer than five values have no interval, and figures that are missing leave their pair out", "[censored]") {
  const std::vector<double> four = {1.0, 2.0, infinity, 4.0};
  CHECK(median_interval(four).value == 3.0);
  CHECK(std::isnan(median_interval(four).lo));
  CHECK(std::isnan(median_interval(four).hi));
  CHECK(std::isnan(median_interval({}).value));

  const std::vector<CensoredCost> mine = {solved(1), solved(not_a_number), solved(3)};
  const std::vector<CensoredCost> other = {solved(2), solved(2), solved(3)};
  CHECK(paired_costs(mine, other).pairs == 2);
  CHECK(paired_costs(mine, other).ratio.value == 0.75);
  CHECK(paired_costs({}, {}).pairs == 0);
  CHECK(std::isnan(paired_costs({}, {}).effect));
  CHECK_THROWS_AS(paired_costs(mine, {}), Error);
}

TEST_CASE("the interval of a median is that of the order statistics", "[censored]") {
  // Of 15 fair coins at most 11 show heads with .982, at most 10 with .941: the 4th and the 12th of 15.
  std::vector<double> values;
  for (int i = 1; i <= 15; ++i) values.push_back(i);
  const Interval all = median_interval(values);
  CHECK(all.value == 8.0);
  CHECK(all.lo == 4.0);
  CHECK(all.hi == 12.0);
  CHECK(all.n == 15);
  // The upper end goes where the unsolved runs are.
  std::fill(values.end() - 4, values.end(), infinity);
  const Interval censored = median_interval(values);
  CHECK(censored.value == 8.0);
  CHECK(censored.lo == 4.0);
  CHECK(censored.hi == infinity);
  CHECK(censored.infinite == 4);
  CHECK(median_interval(values, 0.8).hi == 11.0);
}

// Costs are log-normal, as those of planners are about; a run that would cost more than the budget fails. The true
// median, of the costs with infinity for what lies beyond the budget, is known.
TEST_CASE("intervals of censored costs hold the truth 94 to 100 times of 100 at 95 %", "[censored][slow]") {
  constexpr int rounds = 3000;
  struct Case {
    std::size_t runs;
    double budget;  ///< as a multiple of the median cost; below 1 most runs fail
    double factor;  ///< of the strategy's median to the reference's
  };
  const std::vector<Case> cases = {{8, 4.0, 1.0},  {15, 4.0, 0.5},  {15, 1.2, 0.5}, {15, 0.8, 2.0},
                                   {20, 1.0, 1.5}, {30, 1.05, 0.7}, {60, 2.0, 1.0}};
  for (const Case& one : cases) {
    Stream stream(7, "", "censored coverage");
    const auto draw = [&](double middle, double shared) {
      const double cost = middle * std::exp(1.2 * (0.6 * shared + 0.8 * stream.normal()));
      return CensoredCost{std::min(cost, one.budget), cost <= one.budget};
    };
    // A pair is more or less than a ratio with the chance that a pair of infinitely many is: from many of them.
    constexpr std::size_t many = 400001;
    std::vector<double> ratios(many);
    std::vector<double> differences(many);
    for (std::size_t i = 0; i < many; ++i) {
      const double shared = stream.normal();
      const CensoredCost mine = draw(one.factor, shared);
      const CensoredCost reference = draw(1.0, shared);
      ratios[i] = cost_ratio(mine, reference);
      differences[i] = cost_difference(mine, reference);
    }
    const auto middle = [](std::vector<double>& values) {
      std::nth_element(values.begin(), values.begin() + many / 2, values.end());
      return values[many / 2];
    };
    const double ratio = middle(ratios);
    const double difference = middle(differences);
    const double median = one.factor <= one.budget ? one.factor : infinity;

    int of_median = 0;
    int of_ratio = 0;
    int of_difference = 0;
    for (int round = 0; round < rounds; ++round) {
      std::vector<CensoredCost> mine;
      std::vector<CensoredCost> reference;
      for (std::size_t i = 0; i < one.runs; ++i) {
        const double shared = stream.normal();
        mine.push_back(draw(one.factor, shared));
        reference.push_back(draw(1.0, shared));
      }
      const PairedCosts pairs = paired_costs(mine, reference);
      const auto holds = [](const Interval& interval, double truth) {
        return interval.lo <= truth && truth <= interval.hi ? 1 : 0;
      };
      of_median += holds(pairs.median, median);
      of_ratio += holds(pairs.ratio, ratio);
      of_difference += holds(pairs.difference, difference);
    }
    INFO(one.runs << " runs, budget " << one.budget << ", factor " << one.factor);
    CHECK(of_median / static_cast<double>(rounds) >= 0.94);
    CHECK(of_ratio / static_cast<double>(rounds) >= 0.94);
    CHECK(of_difference / static_cast<double>(rounds) >= 0.94);
  }
}

TEST_CASE("Newcombe's interval of two success rates holds the truth 98 to 100 times of 100 at 99 %", "[censored]") {
  constexpr int rounds = 4000;
  for (const std::size_t runs : {15U, 30U}) {
    for (const auto& [p, q] : {std::pair{0.9, 0.5}, {0.5, 0.5}, {0.8, 0.7}, {0.3, 0.6}}) {
      Stream stream(3, "", "newcombe coverage");
      int holds = 0;
      for (int round = 0; round < rounds; ++round) {
        Share a{0, runs};
        Share b{0, runs};
        for (std::size_t i = 0; i < runs; ++i) {
          a.successes += stream.uniform() < p ? 1 : 0;
          b.successes += stream.uniform() < q ? 1 : 0;
        }
        const Interval interval = newcombe_interval(a, b, 0.99);
        holds += interval.lo <= p - q && p - q <= interval.hi ? 1 : 0;
      }
      INFO(runs << " runs of " << p << " and " << q);
      CHECK(holds / static_cast<double>(rounds) >= 0.98);
    }
  }
}
