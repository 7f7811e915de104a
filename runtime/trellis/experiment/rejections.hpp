// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include <trellis/strategy/executor.hpp>

namespace trellis {

/// The obstacles that rejected the proposals of a level.
struct Rejections {
  std::size_t rejected = 0;  ///< proposals without a node because the motion to them is invalid
  std::size_t examined = 0;  ///< of these, those with a located first invalid configuration
  /// The contacts there ("obstacle 3 (box 4 0 6 4.75)"), with their numbers, the most frequent first.
  std::vector<std::pair<std::string, std::size_t>> by;
};

/// Examines at most `most` rejected proposals, evenly spread over the search, along the straight motion from the node
/// that each extended. A level with presumed validity has no rejections, nor has
/// one whose space has fewer axes than its robot. Repeats collision checks of the run, which do
/// not count.
/// \param resolution  metres that the robot's fastest point moves between two configurations, > 0
Rejections rejections(const LevelRecord& level, double resolution, std::size_t most = 200);

}  // namespace trellis
