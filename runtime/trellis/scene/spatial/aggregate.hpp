// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <trellis/scene/spatial/world.hpp>

namespace trellis {

/// Returns a coarser world: merges obstacles near one another, bottom-up, into their convex hulls. No point of a hull
/// is farther than `error` metres from its obstacles' points, which are sampled. Each obstacle lies within one obstacle
/// of the result. Merges the pair with the least error first (ties by their order). Deterministic. \param error metres,
/// at least 0; with 0 the result is the same world
World3 aggregated(const World3& world, double error);

}  // namespace trellis
