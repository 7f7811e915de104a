// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

namespace trellis {

/// Returns the version of Trellis, e.g. "0.1.0".
std::string version();

}  // namespace trellis
