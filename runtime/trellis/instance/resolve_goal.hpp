// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
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

/// A pose of the world that a link of a manipulator is to have.
struct LinkTarget {
  std::size_t link = 0;
  Pose3 pose = {};
  double near = 1e-3;  ///< metres from the pose's position; > 0
  double turn = 1e-2;  ///< radians from its orientation; > 0; of pi or more any orientation will do
  Vec3 point = {};     ///< of the link, in its frame, which is brought to the pose's position
};

/// Configurations that inverse kinematics is to find.
struct ReachQuery {
  std::vector<LinkTarget> targets;  ///< at least one; all hold at once
  Configuration given = {};         ///< coordinates that stay; NaN where one is free; empty: all are
  Configuration first = {};         ///< where the first attempt starts; the nearest to it come first; empty: none
  std::size_t most = 10;            ///< configurations
  std::uint64_t seed = 0;           ///< of the random starts, with the name
  std::string name = "goal";
};

struct ReachAnswer {
  std::vector<Configuration> configurations;  ///< valid ones; empty: none was found
  std::string failure;                        ///< why there are none: "0 of 2000 starts of inverse kinematics ..."
};

/// Finds valid configurations of a manipulator whose links are at their targets, by inverse kinematics from `first` and
/// from random starts. Where balls that cover the links touch something in all of them, the shapes decide (EndChecker).
/// Deterministic.
/// \param problem  its scene is one of a manipulator; its start and goals are not used
ReachAnswer reach_configurations(const Problem& problem, const ReachQuery& query);

/// Returns valid configurations of a manipulator that bring a link to a pose, by inverse kinematics: at most ten, the
/// nearest to the start first.
/// \param problem  its scene is one of a manipulator; without a start they are in no order
/// \param near     metres from the pose's position; > 0
/// \param turn     radians from its orientation; > 0
/// \throws InvalidEnd where none is found
std::vector<Configuration> configurations_at(const Problem& problem, std::size_t link, const Pose3& target, double near,
                                             double turn);

/// The same for a point of a link, whatever the link's orientation.
/// \param point   in the link's frame
/// \param target  where it is to be in the world
std::vector<Configuration> configurations_near(const Problem& problem, std::size_t link, const Vec3& point,
                                               const Vec3& target, double near);

}  // namespace trellis
