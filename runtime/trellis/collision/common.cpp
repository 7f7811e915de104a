// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/collision/common.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include <trellis/base/error.hpp>

namespace trellis {

void check_fits(const Scene& scene, const Space& space, double resolution) {
  if (!std::isfinite(resolution) || resolution <= 0.0) {
    throw Error(fmt::format("the collision resolution must be a finite number greater than 0, got {}", resolution));
  }
  if (scene.body_count() == 0) throw Error("collision checking needs a robot with at least one body");
  if (space.dimension() < scene.robot_dimension()) {
    throw Error(fmt::format("robot '{}' needs {} axes, the space {} has {}", scene.robot_name(),
                            scene.robot_dimension(), space.name(), space.dimension()));
  }
}

double touching_slack(const Scene& scene) { return std::ldexp(scene.magnitude(), -43); }

std::vector<double> wraps(const Space& space, View a, View difference) {
  std::vector<double> found;
  for (std::size_t j = 0; j < space.dimension(); ++j) {
    const Axis& axis = space.axes()[j];
    if (!axis.periodic || difference[j] == 0.0) continue;
    // The ends of periods that lie between the ends of the motion; a itself need not be normalised.
    const double to = a[j] + difference[j];
    const double first = std::ceil((std::min(a[j], to) - axis.lo) / axis.period());
    const double last = std::floor((std::max(a[j], to) - axis.lo) / axis.period());
    for (double k = first; k <= last; ++k) {
      const double t = (axis.lo + k * axis.period() - a[j]) / difference[j];
      if (t > 0.0 && t < 1.0) found.push_back(t);
    }
  }
  std::sort(found.begin(), found.end());
  found.erase(std::unique(found.begin(), found.end()), found.end());
  return found;
}

void refuse_motion(double displacement, double resolution) {
  throw Error(fmt::format("a motion of {} m at resolution {} m would take checks of more than {} configurations",
                          displacement, resolution, most_configurations));
}

}  // namespace trellis
