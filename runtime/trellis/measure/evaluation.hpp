// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <functional>
#include <span>

#include <trellis/measure/along.hpp>
#include <trellis/measure/estimator.hpp>
#include <trellis/measure/samples.hpp>

namespace trellis::measure {

/// The input of estimators: prepared samples, the target's evaluation points, and shared intermediate results.
struct Evaluation {
  const Target& target;
  const PreparedSamples& samples;
  const InTarget& in_target;
  std::size_t points = 0;                            ///< evaluation points, a prefix of the target's pool
  std::span<const double> neighbours;                ///< squared distances to the `neighbour_count` nearest of all
  const std::function<double(View)>& known_density;  ///< of Q where it is recorded, raw coordinates; else empty
  std::span<const char> unreachable;                 ///< points of the pool where Q is certainly 0; empty: none
  const Along& along;                                ///< the samples in the target along the path
  std::size_t pool = 0;                              ///< the prefix of the pool that `exact` uses

  static constexpr std::size_t neighbour_count = 8;
  [[nodiscard]] const Frame& frame() const { return samples.frame(); }
  /// Returns the i-th evaluation point, a row of the frame.
  [[nodiscard]] View at(std::size_t i) const {
    const std::size_t d = frame().dimension();
    return View(target.pool_rows()).subspan(i * d, d);
  }
};

/// Returns the -log Q(A) that estimators use where none of N samples lies in A: that of half a sample, which is
/// compatible with N samples without a hit.
double mass_without_hit(std::size_t samples);

/// Computes the values that follow from log q at the first points of the pool.
Estimate estimate_from(const Evaluation& evaluation, std::span<const double> log_density);

}  // namespace trellis::measure
