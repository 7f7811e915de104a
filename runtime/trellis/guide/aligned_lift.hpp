// SPDX-License-Identifier: GPL-3.0-or-later
// States whose velocity points where an edge of the workspace's skeleton leads.
#pragma once

#include <memory>
#include <vector>

#include <trellis/guide/lifted.hpp>
#include <trellis/instance/instance.hpp>
#include <trellis/scene/shapes.hpp>

namespace trellis {

/// Lifts positions to states of a motion model that move along a direction: the cosine of the angle between it and the
/// velocity of the position is at least `alignment`. Of several directions each draw takes one. The velocity of a model
/// whose state has none is the one at its greatest speed.
class AlignedLift final : public Projection {
 public:
  /// \param position    uniform over headings and velocities; its fibres have a closed density
  /// \param directions  of length 1, at least one
  /// \param alignment   in (-1, 1)
  AlignedLift(std::shared_ptr<const Projection> position, std::shared_ptr<const MotionModel> model,
              std::vector<Vec2> directions, double alignment);

  /// Whether an instance has states that can be aligned.
  static bool applies(const Instance& instance);

  void project(View q, MutableView s) const override { position_->project(q, s); }
  void lift(View s, Stream& stream, MutableView q) const override;
  [[nodiscard]] bool closed_form() const override { return position_->closed_form(); }
  [[nodiscard]] double log_fibre_density(View q) const override;
  [[nodiscard]] bool contracts() const override { return position_->contracts(); }

 private:
  /// The direction in which the position moves at q; {0, 0} where it stands still.
  [[nodiscard]] Vec2 heading(View q) const;
  [[nodiscard]] bool aligned(Vec2 heading, Vec2 direction) const;

  std::shared_ptr<const Projection> position_;
  std::shared_ptr<const MotionModel> model_;
  std::vector<Vec2> directions_;
  double alignment_;
  double share_;  ///< of a fibre that is aligned with one direction
  Configuration fastest_;
};

}  // namespace trellis
