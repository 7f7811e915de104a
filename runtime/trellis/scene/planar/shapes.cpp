// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/scene/planar/shapes.hpp>

#include <algorithm>

namespace trellis {

Box2 bounding_box(const ConvexShape& shape) {
  if (const auto* disc = std::get_if<Disc>(&shape)) {
    const Vec2 r{disc->radius, disc->radius};
    return {disc->centre - r, disc->centre + r};
  }
  return bounding_box(std::get<Polygon>(shape).vertices);
}

Box2 bounding_box(const std::vector<Vec2>& points) {
  Box2 box{points.front(), points.front()};
  for (const Vec2 p : points) box = united(box, {p, p});
  return box;
}

std::vector<Vec2> rectangle_vertices(const Box2& box) {
  return {box.lo, {box.hi.x, box.lo.y}, box.hi, {box.lo.x, box.hi.y}};
}

}  // namespace trellis
