// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/guide/axis_projection.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include <trellis/base/error.hpp>

namespace trellis {

namespace {

std::vector<Axis> axes_of(const Space& parent, const std::vector<std::size_t>& kept) {
  std::vector<Axis> axes;
  axes.reserve(kept.size());
  for (const std::size_t j : kept) axes.push_back(parent.axes()[j]);
  return axes;
}

/// For each axis of S, the parent's axis of the same name.
std::vector<std::size_t> named_alike(const Space& parent, const Space& s) {
  std::vector<std::string> names;
  names.reserve(parent.dimension());
  for (const Axis& axis : parent.axes()) names.push_back(axis.name);
  std::vector<std::size_t> kept;
  kept.reserve(s.dimension());
  for (const Axis& axis : s.axes()) {
    const auto found = std::find(names.begin(), names.end(), axis.name);
    if (found == names.end()) {
      throw Error(fmt::format("S has an axis '{}' that C lacks{}; C has: {}", axis.name, did_you_mean(axis.name, names),
                              fmt::join(names, ", ")));
    }
    const auto place = static_cast<std::size_t>(found - names.begin());
    const Axis& of = parent.axes()[place];
    if (axis.periodic != of.periodic || axis.lo < of.lo || axis.hi > of.hi) {
      throw Error(fmt::format("S has the axis '{}' from {:g} to {:g}{}, which is not within C's, from {:g} to {:g}{}",
                              axis.name, axis.lo, axis.hi, axis.periodic ? ", periodic" : "", of.lo, of.hi,
                              of.periodic ? ", periodic" : ""));
    }
    kept.push_back(place);
  }
  return kept;
}

}  // namespace

AxisProjection::AxisProjection(Space parent, std::vector<std::size_t> kept, std::string name)
    : parent_(std::move(parent)),
      kept_(std::move(kept)),
      space_(std::move(name), axes_of(parent_, kept_)),
      log_fibre_volume_(parent_.log_volume() - space_.log_volume()) {}

AxisProjection::AxisProjection(Space parent, Space s)
    : parent_(std::move(parent)),
      kept_(named_alike(parent_, s)),
      space_(std::move(s)),
      log_fibre_volume_(parent_.log_volume() - space_.log_volume()) {
  for (std::size_t j = 0; j < kept_.size(); ++j) {
    log_fibre_volume_ += std::log(space_.axes()[j].period() / parent_.axes()[kept_[j]].period());
  }
}

bool AxisProjection::contracts() const {
  for (std::size_t j = 0; j < kept_.size(); ++j) {
    if (space_.axes()[j].weight > parent_.axes()[kept_[j]].weight) return false;
  }
  return true;
}

bool AxisProjection::identity() const {
  for (std::size_t j = 0; j < kept_.size(); ++j) {
    if (kept_[j] != j) return false;
  }
  return kept_.size() == parent_.dimension();
}

Configurations AxisProjection::lifted(const Configurations& path, View start, View goal) const {
  Configurations result(parent_.dimension());
  Configuration q(parent_.dimension());
  const double length = path_length(space_, path);
  double at = 0.0;
  for (std::size_t i = 0; i < path.size(); ++i) {
    if (i > 0) at += space_.distance(path[i - 1], path[i]);
    parent_.interpolate(start, goal, length > 0.0 ? at / length : 0.0, q);
    for (std::size_t j = 0; j < kept_.size(); ++j) q[kept_[j]] = path[i][j];
    result.push(q);
  }
  return result;
}

}  // namespace trellis
