// SPDX-License-Identifier: GPL-3.0-or-later
// Placements of the robot along the workspace's medial axis, by handle points.
#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <trellis/guide/position.hpp>
#include <trellis/scene/skeleton.hpp>

namespace trellis {

/// A handle point: the body that it is fixed to, and where in the body's frame.
struct Handle {
  std::size_t body = 0;
  Vec2 point;
};

/// Handles as scripts write them: "x, y" on the first body, "n: x, y" on the n-th. Throws Error, for the guide named,
/// for what is none, and for a body that the robot lacks.
std::vector<Handle> parse_handles(const std::string& guide, const std::vector<std::string>& texts, const Robot& robot);

/// Lifts positions by handle points: those given, and on each other body that turns two, at the ends of its longest
/// direction. The angle of a body is the likelier the nearer to the medial axis its handles come to lie; everything
/// else is uniform.
class HandleLift final : public Projection {
 public:
  HandleLift(std::shared_ptr<const PositionProjection> position, const Instance& parent,
             const std::vector<Handle>& given = {});
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
  /// Moves and turns the robot at q until its handles come no nearer to the medial axis, by iterative closest points.
  void draw_near(MutableView q) const;
  /// The root mean square of the handles' distances from the medial axis.
  [[nodiscard]] double distance(View q) const;
  /// Lifts points of a path in S one after another: the robot is placed there with the angles before, then with the
  /// likeliest, then with drawn ones, and drawn near to the medial axis; at last positions near it are lifted too.
  /// \param parent  outlives the result, as does this
  [[nodiscard]] PointLift point_lift(const Instance& parent) const;
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
    std::vector<Vec2> handles;
  };

  /// The chance of each bin of a turn's angle, given the position and the angles of the bodies before it.
  void chances(const Turn& turn, MutableView q, Chances& out) const;

  std::shared_ptr<const PositionProjection> position_;
  std::shared_ptr<const Scene> scene_;
  std::shared_ptr<const Field> field_;
  Space space_;                             ///< C
  std::vector<std::size_t> position_axes_;  ///< of C
  std::vector<Handle> handles_;             ///< of all bodies
  std::vector<Turn> turns_;                 ///< parents before what hangs on them
};

}  // namespace trellis
