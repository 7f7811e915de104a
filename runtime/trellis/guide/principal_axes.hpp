// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <vector>

namespace trellis {

/// The principal directions of points about the origin, by decreasing mean square of the coordinates along them.
/// Orthonormal and complete: the directions after the first few span the orthogonal complement of these.
/// \param points  rows of `dimension` coordinates
/// \param first  directions, of any length, that come before the others, each without its component along those before
///     it; those that leave nothing have no effect. The others are orthogonal to them, and principal for the points
///     without their component along them.
/// \param dimension  at least 1
std::vector<std::vector<double>> principal_axes(const std::vector<double>& points,
                                                const std::vector<std::vector<double>>& first, std::size_t dimension);

}  // namespace trellis
