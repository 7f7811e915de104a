// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/measure/group_correlation.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <boost/math/distributions/normal.hpp>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <limits>

#include <trellis/base/error.hpp>
#include <trellis/base/random.hpp>

namespace trellis {

namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr std::size_t least_pairs = 3;
constexpr std::size_t samples = 10000;

/// The sums of products of scaled ranks, of one group or of several.
struct Sums {
  double ab = 0.0;
  double aa = 0.0;
  double bb = 0.0;

  void add(const Sums& other) {
    ab += other.ab;
    aa += other.aa;
    bb += other.bb;
  }
  [[nodiscard]] double rho() const { return aa > 0.0 && bb > 0.0 ? ab / std::sqrt(aa * bb) : nan; }
};

/// Zero for a group that does not count.
Sums sums_of(const PairGroup& group) {
  if (group.a.size() != group.b.size()) {
    throw Error(
        fmt::format("rank correlation: lists of {} and {} figures are no pairs", group.a.size(), group.b.size()));
  }
  std::vector<double> a;
  std::vector<double> b;
  for (std::size_t i = 0; i < group.a.size(); ++i) {
    if (std::isnan(group.a[i]) || std::isnan(group.b[i])) continue;
    a.push_back(group.a[i]);
    b.push_back(group.b[i]);
  }
  if (a.size() < least_pairs) return {};
  const std::vector<double> x = ranks(a);
  const std::vector<double> y = ranks(b);
  const auto most = static_cast<double>(a.size() - 1);
  const auto scaled = [most](double rank) { return (rank - 1.0) / most - 0.5; };
  Sums sums;
  for (std::size_t i = 0; i < x.size(); ++i) {
    sums.add({scaled(x[i]) * scaled(y[i]), scaled(x[i]) * scaled(x[i]), scaled(y[i]) * scaled(y[i])});
  }
  return sums.aa > 0.0 && sums.bb > 0.0 ? sums : Sums{};
}

/// Returns the two ends by percentiles of the samples, expanded for few groups.
Interval percentiles(double value, std::vector<double> resampled, std::size_t groups, double confidence) {
  if (!(confidence > 0.0 && confidence < 1.0)) {
    throw Error(fmt::format("interval: the confidence must be in (0, 1), got {:g}", confidence));
  }
  Interval result{.value = value, .n = groups};
  std::erase_if(resampled, [](double x) { return std::isnan(x); });
  if (groups < least_groups_for_interval || resampled.empty()) return result;
  std::sort(resampled.begin(), resampled.end());
  const auto n = static_cast<double>(groups);
  const double t = boost::math::quantile(boost::math::students_t(n - 1.0), 0.5 + 0.5 * confidence);
  const double tail = boost::math::cdf(boost::math::normal(), -std::sqrt(n / (n - 1.0)) * t);
  const auto last = static_cast<double>(resampled.size() - 1);
  result.lo = resampled[static_cast<std::size_t>(std::floor(tail * last))];
  result.hi = resampled[static_cast<std::size_t>(std::ceil((1.0 - tail) * last))];
  return result;
}

}  // namespace

GroupCorrelation group_rank_correlation(std::span<const PairGroup> groups, double confidence) {
  std::vector<Sums> sums;
  sums.reserve(groups.size());
  for (const PairGroup& group : groups) sums.push_back(sums_of(group));
  Sums all;
  std::size_t counted = 0;
  for (const Sums& one : sums) {
    all.add(one);
    counted += one.aa > 0.0 ? 1 : 0;
  }
  GroupCorrelation result;
  result.groups = groups.size();
  result.resampled.reserve(samples);
  // Groups that do not count are drawn too, so that the samples of two correlations are of the same groups.
  Stream random(0, "", "bootstrap");
  for (std::size_t s = 0; s < samples && !sums.empty(); ++s) {
    Sums sample;
    for (std::size_t g = 0; g < sums.size(); ++g) sample.add(sums[random.below(sums.size())]);
    result.resampled.push_back(sample.rho());
  }
  result.rho = percentiles(all.rho(), result.resampled, counted, confidence);
  return result;
}

Interval correlation_difference(const GroupCorrelation& a, const GroupCorrelation& b, double confidence) {
  if (a.groups != b.groups) {
    throw Error(
        fmt::format("rank correlation: no difference of one over {} groups and one over {}", a.groups, b.groups));
  }
  std::vector<double> differences;
  differences.reserve(a.resampled.size());
  for (std::size_t s = 0; s < a.resampled.size(); ++s) differences.push_back(a.resampled[s] - b.resampled[s]);
  return percentiles(a.rho.value - b.rho.value, std::move(differences), std::min(a.rho.n, b.rho.n), confidence);
}

}  // namespace trellis
