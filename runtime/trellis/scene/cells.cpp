// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/scene/cells.hpp>

#include <utility>

#include <trellis/scene/planar/scene.hpp>
#include <trellis/scene/planar/triangle_cells.hpp>
#include <trellis/scene/set_up_cache.hpp>
#include <trellis/scene/spatial/octree_cells.hpp>
#include <trellis/scene/spatial/scene.hpp>
#include <trellis/scene/visit.hpp>

namespace trellis {

std::shared_ptr<const Cells> free_cells(const Scene& scene, double size, double needed) {
  if (const PlanarScene* plane = scene.planar()) {
    static SetUpCache<TriangleCells, double> triangles;
    return triangles.get(plane->world, size,
                         [&](const World& world) { return TriangleCells(Triangulation(world, size)); });
  }
  static SetUpCache<OctreeCells, std::pair<double, double>> boxes;
  return boxes.get(*spatial_world(scene), {size, needed},
                   [&](const World3& world) { return OctreeCells(world, size, needed); });
}

}  // namespace trellis
