// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <vector>

#include <trellis/space/space.hpp>

namespace trellis::measure {

/// A space in metric coordinates y_j = w_j x_j, with periodic axes wrapped into one period. Functions that measure
/// volumes or distances use these coordinates, where the metric is Euclidean up to the wrap.
class Frame {
 public:
  explicit Frame(const Space& space);

  [[nodiscard]] std::size_t dimension() const { return lo_.size(); }
  [[nodiscard]] double lo(std::size_t j) const { return lo_[j]; }
  [[nodiscard]] double hi(std::size_t j) const { return hi_[j]; }
  [[nodiscard]] double extent(std::size_t j) const { return hi_[j] - lo_[j]; }
  [[nodiscard]] bool periodic(std::size_t j) const { return periodic_[j] != 0; }
  /// Returns the period; infinity for an axis that is not periodic.
  [[nodiscard]] double period(std::size_t j) const { return period_[j]; }

  /// Computes the metric coordinates of a configuration, periodic ones within [lo, hi].
  void to_metric(View x, MutableView y) const;
  /// Computes the configuration at metric coordinates; coordinates within [lo, hi] give a configuration within the
  /// space.
  void to_raw(View y, MutableView x) const;
  /// Wraps a periodic coordinate into [lo, hi]; returns others unchanged.
  [[nodiscard]] double fold(std::size_t j, double y) const;
  /// Returns the difference of smaller magnitude on a periodic axis.
  [[nodiscard]] double shortest(std::size_t j, double delta) const;

 private:
  Space space_;
  std::vector<double> lo_, hi_, period_;
  std::vector<char> periodic_;
};

}  // namespace trellis::measure
