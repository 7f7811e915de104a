// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/space/space.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include <trellis/base/error.hpp>

namespace trellis {

namespace {

double shortest_difference(const Axis& axis, double delta) {
  const double period = axis.period();
  if (delta > 0.5 * period || delta <= -0.5 * period) {
    delta -= period * std::floor(delta / period);
    if (delta > 0.5 * period) delta -= period;
  }
  return delta;
}

double wrap(const Axis& axis, double x) {
  if (x >= axis.lo && x < axis.hi) return x;
  const double period = axis.period();
  double y = x - period * std::floor((x - axis.lo) / period);
  if (y >= axis.hi) y -= period;
  return y < axis.lo ? axis.lo : y;
}

double reflect_once(const Axis& axis, double x) {
  const double extent = axis.hi - axis.lo;
  double y = std::fmod(x - axis.lo, 2.0 * extent);
  if (y < 0.0) y += 2.0 * extent;
  return axis.lo + (y <= extent ? y : 2.0 * extent - y);
}

}  // namespace

Space::Space(std::string name, std::vector<Axis> axes) : name_(std::move(name)), axes_(std::move(axes)) {
  for (const auto& axis : axes_) {
    if (!std::isfinite(axis.lo) || !std::isfinite(axis.hi) || axis.hi <= axis.lo) {
      throw Error(fmt::format("space {}: axis '{}' needs finite bounds lo < hi, got [{}, {}]", name_, axis.name,
                              axis.lo, axis.hi));
    }
    if (!std::isfinite(axis.weight) || axis.weight <= 0.0) {
      throw Error(
          fmt::format("space {}: axis '{}' needs a weight greater than 0, got {}", name_, axis.name, axis.weight));
    }
  }
}

Space Space::euclidean(const std::vector<std::pair<double, double>>& bounds) {
  static constexpr std::array<const char*, 3> names = {"x", "y", "z"};
  std::vector<Axis> axes;
  for (std::size_t i = 0; i < bounds.size(); ++i) {
    axes.push_back(
        {i < names.size() ? names[i] : fmt::format("q{}", i + 1), bounds[i].first, bounds[i].second, 1.0, false});
  }
  return {fmt::format("R^{}", bounds.size()), std::move(axes)};
}

Space Space::so2(double weight, const std::string& name) {
  return {"SO(2)", {{name, -std::numbers::pi, std::numbers::pi, weight, true}}};
}

Space Space::se2(std::pair<double, double> x, std::pair<double, double> y, double weight) {
  return {"SE(2)",
          {{"x", x.first, x.second, 1.0, false},
           {"y", y.first, y.second, 1.0, false},
           {"theta", -std::numbers::pi, std::numbers::pi, weight, true}}};
}

Space Space::product(const std::vector<std::pair<double, Space>>& factors) {
  std::string name;
  std::vector<Axis> axes;
  for (const auto& [weight, factor] : factors) {
    name += (name.empty() ? "" : " x ") + factor.name();
    for (Axis axis : factor.axes()) {
      axis.weight *= weight;
      const auto taken = [&](const std::string& n) {
        return std::any_of(axes.begin(), axes.end(), [&](const Axis& other) { return other.name == n; });
      };
      const std::string stem = axis.name;
      for (int k = 2; taken(axis.name); ++k) axis.name = fmt::format("{}{}", stem, k);
      axes.push_back(std::move(axis));
    }
  }
  return {std::move(name), std::move(axes)};
}

double Space::squared_distance(View a, View b) const {
  double sum = 0.0;
  const double* from = a.data();
  const double* to = b.data();
  for (const Axis& axis : axes_) {
    double delta = *to++ - *from++;
    if (axis.periodic) delta = shortest_difference(axis, delta);
    delta *= axis.weight;
    sum += delta * delta;
  }
  return sum;
}

double Space::distance(View a, View b) const { return std::sqrt(squared_distance(a, b)); }

void Space::difference(View a, View b, MutableView out) const {
  for (std::size_t j = 0; j < axes_.size(); ++j) {
    const double delta = b[j] - a[j];
    out[j] = axes_[j].periodic ? shortest_difference(axes_[j], delta) : delta;
  }
}

void Space::interpolate(View a, View b, double t, MutableView out) const {
  if (t == 1.0) {
    std::copy_n(b.begin(), axes_.size(), out.begin());
    return;
  }
  for (std::size_t j = 0; j < axes_.size(); ++j) {
    if (axes_[j].periodic) {
      out[j] = wrap(axes_[j], a[j] + t * shortest_difference(axes_[j], b[j] - a[j]));
    } else {
      out[j] = a[j] + t * (b[j] - a[j]);
    }
  }
}

void Space::normalise(MutableView q) const {
  for (std::size_t j = 0; j < axes_.size(); ++j) {
    if (axes_[j].periodic) q[j] = wrap(axes_[j], q[j]);
  }
}

void Space::reflect(MutableView q) const {
  for (std::size_t j = 0; j < axes_.size(); ++j) {
    const auto& axis = axes_[j];
    if (axis.periodic) {
      q[j] = wrap(axis, q[j]);
    } else if (q[j] < axis.lo || q[j] > axis.hi) {
      q[j] = reflect_once(axis, q[j]);
    }
  }
}

bool Space::contains(View q) const {
  if (q.size() != axes_.size()) return false;
  for (std::size_t j = 0; j < axes_.size(); ++j) {
    if (!std::isfinite(q[j])) return false;
    if (!axes_[j].periodic && (q[j] < axes_[j].lo || q[j] > axes_[j].hi)) return false;
  }
  return true;
}

void Space::sample_uniform(Stream& stream, MutableView out) const {
  for (std::size_t j = 0; j < axes_.size(); ++j) out[j] = stream.uniform(axes_[j].lo, axes_[j].hi);
}

double Space::log_volume() const {
  double sum = 0.0;
  for (const auto& axis : axes_) sum += std::log(axis.weight * (axis.hi - axis.lo));
  return sum;
}

double Space::diameter() const {
  double sum = 0.0;
  for (const auto& axis : axes_) {
    const double extent = axis.weight * (axis.periodic ? 0.5 * axis.period() : axis.hi - axis.lo);
    sum += extent * extent;
  }
  return std::sqrt(sum);
}

double Space::injectivity_radius() const {
  double radius = std::numeric_limits<double>::infinity();
  for (const auto& axis : axes_) {
    if (axis.periodic) radius = std::min(radius, 0.5 * axis.weight * axis.period());
  }
  return radius;
}

Foot nearest_on_motion(const Space& space, View a, View b, View q) {
  // Relative to the motion's midpoint, the shorter direction to q on a periodic axis is correct for both halves.
  double along = 0.0;
  double squared = 0.0;
  double to_middle = 0.0;
  for (std::size_t j = 0; j < a.size(); ++j) {
    const Axis& axis = space.axes()[j];
    double difference_of_ends = b[j] - a[j];
    if (axis.periodic) difference_of_ends = shortest_difference(axis, difference_of_ends);
    double to = q[j] - (a[j] + 0.5 * difference_of_ends);
    if (axis.periodic) to = shortest_difference(axis, to);
    along += axis.weight * to * axis.weight * difference_of_ends;
    squared += axis.weight * difference_of_ends * axis.weight * difference_of_ends;
    to_middle += axis.weight * to * axis.weight * to;
  }
  const double t = squared > 0.0 ? std::clamp(along / squared, -0.5, 0.5) : 0.0;
  return {0.5 + t, std::max(0.0, to_middle - 2.0 * t * along + t * t * squared)};
}

double log_unit_ball(std::size_t d) {
  const double half = 0.5 * static_cast<double>(d);
  return half * std::log(std::numbers::pi) - std::lgamma(half + 1.0);
}

double path_length(const Space& space, const Configurations& path) {
  double length = 0.0;
  for (std::size_t i = 1; i < path.size(); ++i) length += space.distance(path[i - 1], path[i]);
  return length;
}

Configurations evenly_spread(const Space& space, const Configurations& path, std::size_t count) {
  std::vector<double> at = {0.0};
  at.reserve(path.size());
  for (std::size_t i = 1; i < path.size(); ++i) at.push_back(at.back() + space.distance(path[i - 1], path[i]));
  Configurations points(space.dimension());
  points.reserve(count);
  Configuration q(space.dimension());
  std::size_t leg = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const double s = at.back() * static_cast<double>(i) / static_cast<double>(count - 1);
    while (leg + 2 < at.size() && at[leg + 1] < s) ++leg;
    if (path.size() == 1) {
      points.push(path[0]);
      continue;
    }
    const double length = at[leg + 1] - at[leg];
    space.interpolate(path[leg], path[leg + 1], length > 0.0 ? std::clamp((s - at[leg]) / length, 0.0, 1.0) : 0.0, q);
    points.push(q);
  }
  return points;
}

}  // namespace trellis
