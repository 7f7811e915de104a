// SPDX-License-Identifier: GPL-3.0-or-later
// f of guides that use only the position of the robot.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <trellis/base/component.hpp>
#include <trellis/guide/axis_projection.hpp>
#include <trellis/guide/path_steps.hpp>
#include <trellis/guide/tip_projection.hpp>
#include <trellis/instance/instance.hpp>

namespace trellis {

/// f: the position of the reference point, or of the tip of an arm that is fixed to its base. The fibre of a reference
/// point consists of all other coordinates, uniformly; inverse kinematics draws the fibre of a tip (TipProjection).
class PositionProjection final : public Projection {
 public:
  /// \param guide  name of the guide, for messages
  /// \param link   of a manipulator, at most one: the link whose frame's origin is the point; else its tip
  /// \throws Error if the robot has neither, or no such link
  PositionProjection(const std::string& guide, const Instance& parent, const std::vector<std::string>& link = {});

  void project(View q, MutableView s) const override { of().project(q, s); }
  void lift(View s, Stream& stream, MutableView q) const override { of().lift(s, stream, q); }
  [[nodiscard]] bool closed_form() const override { return of().closed_form(); }
  [[nodiscard]] double log_fibre_density(View q) const override { return of().log_fibre_density(q); }
  [[nodiscard]] bool contracts() const override { return of().contracts(); }
  [[nodiscard]] double folded(View s, const std::function<double(View)>& density) const override {
    return of().folded(s, density);
  }

  [[nodiscard]] const Space& space() const { return arm_ ? arm_->space() : axes_->space(); }
  /// Whether the position is that of an arm's tip.
  [[nodiscard]] bool arm() const { return arm_ != nullptr; }
  /// See TipProjection::complete; true of a reference point.
  [[nodiscard]] bool complete() const { return !arm_ || arm_->complete(); }
  /// As Guide::closed_fibre. False for a tip: its position is reflected into the reachable set, so the lifted density
  /// is not that over S times the fibre's.
  [[nodiscard]] bool closed_fibre() const { return !arm_; }
  /// A path in S; the other coordinates are interpolated from `start` to `goal`.
  [[nodiscard]] Configurations lifted(const Configurations& path, View start, View goal) const override;
  /// The instance of a free point in the parent's world; for an arm's tip, in the reachable part of the world.
  [[nodiscard]] std::unique_ptr<Instance> point_instance(const Instance& parent) const;
  /// Lifts the points of a path in S one after another: first to the configuration nearest to the previous one, then to
  /// others.
  /// \param parent  the instance to lift to; outlives the result, as does this projection
  /// \param variation  for an arm: larger values start farther from the previous configuration
  [[nodiscard]] PointLift point_lift(const Instance& parent, int variation = 0) const;
  /// How often the path of a tip is lifted to other configurations before a place that C blocks is refuted.
  static constexpr int most_variations = 3;
  /// Default distance in S between the points of a path that the parent validates, in metres in the metric.
  /// \param point  the instance in S
  [[nodiscard]] double spacing(const Instance& parent, const Instance& point) const;

 private:
  [[nodiscard]] const Projection& of() const {
    if (arm_) return *arm_;
    return *axes_;
  }

  std::shared_ptr<const AxisProjection> axes_;
  std::shared_ptr<const TipProjection> arm_;
};

/// Declares the option `point` of a guide.
template <class S>
Settings<S> with_point(Settings<S> settings) {
  return settings.names("point", &S::point,
                        "of a robot of a URDF file, the link whose frame's origin is its position, as \"panda_hand\"; "
                        "without it the middle of the last body of its longest chain");
}

}  // namespace trellis
