// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/scene/cells.hpp>

#include <trellis/scene/planar/scene.hpp>
#include <trellis/scene/planar/triangle_cells.hpp>
#include <trellis/scene/spatial/octree_cells.hpp>
#include <trellis/scene/spatial/scene.hpp>

namespace trellis {

std::shared_ptr<const Cells> free_cells(const Scene& scene, double size, double needed) {
  if (const PlanarScene* plane = scene.planar()) {
    return std::make_shared<const TriangleCells>(Triangulation(plane->world, size));
  }
  return std::make_shared<const OctreeCells>(spatial(scene).world, size, needed);
}

}  // namespace trellis
