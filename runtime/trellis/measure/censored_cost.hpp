// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include <trellis/measure/statistics.hpp>

/// The cost of runs where some runs found no path. One rule serves every median, ratio and difference of costs: an
/// unsolved run costs infinitely much, so giving up early is never an advantage.
namespace trellis {

/// The cost of a run in one quantity. Without a path it is a lower bound of the true cost: the cost is censored.
struct CensoredCost {
  double spent = std::numeric_limits<double>::quiet_NaN();  ///< NaN: the run has no such value
  bool solved = false;
  bool cut_off = false;  ///< it was stopped at `spent`, and might have found a path
  [[nodiscard]] double cost() const { return solved ? spent : std::numeric_limits<double>::infinity(); }
};

/// The claim of a comparison: a censored run never supports it.
enum class Claim : std::uint8_t {
  none,  ///< an unsolved run is infinite on either side, and two unsolved runs are a tie
  less,  ///< an unsolved run of the reference counts with its actual cost
  more,  ///< an unsolved run of the compared strategy counts with its actual cost
};

/// Returns mine / reference: 1 for equal costs, 0 and infinity where one of them is infinite. NaN where a value is
/// missing.
double cost_ratio(const CensoredCost& mine, const CensoredCost& reference, Claim claim = Claim::none);
/// Returns mine - reference, 0 for equal costs.
double cost_difference(const CensoredCost& mine, const CensoredCost& reference);

/// Returns the median cost with its 95 % interval; infinite where at least half of the runs are unsolved.
Interval median_cost(std::span<const CensoredCost> costs);

/// Two lists of costs of the same seeds, paired by seed; medians with 95 % intervals by order statistics.
struct PairedCosts {
  Interval median;            ///< of the strategy, over the pairs
  Interval reference_median;  ///< of the reference
  Interval ratio;             ///< of the ratios of the pairs
  Interval difference;        ///< of the differences
  std::size_t pairs = 0;      ///< with both values
  std::size_t solved = 0;     ///< pairs that the strategy solved
  std::size_t reference_solved = 0;
  std::size_t both_solved = 0;
  std::size_t less = 0;  ///< pairs in which the strategy costs less
  std::size_t greater = 0;
  std::size_t equal = 0;  ///< includes pairs that both failed
  double sign_p = 1.0;    ///< sign test of `less` against `greater`
  double holm_p = 1.0;    ///< the same with Holm's correction for the comparisons of one table
  /// Effect size: the share of pairs in which the strategy costs less, minus the share in which it costs more, in [-1,
  /// 1].
  double effect = std::numeric_limits<double>::quiet_NaN();
};
/// \throws Error for lists of different lengths.
PairedCosts paired_costs(std::span<const CensoredCost> mine, std::span<const CensoredCost> reference);

}  // namespace trellis
