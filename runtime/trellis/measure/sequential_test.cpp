// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/measure/sequential_test.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace trellis {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double directions = 2.0;  // the error is divided between the two
constexpr double forecast_power = 0.8;

/// What is known of a cost: of a run that was cut off, a lower bound.
RatioBracket known_cost(const CensoredCost& cost) {
  if (cost.solved) return {cost.spent, cost.spent};
  return {cost.cut_off ? cost.spent : infinity, infinity};
}

/// Two equal costs have the ratio 1, two infinite ones too.
double quotient(double cost, double by) {
  if (cost == by) return 1.0;
  return by > 0.0 ? cost / by : infinity;
}

}  // namespace

RatioBracket ratio_bracket(const CensoredCost& with, const CensoredCost& without) {
  const RatioBracket mine = known_cost(with);
  const RatioBracket other = known_cost(without);
  return {quotient(mine.lo, other.hi), quotient(mine.hi, other.lo)};
}

RatioBracket solved_bracket(const CensoredCost& with, const CensoredCost& without) {
  return ratio_bracket({1.0, with.solved, with.cut_off}, {1.0, without.solved, without.cut_off});
}

void PairCounts::add(const RatioBracket& ratio) {
  ++pairs;
  less += ratio.hi < 1.0 ? 1 : 0;
  greater += ratio.lo > 1.0 ? 1 : 0;
  equal += ratio.lo == 1.0 && ratio.hi == 1.0 ? 1 : 0;
  below += ratio.hi < least_difference ? 1 : 0;
  above += ratio.lo > 1.0 / least_difference ? 1 : 0;
}

PairCounts count_pairs(std::span<const RatioBracket> ratios) {
  PairCounts counts;
  for (const RatioBracket& ratio : ratios) counts.add(ratio);
  return counts;
}

double e_value(std::size_t wins, std::size_t losses) {
  static constexpr std::array<double, 5> stakes = {0.2, 0.4, 0.6, 0.8, 1.0};
  double sum = 0.0;
  for (const double stake : stakes) {
    // The logarithm of 0 is -infinity, and 0 times that is no number.
    const double lost = losses == 0 ? 0.0 : static_cast<double>(losses) * std::log1p(-stake);
    sum += std::exp(static_cast<double>(wins) * std::log1p(stake) + lost);
  }
  return sum / static_cast<double>(stakes.size());
}

double decisive_e_value(std::size_t tests) {
  return directions * static_cast<double>(std::max<std::size_t>(tests, 1)) / sequential_error;
}

void decide(std::span<const PairCounts> counts, std::span<SequentialDecision> decisions) {
  const auto directed = [](SequentialDecision one) {
    return one == SequentialDecision::less || one == SequentialDecision::greater;
  };
  std::size_t tests = 0;
  std::size_t undecided = 0;
  for (std::size_t i = 0; i < counts.size(); ++i) {
    if (counts[i].pairs == 0) continue;
    ++tests;
    undecided += directed(decisions[i]) ? 0 : 1;
  }
  for (bool again = true; again;) {
    again = false;
    for (std::size_t i = 0; i < counts.size() && !again; ++i) {
      if (decisions[i] != SequentialDecision::open || counts[i].pairs == 0) continue;
      const double wanted = decisive_e_value(undecided);
      if (e_value(counts[i].less, counts[i].greater) >= wanted) decisions[i] = SequentialDecision::less;
      if (e_value(counts[i].greater, counts[i].less) >= wanted) decisions[i] = SequentialDecision::greater;
      again = decisions[i] != SequentialDecision::open;
    }
    // Each decision lowers the threshold of those that are left.
    if (again) --undecided;
  }
  const double wanted = decisive_e_value(tests);
  for (std::size_t i = 0; i < counts.size(); ++i) {
    const PairCounts& of = counts[i];
    if (decisions[i] != SequentialDecision::open || of.pairs == 0) continue;
    if (e_value(of.below, of.pairs - of.below) < wanted || e_value(of.above, of.pairs - of.above) < wanted) continue;
    decisions[i] = SequentialDecision::no_difference;
  }
}

std::vector<SequentialDecision> decide_in_rounds(std::span<const std::vector<RatioBracket>> ratios) {
  std::vector<SequentialDecision> decisions(ratios.size(), SequentialDecision::open);
  std::vector<PairCounts> counts(ratios.size());
  std::size_t rounds = 0;
  for (const auto& of : ratios) rounds = std::max(rounds, of.size());
  for (std::size_t round = 0; round < rounds; ++round) {
    for (std::size_t i = 0; i < ratios.size(); ++i) {
      if (decisions[i] == SequentialDecision::open && round < ratios[i].size()) counts[i].add(ratios[i][round]);
    }
    decide(counts, decisions);
  }
  return decisions;
}

MedianRatio median_ratio(std::span<const RatioBracket> ratios) {
  const std::size_t n = ratios.size();
  if (n == 0) return {};
  std::vector<double> lo;
  std::vector<double> hi;
  for (const RatioBracket& ratio : ratios) {
    lo.push_back(ratio.lo);
    hi.push_back(ratio.hi);
  }
  std::sort(lo.begin(), lo.end());
  std::sort(hi.begin(), hi.end());
  MedianRatio result;
  result.median = {lo[(n - 1) / 2], hi[(n - 1) / 2]};
  std::size_t rank = 0;
  while (rank < n && e_value(n - rank, rank) >= decisive_e_value(1)) ++rank;
  if (rank > 0) result.interval = {lo[rank - 1], hi[n - rank]};
  return result;
}

std::size_t forecast_pairs(const PairCounts& counts, double threshold) {
  if (counts.less + counts.greater == 0) return 0;
  const auto seen = static_cast<double>(counts.less + counts.greater);
  const double signs_per_pair = (seen + 1.0) / (static_cast<double>(counts.pairs) + 2.0);
  // The probability of each number of wins after so many further signs, of urns that did not decide before.
  std::vector<double> share = {1.0};
  double decided = 0.0;
  for (std::size_t further = 1;; ++further) {
    const double pairs = static_cast<double>(counts.pairs) + std::ceil(static_cast<double>(further) / signs_per_pair);
    if (pairs > static_cast<double>(most_forecast)) return 0;
    std::vector<double> next(further + 1, 0.0);
    for (std::size_t wins = 0; wins < further; ++wins) {
      const std::size_t losses = further - 1 - wins;
      const double win = (static_cast<double>(counts.less + wins) + 1.0) /
                         (static_cast<double>(counts.less + counts.greater + further - 1) + 2.0);
      const auto draw = [&](std::size_t won, std::size_t lost, double probability) {
        const std::size_t less = counts.less + won;
        const std::size_t greater = counts.greater + lost;
        if (std::max(e_value(less, greater), e_value(greater, less)) >= threshold) {
          decided += probability;
        } else {
          next[won] += probability;
        }
      };
      draw(wins + 1, losses, share[wins] * win);
      draw(wins, losses + 1, share[wins] * (1.0 - win));
    }
    share = std::move(next);
    if (decided >= forecast_power) return static_cast<std::size_t>(pairs);
  }
}

}  // namespace trellis
