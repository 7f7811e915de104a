// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/guide/axis_projection.hpp>

#include <array>
#include <cmath>
#include <utility>

namespace trellis {

namespace {

Space chosen(const Space& space, const std::vector<std::size_t>& axes, std::string name) {
  std::vector<Axis> all;
  all.reserve(axes.size());
  for (const std::size_t axis : axes) all.push_back(space.axes().at(axis));
  return {std::move(name), std::move(all)};
}

}  // namespace

AxisProjection::AxisProjection(Space parent, std::vector<std::size_t> axes, std::string name)
    : parent_(std::move(parent)),
      axes_(std::move(axes)),
      space_(chosen(parent_, axes_, std::move(name))),
      log_fibre_volume_(parent_.log_volume() - space_.log_volume()) {}

Configurations AxisProjection::lifted_path(const Configurations& path, View start, View goal) const {
  Configurations lifted(parent_.dimension());
  Configuration q(parent_.dimension());
  const double length = path_length(space_, path);
  double at = 0.0;
  for (std::size_t i = 0; i < path.size(); ++i) {
    if (i > 0) at += space_.distance(path[i - 1], path[i]);
    parent_.interpolate(start, goal, length > 0.0 ? at / length : 0.0, q);
    for (std::size_t j = 0; j < axes_.size(); ++j) q[axes_[j]] = path[i][j];
    lifted.push(q);
  }
  return lifted;
}

double LiftedDensity::at(View q) const {
  // Runs for every sample of every measure: the usual sizes stay on the stack.
  constexpr std::size_t few_axes = 16;
  std::array<double, few_axes> buffer;
  std::vector<double> many;
  const std::size_t d = projection_->axes().size();
  if (d > few_axes) many.resize(d);
  const MutableView s = d > few_axes ? MutableView(many) : MutableView(buffer).first(d);
  projection_->project(q, s);
  return below_->at(s) * std::exp(-projection_->log_fibre_volume());
}

bool LiftedDensity::akin(const Density& other) const {
  const auto* lifted = dynamic_cast<const LiftedDensity*>(&other);
  return lifted != nullptr && lifted->projection_ == projection_ && below_->akin(*lifted->below_);
}

std::shared_ptr<const Density> LiftedDensity::sum(const std::vector<Term>& terms) const {
  std::vector<Term> below;
  below.reserve(terms.size());
  for (const auto& term : terms) {
    below.push_back({dynamic_cast<const LiftedDensity&>(*term.density).below_, term.weight});
  }
  return std::make_shared<LiftedDensity>(projection_, below_->sum(below));
}

}  // namespace trellis
