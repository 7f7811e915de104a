// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <limits>
#include <span>
#include <vector>

namespace trellis {

/// Fewer values than these have no interval: it would say more of its assumptions than of them.
inline constexpr std::size_t least_for_interval = 5;

/// A figure with its interval; NaN where it does not exist.
struct Interval {
  double value = std::numeric_limits<double>::quiet_NaN();
  double lo = std::numeric_limits<double>::quiet_NaN();
  double hi = std::numeric_limits<double>::quiet_NaN();
  std::size_t n = 0;         ///< values that entered
  std::size_t infinite = 0;  ///< values left out because they are infinite; then `value` is the median of all
};

/// Mean and Student t interval over runs. NaNs are left out; fewer than `least_for_interval` values have no interval.
/// Infinite values are never averaged: with any of them the value is the median of all and there is no interval.
Interval student_interval(std::span<const double> values, double confidence = 0.95);

/// Share of successes with Wilson's score interval.
Interval wilson_interval(std::size_t successes, std::size_t trials, double confidence = 0.95);

/// A share less another one, with Newcombe's interval: Wilson's of both, combined (Newcombe 1998, method 10). It lies
/// in
/// [-1, 1]. `n` is the smaller number of trials; NaN without trials on either side.
struct Share {
  std::size_t successes = 0;
  std::size_t trials = 0;
};
Interval newcombe_interval(Share share, Share reference, double confidence = 0.95);

/// Two-sided sign test: the chance of so lopsided a split, or a more lopsided one, if either sign were as likely; 1 for
/// no signs.
double sign_test(std::size_t less, std::size_t greater);

/// Holm's correction: p values of tests that are read together, adjusted so that the chance of any false finding among
/// those below a level is at most this level. NaNs stay, and do not count as tests.
std::vector<double> holm(std::span<const double> p);

/// Two lists of figures of the same runs, compared run by run.
struct Paired {
  Interval difference;   ///< mean of b - a over the pairs, with Student's interval; never of infinite values
  std::size_t less = 0;  ///< pairs where b is less than a
  std::size_t greater = 0;
  std::size_t equal = 0;
  double sign_p = 1.0;  ///< of the pairs that differ
  double holm_p = 1.0;  ///< the same, corrected for the comparisons that it is shown with
};
/// Pairs where a figure is NaN are left out. Throws Error for lists of different lengths.
Paired paired(std::span<const double> a, std::span<const double> b, double confidence = 0.95);

/// Spearman's rank correlation, in [-1, 1]; ties share their mean rank. Pairs where a figure is NaN are left out; NaN
/// for fewer than three pairs, and where all figures of a list are equal. Throws Error for lists of different lengths.
double rank_correlation(std::span<const double> a, std::span<const double> b);

/// The median of the values that are not NaN; NaN without any.
double median(std::span<const double> values);

}  // namespace trellis
