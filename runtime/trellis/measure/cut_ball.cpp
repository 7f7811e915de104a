// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/measure/cut_ball.hpp>

#include <algorithm>
#include <boost/math/special_functions/erf.hpp>
#include <cmath>

#include <trellis/base/clones.hpp>
#include <trellis/measure/low_discrepancy.hpp>

namespace trellis::measure {

namespace {

constexpr double log_half = -0.6931471805599453;

/// Adds `far` for each point, scaled by r, that falls outside of [begin, end].
TRELLIS_CLONES void cut(const double* points, std::size_t count, double r, double begin, double end, double far,
                        double* square) {
  for (std::size_t i = 0; i < count; ++i) {
    const double offset = r * points[i];
    const double below = offset < begin ? far : 0.0;
    const double above = offset > end ? far : 0.0;
    square[i] += below + above;
  }
}

/// Adds the squares of points of the unit interval, mapped to [begin, begin + width].
TRELLIS_CLONES void add_squares(const double* points, std::size_t count, double begin, double width, double* square) {
  for (std::size_t i = 0; i < count; ++i) {
    const double offset = begin + width * points[i];
    square[i] += offset * offset;
  }
}

/// The points of the balls of a flat space.
class FlatBallPoints : public BallPoints {
 public:
  FlatBallPoints(const Frame& frame, std::size_t points);
  [[nodiscard]] Region choose(View y, double r) const override;
  double place(const Region& region, View y, double r, std::size_t i, MutableView at) const override;
  [[nodiscard]] double log_volume(View y, double r) const override;

 private:
  /// The box's range of an axis.
  void range(std::size_t j, View y, double r, double& lo, double& width) const;

  Frame frame_;
  std::size_t points_;
  double log_unit_;
  std::vector<double> ball_;  // in the unit ball, axis by axis
  std::vector<double> cube_;  // in the unit cube, axis by axis
};

FlatBallPoints::FlatBallPoints(const Frame& frame, std::size_t points)
    : frame_(frame), points_(points), log_unit_(log_unit_ball(frame.dimension())) {
  const std::size_t d = frame_.dimension();
  const std::size_t half = points_ / 2;
  ball_.resize(d * points_);
  cube_.resize(d * points_);
  LowDiscrepancy sequence(d, std::vector<double>(d, 0.5 / static_cast<double>(half)));
  std::vector<double> u(d);
  for (std::size_t i = 0; i < half; ++i) {
    sequence.next(u);
    // The direction comes from normal deviates, the radius from strata: uniform in the ball in any dimension.
    std::vector<double> normal(d);
    double square = 0.0;
    for (std::size_t j = 0; j < d; ++j) {
      normal[j] = boost::math::erf_inv(std::clamp(2.0 * u[j] - 1.0, -1.0 + 1e-15, 1.0 - 1e-15));
      square += normal[j] * normal[j];
    }
    // The index, as one more coordinate of the sequence (Hammersley's set), gives the radius.
    const double level = (static_cast<double>(i) + 0.5) / static_cast<double>(half);
    const double radius = std::pow(level, 1.0 / static_cast<double>(d));
    const double scale = square > 0.0 ? radius / std::sqrt(square) : 0.0;
    for (std::size_t j = 0; j < d; ++j) {
      ball_[j * points_ + 2 * i] = normal[j] * scale;
      ball_[j * points_ + 2 * i + 1] = -normal[j] * scale;
      cube_[j * points_ + 2 * i] = u[j];
      cube_[j * points_ + 2 * i + 1] = 1.0 - u[j];
    }
  }
}

void FlatBallPoints::range(std::size_t j, View y, double r, double& lo, double& width) const {
  if (frame_.periodic(j)) {
    const double reach = std::min(r, 0.5 * frame_.period(j));
    lo = y[j] - reach;
    width = 2.0 * reach;
  } else {
    lo = std::max(y[j] - r, frame_.lo(j));
    width = std::min(y[j] + r, frame_.hi(j)) - lo;
  }
}

BallPoints::Region FlatBallPoints::choose(View y, double r) const {
  Region region;
  double log_box = 0.0;
  for (std::size_t j = 0; j < frame_.dimension(); ++j) {
    double lo = 0.0;
    double width = 0.0;
    range(j, y, r, lo, width);
    const bool meets =
        frame_.periodic(j) ? r > 0.5 * frame_.period(j) : y[j] - r < frame_.lo(j) || y[j] + r > frame_.hi(j);
    if (meets) region.whole = false;
    log_box += std::log(width);
  }
  region.log_volume = log_unit_ + static_cast<double>(frame_.dimension()) * std::log(r);
  // For a ball that one bound cuts, the antithetic points are best: they halve it exactly. Use the box only if it is
  // much smaller.
  if (!region.whole && log_box < region.log_volume + log_half) {
    region.ball = false;
    region.log_volume = log_box;
  }
  return region;
}

double FlatBallPoints::place(const Region& region, View y, double r, std::size_t i, MutableView at) const {
  double square = 0.0;
  for (std::size_t j = 0; j < frame_.dimension(); ++j) {
    double offset = 0.0;
    if (region.ball) {
      offset = r * ball_[j * points_ + i];
      if (frame_.periodic(j)) {
        if (std::abs(offset) > 0.5 * frame_.period(j)) return 0.0;
      } else if (y[j] + offset < frame_.lo(j) || y[j] + offset > frame_.hi(j)) {
        return 0.0;
      }
    } else {
      double lo = 0.0;
      double width = 0.0;
      range(j, y, r, lo, width);
      offset = lo + width * cube_[j * points_ + i] - y[j];
      square += offset * offset;
    }
    at[j] = frame_.fold(j, y[j] + offset);
  }
  return region.ball || square <= r * r ? 1.0 : 0.0;
}

double FlatBallPoints::log_volume(View y, double r) const {
  const Region region = choose(y, r);
  if (region.whole) return region.log_volume;
  const std::size_t d = frame_.dimension();
  std::vector<double> square(points_, 0.0);  // infinite where a point falls outside
  for (std::size_t j = 0; j < d; ++j) {
    double lo = 0.0;
    double width = 0.0;
    range(j, y, r, lo, width);
    const double begin = lo - y[j];
    const double end = begin + width;
    if (region.ball) {
      cut(&ball_[j * points_], points_, r, begin, end, 2.0 * r * r, square.data());
    } else {
      add_squares(&cube_[j * points_], points_, begin, width, square.data());
    }
  }
  std::size_t found = 0;
  for (const double s : square) found += s <= r * r ? 1 : 0;
  // The ball's centre lies in C, so the share is positive; half a point replaces a share below the resolution.
  const double share = std::max(static_cast<double>(found), 0.5) / static_cast<double>(points_);
  return region.log_volume + std::log(share);
}

}  // namespace

CutBall::CutBall(const Frame& frame, std::size_t points)
    : dimension_(frame.dimension()),
      points_(points),
      ball_(frame.flat() ? std::make_shared<const FlatBallPoints>(frame, points)
                         : curved_ball_points(frame.space(), points)) {}

}  // namespace trellis::measure
