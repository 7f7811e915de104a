// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <functional>
#include <span>

#include <trellis/measure/along.hpp>
#include <trellis/measure/estimator.hpp>
#include <trellis/measure/samples.hpp>

namespace trellis::measure {

/// What estimators work from: samples made ready, the target's evaluation points, and what is asked of both by all.
struct Evaluation {
  const Target& target;
  const PreparedSamples& samples;
  const InTarget& in_target;
  std::size_t points = 0;                            ///< evaluation points, a prefix of the target's pool
  std::span<const double> neighbours;                ///< squared distances to the `neighbour_count` nearest of all
  const std::function<double(View)>& known_density;  ///< of Q where it is known, raw coordinates; else empty
  std::span<const char> unreachable;                 ///< points of the pool where Q is known to be 0; empty: none
  const Along& along;                                ///< where along the path the samples in the target lie
  std::size_t kernel_points = 0;                     ///< of them, those that `kde` looks at; 0: all

  static constexpr std::size_t neighbour_count = 8;
  [[nodiscard]] const Frame& frame() const { return samples.frame(); }
  /// The i-th evaluation point in metric coordinates.
  [[nodiscard]] View at(std::size_t i) const {
    const std::size_t d = frame().dimension();
    return View(target.pool_rows()).subspan(i * d, d);
  }
};

/// -log Q(A) as estimators take it where none of N samples lies in A: half a sample, what N without a hit leave
/// possible.
double mass_without_hit(std::size_t samples);

/// The figures that follow from log q at the first points of the pool.
/// \param mass  the mass that Q has in A without atoms, for JS
Estimate estimate_from(const Evaluation& evaluation, std::span<const double> log_density, double mass);

}  // namespace trellis::measure
