// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/guide/position.hpp>

#include <array>
#include <cmath>

#include <trellis/base/error.hpp>

namespace trellis {

PositionProjection::PositionProjection(const std::string& guide, const Instance& parent)
    : parent_(parent.space), position_(parent.position_axes) {
  if (position_.size() != 2) {
    throw Error(guide + ": needs a robot whose reference point moves in the plane; this space (" + parent.space.name() +
                ") has no position");
  }
  space_ = Space("R^2", {parent.space.axes()[position_[0]], parent.space.axes()[position_[1]]});
  log_fibre_volume_ = parent_.log_volume() - space_.log_volume();
}

Configurations PositionProjection::lifted_path(const Instance& parent, const Configurations& path) const {
  Configurations lifted(parent.space.dimension());
  Configuration q(parent.space.dimension());
  const double length = path_length(space_, path);
  double at = 0.0;
  for (std::size_t i = 0; i < path.size(); ++i) {
    if (i > 0) at += space_.distance(path[i - 1], path[i]);
    parent.space.interpolate(parent.start, parent.goal, length > 0.0 ? at / length : 0.0, q);
    for (std::size_t j = 0; j < 2; ++j) q[position_[j]] = path[i][j];
    lifted.push(q);
  }
  return lifted;
}

std::unique_ptr<Instance> PositionProjection::point_instance(const Instance& parent) const {
  auto instance = std::make_unique<Instance>();
  instance->space = space_;
  instance->scene = std::make_shared<Scene>(Scene{parent.scene->world, Robot::point()});
  instance->validity = std::make_shared<CollisionValidity>(
      make_checker(parent.collision, instance->scene, instance->space, parent.resolution));
  instance->start.resize(2);
  instance->goal.resize(2);
  project(parent.start, instance->start);
  project(parent.goal, instance->goal);
  instance->goal_tolerance = parent.goal_tolerance;
  instance->resolution = parent.resolution;
  instance->collision = parent.collision;
  instance->position_axes = {0, 1};
  return instance;
}

double LiftedDensity::at(View q) const {
  std::array<double, 2> s{};
  projection_->project(q, s);
  return positions_->at(s) * std::exp(-projection_->log_fibre_volume());
}

bool LiftedDensity::akin(const Density& other) const {
  const auto* lifted = dynamic_cast<const LiftedDensity*>(&other);
  return lifted != nullptr && lifted->projection_ == projection_ && positions_->akin(*lifted->positions_);
}

std::shared_ptr<const Density> LiftedDensity::sum(const std::vector<Term>& terms) const {
  std::vector<Term> positions;
  positions.reserve(terms.size());
  for (const auto& term : terms) {
    positions.push_back({dynamic_cast<const LiftedDensity&>(*term.density).positions_, term.weight});
  }
  return std::make_shared<LiftedDensity>(projection_, positions_->sum(positions));
}

}  // namespace trellis
