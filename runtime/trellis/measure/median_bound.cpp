// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/measure/median_bound.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <boost/math/distributions/binomial.hpp>
#include <cmath>
#include <iterator>
#include <limits>
#include <vector>

#include <trellis/base/error.hpp>

namespace trellis {

namespace {

void check_confidence(double confidence) {
  if (confidence > 0.0 && confidence < 1.0) return;
  throw Error(fmt::format("bound of a median: the confidence must be in (0, 1), got {:g}", confidence));
}

/// Returns the rank, from 1, of the value that bounds the median from above: the least k such that n fair coins show
/// fewer than k heads with that probability. n + 1 where no rank suffices.
std::size_t place_of_bound(std::size_t n, double confidence) {
  if (n == 0) return 1;
  const boost::math::binomial coins(static_cast<double>(n), 0.5);
  std::size_t k = 1;
  while (k <= n && boost::math::cdf(coins, static_cast<double>(k - 1)) < confidence) ++k;
  return k;
}

}  // namespace

double median_upper(std::span<const double> values, double confidence) {
  check_confidence(confidence);
  if (std::any_of(values.begin(), values.end(), [](double v) { return std::isnan(v); })) {
    throw Error("bound of a median: there is a value that is no number");
  }
  const std::size_t place = place_of_bound(values.size(), confidence);
  if (place > values.size()) return std::numeric_limits<double>::infinity();
  std::vector<double> sorted(values.begin(), values.end());
  std::sort(sorted.begin(), sorted.end());
  return sorted[place - 1];
}

double median_lower(std::span<const double> values, double confidence) {
  std::vector<double> mirrored;
  mirrored.reserve(values.size());
  for (const double v : values) mirrored.push_back(-v);
  return -median_upper(mirrored, confidence);
}

Interval median_interval(std::span<const double> values, double confidence) {
  check_confidence(confidence);
  std::vector<double> known;
  std::copy_if(values.begin(), values.end(), std::back_inserter(known), [](double v) { return !std::isnan(v); });
  Interval result;
  result.value = median(known);
  result.n = known.size();
  result.infinite =
      static_cast<std::size_t>(std::count_if(known.begin(), known.end(), [](double v) { return std::isinf(v); }));
  if (known.size() < least_for_interval) return result;
  const double each_side = 0.5 + 0.5 * confidence;
  result.lo = median_lower(known, each_side);
  result.hi = median_upper(known, each_side);
  return result;
}

std::size_t least_for_median(double confidence) {
  check_confidence(confidence);
  std::size_t n = 1;
  while (place_of_bound(n, confidence) > n) ++n;
  return n;
}

}  // namespace trellis
