// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/motion/timed_path.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <trellis/base/error.hpp>

namespace trellis {

namespace {

double length_of(const std::vector<double>& v) {
  double sum = 0.0;
  for (const double x : v) sum += x * x;
  return std::sqrt(sum);
}

/// Whether a step continues in the direction of the ones before it.
bool straight_on(const std::vector<double>& before, const std::vector<double>& step) {
  constexpr double rounding = 1e-9;
  const double a = length_of(before);
  const double b = length_of(step);
  double off = 0.0;
  for (std::size_t j = 0; j < step.size(); ++j) off = std::max(off, std::abs(before[j] / a - step[j] / b));
  return off <= rounding;
}

}  // namespace

double TimedPath::Leg::time_of(double share) const {
  const double ramped = 0.5 * speed * ramp();  // share of the leg while the speed grows
  if (share >= 1.0) return duration;
  if (share <= ramped) return std::sqrt(2.0 * std::max(share, 0.0) / acceleration);
  if (share >= 1.0 - ramped) return duration - std::sqrt(2.0 * (1.0 - share) / acceleration);
  return ramp() + (share - ramped) / speed;
}

TimedPath::TimedPath(const Space& space, const Configurations& path, RateLimits limits) {
  const std::size_t n = space.dimension();
  const auto positive = [](double x) { return x > 0.0 && std::isfinite(x); };
  if (!space.flat() || path.empty() || limits.velocity.size() != n || limits.acceleration.size() != n ||
      !std::all_of(limits.velocity.begin(), limits.velocity.end(), positive) ||
      !std::all_of(limits.acceleration.begin(), limits.acceleration.end(), positive)) {
    throw Fault("a timed path needs a flat space, a path, and a speed and an acceleration of each coordinate");
  }
  start_.assign(path[0].begin(), path[0].end());
  Configuration at = start_;  // continued beyond the bounds of coordinates that wrap
  std::vector<double> step(n);
  std::vector<double> change(n, 0.0);
  std::vector<std::pair<std::size_t, double>> marks;  // points of the path, with their lengths along the present leg
  const auto finish = [&] {
    const double length = length_of(change);
    if (length > 0.0) {
      add_leg(at, change, limits);
      for (std::size_t j = 0; j < n; ++j) at[j] += change[j];
      const Leg& leg = legs_.back();
      for (const auto& [point, done] : marks) times_[point] = leg.begin + leg.time_of(done / length);
    } else {
      for (const auto& [point, done] : marks) times_[point] = duration_;
    }
    marks.clear();
    std::fill(change.begin(), change.end(), 0.0);
  };
  times_.assign(path.size(), 0.0);
  for (std::size_t i = 1; i < path.size(); ++i) {
    space.difference(path[i - 1], path[i], step);
    const double length = length_of(step);
    if (length > 0.0 && length_of(change) > 0.0 && !straight_on(change, step)) finish();
    for (std::size_t j = 0; j < n; ++j) change[j] += step[j];
    marks.emplace_back(i, length_of(change));
  }
  finish();
}

void TimedPath::add_leg(Configuration from, std::vector<double> change, const RateLimits& limits) {
  Leg leg{std::move(from), std::move(change)};
  double speed = std::numeric_limits<double>::infinity();
  double acceleration = std::numeric_limits<double>::infinity();
  for (std::size_t j = 0; j < leg.change.size(); ++j) {
    const double far = std::abs(leg.change[j]);
    if (!(far > 0.0)) continue;
    speed = std::min(speed, limits.velocity[j] / far);
    acceleration = std::min(acceleration, limits.acceleration[j] / far);
  }
  // Where the leg is too short for the greatest speed, it slows down as soon as it has reached the middle.
  leg.speed = std::min(speed, std::sqrt(acceleration));
  leg.acceleration = acceleration;
  leg.begin = duration_;
  leg.duration = 1.0 / leg.speed + leg.ramp();
  duration_ += leg.duration;
  legs_.push_back(std::move(leg));
}

TimedPath::Sample TimedPath::at(double time) const {
  Sample sample{std::clamp(time, 0.0, duration_), start_, std::vector<double>(start_.size(), 0.0)};
  if (legs_.empty()) return sample;
  const auto after =
      std::upper_bound(legs_.begin(), legs_.end(), sample.time, [](double t, const Leg& leg) { return t < leg.begin; });
  const Leg& leg = *(after == legs_.begin() ? after : after - 1);
  const double t = std::clamp(sample.time - leg.begin, 0.0, leg.duration);
  double share = 0.0;
  double rate = 0.0;
  if (t < leg.ramp()) {
    share = 0.5 * leg.acceleration * t * t;
    rate = leg.acceleration * t;
  } else if (t > leg.duration - leg.ramp()) {
    const double left = leg.duration - t;
    share = 1.0 - 0.5 * leg.acceleration * left * left;
    rate = leg.acceleration * left;
  } else {
    share = leg.speed * (t - 0.5 * leg.ramp());
    rate = leg.speed;
  }
  for (std::size_t j = 0; j < start_.size(); ++j) {
    sample.position[j] = leg.from[j] + share * leg.change[j];
    sample.velocity[j] = rate * leg.change[j];
  }
  return sample;
}

std::vector<TimedPath::Sample> TimedPath::samples(double spacing) const {
  std::vector<double> knots = times_;
  for (const Leg& leg : legs_) {
    for (const double t : {0.0, leg.ramp(), leg.duration - leg.ramp(), leg.duration}) knots.push_back(leg.begin + t);
  }
  std::sort(knots.begin(), knots.end());
  std::vector<Sample> all = {at(0.0)};
  constexpr double rounding = 1e-9;  // seconds
  for (const double knot : knots) {
    const double before = all.back().time;
    if (knot - before <= rounding) continue;
    const auto parts = static_cast<std::size_t>(std::ceil((knot - before) / spacing - rounding));
    for (std::size_t k = 1; k < parts; ++k) {
      all.push_back(at(before + (knot - before) * static_cast<double>(k) / static_cast<double>(parts)));
    }
    all.push_back(at(knot));
  }
  // The last one is the end, at rest, without rounding.
  if (!legs_.empty()) {
    Sample& end = all.back();
    end.time = duration_;
    for (std::size_t j = 0; j < start_.size(); ++j) end.position[j] = legs_.back().from[j] + legs_.back().change[j];
    std::fill(end.velocity.begin(), end.velocity.end(), 0.0);
  }
  return all;
}

}  // namespace trellis
