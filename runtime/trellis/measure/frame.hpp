// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <vector>

#include <trellis/space/space.hpp>

namespace trellis::measure {

/// A space in metric coordinates y_j = w_j x_j, periodic axes folded into one period. Everything that measures volumes
/// or distances works in these, where the metric is Euclidean up to the wrap.
class Frame {
 public:
  explicit Frame(const Space& space);

  [[nodiscard]] std::size_t dimension() const { return lo_.size(); }
  [[nodiscard]] double lo(std::size_t j) const { return lo_[j]; }
  [[nodiscard]] double hi(std::size_t j) const { return hi_[j]; }
  [[nodiscard]] double extent(std::size_t j) const { return hi_[j] - lo_[j]; }
  [[nodiscard]] bool periodic(std::size_t j) const { return periodic_[j] != 0; }
  /// The period; infinity for an axis that does not wrap.
  [[nodiscard]] double period(std::size_t j) const { return period_[j]; }

  /// Metric coordinates of a configuration, periodic ones within [lo, hi].
  void to_metric(View x, MutableView y) const;
  /// The configuration at metric coordinates; coordinates within [lo, hi] give a configuration within the space.
  void to_raw(View y, MutableView x) const;
  /// A periodic coordinate brought into [lo, hi]; others as they are.
  [[nodiscard]] double fold(std::size_t j, double y) const;
  /// A difference of coordinates the short way round.
  [[nodiscard]] double shortest(std::size_t j, double delta) const;

 private:
  Space space_;
  std::vector<double> lo_, hi_, period_;
  std::vector<char> periodic_;
};

}  // namespace trellis::measure
