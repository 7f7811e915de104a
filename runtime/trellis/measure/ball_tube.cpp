// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/measure/ball_tube.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <trellis/measure/tangent_ball.hpp>

namespace trellis::measure {

namespace {

constexpr double thinning = 1e-3;      // as a share of the radius
constexpr std::size_t run_limit = 64;  // keeps the search for bends linear in the number of waypoints

Space product_of(const std::vector<Factor>& factors) {
  std::vector<std::pair<double, Space>> spaces;
  spaces.reserve(factors.size());
  for (const Factor& factor : factors) {
    spaces.emplace_back(1.0, factor.kind == Factor::Kind::rotation ? Space::so3(factor.axis.weight, factor.axis.name)
                                                                   : Space(factor.axis.name, {factor.axis}));
  }
  return Space::product(spaces);
}

double log_ball(std::size_t degrees, double radius) {
  return log_unit_ball(degrees) + static_cast<double>(degrees) * std::log(radius);
}

}  // namespace

BallTube::BallTube(const Frame& frame, const Configurations& path, std::vector<std::size_t> axes, double radius)
    : Tube(frame, std::move(axes), radius) {
  choose_spaces();
  cut_path(path);
  choose_centres();
}

void BallTube::choose_spaces() {
  std::vector<Factor> measured;
  std::vector<Factor> rest;
  std::size_t row = 0;
  std::size_t free_row = 0;
  for (const Factor& factor : frame_.space().factors()) {
    const bool chosen = std::any_of(axes_.begin(), axes_.end(), [&](std::size_t axis) {
      return axis >= factor.column && axis < factor.column + factor.width();
    });
    std::size_t& part = chosen ? row : free_row;
    columns_.push_back({factor.column, part, factor.width(), chosen});
    part += factor.width();
    (chosen ? measured : rest).push_back(factor);
  }
  space_ = product_of(measured);
  rest_ = product_of(rest);
}

Configuration BallTube::measured_of_row(View y) const {
  if (!frame_.flat()) return measured(y);
  Configuration x(frame_.dimension());
  frame_.to_raw(y, x);
  return measured(x);
}

Configuration BallTube::measured(View x) const {
  Configuration z(space_.dimension());
  for (const Column& column : columns_) {
    if (!column.measured) continue;
    std::copy_n(x.begin() + static_cast<std::ptrdiff_t>(column.row), column.width,
                z.begin() + static_cast<std::ptrdiff_t>(column.part));
  }
  return z;
}

void BallTube::cut_path(const Configurations& path) {
  Configurations points(space_.dimension());
  for (std::size_t i = 0; i < path.size(); ++i) {
    Configuration z = measured(path[i]);
    space_.normalise(z);
    points.push(z);
  }
  const Configurations& at = points;
  length_ = path_length(space_, points);
  ends_ = Configurations(space_.dimension());
  ends_.push(at[0]);
  begin_.push_back(0.0);
  const double tolerance = thinning * thinning * radius_ * radius_;
  const auto bends = [&](std::size_t a, std::size_t b) {  // whether a motion from a to b misses a waypoint between
    if (space_.squared_distance(at[a], at[b]) > radius_ * radius_) return true;
    for (std::size_t i = a + 1; i < b; ++i) {
      if (nearest_on_motion(space_, at[a], at[b], at[i]).squared_distance > tolerance) return true;
    }
    return false;
  };
  Configuration z(space_.dimension());
  for (std::size_t a = 0; a + 1 < at.size();) {
    std::size_t b = a + 1;
    while (b + 1 < at.size() && b - a < run_limit && !bends(a, b + 1)) ++b;
    // Pieces as long as the radius: short enough for the search of nearest points, and not many.
    const double length = space_.distance(at[a], at[b]);
    const auto parts = static_cast<std::size_t>(std::max(1.0, std::ceil(length / radius_)));
    for (std::size_t i = 1; i <= parts && length > 0.0; ++i) {
      space_.interpolate(at[a], at[b], static_cast<double>(i) / static_cast<double>(parts), z);
      ends_.push(z);
      begin_.push_back(begin_.back() + length / static_cast<double>(parts));
    }
    a = b;
  }
}

/// Chooses the cover of the lesser volume.
///
/// The ends of the pieces are one choice of centres. A point of the tube is nearest to an end of a leg, or its nearest
/// point is the foot of a perpendicular at most half a piece from an end. In a space whose curvature nowhere is
/// negative, two points at right angles are no farther apart than in the plane (Toponogov): the radius that covers is
/// sqrt(radius^2 + (piece / 2)^2). Where waypoints are much denser than the radius, as on a path that bends everywhere,
/// centres evenly along it are fewer; they need the radius + spacing / 2, by the triangle inequality.
void BallTube::choose_centres() {
  double longest = 0.0;
  for (std::size_t i = 1; i < begin_.size(); ++i) longest = std::max(longest, begin_[i] - begin_[i - 1]);
  constexpr double margin = 1.0 + 1e-9;  // of rounding
  const std::size_t d = space_.degrees();
  reach_ = margin * std::sqrt(radius_ * radius_ + 0.25 * longest * longest);
  centres_ = ends_;
  double log_volume = std::log(static_cast<double>(centres_.size())) + log_ball(d, reach_);
  if (const double length = begin_.back(); length > 0.0) {
    const double best = 2.0 * radius_ / std::max(1.0, static_cast<double>(d) - 1.0);
    const double count = std::max(2.0, std::ceil(length / best) + 1.0);
    const double reach = margin * (radius_ + 0.5 * length / (count - 1.0));
    if (const double other = std::log(count) + log_ball(d, reach); other < log_volume) {
      log_volume = other;
      reach_ = reach;
      centres_ = evenly_spread(space_, ends_, static_cast<std::size_t>(count));
    }
  }
  log_cover_volume_ = log_volume + rest_.log_volume();
  for (std::size_t i = 1; i < centres_.size(); ++i) {
    pace_ = std::max(pace_, space_.distance(std::as_const(centres_)[i - 1], std::as_const(centres_)[i]));
  }
}

BallTube::Nearest BallTube::nearest(View z, double horizon) const {
  const std::size_t count = ends_.size();
  std::vector<double> to_end(count);
  Nearest best{horizon * horizon, 0.0};
  for (std::size_t i = 0; i < count; ++i) {
    const double squared = space_.squared_distance(std::as_const(ends_)[i], z);
    to_end[i] = std::sqrt(squared);
    if (squared < best.squared_distance) best = {squared, begin_[i]};
  }
  for (std::size_t i = 0; i + 1 < count; ++i) {
    const double length = begin_[i + 1] - begin_[i];
    // The triangle inequality bounds the distance to each point of the piece.
    const double least = 0.5 * (to_end[i] + to_end[i + 1] - length);
    if (least > 0.0 && least * least >= best.squared_distance) continue;
    const Foot foot = nearest_on_motion(space_, std::as_const(ends_)[i], std::as_const(ends_)[i + 1], z);
    if (foot.squared_distance < best.squared_distance) {
      best = {foot.squared_distance, begin_[i] + foot.t * length};
    }
  }
  return best;
}

bool BallTube::holds(View z) const {
  const std::size_t count = ends_.size();
  const double square = radius_ * radius_;
  std::vector<double> to_end(count);
  for (std::size_t i = 0; i < count; ++i) {
    to_end[i] = space_.squared_distance(std::as_const(ends_)[i], z);
    if (to_end[i] < square) return true;
  }
  for (std::size_t i = 0; i + 1 < count; ++i) {
    // The triangle inequality bounds the distance to each point of the piece.
    const double length = begin_[i + 1] - begin_[i];
    if (0.5 * (std::sqrt(to_end[i]) + std::sqrt(to_end[i + 1]) - length) >= radius_) continue;
    if (nearest_on_motion(space_, std::as_const(ends_)[i], std::as_const(ends_)[i + 1], z).squared_distance < square) {
      return true;
    }
  }
  return false;
}

bool BallTube::contains(View y) const { return holds(measured_of_row(y)); }

double BallTube::distance(View y) const {
  return std::sqrt(nearest(measured_of_row(y), std::numeric_limits<double>::infinity()).squared_distance);
}

double BallTube::along(View y) const {
  return std::min(length_, nearest(measured_of_row(y), std::numeric_limits<double>::infinity()).arc);
}

std::size_t BallTube::unit_dimension() const {
  constexpr std::size_t others = 3;  // the centre, the radius, and whether to accept
  return others + space_.degrees() + rest_.degrees();
}

double BallTube::multiplicity(View z, std::size_t own, View tangent) const {
  double sum = std::exp(-space_.log_jacobian(tangent));
  std::vector<double> other(space_.degrees());
  for (std::size_t i = 0; i < centres_.size(); ++i) {
    if (i == own) continue;
    const double squared = space_.squared_distance(std::as_const(centres_)[i], z);
    if (squared >= reach_ * reach_) {
      // By the triangle inequality neither contain it those that follow for a while.
      const double beyond = std::sqrt(squared) - reach_;
      if (pace_ > 0.0) i += static_cast<std::size_t>((1.0 - 1e-9) * beyond / pace_);
      continue;
    }
    space_.log(std::as_const(centres_)[i], z, other);
    sum += std::exp(-space_.log_jacobian(other));
  }
  return sum;
}

bool BallTube::draw(View unit, MutableView y) const {
  const std::size_t d = space_.degrees();
  const auto count = static_cast<double>(centres_.size());
  const std::size_t own = std::min(centres_.size() - 1, static_cast<std::size_t>(unit[0] * count));
  std::vector<double> tangent(d);
  in_unit_ball(unit.subspan(1, d), unit[d + 1], tangent);
  for (double& v : tangent) v *= reach_;
  if (!before_cut(space_, tangent)) return false;
  Configuration z(space_.dimension());
  space_.exp(std::as_const(centres_)[own], tangent, z);
  if (!space_.contains(z)) return false;
  if (!holds(z)) return false;
  if (unit[d + 2] * multiplicity(z, own, tangent) >= 1.0) return false;
  Configuration free(rest_.dimension());
  rest_.from_unit(unit.subspan(d + 3), free);
  for (const Column& column : columns_) {
    const Configuration& from = column.measured ? z : free;
    std::copy_n(from.begin() + static_cast<std::ptrdiff_t>(column.part), column.width,
                y.begin() + static_cast<std::ptrdiff_t>(column.row));
  }
  frame_.space().normalise(y);
  if (frame_.flat()) frame_.to_metric(Configuration(y.begin(), y.end()), y);
  return true;
}

}  // namespace trellis::measure
