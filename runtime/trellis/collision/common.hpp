// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include <trellis/collision/checker.hpp>
#include <trellis/scene/scene.hpp>

namespace trellis {

// Functions that all backends share.

/// \throws Error where a robot and a space do not fit or the resolution is not positive.
void check_fits(const Scene& scene, const Space& space, double resolution);

/// Returns the gap in metres below which bodies count as touching; also how far the robot may leave the boundary. It
/// bounds the accumulated rounding error in a world of this size.
double touching_slack(const Scene& scene);

/// Returns what checks of a scene cost, of all its backends: by the pieces, solids or balls of the robot, and by
/// whether meshes meet.
CheckCost check_cost(const Scene& scene);

/// Returns the parameters in (0, 1), ascending, at which the shortest motion from a passes an end of a periodic axis of
/// a flat space: only there can a robot jump.
/// \param difference  Space::difference of the motion's ends
std::vector<double> wraps(const Space& space, View a, View difference);

}  // namespace trellis
