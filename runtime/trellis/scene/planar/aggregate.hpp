// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include <trellis/scene/planar/world.hpp>

namespace trellis {

/// Returns the convex hull, counter-clockwise without collinear vertices. \param points  at least three, not all on a
/// line
Polygon convex_hull(std::vector<Vec2> points);

/// Returns a coarser world: merges obstacles near one another, bottom-up, into their convex hulls. No point of a hull
/// is farther than `error` metres from its obstacles; the check samples the hull's outline at intervals of a tenth of
/// `error`. Each obstacle lies within one obstacle of the result. Merges the pair with the least error first (ties by
/// their order). Deterministic.
/// \param error  metres, at least 0; with 0 the result is the same world
World aggregated(const World& world, double error);

}  // namespace trellis
