// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <limits>
#include <string>
#include <vector>

#include <trellis/guide/lifted.hpp>
#include <trellis/space/space.hpp>

namespace trellis {

/// f that keeps some axes of a space. The fibre is everything else, uniform.
class AxisProjection : public Projection {
 public:
  /// The axes of S are those of the parent, with their weights.
  /// \param kept  axes of the parent, in the order of S
  /// \param name  of S
  AxisProjection(Space parent, std::vector<std::size_t> kept, std::string name);
  /// The axes of S are told by their names. Throws Error where S has an axis that the parent lacks, or one that goes
  /// beyond the parent's or wraps around otherwise.
  AxisProjection(Space parent, Space s);

  void project(View q, MutableView s) const override {
    for (std::size_t j = 0; j < kept_.size(); ++j) s[j] = q[kept_[j]];
  }
  void lift(View s, Stream& stream, MutableView q) const override {
    if (kept_.size() < q.size()) parent_.sample_uniform(stream, q);
    for (std::size_t j = 0; j < kept_.size(); ++j) q[kept_[j]] = s[j];
  }
  [[nodiscard]] bool closed_form() const override { return true; }
  [[nodiscard]] double log_fibre_density(View q) const override {
    return parent_.contains(q) ? -log_fibre_volume_ : -std::numeric_limits<double>::infinity();
  }
  [[nodiscard]] bool contracts() const override;
  [[nodiscard]] const Space& space() const { return space_; }
  [[nodiscard]] const Space& parent() const { return parent_; }
  /// Of each axis of S the axis of the parent.
  [[nodiscard]] const std::vector<std::size_t>& kept() const { return kept_; }
  /// Whether S has all axes of the parent in their order.
  [[nodiscard]] bool identity() const;
  /// Per volume in metric coordinates of C and S: where S weighs an axis otherwise it holds the Jacobian too.
  [[nodiscard]] double log_fibre_volume() const { return log_fibre_volume_; }
  /// A path in S with the other coordinates turned evenly from those of `start` to those of `goal`.
  [[nodiscard]] Configurations lifted(const Configurations& path, View start, View goal) const override;

 private:
  Space parent_;
  std::vector<std::size_t> kept_;
  Space space_;
  double log_fibre_volume_;
};

}  // namespace trellis
