// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/guide/position.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <optional>
#include <utility>
#include <vector>

#include <trellis/base/error.hpp>
#include <trellis/collision/checker.hpp>
#include <trellis/guide/path_guide.hpp>
#include <trellis/instance/characteristic_length.hpp>
#include <trellis/instance/forwarding_validity.hpp>

namespace trellis {

namespace {

/// Validity of positions within an arm's reach. Its world represents the unreachable part by obstacles with straight
/// sides; this class excludes the gap between these and the circle.
class ReachableValidity final : public ForwardingValidity<> {
 public:
  ReachableValidity(std::shared_ptr<Validity> positions, std::shared_ptr<const TipProjection> arm)
      : ForwardingValidity(std::move(positions)), arm_(std::move(arm)) {}
  [[nodiscard]] bool state(View s) override { return arm_->reaches(s) && inner_->state(s); }
  [[nodiscard]] MotionReport motion(View a, View b) override {
    if (!arm_->reaches(b)) return {false, 1, 1.0};
    return inner_->motion(a, b);
  }

 private:
  std::shared_ptr<const TipProjection> arm_;
};

/// Lifts the position of a reference point. The attempts take the previous angles, then those along the path, in either
/// direction, then any; the last attempts also lift nearby positions.
PointLift lift_of_reference_point(const PositionProjection& projection, const Instance& parent) {
  std::vector<std::size_t> headings;
  const std::vector<Axis> coordinates = parent.space.coordinates();
  const std::size_t width = parent.position_axes.size();
  for (std::size_t j = 0; j < coordinates.size(); ++j) {
    const bool kept =
        std::find(parent.position_axes.begin(), parent.position_axes.end(), j) != parent.position_axes.end();
    if (!kept && coordinates[j].periodic) headings.push_back(j);
  }
  const double wander = characteristic_length(parent);
  return [&projection, &parent, headings, wander, width](int attempt, View s, View previous, View ahead, Stream& stream,
                                                         MutableView q) {
    constexpr int here = 14;
    constexpr int most = 26;
    if (attempt >= most) return false;
    if (attempt > 2) {
      projection.lift(s, stream, q);
    } else {
      std::copy(previous.begin(), previous.end(), q.begin());
      for (std::size_t k = 0; k < width; ++k) q[parent.position_axes[k]] = s[k];
      if (attempt > 0 && width == 2) {
        const double turn = attempt == 1 ? 0.0 : std::numbers::pi;
        for (const std::size_t axis : headings) q[axis] = std::atan2(ahead[1] - s[1], ahead[0] - s[0]) + turn;
        parent.space.normalise(q);
      }
    }
    if (attempt >= here) {
      const double r = wander * static_cast<double>(attempt - here + 1) / (most - here);
      for (std::size_t k = 0; k < width; ++k) q[parent.position_axes[k]] += r * stream.uniform(-1.0, 1.0);
      parent.space.reflect(q);
    }
    return true;
  };
}

/// Lifts the position of a tip. The attempts take the configuration of the fibre nearest to the previous one, then
/// those nearest to increasingly different ones, then any; the last attempts also lift nearby positions.
PointLift lift_of_tip(const TipProjection& arm, const Instance& parent, int variation) {
  return [&arm, &parent, variation](int attempt, View s, View previous, View, Stream& stream, MutableView q) {
    constexpr int any = 16;
    constexpr int beside = 24;
    constexpr int most = 32;
    if (attempt >= most) return false;
    if (attempt >= any && attempt < beside) {
      arm.lift(s, stream, q);
      return true;
    }
    Configuration to(s.begin(), s.end());
    double share = std::min(1.0, static_cast<double>(attempt) / any + 0.2 * variation);
    if (attempt >= beside) {
      share = static_cast<double>(attempt - beside + 1) / (most - beside);
      const double r = share * 0.02 * arm.space().diameter();
      for (double& x : to) x += r * stream.uniform(-1.0, 1.0);
    }
    std::copy(previous.begin(), previous.end(), q.begin());
    // Standard deviation of up to an eighth of a turn per joint.
    const double spread = 0.25 * std::numbers::pi * share;
    if (spread > 0.0) {
      for (double& x : q) x += spread * stream.normal();
      parent.space.reflect(q);
    }
    if (!arm.follow(to, q)) arm.lift(s, stream, q);
    return true;
  };
}

}  // namespace

PositionProjection::PositionProjection(const std::string& guide, const Instance& parent,
                                       const std::vector<std::string>& link) {
  if (link.size() > 1) throw Error(fmt::format("{}: option 'point' names one link, got {}", guide, link.size()));
  if (!parent.position_axes.empty()) {
    if (!link.empty()) {
      throw Error(fmt::format("{}: option 'point' is \"{}\", and the robot '{}' is none of a URDF file", guide,
                              link.front(), parent.scene->robot_name()));
    }
    axes_ = std::make_shared<AxisProjection>(parent.space, parent.position_axes,
                                             fmt::format("R^{}", parent.position_axes.size()));
    return;
  }
  arm_ = tip_projection(guide, parent, link.empty() ? "" : link.front());
}

Configurations PositionProjection::lifted(const Configurations& path, View start, View goal) const {
  return arm_ ? arm_->lifted(path, start, goal) : axes_->lifted(path, start, goal);
}

PointLift PositionProjection::point_lift(const Instance& parent, int variation) const {
  return arm_ ? lift_of_tip(*arm_, parent, variation) : lift_of_reference_point(*this, parent);
}

double PositionProjection::spacing(const Instance& parent, const Instance& point) const {
  // The planner's step is a distance in C, not a distance of the tip.
  return arm_ ? characteristic_length(point) : sparse_spacing(parent);
}

std::unique_ptr<Instance> PositionProjection::point_instance(const Instance& parent) const {
  auto instance = std::make_unique<Instance>();
  instance->space = space();
  instance->scene = arm_ ? arm_->point_scene() : parent.scene->of_point();
  const auto known = collision_backends(*instance->scene);
  // The point of a manipulator is a body in space.
  const std::string collision =
      std::find(known.begin(), known.end(), parent.collision) != known.end() ? parent.collision : known.front();
  instance->validity = make_validity(collision, instance->scene, instance->space, parent.resolution, nullptr);
  if (arm_) instance->validity = std::make_shared<ReachableValidity>(instance->validity, arm_);
  project_ends(*this, parent, *instance);
  instance->goal_tolerance = parent.goal_tolerance;
  instance->resolution = parent.resolution;
  instance->collision = collision;
  instance->position_axes.resize(space().dimension());
  std::iota(instance->position_axes.begin(), instance->position_axes.end(), std::size_t{0});
  return instance;
}

}  // namespace trellis
