// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>

#include <trellis/scene/scene.hpp>

namespace trellis {

// What all backends decide alike.

/// Throws Error where a robot and a space do not fit or the resolution is not positive.
void check_fits(const Scene& scene, const Space& space, double resolution);

/// How far apart, in metres, things may be and still count as touching, and how far the robot may stick out of the
/// boundary: what rounding may add up to in a world of its size.
double touching_slack(const Scene& scene);

/// Whether the coordinates that move the robot are all finite. A configuration that is not is invalid.
inline bool is_finite(const Robot& robot, View q) {
  // Nothing else times 0 is not 0.
  double sum = 0.0;
  for (std::size_t j = 0; j < robot.dimension(); ++j) sum += 0.0 * q[j];
  return sum == 0.0;
}

/// The most configurations that a motion may be looked at in.
inline constexpr double most_configurations = 1U << 26U;
[[noreturn]] void refuse_motion(double displacement, double resolution);

/// How many configurations a motion with this bound on its displacement is looked at in: max(1, ceil of their ratio).
/// Throws Error where that is beyond reason.
inline std::uint32_t configurations_of(double displacement, double resolution) {
  const double count = displacement / resolution;
  if (!(count <= most_configurations)) refuse_motion(displacement, resolution);
  // Without SSE 4.1, std::ceil is a call.
  const auto whole = static_cast<std::uint32_t>(count);
  const std::uint32_t up = whole + (static_cast<double>(whole) < count ? 1 : 0);
  return up == 0 ? 1 : up;
}

}  // namespace trellis
