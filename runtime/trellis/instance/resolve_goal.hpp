// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <vector>

#include <trellis/scene/planar/scene.hpp>
#include <trellis/space/rotation.hpp>

namespace trellis {

/// Chooses goals of a problem that has a goal region (Problem::reach). Inverse kinematics solves for the region from
/// samples about the start and in the whole space; the function selects the ten valid solutions nearest to the start in
/// the metric, the nearest first. Deterministic. Does not change a problem without a goal region.
/// \throws Error where it finds no valid solution.
void resolve_goal(Problem& problem);

/// Whether the configuration lies in the goal region.
bool reaches(const Robot& robot, const Reach& reach, View q);

/// Returns valid configurations of a manipulator that bring a link to a pose, by inverse kinematics: at most ten, the
/// nearest to the start first.
/// \param problem  its scene is one of a manipulator; without a start they are in no order
/// \param near     metres from the pose's position; > 0
/// \param turn     radians from its orientation; > 0
/// \throws Error where none is found
std::vector<Configuration> configurations_at(const Problem& problem, std::size_t link, const Pose3& target, double near,
                                             double turn);

/// The same for a point of a link, whatever the link's orientation.
/// \param point   in the link's frame
/// \param target  where it is to be in the world
std::vector<Configuration> configurations_near(const Problem& problem, std::size_t link, const Vec3& point,
                                               const Vec3& target, double near);

}  // namespace trellis
