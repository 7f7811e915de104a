// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <vector>

#include <trellis/scene/scene.hpp>
#include <trellis/space/space.hpp>

namespace trellis {

/// Inverse kinematics of one point of a robot by damped least squares. Refers to the robot and the space; has scratch
/// memory: one thread at a time.
class InverseKinematics {
 public:
  /// \param body   of the robot, that the point belongs to
  /// \param point  in the frame of that body
  InverseKinematics(const Robot& robot, const Space& space, std::size_t body, Vec2 point);

  /// Moves q, along the least way in the metric and within the bounds of the space, until its point lies at the target
  /// to within `near` metres; whether it got there.
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
