// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include <trellis/measure/statistics.hpp>

/// What runs cost where some of them found no path. One rule serves every median, ratio and difference of costs: an
/// unsolved run costs infinitely much, so giving up early is never cheap.
namespace trellis {

/// What a run spent of a quantity. Without a path that is the least that it would have cost: the cost is censored.
struct CensoredCost {
  double spent = std::numeric_limits<double>::quiet_NaN();  ///< NaN: the run has no such figure
  bool solved = false;
  [[nodiscard]] double cost() const { return solved ? spent : std::numeric_limits<double>::infinity(); }
};

/// What a comparison is to show: that is never helped by a run that was cut off.
enum class Claim : std::uint8_t {
  none,  ///< unsolved is infinite on either side, and two unsolved runs are a tie
  less,  ///< an unsolved run of the reference counts with what it spent
  more,  ///< an unsolved run of the strategy that is compared counts with what it spent
};

/// mine / reference: 1 for equal costs, 0 and infinity where one of them is infinite. NaN where a figure is missing.
double cost_ratio(const CensoredCost& mine, const CensoredCost& reference, Claim claim = Claim::none);
/// mine - reference, 0 for equal costs.
double cost_difference(const CensoredCost& mine, const CensoredCost& reference);

/// The median cost with its 99 % interval; infinite where at least half of the runs are unsolved.
Interval median_cost(std::span<const CensoredCost> costs);

/// Two lists of costs of the same seeds, compared seed by seed; medians with 99 % intervals by order statistics.
struct PairedCosts {
  Interval median;               ///< of the strategy, over the pairs
  Interval reference_median;     ///< of the reference
  Interval ratio;                ///< of the ratios, seed by seed
  Interval difference;           ///< of the differences
  double total = 0.0;            ///< the strategy's costs of all pairs; infinite where it left one unsolved
  double reference_total = 0.0;  ///< the reference's costs of all pairs
  std::size_t pairs = 0;         ///< that have both figures
  std::size_t solved = 0;        ///< of these, those that the strategy solved
  std::size_t reference_solved = 0;
  std::size_t both_solved = 0;
  std::size_t less = 0;  ///< pairs in which the strategy costs less
  std::size_t greater = 0;
  std::size_t equal = 0;  ///< those that both failed among them
  double sign_p = 1.0;    ///< sign test of `less` against `greater`
  double holm_p = 1.0;    ///< the same, corrected for the comparisons that it is shown with
  /// Effect size: the share of pairs in which it costs less, minus the share in which it costs more, in [-1, 1].
  double effect = std::numeric_limits<double>::quiet_NaN();

  /// Of two finite medians only.
  [[nodiscard]] double ratio_of_medians() const;
  /// What all runs cost together, beside the reference. A few long runs decide it, where they hardly move a median.
  /// NaN where both left runs unsolved, or without pairs.
  [[nodiscard]] double ratio_of_totals() const;
};
/// Throws Error for lists of different lengths.
PairedCosts paired_costs(std::span<const CensoredCost> mine, std::span<const CensoredCost> reference);

}  // namespace trellis
