// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <cstddef>
#include <memory>
#include <vector>

#include <trellis/measure/frame.hpp>

namespace trellis::measure {

/// Fixed antithetic points of the balls of a space, and their share in it.
///
/// The points fill the ball itself or, where that is much smaller, the intersection of the ball's bounding box with the
/// space: for a ball much wider than the space, few points of the ball lie inside. On a periodic axis a ball extends at
/// most half a period, because the metric takes the shorter direction.
class BallPoints {
 public:
  struct Region {
    bool ball = true;   ///< the points fill the ball, else the box
    bool whole = true;  ///< the ball reaches neither a bound nor its own periodic image
    double log_volume = 0.0;
  };

  virtual ~BallPoints() = default;
  BallPoints() = default;
  BallPoints(const BallPoints&) = delete;
  BallPoints& operator=(const BallPoints&) = delete;

  [[nodiscard]] virtual Region choose(View y, double r) const = 0;
  /// Computes the i-th fixed point, a row of the frame. \return the volume at it in shares of the region's, 1 in a flat
  /// space; 0 where the point lies outside of the ball or of C
  virtual double place(const Region& region, View y, double r, std::size_t i, MutableView at) const = 0;
  /// Returns the log of the volume of the ball of radius r > 0 around y within C.
  [[nodiscard]] virtual double log_volume(View y, double r) const = 0;
};

/// The points of the balls of a space with rotations: those of the ball of tangent vectors and `exp` of them, with the
/// factor by which it changes volumes. The box is the product of ranges and, for each rotation, of a ball of turns.
std::shared_ptr<const BallPoints> curved_ball_points(const Space& space, std::size_t points);

/// Volumes of metric balls intersected with the space, or with a part of it, by fixed points. Each ball uses the same
/// points, so a result does not depend on the order of calls.
class CutBall {
 public:
  /// \param points  number of fixed points, even
  CutBall(const Frame& frame, std::size_t points);

  /// Returns the log of the volume of the ball of radius r > 0 around y, a row of the frame, within C.
  [[nodiscard]] double log_volume(View y, double r) const { return ball_->log_volume(y, r); }

  /// Returns the log of the volume of that part of the ball within C where inside(point) is true, point a row of the
  /// frame; -infinity where no point is inside.
  template <class Inside>
  [[nodiscard]] double log_volume(View y, double r, const Inside& inside) const {
    const BallPoints::Region region = ball_->choose(y, r);
    std::vector<double> at(dimension_);
    double found = 0.0;
    for (std::size_t i = 0; i < points_; ++i) {
      const double share = ball_->place(region, y, r, i, at);
      if (share > 0.0 && inside(View(at))) found += share;
    }
    return region.log_volume + std::log(found / static_cast<double>(points_));
  }

 private:
  std::size_t dimension_;
  std::size_t points_;
  std::shared_ptr<const BallPoints> ball_;
};

}  // namespace trellis::measure
