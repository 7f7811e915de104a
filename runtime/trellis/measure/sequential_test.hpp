// SPDX-License-Identifier: GPL-3.0-or-later
// Whether a part of a strategy pays, from costs with and without it: a sequential test that may stop after any pair.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include <trellis/measure/censored_cost.hpp>

namespace trellis {

/// Both errors of a sequential verdict: a wrong direction, and a wrong "no difference".
inline constexpr double sequential_error = 0.05;
/// A ratio between its inverse and this one is no difference that a user notices.
inline constexpr double least_difference = 1.25;
/// The most pairs of a test of an experiment with so many seeds: those, and the seeds after them.
inline std::size_t most_tested_pairs(std::size_t seeds) { return std::max<std::size_t>(2 * seeds, 20); }
/// No forecast is of more pairs.
inline constexpr std::size_t most_forecast = 200;

/// What is known of the ratio of two costs. A run that was cut off leaves an interval.
struct RatioBracket {
  double lo = 0.0;
  double hi = std::numeric_limits<double>::infinity();
};

/// Returns the bracket of with / without. A run without a path costs infinitely much, and two of them cost the same; a
/// run that was cut off costs at least what it spent.
RatioBracket ratio_bracket(const CensoredCost& with, const CensoredCost& without);

/// The same of runs that cost 1 where they find a path.
RatioBracket solved_bracket(const CensoredCost& with, const CensoredCost& without);

/// Counts over pairs.
struct PairCounts {
  std::size_t pairs = 0;
  std::size_t less = 0;     ///< the ratio is certainly below 1
  std::size_t greater = 0;  ///< the ratio is certainly above 1
  std::size_t equal = 0;    ///< the ratio is certainly 1
  std::size_t below = 0;    ///< the ratio is certainly below `least_difference`
  std::size_t above = 0;    ///< the ratio is certainly above 1 / `least_difference`
  void add(const RatioBracket& ratio);
};
PairCounts count_pairs(std::span<const RatioBracket> ratios);

/// Returns the wealth of a bettor who begins with 1 and bets on wins, in equal parts at 0.2, 0.4, 0.6, 0.8 and 1 of the
/// wealth. Where wins are at most as likely as losses, whatever came before, its expectation is at most 1 at each time,
/// and it ever reaches x with a probability of at most 1 / x (Ville's inequality).
double e_value(std::size_t wins, std::size_t losses);

enum class SequentialDecision : std::uint8_t {
  open,
  less,           ///< the part pays
  greater,        ///< the part costs
  no_difference,  ///< the median ratio is between 1 / least_difference and least_difference
};

/// Decides the open ones of a family of tests by their counts so far. With K tests of which r have a direction, one has
/// a direction where the e-value of its wins or of its losses is at least 40 (K - r): Holm's procedure, so that at most
/// 5 % of families ever get a wrong direction, however many pairs follow. There is no difference where the e-values of
/// `below` and of `above` are both at least 40 K.
/// \param counts     of each test; a test without pairs does not belong to the family
/// \param decisions  receives the new decisions
void decide(std::span<const PairCounts> counts, std::span<SequentialDecision> decisions);

/// The same round by round: in each, every open test that has a further pair takes it, then `decide` decides.
/// \param ratios  of each test, in the order in which they were observed
std::vector<SequentialDecision> decide_in_rounds(std::span<const std::vector<RatioBracket>> ratios);

/// The median of ratios, and its interval of 95 %.
struct MedianRatio {
  RatioBracket median;    ///< the lower median; a bracket where a run was cut off
  RatioBracket interval;  ///< it holds at every time at once with 95 %, so that the runs may stop at any time
};
/// Lower end: the j-th smallest `lo`, upper end: the j-th largest `hi`, with j the least number of losses in m pairs
/// whose e-value is below 40. Without such a j: 0 and infinity.
MedianRatio median_ratio(std::span<const RatioBracket> ratios);

/// Returns the least number of pairs, beyond those there are, at which a test has a direction with a probability of 80
/// %: each sign is drawn from an urn with the signs so far and one of each (Polya's), ties come in proportion. 0 where
/// that takes more than `most_forecast` pairs.
/// \param threshold  of the e-value
std::size_t forecast_pairs(const PairCounts& counts, double threshold);
/// Returns the threshold of the e-value for one of so many undecided tests.
double decisive_e_value(std::size_t tests);

}  // namespace trellis
