// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <vector>

#include <trellis/space/space.hpp>

namespace trellis::measure {

/// The rows in which the measure keeps configurations. Those of a flat space are metric coordinates y_j = w_j x_j, with
/// periodic axes wrapped into one period: functions that measure volumes or distances use these coordinates, where the
/// metric is Euclidean up to the wrap. A space with rotations has no such coordinates: its rows are the configurations,
/// normalised, and distances and volumes are those of the space.
class Frame {
 public:
  explicit Frame(const Space& space);

  [[nodiscard]] const Space& space() const { return space_; }
  [[nodiscard]] bool flat() const { return space_.flat(); }
  /// The number of coordinates of a row, and the number of degrees of freedom, by which volumes grow.
  [[nodiscard]] std::size_t dimension() const { return space_.dimension(); }
  [[nodiscard]] std::size_t degrees() const { return space_.degrees(); }
  /// The space of the rows.
  [[nodiscard]] Space rows() const;
  // The axes of a flat space.
  [[nodiscard]] double lo(std::size_t j) const { return lo_[j]; }
  [[nodiscard]] double hi(std::size_t j) const { return hi_[j]; }
  [[nodiscard]] double extent(std::size_t j) const { return hi_[j] - lo_[j]; }
  [[nodiscard]] bool periodic(std::size_t j) const { return periodic_[j] != 0; }
  /// Returns the period; infinity for an axis that is not periodic.
  [[nodiscard]] double period(std::size_t j) const { return period_[j]; }

  /// Computes the row of a configuration; periodic metric coordinates are within [lo, hi].
  void to_metric(View x, MutableView y) const;
  /// Computes the configuration of a row; metric coordinates within [lo, hi] give a configuration within the space.
  void to_raw(View y, MutableView x) const;
  /// Computes the row of a point of the unit cube, `degrees` numbers, such that equal volumes have equal volumes.
  void from_unit(View unit, MutableView y) const;
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
