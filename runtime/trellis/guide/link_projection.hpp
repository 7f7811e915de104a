// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>

#include <trellis/guide/tip_projection.hpp>
#include <trellis/instance/manipulator_kinematics.hpp>
#include <trellis/scene/spatial/manipulator_scene.hpp>

namespace trellis {

/// f of a manipulator: the position of a point that one of its bodies carries. `lift` starts inverse kinematics from
/// uniform configurations; the density of what it draws is unknown.
class LinkProjection final : public TipProjection {
 public:
  LinkProjection(const Instance& parent, const PointOnBody& point);

  void project(View q, MutableView s) const override;
  void lift(View s, Stream& stream, MutableView q) const override;
  [[nodiscard]] bool closed_form() const override { return false; }
  [[nodiscard]] double log_fibre_density(View q) const override;
  [[nodiscard]] bool complete() const override { return false; }
  [[nodiscard]] const Space& space() const override { return space_; }
  [[nodiscard]] std::shared_ptr<const Scene> point_scene() const override { return point_scene_; }
  [[nodiscard]] bool reaches(View s) const override;
  [[nodiscard]] bool follow(View s, MutableView q) const override;

 private:
  /// Counts the work of a lift.
  void count(const ManipulatorKinematics& kinematics) const;

  std::shared_ptr<const Scene> scene_;  ///< of the parent
  const SphereModel& robot_;
  PointOnBody point_;
  std::shared_ptr<double> lift_work_;  ///< of the parent
  Vec3 centre_;         ///< the first joint's position, about which the point stays within `reach_`; of a base that
                        ///< does not move
  double reach_ = 0.0;  ///< metres; infinity for a base that moves
  double near_ = 0.0;   ///< metres from s that count as s
  Space space_;
  std::shared_ptr<const Scene> point_scene_;
};

}  // namespace trellis
