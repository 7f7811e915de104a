// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/measure/statistics.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <boost/math/distributions/binomial.hpp>
#include <boost/math/distributions/normal.hpp>
#include <boost/math/distributions/students_t.hpp>
#include <boost/math/statistics/bivariate_statistics.hpp>
#include <cmath>
#include <iterator>
#include <vector>

#include <trellis/base/error.hpp>

namespace trellis {

namespace {

/// Returns the probability below the upper end of a two-sided interval.
double upper_tail(double confidence) {
  if (!(confidence > 0.0 && confidence < 1.0)) {
    throw Error(fmt::format("interval: the confidence must be in (0, 1), got {:g}", confidence));
  }
  return 0.5 + 0.5 * confidence;
}

}  // namespace

Interval student_interval(std::span<const double> values, double confidence) {
  const double tail = upper_tail(confidence);
  Interval result;
  std::vector<double> finite;
  for (const double v : values) {
    if (std::isfinite(v)) {
      finite.push_back(v);
    } else if (!std::isnan(v)) {
      ++result.infinite;
    }
  }
  result.n = finite.size();
  if (result.infinite > 0) {
    result.value = median(values);
    return result;
  }
  if (finite.empty()) return result;
  const auto n = static_cast<double>(finite.size());
  double sum = 0.0;
  for (const double v : finite) sum += v;
  result.value = sum / n;
  if (finite.size() < least_for_interval) return result;
  double squares = 0.0;
  for (const double v : finite) squares += (v - result.value) * (v - result.value);
  const double error = std::sqrt(squares / (n - 1.0) / n);
  const double half = boost::math::quantile(boost::math::students_t(n - 1.0), tail) * error;
  result.lo = result.value - half;
  result.hi = result.value + half;
  return result;
}

Interval wilson_interval(std::size_t successes, std::size_t trials, double confidence) {
  const double tail = upper_tail(confidence);
  if (successes > trials) {
    throw Error(fmt::format("interval: {} successes in {} trials", successes, trials));
  }
  Interval result;
  result.n = trials;
  if (trials == 0) return result;
  const auto n = static_cast<double>(trials);
  const double share = static_cast<double>(successes) / n;
  const double z = boost::math::quantile(boost::math::normal(), tail);
  const double centre = share + z * z / (2.0 * n);
  const double half = z * std::sqrt(share * (1.0 - share) / n + z * z / (4.0 * n * n));
  const double scale = 1.0 + z * z / n;
  result.value = share;
  result.lo = successes == 0 ? 0.0 : (centre - half) / scale;
  result.hi = successes == trials ? 1.0 : (centre + half) / scale;
  return result;
}

Interval newcombe_interval(Share share, Share reference, double confidence) {
  const Interval mine = wilson_interval(share.successes, share.trials, confidence);
  const Interval other = wilson_interval(reference.successes, reference.trials, confidence);
  Interval result;
  result.n = std::min(mine.n, other.n);
  if (result.n == 0) return result;
  result.value = mine.value - other.value;
  result.lo = result.value - std::hypot(mine.value - mine.lo, other.hi - other.value);
  result.hi = result.value + std::hypot(mine.hi - mine.value, other.value - other.lo);
  return result;
}

double sign_test(std::size_t less, std::size_t greater) {
  if (less + greater == 0) return 1.0;
  const boost::math::binomial coin(static_cast<double>(less + greater), 0.5);
  return std::min(1.0, 2.0 * boost::math::cdf(coin, static_cast<double>(std::min(less, greater))));
}

std::vector<double> holm(std::span<const double> p) {
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < p.size(); ++i) {
    if (!std::isnan(p[i])) order.push_back(i);
  }
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return p[a] < p[b]; });
  std::vector<double> adjusted(p.begin(), p.end());
  double largest = 0.0;  // keeps the corrected p values in the order of the given ones
  for (std::size_t k = 0; k < order.size(); ++k) {
    largest = std::max(largest, std::min(1.0, static_cast<double>(order.size() - k) * p[order[k]]));
    adjusted[order[k]] = largest;
  }
  return adjusted;
}

Paired paired(std::span<const double> a, std::span<const double> b, double confidence) {
  if (a.size() != b.size()) {
    throw Error(fmt::format("paired: {} figures against {}; the runs must be the same", a.size(), b.size()));
  }
  Paired result;
  std::vector<double> differences;
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (std::isnan(a[i]) || std::isnan(b[i])) continue;
    result.less += b[i] < a[i] ? 1 : 0;
    result.greater += b[i] > a[i] ? 1 : 0;
    result.equal += b[i] == a[i] ? 1 : 0;
    // Two infinite values have no defined difference.
    if (!(std::isinf(a[i]) && std::isinf(b[i]))) differences.push_back(b[i] - a[i]);
  }
  result.difference = student_interval(differences, confidence);
  result.sign_p = result.holm_p = sign_test(result.less, result.greater);
  return result;
}

std::vector<double> ranks(std::span<const double> values) {
  std::vector<double> result;
  result.reserve(values.size());
  for (const double v : values) {
    const auto below = std::count_if(values.begin(), values.end(), [&](double w) { return w < v; });
    const auto equal = std::count(values.begin(), values.end(), v);
    result.push_back(static_cast<double>(below) + 0.5 * static_cast<double>(equal + 1));
  }
  return result;
}

double rank_correlation(std::span<const double> a, std::span<const double> b) {
  if (a.size() != b.size()) {
    throw Error(fmt::format("rank correlation: lists of {} and {} figures are no pairs", a.size(), b.size()));
  }
  std::vector<double> left;
  std::vector<double> right;
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (std::isnan(a[i]) || std::isnan(b[i])) continue;
    left.push_back(a[i]);
    right.push_back(b[i]);
  }
  constexpr std::size_t least_pairs = 3;
  if (left.size() < least_pairs) return std::numeric_limits<double>::quiet_NaN();
  const std::vector<double> x = ranks(left);
  const std::vector<double> y = ranks(right);
  const auto same = [](const std::vector<double>& r) {
    return std::all_of(r.begin(), r.end(), [&](double v) { return v == r.front(); });
  };
  if (same(x) || same(y)) return std::numeric_limits<double>::quiet_NaN();
  return boost::math::statistics::correlation_coefficient(x, y);
}

double median(std::span<const double> values) {
  std::vector<double> known;
  std::copy_if(values.begin(), values.end(), std::back_inserter(known), [](double v) { return !std::isnan(v); });
  if (known.empty()) return std::numeric_limits<double>::quiet_NaN();
  std::sort(known.begin(), known.end());
  const std::size_t middle = known.size() / 2;
  if (known.size() % 2 == 1 || known[middle - 1] == known[middle]) return known[middle];
  return 0.5 * (known[middle - 1] + known[middle]);
}

}  // namespace trellis
