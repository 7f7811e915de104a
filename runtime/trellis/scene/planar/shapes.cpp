// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/scene/planar/shapes.hpp>

#include <algorithm>

namespace trellis {

Box2 bounding_box(const ConvexShape& shape) {
  if (const auto* disc = std::get_if<Disc>(&shape)) {
    const Vec2 r{disc->radius, disc->radius};
    return {disc->centre - r, disc->centre + r};
  }
  const auto& vertices = std::get<Polygon>(shape).vertices;
  Box2 box{vertices.front(), vertices.front()};
  for (const Vec2 v : vertices) {
    box.lo = {std::min(box.lo.x, v.x), std::min(box.lo.y, v.y)};
    box.hi = {std::max(box.hi.x, v.x), std::max(box.hi.y, v.y)};
  }
  return box;
}

std::vector<Vec2> rectangle_vertices(const Box2& box) {
  return {box.lo, {box.hi.x, box.lo.y}, box.hi, {box.lo.x, box.hi.y}};
}

}  // namespace trellis
