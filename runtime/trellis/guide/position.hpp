// SPDX-License-Identifier: GPL-3.0-or-later
// f of guides that look at where the robot's reference point is and at nothing else of it.
#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <trellis/base/random.hpp>
#include <trellis/instance/instance.hpp>
#include <trellis/planner/density.hpp>

namespace trellis {

/// f: the position of the reference point. The fibre is everything else, uniform.
class PositionProjection {
 public:
  /// Throws Error, for the guide named, where the robot's reference point does not move.
  PositionProjection(const std::string& guide, const Instance& parent);

  void project(View q, MutableView s) const {
    s[0] = q[position_[0]];
    s[1] = q[position_[1]];
  }
  void lift(View s, Stream& stream, MutableView q) const {
    parent_.sample_uniform(stream, q);
    q[position_[0]] = s[0];
    q[position_[1]] = s[1];
  }
  /// The positions with the other coordinates turned evenly from the start's to the goal's.
  [[nodiscard]] Configurations lifted_path(const Instance& parent, const Configurations& path) const;
  /// The instance of a free point in the parent's world.
  [[nodiscard]] std::unique_ptr<Instance> point_instance(const Instance& parent) const;
  [[nodiscard]] const Space& space() const { return space_; }
  /// Per volume in metric coordinates of C and S. The position's weights are the same in both; were they not, the
  /// quotient of the volumes would hold the Jacobian too.
  [[nodiscard]] double log_fibre_volume() const { return log_fibre_volume_; }

 private:
  Space parent_;
  std::vector<std::size_t> position_;
  Space space_;
  double log_fibre_volume_ = 0.0;
};

/// A density of positions with the uniform fibre on it.
class LiftedDensity final : public Density {
 public:
  LiftedDensity(std::shared_ptr<const PositionProjection> projection, std::shared_ptr<const Density> positions)
      : projection_(std::move(projection)), positions_(std::move(positions)) {}

  [[nodiscard]] double at(View q) const override;
  [[nodiscard]] bool akin(const Density& other) const override;
  [[nodiscard]] std::shared_ptr<const Density> sum(const std::vector<Term>& terms) const override;

 private:
  std::shared_ptr<const PositionProjection> projection_;
  std::shared_ptr<const Density> positions_;
};

}  // namespace trellis
