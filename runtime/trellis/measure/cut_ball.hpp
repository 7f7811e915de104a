// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

#include <trellis/measure/frame.hpp>

namespace trellis::measure {

/// Volumes of metric balls intersected with the space, or with a part of it, by fixed antithetic points. Each ball uses
/// the same points, so a result does not depend on the order of calls.
///
/// The points fill the ball itself or, where that is much smaller, the intersection of the ball's bounding box with the
/// space: for a ball much wider than the space, few points of the ball lie inside. On a periodic axis a ball extends at
/// most half a period, because the metric takes the shorter direction.
class CutBall {
 public:
  /// \param points  number of fixed points, even
  CutBall(const Frame& frame, std::size_t points);

  /// Returns the log of the volume of the ball of radius r > 0 around y (metric coordinates) within C.
  [[nodiscard]] double log_volume(View y, double r) const;

  /// Returns the log of the volume of that part of the ball within C where inside(point) is true, point in metric
  /// coordinates; -infinity where no point is inside.
  template <class Inside>
  [[nodiscard]] double log_volume(View y, double r, const Inside& inside) const {
    const Region region = choose(y, r);
    std::vector<double> at(frame_.dimension());
    std::size_t found = 0;
    for (std::size_t i = 0; i < points_; ++i) {
      if (place(region, y, r, i, at) && inside(View(at))) ++found;
    }
    return region.log_volume + std::log(static_cast<double>(found) / static_cast<double>(points_));
  }

 private:
  struct Region {
    bool ball = true;   ///< the points fill the ball, else the box
    bool whole = true;  ///< the ball reaches neither a bound nor its own periodic image
    double log_volume = 0.0;
  };
  [[nodiscard]] Region choose(View y, double r) const;
  /// The box's range of an axis.
  void range(std::size_t j, View y, double r, double& lo, double& width) const;
  /// Computes the i-th fixed point; returns false where it lies outside of the ball or of C.
  bool place(const Region& region, View y, double r, std::size_t i, MutableView at) const;

  Frame frame_;
  std::size_t points_;
  double log_unit_;
  std::vector<double> ball_;  // in the unit ball, axis by axis
  std::vector<double> cube_;  // in the unit cube, axis by axis
};

}  // namespace trellis::measure
