// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <span>

namespace trellis {

/// A bound of the median of whatever the values were drawn from, whatever its distribution: one of the values, that the
/// sign test puts beyond the median with the confidence asked for, or an infinity where there are too few of them.
/// Infinite values take part; throws Error for a NaN and for a confidence outside of (0, 1).
double median_upper(std::span<const double> values, double confidence = 0.95);
double median_lower(std::span<const double> values, double confidence = 0.95);

/// How many values it takes for a finite bound.
std::size_t least_for_median(double confidence = 0.95);

}  // namespace trellis
