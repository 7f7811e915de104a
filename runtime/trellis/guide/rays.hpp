// SPDX-License-Identifier: GPL-3.0-or-later
// Rays out of obstacles, for samplers of the obstacles' surface.
#pragma once

#include <array>
#include <vector>

#include <trellis/base/random.hpp>
#include <trellis/instance/instance.hpp>

namespace trellis {

/// Follows a straight ray from an invalid configuration to the surface of the obstacle. The instance counts the checks.
class SurfaceRay {
 public:
  explicit SurfaceRay(Instance& instance);

  /// Draws a uniform direction of length 1 m in the metric.
  void draw_direction(Stream& stream);
  /// Sets a direction in the plane of the position, by its angle in radians.
  void set_direction(double angle);
  /// Sets a direction of the position in space, of length 1.
  void set_direction(const std::array<double, 3>& direction);
  /// Finds the first valid configuration on the ray from q, within the instance's resolution of the surface.
  /// \param out  receives the configuration
  /// \return its distance from q in metres in the metric; infinity if the ray leaves the space first
  double walk(View q, MutableView out);
  /// Computes the configuration at a distance along the ray. Returns whether it lies in the space.
  bool at(View q, double distance, MutableView out) const;

 private:
  Instance& instance_;
  std::vector<double> direction_;     ///< per metre in the metric: coordinates of a flat space, else a tangent vector
  mutable std::vector<double> step_;  ///< scratch
};

}  // namespace trellis
