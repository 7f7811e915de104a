// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/figures/world_shapes.hpp>

#include <string>

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

std::vector<std::vector<WorldShape>> placed_team(const Robot& team, View q) {
  std::vector<std::vector<WorldShape>> robots;
  robots.reserve(team.members().size());
  for (const Robot::Member& member : team.members()) {
    robots.push_back(placed(*member.robot, q.subspan(member.axis, member.robot->dimension())));
  }
  return robots;
}

void add_ends(const Problem& problem, draw::PlanarFigure& figure) {
  const Robot& robot = planar(*problem.scene).robot;
  for (const Robot::Member& member : robot.members()) {
    figure.team.push_back({std::to_string(member.number), draw::palette::robot(member.number - 1), {}, {}});
  }
  const auto add = [&](const Configuration& q, std::vector<WorldShape> draw::TeamRobot::*end,
                       std::vector<WorldShape>& alone) {
    if (figure.team.empty()) {
      const auto shapes = placed(robot, q);
      alone.insert(alone.end(), shapes.begin(), shapes.end());
      return;
    }
    const auto team = placed_team(robot, q);
    for (std::size_t i = 0; i < team.size(); ++i) {
      (figure.team[i].*end).insert((figure.team[i].*end).end(), team[i].begin(), team[i].end());
    }
  };
  add(problem.start, &draw::TeamRobot::start, figure.start);
  for (const Configuration& goal : problem.goals) add(goal, &draw::TeamRobot::goal, figure.goal);
}

}  // namespace trellis
