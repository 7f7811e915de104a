// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include <trellis/scene/planar/world.hpp>

namespace trellis {

/// One task for training or validation: a world with a start and a goal in the plane.
struct LearningTask {
  std::string name;
  World world;
  Vec2 start;
  Vec2 goal;
};

}  // namespace trellis
