// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <trellis/base/error.hpp>
#include <trellis/scene/planar/scene.hpp>
#include <trellis/scene/spatial/scene.hpp>

namespace trellis {

/// Calls f with the scene as the class that it is: PlanarScene or SpatialScene. f returns the same type for both.
template <class F>
auto visit(const Scene& scene, F&& f) {
  if (const PlanarScene* planar = scene.planar()) return f(*planar);
  if (const SpatialScene* spatial = scene.spatial()) return f(*spatial);
  throw Fault("a scene that is neither planar nor spatial");
}

}  // namespace trellis
