// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <trellis/scene/scene.hpp>

namespace trellis {

/// Chooses goals of a problem that has a set of them (Problem::reach): of the valid configurations in the set that
/// inverse kinematics finds from configurations drawn about the start and in the whole space, the ten nearest to the
/// start in the metric, the nearest first. The same each time. Leaves a problem without a set as it is. Throws Error
/// where none is found.
void settle_goal(Problem& problem);

/// Whether the configuration lies in the set.
bool reaches(const Robot& robot, const Reach& reach, View q);

}  // namespace trellis
