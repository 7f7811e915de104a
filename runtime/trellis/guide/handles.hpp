// SPDX-License-Identifier: GPL-3.0-or-later
// Angles that go with a position: those that lay the robot along the workspace's medial axis.
#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <vector>

#include <trellis/guide/position.hpp>
#include <trellis/scene/skeleton.hpp>

namespace trellis {

/// Lifts positions by handle points: two on each body that turns, at the ends of its longest direction. The angle of a
/// body is the likelier the nearer to the medial axis its handles come to lie; everything else is uniform.
class HandleLift final : public Projection {
 public:
  HandleLift(std::shared_ptr<const PositionProjection> position, const Instance& parent);
  ~HandleLift() override;
  HandleLift(const HandleLift&) = delete;
  HandleLift& operator=(const HandleLift&) = delete;
  HandleLift(HandleLift&&) = delete;
  HandleLift& operator=(HandleLift&&) = delete;

  void project(View q, MutableView s) const override { position_->project(q, s); }
  void lift(View s, Stream& stream, MutableView q) const override;
  [[nodiscard]] bool closed_form() const override { return true; }
  [[nodiscard]] double log_fibre_density(View q) const override;
  [[nodiscard]] bool contracts() const override { return position_->contracts(); }

  /// Sets the angles of q, whose position is set, to the likeliest.
  void settle(MutableView q) const;
  /// A path of positions, moved to the medial axis: each point to the nearest of the axis where the way there is free.
  /// \param point  the free point's instance, whose motions look at the ways
  [[nodiscard]] Configurations on_axis(const Configurations& path, Instance& point) const;

 private:
  class Field;
  static constexpr std::size_t bins = 64;
  using Chances = std::array<double, bins>;
  struct Turn {
    std::size_t body = 0;
    std::size_t axis = 0;
    double lo = 0.0;
    double width = 0.0;  ///< of a bin, radians
    double scale = 0.0;  ///< distance from the medial axis that counts, metres
    std::array<Vec2, 2> handles;
  };

  /// The chance of each bin of a turn's angle, given the position and the angles of the bodies before it.
  void chances(const Turn& turn, MutableView q, Chances& out) const;

  std::shared_ptr<const PositionProjection> position_;
  std::shared_ptr<const Scene> scene_;
  std::shared_ptr<const Field> field_;
  std::vector<Turn> turns_;  ///< parents before what hangs on them
};

}  // namespace trellis
