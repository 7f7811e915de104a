// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <string>
#include <vector>

#include <trellis/planner/density.hpp>
#include <trellis/space/space.hpp>

namespace trellis {

/// f: some of the axes of C, with their weights. The fibre is the others, uniform.
class AxisProjection {
 public:
  /// \param axes  of C, at least one, ascending
  /// \param name  of S
  AxisProjection(Space parent, std::vector<std::size_t> axes, std::string name);

  void project(View q, MutableView s) const {
    for (std::size_t j = 0; j < axes_.size(); ++j) s[j] = q[axes_[j]];
  }
  void lift(View s, Stream& stream, MutableView q) const {
    parent_.sample_uniform(stream, q);
    for (std::size_t j = 0; j < axes_.size(); ++j) q[axes_[j]] = s[j];
  }
  /// A path in S with the other coordinates turned evenly from `start` to `goal`.
  [[nodiscard]] Configurations lifted_path(const Configurations& path, View start, View goal) const;

  [[nodiscard]] const Space& space() const { return space_; }
  [[nodiscard]] const std::vector<std::size_t>& axes() const { return axes_; }
  /// Per volume in metric coordinates of C and S. An axis' weight is the same in both; were it not, the quotient of the
  /// volumes would hold the Jacobian too.
  [[nodiscard]] double log_fibre_volume() const { return log_fibre_volume_; }

 private:
  Space parent_;
  std::vector<std::size_t> axes_;
  Space space_;
  double log_fibre_volume_;
};

/// A density over S with the uniform fibre on it.
class LiftedDensity final : public Density {
 public:
  LiftedDensity(std::shared_ptr<const AxisProjection> projection, std::shared_ptr<const Density> below)
      : projection_(std::move(projection)), below_(std::move(below)) {}

  [[nodiscard]] double at(View q) const override;
  [[nodiscard]] bool akin(const Density& other) const override;
  [[nodiscard]] std::shared_ptr<const Density> sum(const std::vector<Term>& terms) const override;

 private:
  std::shared_ptr<const AxisProjection> projection_;
  std::shared_ptr<const Density> below_;
};

}  // namespace trellis
