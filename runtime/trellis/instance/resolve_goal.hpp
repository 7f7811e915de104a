// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <trellis/scene/planar/scene.hpp>

namespace trellis {

/// Chooses goals of a problem that has a goal region (Problem::reach). Inverse kinematics solves for the region from
/// samples about the start and in the whole space; the function selects the ten valid solutions nearest to the start in
/// the metric, the nearest first. Deterministic. Does not change a problem without a goal region.
/// \throws Error where it finds no valid solution.
void resolve_goal(Problem& problem);

/// Whether the configuration lies in the goal region.
bool reaches(const Robot& robot, const Reach& reach, View q);

}  // namespace trellis
