// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string_view>

namespace trellis {

/// Whether an option is one of those that every planner has (goal bias, uniform share, bound, budget), by which its
/// level goes.
bool every_planner_has(std::string_view option);

}  // namespace trellis
