// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <limits>
#include <span>
#include <vector>

namespace trellis {

/// Fewer values have no interval: it would depend more on its assumptions than on the values.
inline constexpr std::size_t least_for_interval = 5;

/// A statistic with its interval; NaN where it does not exist.
struct Interval {
  double value = std::numeric_limits<double>::quiet_NaN();
  double lo = std::numeric_limits<double>::quiet_NaN();
  double hi = std::numeric_limits<double>::quiet_NaN();
  std::size_t n = 0;         ///< number of values
  std::size_t infinite = 0;  ///< values left out because they are infinite; then `value` is the median of all
};

/// Returns the mean and Student's t interval over runs. Omits NaNs; fewer than `least_for_interval` values have no
/// interval. Never averages infinite values: with any of them the value is the median of all and there is no interval.
Interval student_interval(std::span<const double> values, double confidence = 0.95);

/// Returns the share of successes with Wilson's score interval.
Interval wilson_interval(std::size_t successes, std::size_t trials, double confidence = 0.95);

/// The difference of two shares with Newcombe's interval: Wilson's of both, combined (Newcombe 1998, method 10). It
/// lies in [-1, 1]. `n` is the smaller number of trials; NaN without trials on either side.
struct Share {
  std::size_t successes = 0;
  std::size_t trials = 0;
};
Interval newcombe_interval(Share share, Share reference, double confidence = 0.95);

/// Returns the p value of the two-sided sign test: the probability of a split at least as uneven if both signs are
/// equally likely; 1 for no signs.
double sign_test(std::size_t less, std::size_t greater);

/// Returns p values with Holm's correction for tests that a reader interprets together: the probability of any false
/// finding among those below a level is at most this level. Keeps NaNs, which do not count as tests.
std::vector<double> holm(std::span<const double> p);

/// Two lists of values of the same runs, paired by run.
struct Paired {
  Interval difference;   ///< mean of b - a over the pairs, with Student's interval; never of infinite values
  std::size_t less = 0;  ///< pairs where b is less than a
  std::size_t greater = 0;
  std::size_t equal = 0;
  double sign_p = 1.0;  ///< of the pairs that differ
  double holm_p = 1.0;  ///< the same with Holm's correction for the comparisons of one table
};
/// Omits pairs with a NaN. \throws Error for lists of different lengths.
Paired paired(std::span<const double> a, std::span<const double> b, double confidence = 0.95);

/// Returns the rank of each value, from 1; ties share their mean rank. No value is NaN.
std::vector<double> ranks(std::span<const double> values);

/// Returns Spearman's rank correlation, in [-1, 1]; ties share their mean rank. Omits pairs with a NaN; NaN for fewer
/// than three pairs, and where all values of a list are equal.
/// \throws Error for lists of different lengths.
double rank_correlation(std::span<const double> a, std::span<const double> b);

/// Returns the median of the values that are not NaN; NaN without any.
double median(std::span<const double> values);

}  // namespace trellis
