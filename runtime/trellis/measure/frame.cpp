// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/measure/frame.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

namespace trellis::measure {

Frame::Frame(const Space& space) : space_(space) {
  if (!flat()) return;
  for (const Axis& axis : space.axes()) {
    lo_.push_back(axis.weight * axis.lo);
    hi_.push_back(axis.weight * axis.hi);
    period_.push_back(axis.periodic ? axis.weight * axis.period() : std::numeric_limits<double>::infinity());
    periodic_.push_back(axis.periodic ? 1 : 0);
  }
}

Space Frame::rows() const {
  if (!flat()) return space_;
  std::vector<Axis> axes = space_.axes();
  for (Axis& axis : axes) axis = {axis.name, axis.weight * axis.lo, axis.weight * axis.hi, 1.0, axis.periodic};
  return {space_.name(), std::move(axes)};
}

void Frame::to_metric(View x, MutableView y) const {
  std::copy(x.begin(), x.end(), y.begin());
  space_.normalise(y);
  if (!flat()) return;
  const auto& axes = space_.axes();
  for (std::size_t j = 0; j < axes.size(); ++j) y[j] *= axes[j].weight;
}

void Frame::to_raw(View y, MutableView x) const {
  if (!flat()) {
    std::copy(y.begin(), y.end(), x.begin());
    return;
  }
  const auto& axes = space_.axes();
  for (std::size_t j = 0; j < axes.size(); ++j) {
    // The division may leave the bounds by a rounding error; a point of C must stay in C.
    x[j] = std::clamp(y[j] / axes[j].weight, axes[j].lo, axes[j].hi);
  }
  space_.normalise(x);
}

void Frame::from_unit(View unit, MutableView y) const {
  if (!flat()) {
    space_.from_unit(unit, y);
    space_.normalise(y);
    return;
  }
  for (std::size_t j = 0; j < lo_.size(); ++j) y[j] = lo_[j] + unit[j] * extent(j);
}

double Frame::fold(std::size_t j, double y) const {
  if (periodic_[j] == 0 || (y >= lo_[j] && y <= hi_[j])) return y;
  return std::clamp(y - period_[j] * std::floor((y - lo_[j]) / period_[j]), lo_[j], hi_[j]);
}

double Frame::shortest(std::size_t j, double delta) const {
  if (periodic_[j] == 0 || std::abs(delta) <= 0.5 * period_[j]) return delta;
  return delta - period_[j] * std::round(delta / period_[j]);
}

}  // namespace trellis::measure
