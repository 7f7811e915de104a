// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

namespace trellis {

/// The message for a baseline that is none of the strategies.
std::string unknown_baseline(const std::string& baseline, const std::vector<std::string>& strategies);

}  // namespace trellis
