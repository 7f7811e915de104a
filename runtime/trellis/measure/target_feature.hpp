// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace trellis::measure {

/// The values of one function of configurations at the first points of a target's pool.
struct TargetFeature {
  std::vector<double> values;
  std::vector<std::uint32_t> order;  ///< the points by ascending value

  static constexpr std::size_t most_points = 1024;
  static constexpr std::size_t anchors = 4;  ///< points of the pool, from its end, for distances to them
};

}  // namespace trellis::measure
