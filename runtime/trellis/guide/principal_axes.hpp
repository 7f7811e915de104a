// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <vector>

namespace trellis {

/// The principal directions of points about the origin, by decreasing mean square of the coordinates along them.
/// Orthonormal and complete: the directions after the first few span the orthogonal complement of these.
/// \param points  rows of `dimension` coordinates
/// \param first  direction, of any length, that comes before the others; empty or 0: none. The others are orthogonal to
///     it, and principal for the points without their component along it.
/// \param dimension  at least 1
std::vector<std::vector<double>> principal_axes(const std::vector<double>& points, const std::vector<double>& first,
                                                std::size_t dimension);

}  // namespace trellis
