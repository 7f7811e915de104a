// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include <trellis/scene/planar/robot.hpp>

namespace trellis {

/// The part of a robot that some axes of its configuration determine: the bodies whose position and angle depend on no
/// other axis. For a body whose position is determined but not its angle, the largest disc inside it about its origin.
/// The axes of the result are numbered as in `axes`. None if no shape is determined.
/// \param axes  ascending; indices beyond the robot's own axes are ignored
std::optional<Robot> reduced_robot(const Robot& robot, const std::vector<std::size_t>& axes);

/// Returns a team in which members pass through each other that do so in another one.
/// \param whole  has members with the numbers of `team`
Robot uncoupled_as(const Robot& whole, const Robot& team);

}  // namespace trellis
