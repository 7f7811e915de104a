// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

#include <trellis/scene/scene.hpp>
#include <trellis/space/space.hpp>

namespace trellis {

// Stable hashes of what a path was found in: the same on every machine and in every version that reads the same files.

/// Of the axes and their weights; the name of the space does not count.
std::uint64_t identity(const Space& space);
/// Of the shapes and joints.
std::uint64_t identity(const Robot& robot);
/// Of the bounds and the obstacles in their order; their names do not count.
std::uint64_t identity(const World& world);

}  // namespace trellis
