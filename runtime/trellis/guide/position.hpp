// SPDX-License-Identifier: GPL-3.0-or-later
// f of guides that look at where the robot is, and at nothing else of it.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include <trellis/guide/arm_projection.hpp>
#include <trellis/guide/axis_projection.hpp>
#include <trellis/guide/path_steps.hpp>
#include <trellis/instance/instance.hpp>

namespace trellis {

/// f: the position of the reference point, or of the tip of an arm that is fixed to its base. The fibre of a reference
/// point is everything else, uniform; that of a tip is drawn by inverse kinematics (ArmProjection).
class PositionProjection final : public Projection {
 public:
  /// Throws Error, for the guide named, where the robot has neither.
  PositionProjection(const std::string& guide, const Instance& parent);

  void project(View q, MutableView s) const override { of().project(q, s); }
  void lift(View s, Stream& stream, MutableView q) const override { of().lift(s, stream, q); }
  [[nodiscard]] bool closed_form() const override { return of().closed_form(); }
  [[nodiscard]] double log_fibre_density(View q) const override { return of().log_fibre_density(q); }
  [[nodiscard]] bool contracts() const override { return of().contracts(); }
  [[nodiscard]] double folded(View s, const std::function<double(View)>& density) const override {
    return of().folded(s, density);
  }

  [[nodiscard]] const Space& space() const { return arm_ ? arm_->space() : axes_->space(); }
  /// Whether it is the tip of an arm.
  [[nodiscard]] bool arm() const { return arm_ != nullptr; }
  /// What Guide::closed_fibre reports: a tip is reflected into what the arm reaches, so the density of what is lifted
  /// is not that of S times the fibre's.
  [[nodiscard]] bool closed_fibre() const { return !arm_; }
  /// A path in S with everything else turned from `start` to `goal`.
  [[nodiscard]] Configurations lifted(const Configurations& path, View start, View goal) const override;
  /// The instance of a free point in the parent's world; of an arm's tip in what the arm reaches of it.
  [[nodiscard]] std::unique_ptr<Instance> point_instance(const Instance& parent) const;
  /// Lifts points of a path in S one after another: to what is nearest to the configuration before, then to others.
  /// \param parent     whose space it lifts to; outlives the result, as does this projection
  /// \param variation  of an arm: the more, the farther its first attempts are from the configuration before
  [[nodiscard]] PointLift point_lift(const Instance& parent, int variation = 0) const;
  /// How often the path of a tip is lifted to other configurations before the place where C blocks it is refuted.
  static constexpr int most_variations = 3;
  /// The distance in S between points of a path that are validated in the parent, where no other one is asked for.
  /// \param point  the instance in S
  [[nodiscard]] double spacing(const Instance& parent, const Instance& point) const;

 private:
  [[nodiscard]] const Projection& of() const {
    if (arm_) return *arm_;
    return *axes_;
  }

  std::shared_ptr<const AxisProjection> axes_;
  std::shared_ptr<const ArmProjection> arm_;
};

/// Whether a guide that looks at the robot's position can guide in an instance.
bool has_position(const Instance& instance);

}  // namespace trellis
