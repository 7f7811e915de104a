// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

#include <trellis/scene/scene.hpp>
#include <trellis/space/space.hpp>

namespace trellis {

// Stable hashes that identify the origin of a path: the same on every machine and in every version that reads the same
// files.

/// Hashes the axes and their weights, but not the name of the space.
std::uint64_t identity(const Space& space);
/// Hashes the shapes and joints of the scene's robot.
std::uint64_t robot_hash(const Scene& scene);
/// Hashes the bounds of the scene's world and its obstacles in their order, but not their names.
std::uint64_t world_hash(const Scene& scene);

}  // namespace trellis
