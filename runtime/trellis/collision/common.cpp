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

void refuse_motion(double displacement, double resolution) {
  throw Error(fmt::format("a motion of {} m at resolution {} m would take checks of more than {} configurations",
                          displacement, resolution, most_configurations));
}

}  // namespace trellis
