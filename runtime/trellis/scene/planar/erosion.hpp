// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <trellis/scene/planar/world.hpp>

namespace trellis {

/// Returns the world whose obstacles, each by itself, lost all points within `distance` metres of their boundary. An
/// obstacle may vanish or fall into pieces.
World eroded(const World& world, double distance);

}  // namespace trellis
