// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include <trellis/draw/planar.hpp>
#include <trellis/scene/planar/scene.hpp>

namespace trellis {

/// Converts a shape of a world for pictures.
draw::WorldShape drawn(const Shape& shape);
/// Returns the robot's parts at a configuration.
std::vector<draw::WorldShape> placed(const Robot& robot, View q);

}  // namespace trellis
