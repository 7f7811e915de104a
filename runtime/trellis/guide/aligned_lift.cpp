// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/guide/aligned_lift.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include <trellis/motion/motion_model.hpp>

namespace trellis {

AlignedLift::AlignedLift(std::shared_ptr<const Projection> position, std::shared_ptr<const MotionModel> model,
                         std::vector<Vec2> directions, double alignment)
    : position_(std::move(position)),
      model_(std::move(model)),
      directions_(std::move(directions)),
      alignment_(alignment),
      // The heading is uniform and rotates the velocity, so the direction of the velocity is uniform too.
      share_(std::acos(alignment) / std::numbers::pi) {
  for (const ControlAxis& control : model_->controls()) fastest_.push_back(control.hi);
}

bool AlignedLift::applies(const Instance& instance) {
  // Of a team, directions of one position say nothing of the other robots.
  return instance.motion_model && !instance.validity_of && instance.scene->members().size() < 2 &&
         instance.space.dimension() == instance.motion_model->dimension();
}

Vec2 AlignedLift::heading(View q) const {
  thread_local Configuration rate;
  rate.resize(q.size());
  model_->derivative(q, fastest_, rate);
  const double speed = std::hypot(rate[0], rate[1]);
  return speed > 0.0 ? Vec2{rate[0] / speed, rate[1] / speed} : Vec2{};
}

bool AlignedLift::aligned(Vec2 heading, Vec2 direction) const {
  return heading.x * direction.x + heading.y * direction.y >= alignment_;
}

void AlignedLift::lift(View s, Stream& stream, MutableView q) const {
  const Vec2 direction = directions_.size() > 1 ? directions_[stream.below(directions_.size())] : directions_.front();
  do {
    position_->lift(s, stream, q);
  } while (!aligned(heading(q), direction));
}

double AlignedLift::log_fibre_density(View q) const {
  const Vec2 towards = heading(q);
  const auto with = std::count_if(directions_.begin(), directions_.end(),
                                  [&](Vec2 direction) { return aligned(towards, direction); });
  if (with == 0) return -std::numeric_limits<double>::infinity();
  const double chosen = static_cast<double>(with) / static_cast<double>(directions_.size());
  return position_->log_fibre_density(q) + std::log(chosen / share_);
}

}  // namespace trellis
