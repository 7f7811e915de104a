// SPDX-License-Identifier: GPL-3.0-or-later
// States whose velocity is aligned with an edge of the workspace's skeleton.
#pragma once

#include <memory>
#include <vector>

#include <trellis/guide/lifted.hpp>
#include <trellis/instance/instance.hpp>
#include <trellis/scene/planar/shapes.hpp>

namespace trellis {

/// Lifts positions to states of a motion model that move along a direction: the cosine of the angle between the
/// direction and the position's velocity is at least `alignment`. Each draw picks one of the directions. If the state
/// of the model has no velocity, the velocity at full speed counts.
class AlignedLift final : public Projection {
 public:
  /// \param position  lift that is uniform over headings and velocities; its fibres have a closed density
  /// \param directions  unit vectors, at least one
  /// \param alignment  in (-1, 1)
  AlignedLift(std::shared_ptr<const Projection> position, std::shared_ptr<const MotionModel> model,
              std::vector<Vec2> directions, double alignment);

  /// Whether the states of an instance have a velocity or heading to align.
  static bool applies(const Instance& instance);

  void project(View q, MutableView s) const override { position_->project(q, s); }
  void lift(View s, Stream& stream, MutableView q) const override;
  [[nodiscard]] bool closed_form() const override { return position_->closed_form(); }
  [[nodiscard]] double log_fibre_density(View q) const override;
  [[nodiscard]] bool contracts() const override { return position_->contracts(); }

 private:
  /// The direction of the position's velocity at q; {0, 0} if it is 0.
  [[nodiscard]] Vec2 heading(View q) const;
  [[nodiscard]] bool aligned(Vec2 heading, Vec2 direction) const;

  std::shared_ptr<const Projection> position_;
  std::shared_ptr<const MotionModel> model_;
  std::vector<Vec2> directions_;
  double alignment_;
  double share_;  ///< share of a fibre that is aligned with one direction
  Configuration fastest_;
};

}  // namespace trellis
