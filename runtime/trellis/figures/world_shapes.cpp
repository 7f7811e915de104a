// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/figures/world_shapes.hpp>

namespace trellis {

namespace {

using draw::Point;
using draw::WorldDisc;
using draw::WorldShape;

Point point(Vec2 p) { return {p.x, p.y}; }

std::vector<Point> points(const std::vector<Vec2>& vertices) {
  std::vector<Point> all;
  all.reserve(vertices.size());
  for (const Vec2 v : vertices) all.push_back(point(v));
  return all;
}

}  // namespace

WorldShape drawn(const Shape& shape) {
  if (const auto* disc = std::get_if<Disc>(&shape)) return WorldDisc{point(disc->centre), disc->radius};
  if (const auto* box = std::get_if<Box2>(&shape)) return points(rectangle_vertices(*box));
  return points(std::get<Polygon>(shape).vertices);
}

std::vector<WorldShape> placed(const Robot& robot, View q) {
  std::vector<Pose2> poses(robot.bodies().size());
  robot.place(q, poses);
  std::vector<WorldShape> shapes;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    for (const ConvexShape& part : robot.bodies()[i].parts) {
      if (const auto* disc = std::get_if<Disc>(&part)) {
        shapes.emplace_back(WorldDisc{point(poses[i](disc->centre)), disc->radius});
        continue;
      }
      std::vector<Vec2> vertices = std::get<Polygon>(part).vertices;
      for (Vec2& v : vertices) v = poses[i](v);
      shapes.emplace_back(points(vertices));
    }
  }
  return shapes;
}

}  // namespace trellis
