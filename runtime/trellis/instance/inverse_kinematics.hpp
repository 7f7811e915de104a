// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <vector>

#include <trellis/scene/planar/scene.hpp>
#include <trellis/space/space.hpp>

namespace trellis {

/// Inverse kinematics of one point of a robot by damped least squares. Refers to the robot and the space. Has scratch
/// memory: only one thread may use it at a time.
class InverseKinematics {
 public:
  /// \param body   the robot's body of the point
  /// \param point  in the frame of that body, metres
  InverseKinematics(const Robot& robot, const Space& space, std::size_t body, Vec2 point);

  /// Moves q by the least distance in the metric, within the bounds of the space, until its point lies within `near`
  /// metres of the target. \return whether it succeeded
  bool bring(MutableView q, Vec2 target, double near);

 private:
  Vec2 point_at(View q);

  const Robot& robot_;
  const Space& space_;
  std::size_t body_;
  Vec2 point_;
  std::vector<Pose2> poses_;
  std::vector<Vec2> columns_;  ///< of the Jacobian
};

}  // namespace trellis
