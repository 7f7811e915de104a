// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <utility>
#include <vector>

#include <trellis/base/configurations.hpp>
#include <trellis/base/random.hpp>
#include <trellis/space/space.hpp>

namespace trellis {

// Distributions with closed densities, from which heuristics are made. Densities are with respect to volume in metric
// coordinates. What falls beyond a wall is reflected back into the space, so every density integrates to 1 over it.

/// The largest radius not above `wanted` at which balls of the space meet neither themselves round a periodic axis nor
/// two opposite walls at once.
double fitting_radius(const Space& space, double wanted);

/// Uniform on the metric ball about a centre.
class BallKernel {
 public:
  /// \param radius  metres, > 0; shortened by fitting_radius
  BallKernel(Space space, double radius);
  void sample(View centre, Stream& stream, MutableView out) const;
  [[nodiscard]] double density(View centre, View q) const;
  [[nodiscard]] double radius() const { return radius_; }
  [[nodiscard]] double log_volume() const { return log_volume_; }
  [[nodiscard]] const Space& space() const { return space_; }

 private:
  Space space_;
  double radius_;
  double log_volume_;
};

/// The tube about a path: a point of the path uniform in arc length over the active stretches, then uniform on the ball
/// about it.
class TubeKernel {
 public:
  /// \param path    at least one configuration of the space
  /// \param radius  metres, > 0; shortened by fitting_radius
  TubeKernel(const Space& space, Configurations path, double radius);

  /// The stretches [from, to] of arc length to draw from, disjoint and in order; the whole path at first.
  void activate(std::vector<std::pair<double, double>> stretches);
  void sample(Stream& stream, MutableView out);
  [[nodiscard]] double density(View q) const;

  [[nodiscard]] double length() const { return at_.back(); }
  [[nodiscard]] double radius() const { return ball_.radius(); }
  [[nodiscard]] const Configurations& path() const { return path_; }
  /// The point of the path at arc length s.
  void point(double s, MutableView out) const;

 private:
  BallKernel ball_;
  Configurations path_;
  std::vector<double> at_;  ///< arc length up to each point of the path
  std::vector<std::pair<double, double>> active_;
  double active_length_ = 0.0;
  Configuration centre_;  ///< scratch, so that drawing allocates nothing
};

}  // namespace trellis
