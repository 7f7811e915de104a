// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <vector>

namespace trellis {

/// The directions in which points lie farthest from the origin in the mean square, the farthest first: orthonormal, and
/// all of them, so that those beyond the first few span what these leave out.
/// \param points     rows of `dimension` coordinates
/// \param first      direction that comes before all others, of any length; empty or 0: none. The others are orthogonal
///                   to it, and farthest after it is taken out.
/// \param dimension  at least 1
std::vector<std::vector<double>> principal_axes(const std::vector<double>& points, const std::vector<double>& first,
                                                std::size_t dimension);

}  // namespace trellis
