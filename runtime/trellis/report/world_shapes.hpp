// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include <trellis/draw/planar.hpp>
#include <trellis/scene/scene.hpp>

namespace trellis {

/// A shape of a world as pictures have it.
draw::WorldShape drawn(const Shape& shape);
/// The robot's parts at a configuration.
std::vector<draw::WorldShape> placed(const Robot& robot, View q);

}  // namespace trellis
