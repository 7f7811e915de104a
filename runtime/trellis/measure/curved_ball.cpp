// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include <trellis/measure/cut_ball.hpp>
#include <trellis/measure/low_discrepancy.hpp>
#include <trellis/measure/tangent_ball.hpp>

namespace trellis::measure {

namespace {

constexpr double log_half = -0.6931471805599453;
constexpr std::size_t turn = 3;  // degrees of freedom of a rotation

class CurvedBallPoints : public BallPoints {
 public:
  CurvedBallPoints(const Space& space, std::size_t points);
  [[nodiscard]] Region choose(View y, double r) const override;
  double place(const Region& region, View y, double r, std::size_t i, MutableView at) const override;
  [[nodiscard]] double log_volume(View y, double r) const override;

 private:
  /// The lengths of the box along a line or a circle, relative to y, in metres.
  struct Range {
    double lo = 0.0;
    double hi = 0.0;
  };
  static Range range(const Factor& factor, View y, double r);
  /// Returns the radius of the box's ball of turns.
  static double reach(const Factor& factor, double r) { return std::min(r, std::numbers::pi * factor.axis.weight); }
  /// Computes the i-th tangent vector. \return the factor by which `exp` changes volumes there; 0 where its end lies
  /// outside of the ball or of C
  double tangent(const Region& region, View y, double r, std::size_t i, MutableView v) const;

  Space space_;
  std::size_t points_;
  double log_unit_;
  std::vector<double> ball_;  // in the unit ball, point by point
  std::vector<double> box_;   // the same in the product of unit intervals and unit balls of turns
};

/// Maps three numbers of the unit cube to the unit ball with uniform density.
void in_ball_of_turns(const double* unit, double* out) {
  const double radius = std::cbrt(unit[0]);
  const double height = 2.0 * unit[1] - 1.0;
  const double across = std::sqrt(std::max(0.0, 1.0 - height * height));
  const double angle = 2.0 * std::numbers::pi * unit[2];
  out[0] = radius * across * std::cos(angle);
  out[1] = radius * across * std::sin(angle);
  out[2] = radius * height;
}

CurvedBallPoints::CurvedBallPoints(const Space& space, std::size_t points)
    : space_(space), points_(points), log_unit_(log_unit_ball(space.degrees())) {
  const std::size_t d = space.degrees();
  const std::size_t half = points / 2;
  LowDiscrepancy sequence(d, std::vector<double>(d, 0.5 / static_cast<double>(half)));
  std::vector<double> u(d);
  std::vector<double> v(d);
  ball_.reserve(d * points);
  box_.reserve(d * points);
  for (std::size_t i = 0; i < half; ++i) {
    sequence.next(u);
    in_unit_ball(u, (static_cast<double>(i) + 0.5) / static_cast<double>(half), v);
    ball_.insert(ball_.end(), v.begin(), v.end());
    for (const double x : v) ball_.push_back(-x);
    std::size_t j = 0;
    for (const Factor& factor : space.factors()) {
      if (factor.kind == Factor::Kind::rotation) {
        in_ball_of_turns(&u[j], &v[j]);
      } else {
        v[j] = u[j];
      }
      j += factor.degrees();
    }
    box_.insert(box_.end(), v.begin(), v.end());
    j = 0;
    for (const Factor& factor : space.factors()) {
      const bool rotation = factor.kind == Factor::Kind::rotation;
      for (std::size_t k = 0; k < factor.degrees(); ++k, ++j) box_.push_back(rotation ? -v[j] : 1.0 - v[j]);
    }
  }
}

CurvedBallPoints::Range CurvedBallPoints::range(const Factor& factor, View y, double r) {
  const Axis& axis = factor.axis;
  if (factor.kind == Factor::Kind::circle) {
    const double half = std::min(r, 0.5 * axis.weight * axis.period());
    return {-half, half};
  }
  const double at = y[factor.column];
  return {std::max(-r, axis.weight * (axis.lo - at)), std::min(r, axis.weight * (axis.hi - at))};
}

BallPoints::Region CurvedBallPoints::choose(View y, double r) const {
  Region region;
  double log_box = 0.0;
  for (const Factor& factor : space_.factors()) {
    if (factor.kind == Factor::Kind::rotation) {
      const double turns = reach(factor, r);
      if (turns < r) region.whole = false;
      log_box += log_unit_ball(turn) + static_cast<double>(turn) * std::log(turns);
    } else {
      const Range part = range(factor, y, r);
      if (part.lo > -r || part.hi < r) region.whole = false;
      log_box += std::log(part.hi - part.lo);
    }
  }
  region.log_volume = log_unit_ + static_cast<double>(space_.degrees()) * std::log(r);
  if (!region.whole && log_box < region.log_volume + log_half) {
    region.ball = false;
    region.log_volume = log_box;
  }
  return region;
}

/// Returns exp(log_jacobian_of_rotation(angle)) by the series of (2 - 2 cos(angle)) / angle^2, to 1e-12 up to a half
/// turn: this is the inner loop of all volumes of balls.
double jacobian_of_rotation(double square_of_angle) {
  double sum = 0.0;
  constexpr int terms = 12;
  for (int k = terms; k > 0; --k) {
    sum = (1.0 - sum) * square_of_angle / ((2.0 * k + 1.0) * (2.0 * k + 2.0));
  }
  return 1.0 - sum;
}

double CurvedBallPoints::tangent(const Region& region, View y, double r, std::size_t i, MutableView v) const {
  const std::size_t d = space_.degrees();
  const double* point = (region.ball ? ball_.data() : box_.data()) + i * d;
  std::size_t j = 0;
  double square = 0.0;
  double factor_of_volume = 1.0;
  for (const Factor& factor : space_.factors()) {
    if (factor.kind == Factor::Kind::rotation) {
      const double scale = region.ball ? r : reach(factor, r);
      double turns = 0.0;
      for (std::size_t k = j; k < j + turn; ++k) {
        v[k] = scale * point[k];
        turns += v[k] * v[k];
      }
      const double most = std::numbers::pi * factor.axis.weight;
      if (turns > most * most) return 0.0;
      square += turns;
      factor_of_volume *= jacobian_of_rotation(turns / (factor.axis.weight * factor.axis.weight));
    } else {
      const Range part = range(factor, y, r);
      v[j] = region.ball ? r * point[j] : part.lo + (part.hi - part.lo) * point[j];
      if (v[j] < part.lo || v[j] > part.hi) return 0.0;
      square += v[j] * v[j];
    }
    j += factor.degrees();
  }
  return region.ball || square <= r * r ? factor_of_volume : 0.0;
}

double CurvedBallPoints::place(const Region& region, View y, double r, std::size_t i, MutableView at) const {
  std::vector<double> v(space_.degrees());
  const double share = tangent(region, y, r, i, v);
  if (share == 0.0) return share;
  space_.exp(y, v, at);
  // The sum may leave the bounds by a rounding error; a point of C must stay in C.
  for (const Factor& factor : space_.factors()) {
    double& x = at[factor.column];
    if (factor.kind == Factor::Kind::line) x = std::clamp(x, factor.axis.lo, factor.axis.hi);
  }
  return share;
}

double CurvedBallPoints::log_volume(View y, double r) const {
  const Region region = choose(y, r);
  std::vector<double> v(space_.degrees());
  double found = 0.0;
  for (std::size_t i = 0; i < points_; ++i) found += tangent(region, y, r, i, v);
  // The ball's centre lies in C, so the share is positive; half a point replaces a share below the resolution.
  return region.log_volume + std::log(std::max(found, 0.5) / static_cast<double>(points_));
}

}  // namespace

std::shared_ptr<const BallPoints> curved_ball_points(const Space& space, std::size_t points) {
  return std::make_shared<const CurvedBallPoints>(space, points);
}

}  // namespace trellis::measure
