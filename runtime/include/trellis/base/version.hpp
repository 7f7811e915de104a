// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

namespace trellis {

/// Returns the version of Trellis, as "0.2.0": that of CMake's project.
std::string version();

}  // namespace trellis
