// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <limits>
#include <string>
#include <vector>

#include <trellis/guide/lifted.hpp>
#include <trellis/space/space.hpp>

namespace trellis {

/// f that keeps some axes of a space. The fibre consists of the other axes; its distribution is uniform.
class AxisProjection : public Projection {
 public:
  /// The axes of S are axes of the parent, with the same weights.
  /// \param kept  axes of the parent, in the order of S
  /// \param name  of S
  AxisProjection(Space parent, std::vector<std::size_t> kept, std::string name);
  /// Matches the axes of S to those of the parent by name.
  /// \throws Error if S has an axis that the parent lacks, that exceeds the parent's range, or that differs in
  ///     periodicity
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
  [[nodiscard]] bool contracts() const override { return contracts_; }
  [[nodiscard]] const Space& space() const { return space_; }
  [[nodiscard]] const Space& parent() const { return parent_; }
  /// For each axis of S, the parent's axis.
  [[nodiscard]] const std::vector<std::size_t>& kept() const { return kept_; }
  /// Whether S has all axes of the parent in the same order.
  [[nodiscard]] bool identity() const;
  /// log volume of the fibre, per volume in the metric coordinates of C and S. It includes the Jacobian if S has other
  /// weights than C.
  [[nodiscard]] double log_fibre_volume() const { return log_fibre_volume_; }
  /// A path in S; the other coordinates are interpolated from `start` to `goal`.
  [[nodiscard]] Configurations lifted(const Configurations& path, View start, View goal) const override;

 private:
  Space parent_;
  std::vector<std::size_t> kept_;
  Space space_;
  bool contracts_;
  double log_fibre_volume_;
};

}  // namespace trellis
