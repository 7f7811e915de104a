// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/guide/kernels.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

#include <trellis/base/error.hpp>

namespace trellis {

namespace {

/// Calls f(u) for every image u of x - a, in metric coordinates, that may lie within r of the segment from 0 to v:
/// x itself, its mirror images at the walls, and its copies round periodic axes.
template <class F>
void for_each_image(const Space& space, View a, const std::vector<double>& v, View x, double r, F&& f) {
  const auto& axes = space.axes();
  const std::size_t d = axes.size();
  std::vector<std::vector<double>> candidates(d);
  for (std::size_t j = 0; j < d; ++j) {
    const auto& axis = axes[j];
    const double lo = std::min(0.0, v[j]) - r;
    const double hi = std::max(0.0, v[j]) + r;
    const auto offer = [&](double raw) {
      const double u = axis.weight * (raw - a[j]);
      if (u >= lo && u <= hi) candidates[j].push_back(u);
    };
    offer(x[j]);
    if (axis.periodic) {
      offer(x[j] - axis.period());
      offer(x[j] + axis.period());
    } else {
      if (x[j] > axis.lo) offer(2.0 * axis.lo - x[j]);
      if (x[j] < axis.hi) offer(2.0 * axis.hi - x[j]);
    }
    if (candidates[j].empty()) return;
  }
  std::vector<std::size_t> choice(d, 0);
  std::vector<double> u(d);
  for (;;) {
    for (std::size_t j = 0; j < d; ++j) u[j] = candidates[j][choice[j]];
    f(u);
    std::size_t j = 0;
    while (j < d && ++choice[j] == candidates[j].size()) choice[j++] = 0;
    if (j == d) return;
  }
}

}  // namespace

double fitting_radius(const Space& space, double wanted) {
  double radius = std::min(wanted, 0.999 * space.injectivity_radius());
  for (const auto& axis : space.axes()) {
    if (!axis.periodic) radius = std::min(radius, 0.5 * axis.weight * (axis.hi - axis.lo));
  }
  return radius;
}

BallKernel::BallKernel(Space space, double radius)
    : space_(std::move(space)),
      radius_(fitting_radius(space_, radius)),
      log_volume_(log_unit_ball(space_.dimension()) + static_cast<double>(space_.dimension()) * std::log(radius_)) {
  if (!(radius > 0.0)) throw Fault("a ball needs a radius greater than 0");
}

void BallKernel::sample(View centre, Stream& stream, MutableView out) const {
  const auto& axes = space_.axes();
  double sum = 0.0;
  for (std::size_t j = 0; j < axes.size(); ++j) {
    out[j] = stream.normal();
    sum += out[j] * out[j];
  }
  const double length = radius_ * std::pow(stream.uniform(), 1.0 / static_cast<double>(axes.size()));
  const double scale = sum > 0.0 ? length / std::sqrt(sum) : 0.0;
  for (std::size_t j = 0; j < axes.size(); ++j) out[j] = centre[j] + scale * out[j] / axes[j].weight;
  space_.reflect(out);
}

double BallKernel::density(View centre, View q) const {
  const std::vector<double> none(space_.dimension(), 0.0);
  int images = 0;
  for_each_image(space_, centre, none, q, radius_, [&](const std::vector<double>& u) {
    double sum = 0.0;
    for (const double x : u) sum += x * x;
    if (sum <= radius_ * radius_) ++images;
  });
  return images * std::exp(-log_volume_);
}

TubeKernel::TubeKernel(const Space& space, Configurations path, double radius)
    : ball_(space, radius), path_(std::move(path)), centre_(space.dimension()) {
  if (path_.empty()) throw Fault("a tube needs a path");
  at_.push_back(0.0);
  for (std::size_t i = 1; i < path_.size(); ++i) {
    at_.push_back(at_.back() + space.distance(std::as_const(path_)[i - 1], std::as_const(path_)[i]));
  }
  activate({{0.0, at_.back()}});
}

void TubeKernel::activate(std::vector<std::pair<double, double>> stretches) {
  active_ = std::move(stretches);
  active_length_ = 0.0;
  for (const auto& [from, to] : active_) active_length_ += to - from;
}

void TubeKernel::point(double s, MutableView out) const {
  if (path_.size() == 1 || at_.back() == 0.0) {
    std::copy(path_.front().begin(), path_.front().end(), out.begin());
    return;
  }
  const auto it = std::upper_bound(at_.begin() + 1, at_.end() - 1, s);
  const auto i = static_cast<std::size_t>(it - at_.begin()) - 1;
  const double span = at_[i + 1] - at_[i];
  const double t = span > 0.0 ? std::clamp((s - at_[i]) / span, 0.0, 1.0) : 0.0;
  ball_.space().interpolate(path_[i], path_[i + 1], t, out);
}

void TubeKernel::sample(Stream& stream, MutableView out) {
  double s = stream.uniform(0.0, active_length_);
  double at = active_.front().first;
  for (const auto& [from, to] : active_) {
    at = std::min(from + s, to);
    if (s < to - from) break;
    s -= to - from;
  }
  point(at, centre_);
  ball_.sample(centre_, stream, out);
}

double TubeKernel::density(View q) const {
  if (active_length_ <= 0.0) {
    Configuration centre(q.size());
    point(active_.front().first, centre);
    return ball_.density(centre, q);
  }
  const Space& space = ball_.space();
  const double r = ball_.radius();
  std::vector<double> v(q.size());
  double inside = 0.0;  // arc length of the active path within r of q
  for (std::size_t i = 0; i + 1 < path_.size(); ++i) {
    const double span = at_[i + 1] - at_[i];
    if (span <= 0.0) continue;
    space.difference(path_[i], path_[i + 1], v);
    for (std::size_t j = 0; j < v.size(); ++j) v[j] *= space.axes()[j].weight;
    for_each_image(space, path_[i], v, q, r, [&](const std::vector<double>& u) {
      // |u - t v|^2 <= r^2 for t in [t0, t1]
      double uv = 0.0;
      double uu = 0.0;
      for (std::size_t j = 0; j < v.size(); ++j) {
        uv += u[j] * v[j];
        uu += u[j] * u[j];
      }
      const double vv = span * span;
      const double under = uv * uv - vv * (uu - r * r);
      if (under <= 0.0) return;
      const double t0 = std::max(0.0, (uv - std::sqrt(under)) / vv);
      const double t1 = std::min(1.0, (uv + std::sqrt(under)) / vv);
      if (t1 <= t0) return;
      const double s0 = at_[i] + t0 * span;
      const double s1 = at_[i] + t1 * span;
      for (const auto& [from, to] : active_) inside += std::max(0.0, std::min(s1, to) - std::max(s0, from));
    });
  }
  return inside / active_length_ * std::exp(-ball_.log_volume());
}

}  // namespace trellis
