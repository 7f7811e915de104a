// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/scene/planar/erosion.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include <trellis/scene/planar/polygon.hpp>
#include <trellis/scene/planar/valid_shapes.hpp>
#include <trellis/scene/precision.hpp>

namespace trellis {

namespace {

/// The part of an obstacle at a depth of at least `d` metres inside it.
std::vector<Shape> eroded(const Shape& shape, double d) {
  if (const auto* box = std::get_if<Box2>(&shape)) {
    const Box2 inner{{box->lo.x + d, box->lo.y + d}, {box->hi.x - d, box->hi.y - d}};
    if (inner.lo.x < inner.hi.x && inner.lo.y < inner.hi.y) return {inner};
    return {};
  }
  if (const auto* disc = std::get_if<Disc>(&shape)) {
    if (disc->radius > d) return {Disc{disc->centre, disc->radius - d}};
    return {};
  }
  std::vector<Shape> rest;
  // Erosion creates no holes.
  for (auto& piece : polygon_offset(std::get<Polygon>(shape), -d)) rest.emplace_back(std::move(piece.outer));
  return rest;
}

Box2 bounds_of(const Shape& shape) {
  if (const auto* box = std::get_if<Box2>(&shape)) return *box;
  if (const auto* disc = std::get_if<Disc>(&shape)) return bounding_box(ConvexShape(*disc));
  return bounding_box(ConvexShape(std::get<Polygon>(shape)));
}

}  // namespace

World eroded(const World& world, double distance) {
  std::vector<Obstacle> obstacles;
  for (const Obstacle& obstacle : world.obstacles()) {
    std::vector<Shape> rest = eroded(obstacle.shape, distance);
    // What only rounding left.
    std::erase_if(rest, [&](const Shape& piece) {
      const Box2 box = bounds_of(piece);
      const double least = least_size(std::max(farthest_of(world.bounds()), farthest_of(box)));
      return box.hi.x - box.lo.x < least || box.hi.y - box.lo.y < least;
    });
    for (std::size_t i = 0; i < rest.size(); ++i) {
      const std::string number = rest.size() > 1 ? fmt::format(", piece {}", i + 1) : "";
      obstacles.push_back({fmt::format("{} eroded by {:g}{}", obstacle.name, distance, number), rest[i]});
    }
  }
  return {world.bounds(), std::move(obstacles)};
}

}  // namespace trellis
