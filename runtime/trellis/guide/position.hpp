// SPDX-License-Identifier: GPL-3.0-or-later
// f of guides that look at where the robot's reference point is and at nothing else of it.
#pragma once

#include <memory>
#include <string>

#include <trellis/guide/axis_projection.hpp>
#include <trellis/instance/instance.hpp>

namespace trellis {

/// f: the position of the reference point. The fibre is everything else, uniform.
class PositionProjection : public AxisProjection {
 public:
  /// Throws Error, for the guide named, where the robot's reference point does not move.
  PositionProjection(const std::string& guide, const Instance& parent);

  /// The instance of a free point in the parent's world.
  [[nodiscard]] std::unique_ptr<Instance> point_instance(const Instance& parent) const;
};

}  // namespace trellis
