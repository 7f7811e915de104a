// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>

// The limits of what a script or a file can make large, each checked before memory is taken (docs/robustness.md lists
// them with those of other layers).

namespace trellis {

inline constexpr std::size_t most_obstacles = 1'000'000;  ///< of a world
inline constexpr std::size_t most_vertices = 100'000;     ///< of a polygon
inline constexpr std::size_t most_shapes = 10'000;        ///< of a rigid robot
inline constexpr std::size_t most_links = 200;            ///< of an arm
inline constexpr double most_turns = 20.0;                ///< of a joint's limits, from the angle 0

}  // namespace trellis
