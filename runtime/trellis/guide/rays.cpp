// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/guide/rays.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace trellis {

SurfaceRay::SurfaceRay(Instance& instance)
    : instance_(instance), direction_(instance.space.degrees(), 0.0), step_(instance.space.degrees()) {}

void SurfaceRay::draw_direction(Stream& stream) {
  double squares = 0.0;
  while (squares <= 0.0) {
    squares = 0.0;
    for (double& x : direction_) {
      x = stream.normal();
      squares += x * x;
    }
  }
  if (!instance_.space.flat()) {
    for (double& x : direction_) x /= std::sqrt(squares);
    return;
  }
  const auto& axes = instance_.space.axes();
  for (std::size_t j = 0; j < direction_.size(); ++j) direction_[j] /= std::sqrt(squares) * axes[j].weight;
}

void SurfaceRay::set_direction(double angle) {
  const auto& axes = instance_.space.axes();
  std::fill(direction_.begin(), direction_.end(), 0.0);
  const std::size_t x = instance_.position_axes[0];
  const std::size_t y = instance_.position_axes[1];
  direction_[x] = std::cos(angle) / axes[x].weight;
  direction_[y] = std::sin(angle) / axes[y].weight;
}

void SurfaceRay::set_direction(const std::array<double, 3>& direction) {
  std::fill(direction_.begin(), direction_.end(), 0.0);
  const auto& positions = instance_.position_axes;
  for (std::size_t k = 0; k < positions.size(); ++k) {
    const double weight = instance_.space.flat() ? instance_.space.axes()[positions[k]].weight : 1.0;
    direction_[positions[k]] = direction[k] / weight;
  }
}

bool SurfaceRay::at(View q, double distance, MutableView out) const {
  if (instance_.space.flat()) {
    for (std::size_t j = 0; j < out.size(); ++j) out[j] = q[j] + distance * direction_[j];
  } else {
    for (std::size_t j = 0; j < step_.size(); ++j) step_[j] = distance * direction_[j];
    instance_.space.exp(q, step_, out);
  }
  instance_.space.normalise(out);
  return instance_.space.contains(out);
}

double SurfaceRay::walk(View q, MutableView out) {
  const double farthest = instance_.space.diameter();
  double inside = 0.0;
  double outside = instance_.resolution;
  while (true) {
    if (outside > farthest || !at(q, outside, out)) return std::numeric_limits<double>::infinity();
    if (instance_.valid(out)) break;
    inside = outside;
    outside *= 2.0;
  }
  while (outside - inside > instance_.resolution) {
    const double middle = 0.5 * (inside + outside);
    at(q, middle, out);
    (instance_.valid(out) ? outside : inside) = middle;
  }
  at(q, outside, out);
  return outside;
}

}  // namespace trellis
