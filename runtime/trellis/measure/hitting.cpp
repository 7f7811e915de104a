// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/measure/hitting.hpp>

#include <algorithm>
#include <boost/math/distributions/binomial.hpp>
#include <cmath>
#include <map>
#include <utility>

#include <trellis/base/polling.hpp>
#include <trellis/measure/cut_ball.hpp>

namespace trellis {

namespace measure {

namespace {

constexpr std::size_t ball_points = 1024;  // of the share of a ball that lies in C
constexpr double outside = 0.05;           // of the intervals of all balls together

/// Returns log(sum(exp(x))).
double log_sum(std::span<const double> logs) {
  const double most = *std::max_element(logs.begin(), logs.end());
  double sum = 0.0;
  for (const double x : logs) sum += std::exp(x - most);
  return most + std::log(sum);
}

Configurations projected(const Configurations& path, const std::vector<std::size_t>& columns) {
  if (columns.empty()) return path;
  Configurations result(columns.size());
  result.reserve(path.size());
  Configuration row(columns.size());
  for (std::size_t i = 0; i < path.size(); ++i) {
    for (std::size_t j = 0; j < columns.size(); ++j) row[j] = path[i][columns[j]];
    result.push(row);
  }
  return result;
}

/// The ends of Clopper and Pearson's interval of a share.
struct Ends {
  double lo;
  double hi;
};
Ends clopper_pearson(std::size_t count, std::size_t samples, double each_side) {
  using Binomial = boost::math::binomial_distribution<>;
  const auto n = static_cast<double>(samples);
  const auto c = static_cast<double>(count);
  return {count == 0 ? 0.0 : Binomial::find_lower_bound_on_p(n, c, each_side),
          count == samples ? 1.0 : Binomial::find_upper_bound_on_p(n, c, each_side)};
}

}  // namespace

Balls::Balls(const Space& space, const Configurations& path, const std::vector<std::size_t>& columns, double radius)
    : part_(columns.empty() ? space : space.part(columns, "position")),
      columns_(columns),
      radius_(radius),
      centres_(part_) {
  const Configurations points = projected(path, columns);
  std::vector<double> ends = {0.0};  // the arc length at each configuration
  for (std::size_t i = 1; i < points.size(); ++i) {
    ends.push_back(ends.back() + part_.distance(points[i - 1], points[i]));
  }
  length_ = ends.back();
  const std::size_t count = std::max<std::size_t>(1, static_cast<std::size_t>(std::ceil(2.0 * length_ / radius)));
  const Frame frame(part_);
  const CutBall ball(frame, ball_points);
  Configuration centre(part_.dimension());
  std::vector<double> row(part_.dimension());
  std::size_t segment = 1;
  for (std::size_t i = 0; i < count; ++i) {
    poll(i);
    arcs_.push_back(length_ * (static_cast<double>(i) + 0.5) / static_cast<double>(count));
    while (segment + 1 < ends.size() && ends[segment] < arcs_.back()) ++segment;
    if (segment < ends.size()) {
      const double step = ends[segment] - ends[segment - 1];
      const double t = step > 0.0 ? std::clamp((arcs_.back() - ends[segment - 1]) / step, 0.0, 1.0) : 0.0;
      part_.interpolate(points[segment - 1], points[segment], t, centre);
    } else {
      std::copy(points.front().begin(), points.front().end(), centre.begin());
    }
    part_.normalise(centre);
    centres_.add(centre);
    frame.to_metric(centre, row);
    log_shares_.push_back(std::min(0.0, ball.log_volume(row, radius) - part_.log_volume()));
  }
}

void Balls::count(View sample, std::span<std::size_t> counts) const {
  thread_local std::vector<NearestIndex::Neighbour> found;
  thread_local Configuration row;
  View at = sample;
  if (!columns_.empty()) {
    row.clear();
    for (const std::size_t column : columns_) row.push_back(sample[column]);
    at = row;
  }
  centres_.within(at, radius_, found);
  for (const NearestIndex::Neighbour& one : found) ++counts[one.id];
}

BallHits Balls::hits(std::span<const std::size_t> counts, std::size_t samples, bool interval) const {
  BallHits result;
  if (samples == 0) return result;
  const auto n = static_cast<double>(samples);
  std::vector<double> uniform;  // log(1/u)
  std::vector<double> these;    // log(1/q)
  for (std::size_t i = 0; i < size(); ++i) {
    const auto c = static_cast<double>(counts[i]);
    const double above = std::log1p(c) - std::log1p(n * std::exp(log_shares_[i]));  // log(q/u)
    uniform.push_back(-log_shares_[i]);
    these.push_back(-log_shares_[i] - above);
    if (i == 0 || above < result.bottleneck) {
      result.bottleneck = above;
      result.at = arcs_[i];
    }
  }
  result.hitting = log_sum(uniform) - log_sum(these);
  if (!interval) return result;
  std::map<std::size_t, Ends> known;  // by count
  const double each_side = 0.5 * outside / static_cast<double>(size());
  for (std::size_t i = 0; i < size(); ++i) {
    auto found = known.find(counts[i]);
    if (found == known.end()) found = known.emplace(counts[i], clopper_pearson(counts[i], samples, each_side)).first;
    const double lo = std::log(found->second.lo) - log_shares_[i];
    const double hi = std::log(found->second.hi) - log_shares_[i];
    result.bottleneck_lo = i == 0 ? lo : std::min(result.bottleneck_lo, lo);
    result.bottleneck_hi = i == 0 ? hi : std::min(result.bottleneck_hi, hi);
  }
  // Where uniform samples would hardly hit a ball, q_i is nearer to u_i than the counts allow.
  result.bottleneck = std::clamp(result.bottleneck, result.bottleneck_lo, result.bottleneck_hi);
  return result;
}

}  // namespace measure

PathBalls::PathBalls(const Space& space, const Configurations& path, const std::vector<std::size_t>& position,
                     double delta)
    : space_(space), position_(space, path, position, delta), full_(space, path, {}, full_radius * delta) {}

Hitting PathBalls::hitting(const Configurations& samples, View goal, bool interval) const {
  std::vector<std::size_t> position(position_.size(), 0);
  std::vector<std::size_t> full(full_.size(), 0);
  std::size_t counted = 0;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    poll(i);
    const View x = samples[i];
    if (!goal.empty() && std::equal(x.begin(), x.end(), goal.begin(), goal.end())) continue;
    ++counted;
    if (!space_.contains(x)) continue;
    position_.count(x, position);
    full_.count(x, full);
  }
  Hitting result{position_.hits(position, counted, interval), full_.hits(full, counted, interval)};
  result.length = position_.length();
  result.samples = static_cast<double>(counted);
  return result;
}

namespace {

BallHits mean_hits(std::span<const Hitting> all, BallHits Hitting::*metric) {
  BallHits result;
  double with = 0.0;
  for (const Hitting& one : all) {
    const BallHits& hits = one.*metric;
    if (std::isnan(hits.hitting)) continue;
    if (with == 0.0) {
      result = hits;
      result.hitting_lo = result.hitting_hi = std::numeric_limits<double>::quiet_NaN();
    }
    with += 1.0;
    result.hitting += (hits.hitting - result.hitting) / with;
  }
  return result;
}

}  // namespace

Hitting mean(std::span<const Hitting> hits) {
  Hitting result{mean_hits(hits, &Hitting::position), mean_hits(hits, &Hitting::full)};
  for (const Hitting& one : hits) {
    if (std::isnan(one.position.hitting)) continue;
    if (std::isnan(result.length)) result.length = one.length;
    result.samples = std::isnan(result.samples) ? one.samples : std::min(result.samples, one.samples);
  }
  return result;
}

}  // namespace trellis
