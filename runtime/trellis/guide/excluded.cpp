// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/guide/excluded.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace trellis {

namespace {

Space positions_of(const Space& space, const std::vector<std::size_t>& axes) {
  const std::vector<Axis> all = space.coordinates();
  std::vector<Axis> chosen;
  chosen.reserve(axes.size());
  for (const std::size_t axis : axes) chosen.push_back(all[axis]);
  return {"positions", std::move(chosen)};
}

}  // namespace

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

double ExcludedBalls::depth(View q) const {
  if (index_.size() == 0) return 0.0;
  return std::max(0.0, radius_ - std::sqrt(index_.nearest(q).squared_distance));
}

std::size_t ExcludedBalls::count(View q) {
  if (index_.size() == 0) return 0;
  index_.within(q, radius_, found_);
  return found_.size();
}

std::optional<double> ExcludedBalls::entered(View a, View b, std::size_t first) {
  if (index_.size() <= first) return std::nullopt;
  const auto foot_in = [&](std::uint32_t id) -> std::optional<double> {
    const View centre = std::as_const(centres_)[id];
    // Where rotations are, the foot of a centre is searched.
    if (!space_.flat() && lines_apart(a, b, centre)) return std::nullopt;
    const Foot foot = nearest_on_motion(space_, a, b, centre);
    if (foot.squared_distance <= radius_ * radius_) return foot.t;
    return std::nullopt;
  };
  // So few are compared sooner than searched for.
  constexpr std::size_t few = 64;
  if (first > 0 && index_.size() - first <= few) {
    for (auto id = static_cast<std::uint32_t>(first); id < index_.size(); ++id) {
      if (const auto t = foot_in(id)) return t;
    }
    return std::nullopt;
  }
  const double length = space_.distance(a, b);
  Configuration middle(a.size());
  space_.interpolate(a, b, 0.5, middle);
  index_.within(middle, 0.5 * length + radius_, found_);
  for (const auto& candidate : found_) {
    if (candidate.id < first) continue;
    if (const auto t = foot_in(candidate.id)) return t;
  }
  return std::nullopt;
}

bool ExcludedBalls::lines_apart(View a, View b, View centre) const {
  double along = 0.0;
  double squared = 0.0;
  double to_start = 0.0;
  for (const Factor& factor : space_.factors()) {
    if (factor.kind != Factor::Kind::line) continue;
    const std::size_t j = factor.column;
    const double motion = factor.axis.weight * (b[j] - a[j]);
    const double to = factor.axis.weight * (centre[j] - a[j]);
    along += motion * to;
    squared += motion * motion;
    to_start += to * to;
  }
  const double t = squared > 0.0 ? std::clamp(along / squared, 0.0, 1.0) : 0.0;
  constexpr double rounding = 1.0 + 1e-9;
  return to_start - 2.0 * t * along + t * t * squared > rounding * radius_ * radius_ + 1e-12 * to_start;
}

Places::Places(const Space& space, std::vector<std::size_t> position_axes, double radius)
    : axes_(std::move(position_axes)),
      space_(axes_.empty() ? space : positions_of(space, axes_)),
      balls_(space_, radius),
      given_(space.dimension()) {}

void Places::project(View q, Configuration& position) const {
  if (axes_.empty()) {
    position.assign(q.begin(), q.end());
    return;
  }
  position.resize(axes_.size());
  for (std::size_t j = 0; j < axes_.size(); ++j) position[j] = q[axes_[j]];
}

void Places::add(View q) {
  project(q, a_);
  balls_.add(a_);
  given_.push(q);
}

void Places::clear() {
  if (given_.empty()) return;
  balls_.clear();
  given_.clear();
}

bool Places::contains(View q) {
  if (given_.empty()) return false;
  project(q, a_);
  return balls_.contains(a_);
}

std::size_t Places::count(View q) {
  project(q, a_);
  return balls_.count(a_);
}

std::optional<double> Places::entered(View a, View b) {
  if (given_.empty()) return std::nullopt;
  project(a, a_);
  project(b, b_);
  return balls_.entered(a_, b_);
}

bool Places::near(View a, View b) {
  project(a, a_);
  project(b, b_);
  return space_.squared_distance(a_, b_) <= balls_.radius() * balls_.radius();
}

ExcludingValidity::ExcludingValidity(std::shared_ptr<Validity> inner, const Space& space, double radius,
                                     std::vector<std::size_t> position_axes, double place_radius)
    : ForwardingValidity(std::move(inner)),
      space_(space),
      balls_(space, radius),
      places_(space, std::move(position_axes), place_radius),
      inner_epoch_(inner_->epoch()) {}

void ExcludingValidity::exclude(const Configurations& path) {
  exclude_points(points_along(path, [](View) { return true; }));
}

Configurations ExcludingValidity::points_along(const Configurations& path,
                                               const std::function<bool(View)>& chosen) const {
  const double r = balls_.radius();
  const View start = path.front();
  const View goal = path.back();
  Configurations points(space_.dimension());
  // Balls at distances of half their radius cover a tube of 0.97 of it without gaps.
  Configuration centre(space_.dimension());
  for (std::size_t i = 1; i < path.size(); ++i) {
    const double length = space_.distance(path[i - 1], path[i]);
    const auto pieces = static_cast<std::size_t>(std::max(1.0, std::ceil(2.0 * length / r)));
    for (std::size_t k = 0; k < pieces; ++k) {
      space_.interpolate(path[i - 1], path[i], static_cast<double>(k) / static_cast<double>(pieces), centre);
      if (space_.distance(centre, start) <= 2.0 * r || space_.distance(centre, goal) <= 2.0 * r) continue;
      if (chosen(centre)) points.push(centre);
    }
  }
  return points;
}

void ExcludingValidity::exclude_points(const Configurations& points) {
  for (std::size_t i = 0; i < points.size(); ++i) balls_.add(points[i]);
  changed();
}

void ExcludingValidity::include_paths() {
  balls_.clear();
  changed();
}

bool ExcludingValidity::exclude_place(View q, const std::vector<Configuration>& keep) {
  if (std::any_of(keep.begin(), keep.end(), [&](const Configuration& kept) { return places_.near(q, kept); })) {
    return false;
  }
  places_.add(q);
  changed();
  return true;
}

void ExcludingValidity::replace(const ExcludingValidity& other) {
  replaces_ = true;
  for (std::size_t i = 0; i < other.excluded_places().size(); ++i) exclude_place(other.excluded_places()[i], {});
}

void ExcludingValidity::changed() { changed_.push_back(epoch() + 1); }

std::optional<double> ExcludingValidity::entered(View a, View b) {
  if (const auto t = balls_.entered(a, b)) return t;
  return places_.entered(a, b);
}

MotionReport ExcludingValidity::motion(View a, View b) {
  if (const auto t = entered(a, b)) return {false, 0, *t};
  return inner_->motion(a, b);
}

MotionReport ExcludingValidity::motion_still_valid(View a, View b, std::uint64_t since) {
  if (const auto t = entered(a, b)) return {false, 0, *t};
  if (replaces_ || inner_->epoch() != inner_epoch_) {
    // An epoch is the sum of the changes here and those of the inner validity.
    const auto here = std::upper_bound(changed_.begin(), changed_.end(), since) - changed_.begin();
    return inner_->motion_still_valid(a, b, since - static_cast<std::uint64_t>(here));
  }
  return {true, 0, std::numeric_limits<double>::quiet_NaN()};
}

}  // namespace trellis
