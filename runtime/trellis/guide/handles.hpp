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
#include <trellis/scene/planar/skeleton.hpp>

namespace trellis {

/// A handle point: a point fixed to a body.
struct Handle {
  std::size_t body = 0;
  Vec2 point;
};

/// Parses handles of a script: "x, y" on the first body, "n: x, y" on the n-th.
/// \param guide  name of the guide, for messages
/// \throws Error if a text is not a handle, or names a body that the robot lacks
std::vector<Handle> parse_handles(const std::string& guide, const std::vector<std::string>& texts, const Robot& robot);

/// Lifts positions by handle points: the given ones, and two on each other rotating body, at the ends of its longest
/// extent. The nearer its handles are to the medial axis, the more likely is the angle of a body; all other coordinates
/// are uniform.
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
  /// As of the position, with the most likely angles between start and goal.
  [[nodiscard]] Configurations lifted(const Configurations& path, View start, View goal) const override;

  /// Sets the angles of q to the most likely ones, given its position.
  void set_likely_angles(MutableView q) const;
  /// Moves and rotates the robot at q by iterative closest points, until its handles come no nearer to the medial axis.
  void draw_near(MutableView q) const;
  /// The root mean square distance of the handles from the medial axis, metres.
  [[nodiscard]] double distance(View q) const;
  /// Lifts the points of a path in S one after another. The attempts place the robot at the point with the angles of
  /// the previous waypoint, then with the most likely angles, then with drawn angles, each moved towards the medial
  /// axis. The last attempts also lift nearby positions.
  /// \param parent  outlives the result, as does this object
  [[nodiscard]] PointLift point_lift(const Instance& parent) const;
  /// Moves the points of a path of positions to the nearest points of the medial axis, where the motion to it is valid.
  /// \param point  the instance of a free point; it checks these motions
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
    double scale = 0.0;  ///< standard deviation of the likelihood in the distance from the medial axis, metres
    std::vector<Vec2> handles;
  };

  /// The probabilities of the bins of a joint's angle, given the position and the angles of the previous bodies.
  void chances(const Turn& turn, MutableView q, Chances& out) const;

  std::shared_ptr<const PositionProjection> position_;
  std::shared_ptr<const Scene> scene_;
  std::shared_ptr<const Field> field_;
  Space space_;                             ///< of C
  std::vector<std::size_t> position_axes_;  ///< of the reference point's position in C
  std::vector<Handle> handles_;             ///< handles of all bodies
  std::vector<Turn> turns_;                 ///< parents before their children
};

}  // namespace trellis
