// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <vector>

#include <trellis/base/configurations.hpp>
#include <trellis/space/space.hpp>

namespace trellis {

/// The greatest speed and the greatest acceleration of each coordinate of a space: radians or metres a second, and a
/// second squared; all > 0.
struct RateLimits {
  std::vector<double> velocity;
  std::vector<double> acceleration;
};

/// A motion along a path's polygon in the least time in which it starts and ends at rest and stops where the path
/// bends: on each straight leg all coordinates speed up, keep their speeds and slow down together, at the limits of the
/// coordinate that needs longest (a trapezoid of speeds, or a triangle). A coordinate that wraps is continued beyond
/// its bounds, so that it never jumps.
class TimedPath {
 public:
  struct Sample {
    double time = 0.0;  ///< seconds
    Configuration position;
    std::vector<double> velocity;
  };

  /// \param space  a flat space
  /// \param path   at least one configuration of it
  /// \throws Fault for another space, and for limits that are not greater than 0 or too few
  TimedPath(const Space& space, const Configurations& path, RateLimits limits);

  /// Seconds from the start to the end; 0 of a path that does not move.
  [[nodiscard]] double duration() const { return duration_; }
  /// Returns when the motion is at each point of the path.
  [[nodiscard]] const std::vector<double>& times() const { return times_; }
  /// The number of straight legs, between which the motion stops.
  [[nodiscard]] std::size_t legs() const { return legs_.size(); }
  /// Returns where the motion is, and how fast. \param time  in [0, duration]; others are moved to it
  [[nodiscard]] Sample at(double time) const;
  /// Returns the motion where its acceleration changes and at all points of the path, and in between so that two
  /// samples are at most `spacing` seconds apart: cubic splines through positions and speeds give the motion exactly.
  [[nodiscard]] std::vector<Sample> samples(double spacing) const;

 private:
  struct Leg {
    Configuration from;
    std::vector<double> change;  ///< of each coordinate
    double begin = 0.0;          ///< seconds
    double duration = 0.0;
    double speed = 0.0;  ///< greatest, in legs a second
    double acceleration = 0.0;

    [[nodiscard]] double ramp() const { return speed / acceleration; }
    /// Returns when a share of the leg is done, in seconds from its begin.
    [[nodiscard]] double time_of(double share) const;
  };
  void add_leg(Configuration from, std::vector<double> change, const RateLimits& limits);

  std::vector<Leg> legs_;
  std::vector<double> times_;
  Configuration start_;
  double duration_ = 0.0;
};

}  // namespace trellis
