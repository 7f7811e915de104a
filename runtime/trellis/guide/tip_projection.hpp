// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <string>

#include <trellis/guide/lifted.hpp>
#include <trellis/instance/instance.hpp>

namespace trellis {

/// f of a robot that is fixed to its base: the position of its tip, or of another point that it carries. The lift is
/// inverse kinematics.
class TipProjection : public Projection {
 public:
  /// S: a box about what the point reaches.
  [[nodiscard]] virtual const Space& space() const = 0;
  /// The scene of the point alone.
  [[nodiscard]] virtual std::shared_ptr<const Scene> point_scene() const = 0;
  /// False for positions that the point certainly cannot reach.
  [[nodiscard]] virtual bool reaches(View s) const = 0;
  /// Moves q by a short motion in the metric, within its bounds, until f(q) is nearly s. \return whether it succeeds
  [[nodiscard]] virtual bool follow(View s, MutableView q) const = 0;
  /// Whether `lift` finds a configuration of each fibre that has one, joint limits apart. Else a failure says little.
  [[nodiscard]] virtual bool complete() const = 0;
  /// Draws a configuration of the fibre of s; a uniform one where it finds none.
  void lift(View s, Stream& stream, MutableView q) const override = 0;
  /// A path in S, lifted to configurations near the straight motion from `start` to `goal`; without the positions that
  /// `follow` does not bring it to.
  [[nodiscard]] Configurations lifted(const Configurations& path, View start, View goal) const final;

 protected:
  explicit TipProjection(Space parent) : parent_(std::move(parent)) {}
  /// C.
  [[nodiscard]] const Space& parent() const { return parent_; }

 private:
  Space parent_;
};

/// Makes f of an instance of a robot without a position of its own.
/// \param guide  for messages
/// \param link   the link whose frame's origin is the point; "": the tip of the robot
/// \throws Error where the robot has no such point
std::shared_ptr<const TipProjection> tip_projection(const std::string& guide, const Instance& parent,
                                                    const std::string& link);

}  // namespace trellis
