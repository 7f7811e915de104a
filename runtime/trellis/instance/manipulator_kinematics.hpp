// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include <trellis/scene/spatial/manipulator_scene.hpp>
#include <trellis/space/space.hpp>

namespace trellis {

/// Inverse kinematics of a point of a manipulator, or of the frame about it, by damped least squares. Refers to the
/// robot and the space. Has scratch memory: only one thread may use it at a time.
class ManipulatorKinematics {
 public:
  /// \param space  whose first coordinates are the robot's
  ManipulatorKinematics(const SphereModel& robot, const Space& space, const PointOnBody& point);
  ~ManipulatorKinematics();
  ManipulatorKinematics(const ManipulatorKinematics&) = delete;
  ManipulatorKinematics& operator=(const ManipulatorKinematics&) = delete;

  /// Returns where the point is in the world.
  [[nodiscard]] Vec3 position(View q);
  /// Moves q by a short motion in the metric, within the bounds of the space, until its point lies within `near` metres
  /// of the target. \return whether it succeeded
  bool bring(MutableView q, const Vec3& target, double near);
  /// The same for the frame: the pose of the body, moved to the point. \param turn  radians
  bool bring(MutableView q, const Pose3& target, double near, double turn);
  /// The number of steps so far.
  [[nodiscard]] std::uint64_t steps() const { return steps_; }
  /// Returns the pose of that frame in the world.
  [[nodiscard]] Pose3 frame(View q);

 private:
  struct Scratch;
  bool solve(MutableView q, const Pose3& target, double near, double turn, bool oriented);
  /// Computes the frames of the joints between the base and the point, and that of the point.
  void place(View q);

  const SphereModel& robot_;
  const Space& space_;
  PointOnBody point_;
  std::vector<std::size_t> chain_;  ///< bodies from the base to that of the point
  std::vector<Pose3> frames_;       ///< of these, in the world
  Pose3 end_;
  std::uint64_t steps_ = 0;
  std::unique_ptr<Scratch> scratch_;
};

}  // namespace trellis
