// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <trellis/measure/evaluation.hpp>

namespace trellis::measure {

/// An interval of SE that so many samples support.
struct Supported {
  double lo = 0.0;
  double hi = 0.0;
};

/// Computes a 95 % interval of SE from the samples, for a target that is uniform on A.
///
/// The lower end is certified by counting, whatever Q, for independent samples: the bound of Clopper and Pearson for
/// the mass in A, and of the shares of nested parts of A, whose shares of T are those of 1024 points of it. Half of the
/// samples choose the parts: cells along the path, across it and along each axis, ordered by their number of samples,
/// and the distance to the nearest sample. The other half is counted.
///
/// The upper end assumes the simplest density in A that the samples do not contradict: constant, else smoothed over the
/// k nearest neighbours with fewer and fewer of them. Tests of goodness of fit compare the
/// distribution of the samples with that of the density: along the path, the axes, by distance to fixed points, and by
/// distance to the other half of the samples, which a density that leaves gaps does not pass. Its divergence then
/// assumes in addition that as large a part of the density is missing as the tests cannot see. Where the samples
/// contradict every density, the end is the largest value that SE has for any Q.
/// \param rough  whether to use fewer samples and points of the target, for a wider interval in less time
Supported supported_interval(const Evaluation& evaluation, bool rough = false);

}  // namespace trellis::measure
