// SPDX-License-Identifier: GPL-3.0-or-later
// Simple and slow reference implementations for the scene layer.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include <trellis/base/random.hpp>
#include <trellis/scene/planar/polygon.hpp>
#include <trellis/scene/planar/scene.hpp>

namespace brute {

using trellis::Box2;
using trellis::Disc;
using trellis::Polygon;
using trellis::Shape;
using trellis::Vec2;
using trellis::World;

inline double area(const Polygon& polygon) {
  double twice = 0.0;
  const auto& v = polygon.vertices;
  for (std::size_t i = 0; i < v.size(); ++i) twice += cross(v[i], v[(i + 1) % v.size()]);
  return 0.5 * twice;
}

inline double area(const std::vector<trellis::PolygonWithHoles>& pieces) {
  double sum = 0.0;
  for (const auto& piece : pieces) {
    sum += area(piece.outer);
    for (const auto& hole : piece.holes) sum += area(hole);  // clockwise: negative
  }
  return sum;
}

/// Even-odd rule.
inline bool inside(const Polygon& polygon, Vec2 p) {
  bool in = false;
  const auto& v = polygon.vertices;
  for (std::size_t i = 0; i < v.size(); ++i) {
    const Vec2 a = v[i], b = v[(i + 1) % v.size()];
    if ((a.y > p.y) != (b.y > p.y) && p.x < a.x + (p.y - a.y) / (b.y - a.y) * (b.x - a.x)) in = !in;
  }
  return in;
}

inline bool inside(const std::vector<trellis::PolygonWithHoles>& pieces, Vec2 p) {
  return std::any_of(pieces.begin(), pieces.end(), [&](const trellis::PolygonWithHoles& piece) {
    return inside(piece.outer, p) &&
           std::none_of(piece.holes.begin(), piece.holes.end(), [&](const Polygon& hole) { return inside(hole, p); });
  });
}

inline Polygon outline(const Shape& shape) {
  if (const auto* box = std::get_if<Box2>(&shape)) return {rectangle_vertices(*box)};
  return std::get<Polygon>(shape);
}

inline Vec2 nearest_on_segment(Vec2 p, Vec2 a, Vec2 b) {
  const double t = std::clamp(dot(p - a, b - a) / dot(b - a, b - a), 0.0, 1.0);
  return a + t * (b - a);
}

/// The nearest point of every edge of every obstacle and of the boundary, every disc counting as one edge.
inline std::vector<Vec2> nearest_points(const World& world, Vec2 p) {
  std::vector<Vec2> points;
  const auto add_loop = [&](const Polygon& loop) {
    const auto& v = loop.vertices;
    for (std::size_t i = 0; i < v.size(); ++i) points.push_back(nearest_on_segment(p, v[i], v[(i + 1) % v.size()]));
  };
  add_loop({rectangle_vertices(world.bounds())});
  for (const auto& obstacle : world.obstacles()) {
    if (const auto* disc = std::get_if<Disc>(&obstacle.shape)) {
      points.push_back(disc->centre + (disc->radius / norm(p - disc->centre)) * (p - disc->centre));
    } else {
      add_loop(outline(obstacle.shape));
    }
  }
  return points;
}

inline bool is_free(const World& world, Vec2 p) {
  if (!inside(Polygon{rectangle_vertices(world.bounds())}, p)) return false;
  return std::none_of(world.obstacles().begin(), world.obstacles().end(), [&](const trellis::Obstacle& obstacle) {
    if (const auto* disc = std::get_if<Disc>(&obstacle.shape)) return norm(p - disc->centre) <= disc->radius;
    return inside(outline(obstacle.shape), p);
  });
}

inline double clearance(const World& world, Vec2 p) {
  double least = std::numeric_limits<double>::infinity();
  for (const Vec2 q : nearest_points(world, p)) least = std::min(least, norm(p - q));
  return least;
}

/// A polygon star-shaped about `centre`: simple, seldom convex.
inline Polygon random_star(trellis::Stream& stream, Vec2 centre, double inner, double outer, int vertices) {
  Polygon polygon;
  for (int i = 0; i < vertices; ++i) {
    const double angle = (i + stream.uniform(0.0, 0.9)) * 2.0 * 3.14159265358979 / vertices;
    polygon.vertices.push_back(centre + stream.uniform(inner, outer) * Vec2{std::cos(angle), std::sin(angle)});
  }
  return polygon;
}

inline World box_world(const std::vector<Box2>& boxes, const Box2& bounds = {{0, 0}, {10, 10}}) {
  std::vector<trellis::Obstacle> obstacles;
  for (const auto& box : boxes) obstacles.push_back({"", box});
  return {bounds, std::move(obstacles)};
}

}  // namespace brute
