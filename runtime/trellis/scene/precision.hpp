// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

namespace trellis {

/// Returns the least size of a shape among coordinates of up to `farthest` metres: 2^-44 of it, 256 times the distance
/// of neighbouring doubles there. The vertices of a smaller shape would fall together.
inline double least_size(double farthest) { return 0x1p-44 * farthest; }

/// \throws Error that starts with `what` for a size below `least_size`
/// \param name  of the size: "diameter", "length along x"
void check_size(double size, double farthest, const char* name, const std::string& what);

}  // namespace trellis
