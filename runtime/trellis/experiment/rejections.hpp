// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include <trellis/strategy/executor.hpp>

namespace trellis {

/// What rejected the proposals of a level.
struct Rejections {
  std::size_t rejected = 0;  ///< proposals of which no node came because the motion to them is invalid
  std::size_t examined = 0;  ///< of these, those whose first invalid configuration was found
  /// What the robot touches there ("obstacle 3 (box 4 0 6 4.75)"), and in how many of them, the most frequent first.
  std::vector<std::pair<std::string, std::size_t>> by;
};

/// Looks at no more than `most` rejected proposals, spread evenly over the search, along the straight motion from the
/// node that each grew from. Of a level whose validity is presumed nothing is rejected. Repeats collision checks that
/// the run made already; they are counted nowhere. \param resolution  metres that the robot's fastest point moves
/// between two configurations, > 0
Rejections rejections(const LevelRecord& level, double resolution, std::size_t most = 200);

}  // namespace trellis
