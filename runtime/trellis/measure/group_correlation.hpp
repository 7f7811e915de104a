// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <trellis/measure/statistics.hpp>

namespace trellis {

/// Two lists of values that are paired, of one group: as two quantities of the strategies on one problem.
struct PairGroup {
  std::vector<double> a;
  std::vector<double> b;
};

/// Fewer groups have no interval: it would contain the correlation too seldom.
inline constexpr std::size_t least_groups_for_interval = 6;

/// A rank correlation within groups.
struct GroupCorrelation {
  Interval rho;                   ///< in [-1, 1]; n: the number of groups that count
  std::size_t groups = 0;         ///< all of them
  std::vector<double> resampled;  ///< its values in the bootstrap's samples of groups; NaN: no group of these counts
};

/// Returns Spearman's rank correlation within groups: each group's values are replaced by their ranks there, scaled
/// to [-1/2, 1/2], ties sharing their mean rank, and the pairs of ranks of all groups are correlated together.
/// Differences between groups have no influence, and each pair counts about as much in a large group as in a small
/// one. Omits pairs with a NaN; infinite values rank as the largest. Groups of fewer than three pairs, and those where
/// all values of a list are equal, do not count. NaN where none counts.
///
/// The interval is a bootstrap's over the groups, so that pairs of one group may depend on each other: the percentiles
/// of 10 000 samples of groups with replacement, expanded for few groups as Student's quantiles are wider than normal
/// ones (Hesterberg 2015, "expanded percentile interval"). It is deterministic. Fewer than
/// `least_groups_for_interval` groups have none.
/// \throws Error for lists of different lengths.
GroupCorrelation group_rank_correlation(std::span<const PairGroup> groups, double confidence = 0.95);

/// Returns the difference of two correlations over the same groups, a - b, with an interval from the same bootstrap.
/// \throws Error for different numbers of groups.
Interval correlation_difference(const GroupCorrelation& a, const GroupCorrelation& b, double confidence = 0.95);

}  // namespace trellis
