// SPDX-License-Identifier: GPL-3.0-or-later
// Ways out of obstacles, for samplers that look for their surface.
#pragma once

#include <vector>

#include <trellis/base/random.hpp>
#include <trellis/instance/instance.hpp>

namespace trellis {

/// Walks from an invalid configuration along a straight ray and stops just outside the obstacle. Its checks are the
/// instance's.
class WayOut {
 public:
  explicit WayOut(Instance& instance);

  /// A direction of length 1 m in the metric, evenly distributed.
  void draw_direction(Stream& stream);
  /// One in the plane of the position, at an angle.
  void set_direction(double angle);
  /// The valid configuration on the ray from q that lies at the surface, within the instance's resolution; into `out`.
  /// Returns how far it is from q in the metric, or infinity where the ray leaves the space before it is valid.
  double walk(View q, MutableView out);
  /// The configuration at a distance along the ray; whether it lies in the space.
  bool at(View q, double distance, MutableView out) const;

 private:
  Instance& instance_;
  std::vector<double> direction_;  ///< raw coordinates per metre
};

}  // namespace trellis
