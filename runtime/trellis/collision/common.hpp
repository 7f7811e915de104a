// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <trellis/collision/checker.hpp>
#include <trellis/scene/scene.hpp>

namespace trellis {

// Functions that all backends share.

/// \throws Error where a robot and a space do not fit or the resolution is not positive.
void check_fits(const Scene& scene, const Space& space, double resolution);

/// Returns the gap in metres below which bodies count as touching; also how far the robot may leave the boundary. It
/// bounds the accumulated rounding error in a world of this size.
double touching_slack(const Scene& scene);

/// Returns what checks of a scene cost, of all its backends: by the pieces, solids or balls of the robot, and by
/// whether meshes meet.
CheckCost check_cost(const Scene& scene);

/// Returns the parameters in (0, 1), ascending, at which the shortest motion from a passes an end of a periodic axis of
/// a flat space: only there can a robot jump.
/// \param difference  Space::difference of the motion's ends
std::vector<double> wraps(const Space& space, View a, View difference);

/// Whether the first `dimension` coordinates, which move the robot, are finite. A configuration with another coordinate
/// is invalid.
inline bool is_finite(View q, std::size_t dimension) {
  // 0 times infinity or NaN is NaN, 0 times a finite number is 0.
  double sum = 0.0;
  for (std::size_t j = 0; j < dimension; ++j) sum += 0.0 * q[j];
  return sum == 0.0;
}

/// The largest number of configurations at which a checker validates a motion.
inline constexpr double most_configurations = 1U << 26U;
[[noreturn]] void refuse_motion(double displacement, double resolution);

/// Returns the number of configurations at which a checker validates a motion with this bound on its displacement:
/// max(1, ceil of their ratio).
/// \throws Error where the number exceeds most_configurations.
inline std::uint32_t configurations_of(double displacement, double resolution) {
  const double count = displacement / resolution;
  if (!(count <= most_configurations)) refuse_motion(displacement, resolution);
  // Without SSE 4.1, std::ceil is a function call.
  const auto whole = static_cast<std::uint32_t>(count);
  const std::uint32_t up = whole + (static_cast<double>(whole) < count ? 1 : 0);
  return up == 0 ? 1 : up;
}

}  // namespace trellis
