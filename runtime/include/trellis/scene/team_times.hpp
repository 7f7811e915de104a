// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include <trellis/base/configurations.hpp>
#include <trellis/scene/scene.hpp>
#include <trellis/space/space.hpp>

namespace trellis {

/// The space of a robot of a team: its coordinates of the team's.
/// \param team  the space of the team
/// \param member  whose axes are coordinates of `team`
/// \throws Fault where the axes contain a part of a rotation
Space space_of(const Space& team, const TeamMember& member);

/// When a team is where on a path whose robots move at 1 m/s at most, each in the metric of its own coordinates.
struct TeamTimes {
  std::vector<double> at;     ///< seconds, of each configuration of the path: all robots move along a piece evenly
  double makespan = 0.0;      ///< seconds until the last robot is at its goal
  double sum_of_costs = 0.0;  ///< the sum over robots of the seconds until it is at its goal and stays there
};

/// Times a path: each piece takes as long as the robot that moves farthest on it.
/// \param space  of the team
/// \param members  of the team, at least one
/// \param path  of the team, from the start on; an empty one takes no time
TeamTimes times_of(const Space& space, const std::vector<TeamMember>& members, const Configurations& path);

/// Times a path whose robots are driven by motion models: each piece takes one step.
/// \param members  of the team
/// \param path  of the team: the start, and the state after each step
/// \param step  duration of a step, in seconds
TeamTimes times_of_steps(const std::vector<TeamMember>& members, const Configurations& path, double step);

}  // namespace trellis
