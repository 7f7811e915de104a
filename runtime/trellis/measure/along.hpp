// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <limits>
#include <span>
#include <vector>

#include <trellis/measure/target.hpp>

namespace trellis {

/// The distribution along the path of the samples in the target: J = min(L / delta, n / 5) bins of equal arc length.
struct Along {
  /// D(T || Q) of arc length, with the posterior mean of Q under a Dirichlet(1/2) prior, in nats.
  double divergence = std::numeric_limits<double>::quiet_NaN();
  /// Share of the target that lies in bins without a sample.
  double empty_share = std::numeric_limits<double>::quiet_NaN();
  double length = std::numeric_limits<double>::quiet_NaN();  ///< of the path, metres of the target's distance
  std::vector<double> target;                                ///< share of the target in each bin
  std::vector<double> samples;                               ///< share of the samples in the target in each bin
  /// `divergence` without its bias for few samples, (J - 1) / 2n, and the same for Q mixed with 5 % uniform samples.
  double corrected = std::numeric_limits<double>::quiet_NaN();
  double regularised = std::numeric_limits<double>::quiet_NaN();
};

namespace measure {

/// \param arcs    arc length along the path of each sample in the target
/// \param points  evaluation points, a prefix of the target's
/// \param mass    the share of all samples that lies in the target
Along along_path(const Target& target, std::span<const double> arcs, std::size_t points, double mass);

}  // namespace measure

}  // namespace trellis
