// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include <trellis/scene/scene.hpp>

namespace trellis {

/// The convex hull, counter-clockwise without straight vertices. \param points  at least three that are not on a line
Polygon convex_hull(std::vector<Vec2> points);

/// A coarser world: obstacles near one another are merged, bottom-up, into their convex hulls. No point of a hull is
/// farther than `error` metres from the obstacles that it stands for, as far as points of its outline a tenth of
/// `error` apart tell. Every obstacle lies within one of the result. Pairs are merged in the order of the error that
/// their hull makes, the least first (ties by their order). Deterministic. \param error  at least 0; with 0 the world
/// itself
World aggregated(const World& world, double error);

}  // namespace trellis
