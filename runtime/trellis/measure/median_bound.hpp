// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <span>

#include <trellis/measure/statistics.hpp>

namespace trellis {

/// Returns an upper bound of the median of the values' distribution, whatever that distribution is. The bound is the
/// value that the sign test places beyond the median with the given confidence, or infinity where there are too few
/// values. Includes infinite values.
/// \throws Error for a NaN and for a confidence outside of (0, 1).
double median_upper(std::span<const double> values, double confidence = 0.95);
double median_lower(std::span<const double> values, double confidence = 0.95);

/// Returns the median with its distribution-free interval by order statistics: two bounds, each with half of the error
/// probability. Includes infinite values and omits NaNs, so the median and a bound may be infinite. Fewer than
/// `least_for_interval` values have no interval. `n` counts the infinite values too.
Interval median_interval(std::span<const double> values, double confidence = 0.95);

/// Returns the least number of values with a finite bound.
std::size_t least_for_median(double confidence = 0.95);

}  // namespace trellis
