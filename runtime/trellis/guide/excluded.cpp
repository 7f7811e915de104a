// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/guide/excluded.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace trellis {

ExcludedBalls::ExcludedBalls(Space space, double radius)
    : space_(std::move(space)), radius_(radius), index_(space_), centres_(space_.dimension()) {}

void ExcludedBalls::add(View centre) {
  index_.add(centre);
  centres_.push(centre);
}

void ExcludedBalls::clear() {
  index_ = NearestIndex(space_);
  centres_ = Configurations(space_.dimension());
}

bool ExcludedBalls::contains(View q) const {
  return index_.size() > 0 && index_.nearest(q).squared_distance <= radius_ * radius_;
}

std::optional<double> ExcludedBalls::entered(View a, View b) {
  if (index_.size() == 0) return std::nullopt;
  const double length = space_.distance(a, b);
  Configuration middle(a.size());
  space_.interpolate(a, b, 0.5, middle);
  index_.within(middle, 0.5 * length + radius_, found_);
  for (const auto& candidate : found_) {
    const Foot foot = nearest_on_motion(space_, a, b, std::as_const(centres_)[candidate.id]);
    if (foot.squared_distance <= radius_ * radius_) return foot.t;
  }
  return std::nullopt;
}

void ExcludingValidity::exclude(const Configurations& path) {
  const double r = balls_.radius();
  const View start = path.front();
  const View goal = path.back();
  // Centres half the radius apart leave a tube of 0.97 of it without gaps.
  Configuration centre(space_.dimension());
  for (std::size_t i = 1; i < path.size(); ++i) {
    const double length = space_.distance(path[i - 1], path[i]);
    const auto pieces = static_cast<std::size_t>(std::max(1.0, std::ceil(2.0 * length / r)));
    for (std::size_t k = 0; k < pieces; ++k) {
      space_.interpolate(path[i - 1], path[i], static_cast<double>(k) / static_cast<double>(pieces), centre);
      if (space_.distance(centre, start) > 2.0 * r && space_.distance(centre, goal) > 2.0 * r) balls_.add(centre);
    }
  }
  ++epoch_;
}

void ExcludingValidity::include_all() {
  balls_.clear();
  ++epoch_;
}

MotionReport ExcludingValidity::motion(View a, View b) {
  if (const auto t = balls_.entered(a, b)) return {false, 0, *t};
  return inner_->motion(a, b);
}

}  // namespace trellis
