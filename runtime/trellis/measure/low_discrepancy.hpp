// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include <trellis/base/configurations.hpp>

namespace trellis::measure {

/// A Sobol sequence in the unit cube, shifted modulo 1. Equal shifts give equal points.
class LowDiscrepancy {
 public:
  /// \param dimension  at least 1
  /// \param shift      one number in [0, 1) per coordinate
  LowDiscrepancy(std::size_t dimension, std::vector<double> shift);
  ~LowDiscrepancy();
  LowDiscrepancy(const LowDiscrepancy&) = delete;
  LowDiscrepancy& operator=(const LowDiscrepancy&) = delete;

  /// Computes the next point, in [0, 1).
  void next(MutableView point);

 private:
  struct Engine;
  std::unique_ptr<Engine> engine_;
  std::vector<double> shift_;
};

}  // namespace trellis::measure
