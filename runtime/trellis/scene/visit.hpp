// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <trellis/base/error.hpp>
#include <trellis/scene/planar/scene.hpp>
#include <trellis/scene/spatial/manipulator_scene.hpp>
#include <trellis/scene/spatial/scene.hpp>

namespace trellis {

/// Calls f with the scene as the class that it is: PlanarScene, SpatialScene or ManipulatorScene. f returns the same
/// type for each.
template <class F>
auto visit(const Scene& scene, F&& f) {
  if (const PlanarScene* planar = scene.planar()) return f(*planar);
  if (const SpatialScene* spatial = scene.spatial()) return f(*spatial);
  if (const ManipulatorScene* manipulator = scene.manipulator()) return f(*manipulator);
  throw Fault("a scene of an unknown kind");
}

/// Returns the world of a scene in space; nullptr in the plane.
inline const World3* spatial_world(const Scene& scene) {
  if (const SpatialScene* spatial = scene.spatial()) return &spatial->world;
  if (const ManipulatorScene* manipulator = scene.manipulator()) return &manipulator->world;
  return nullptr;
}

}  // namespace trellis
