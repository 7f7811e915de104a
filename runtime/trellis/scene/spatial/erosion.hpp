// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <trellis/scene/spatial/world.hpp>

namespace trellis {

/// Returns the world whose obstacles, each by itself, lost all points within `distance` metres of their boundary. What
/// is not twice as thick vanishes. Boxes, spheres, cylinders, capsules and convex meshes are eroded exactly. Of another
/// closed mesh a subset of what is left is returned, from distances on a grid of 200,000 points at most: of the points
/// that are within two diagonals of a cell of being lost, some are.
/// \throws Error for a mesh that is not closed, by name
World3 eroded(const World3& world, double distance);

}  // namespace trellis
