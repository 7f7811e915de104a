// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include <trellis/results/facts.hpp>
#include <trellis/strategy/executor.hpp>

namespace trellis {

/// Examines at most `most` rejected proposals, evenly spread over the search, along the straight motion from the node
/// that each extended. A level with presumed validity has no rejections, nor has
/// one whose space has fewer axes than its robot. Repeats collision checks of the run, which do
/// not count.
/// \param resolution  metres that the robot's fastest point moves between two configurations, > 0
Rejections rejections(const LevelRecord& level, double resolution, std::size_t most = 200);

}  // namespace trellis
