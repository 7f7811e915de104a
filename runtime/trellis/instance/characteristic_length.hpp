// SPDX-License-Identifier: GPL-3.0-or-later
// The lengths that default options are multiples of.
#pragma once

#include <trellis/instance/instance.hpp>

namespace trellis {

/// The robot's bounding radius; `otherwise` for a point, which has no size.
inline double size_or(const Scene& scene, double otherwise) {
  return scene.bounding_radius() > 0.0 ? scene.bounding_radius() : otherwise;
}

/// A distance in metres in the metric, by the size of an instance: the robot's bounding radius; 2 % of the space's
/// diameter for a point; 10 % for a robot that is fixed to its base, because its radius does not relate to its angles.
inline double characteristic_length(const Scene& scene, const Space& space) {
  return scene.translates() ? size_or(scene, 0.02 * space.diameter()) : 0.1 * space.diameter();
}
inline double characteristic_length(const Instance& instance) {
  return characteristic_length(*instance.scene, instance.space);
}

/// The planner's step; for a planner without one, the characteristic length. In metres in the metric.
inline double step_length(const Instance& instance) {
  return instance.step > 0.0 ? instance.step : characteristic_length(instance);
}

}  // namespace trellis
