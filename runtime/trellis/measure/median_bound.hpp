// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <span>

#include <trellis/measure/statistics.hpp>

namespace trellis {

/// A bound of the median of whatever the values were drawn from, whatever its distribution: one of the values, that the
/// sign test puts beyond the median with the confidence asked for, or an infinity where there are too few of them.
/// Infinite values take part; throws Error for a NaN and for a confidence outside of (0, 1).
double median_upper(std::span<const double> values, double confidence = 0.95);
double median_lower(std::span<const double> values, double confidence = 0.95);

/// The median with its distribution-free interval by order statistics: two bounds, each with half of the doubt.
/// Infinite values take part and NaNs are left out, so the median and an end may be infinite; fewer than
/// `least_for_interval` values have no interval. `n` counts the infinite values too.
Interval median_interval(std::span<const double> values, double confidence = 0.99);

/// How many values it takes for a finite bound.
std::size_t least_for_median(double confidence = 0.95);

}  // namespace trellis
