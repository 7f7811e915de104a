// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/measure/censored_cost.hpp>

#include <fmt/format.h>

#include <cmath>

#include <trellis/base/error.hpp>
#include <trellis/measure/median_bound.hpp>

namespace trellis {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double nan = std::numeric_limits<double>::quiet_NaN();

double divided(double cost, double by) {
  if (std::isnan(cost) || std::isnan(by)) return nan;
  if (cost == by) return 1.0;
  return by > 0.0 ? cost / by : infinity;
}

}  // namespace

double cost_ratio(const CensoredCost& mine, const CensoredCost& reference, Claim claim) {
  return divided(claim == Claim::more ? mine.spent : mine.cost(),
                 claim == Claim::less ? reference.spent : reference.cost());
}

double cost_difference(const CensoredCost& mine, const CensoredCost& reference) {
  const double a = mine.cost();
  const double b = reference.cost();
  return a == b ? 0.0 : a - b;
}

Interval median_cost(std::span<const CensoredCost> costs) {
  std::vector<double> values;
  values.reserve(costs.size());
  for (const CensoredCost& one : costs) values.push_back(one.cost());
  return median_interval(values);
}

PairedCosts paired_costs(std::span<const CensoredCost> mine, std::span<const CensoredCost> reference) {
  if (mine.size() != reference.size()) {
    throw Error(
        fmt::format("paired costs: {} runs against {}; the seeds must be the same", mine.size(), reference.size()));
  }
  PairedCosts result;
  std::vector<CensoredCost> left;
  std::vector<CensoredCost> right;
  std::vector<double> ratios;
  std::vector<double> differences;
  for (std::size_t i = 0; i < mine.size(); ++i) {
    const double ratio = cost_ratio(mine[i], reference[i]);
    if (std::isnan(ratio)) continue;
    left.push_back(mine[i]);
    right.push_back(reference[i]);
    ratios.push_back(ratio);
    differences.push_back(cost_difference(mine[i], reference[i]));
    result.solved += mine[i].solved ? 1 : 0;
    result.reference_solved += reference[i].solved ? 1 : 0;
    result.both_solved += mine[i].solved && reference[i].solved ? 1 : 0;
    result.less += ratio < 1.0 ? 1 : 0;
    result.greater += ratio > 1.0 ? 1 : 0;
    result.equal += ratio == 1.0 ? 1 : 0;
  }
  result.pairs = ratios.size();
  result.median = median_cost(left);
  result.reference_median = median_cost(right);
  result.ratio = median_interval(ratios);
  result.difference = median_interval(differences);
  // A ratio of costs is never negative, however few the pairs are.
  if (result.ratio.lo < 0.0) result.ratio.lo = 0.0;
  result.sign_p = result.holm_p = sign_test(result.less, result.greater);
  if (result.pairs > 0) {
    result.effect =
        (static_cast<double>(result.less) - static_cast<double>(result.greater)) / static_cast<double>(result.pairs);
  }
  return result;
}

}  // namespace trellis
