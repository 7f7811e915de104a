// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string_view>

namespace trellis {

/// Whether every planner has this option (goal bias, uniform share, bound, budget). The planner's level reads these
/// options.
bool every_planner_has(std::string_view option);

}  // namespace trellis
