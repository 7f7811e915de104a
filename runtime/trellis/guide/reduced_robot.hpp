// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include <trellis/scene/scene.hpp>

namespace trellis {

/// What some axes of a robot's configuration place of it: bodies whose position and angle depend on no other axis; of
/// one whose angle does, the largest disc about its origin. Its own axes are numbered as in `axes`. None where nothing
/// with a shape is placed.
/// \param axes  ascending; those beyond the robot's own are passed over
std::optional<Robot> reduced_robot(const Robot& robot, const std::vector<std::size_t>& axes);

}  // namespace trellis
