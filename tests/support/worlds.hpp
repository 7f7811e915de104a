// SPDX-License-Identifier: GPL-3.0-or-later
// Worlds and problems that tests share: the three scenes of the paper and random worlds.
#pragma once

#include <fmt/format.h>

#include <array>
#include <memory>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include <trellis/base/random.hpp>
#include <trellis/scene/planar/scene.hpp>

namespace trellis::test {

using Rectangles = std::vector<std::array<double, 4>>;

inline World rectangle_world(const Rectangles& rectangles, double side = 10.0) {
  std::vector<Obstacle> obstacles;
  for (const auto& r : rectangles) {
    obstacles.push_back({fmt::format("obstacle {}", obstacles.size() + 1), Box2{{r[0], r[1]}, {r[2], r[3]}}});
  }
  return World(Box2{{0, 0}, {side, side}}, std::move(obstacles));
}

inline const Rectangles& simple_passage() {
  static const Rectangles all = {{4, 0, 6, 4.75}, {4, 5.25, 6, 10}};
  return all;
}
inline const Rectangles& trap() {
  static const Rectangles all = {{4.5, 0, 5.5, 1.925},    {4.5, 2.075, 5.5, 3.325}, {4.5, 3.475, 5.5, 4.525},
                                 {4.5, 4.675, 5.5, 5.05}, {5.3, 5.05, 5.5, 5.55},   {4.5, 5.55, 5.5, 5.925},
                                 {4.5, 6.075, 5.5, 6.95}, {5.3, 6.95, 5.5, 7.45},   {4.5, 7.45, 5.5, 8.75},
                                 {4.5, 9.25, 5.5, 10}};
  return all;
}
inline const Rectangles& cup() {
  static const Rectangles all = {{6.5, 1.5, 7, 8.5}, {3, 1.5, 6.5, 2}, {3, 8, 6.5, 8.5}};
  return all;
}

inline Robot rectangle_robot(double length = 0.6, double width = 0.2) {
  return Robot::rigid({Box2{{-0.5 * length, -0.5 * width}, {0.5 * length, 0.5 * width}}});
}

inline Problem make_problem(std::string name, World world, Robot robot, Configuration start, Configuration goal) {
  Problem problem;
  problem.name = std::move(name);
  problem.space = default_space(robot, world, 1.0 / std::numbers::pi);
  problem.scene = std::make_shared<PlanarScene>(std::move(world), std::move(robot));
  problem.start = std::move(start);
  problem.goals = {std::move(goal)};
  return problem;
}

/// Two discs that change places beside a wall.
inline Problem team_problem() {
  return make_problem("team", rectangle_world({{4, 0, 5, 6}}), Robot::team({Robot::disc(0.4), Robot::disc(0.3)}),
                      {1, 1, 8, 1}, {8, 1, 1, 1});
}

inline Problem simple_passage_problem() {
  return make_problem("simple_passage", rectangle_world(simple_passage()), rectangle_robot(), {1, 8.5, 0}, {9, 1.5, 0});
}
inline Problem trap_problem() {
  return make_problem("trap", rectangle_world(trap()), rectangle_robot(), {1, 4, 0}, {9, 4, 0});
}
inline Problem cup_problem() {
  return make_problem("cup", rectangle_world(cup()), rectangle_robot(), {1, 5, 0}, {9, 5, 0});
}

/// The problem for a robot that drives: a quick one, so that it crosses these worlds in few steps.
inline Problem driven(Problem problem, const std::string& model = "unicycle1") {
  const MotionKind& kind = *find_motion(model);
  std::vector<Options::Entry> quick = {{"max_speed", 2.0}, {"min_speed", -2.0}};
  if (model.starts_with("unicycle")) quick.emplace_back("max_angular_speed", 3.0);
  if (model == "unicycle2") quick.insert(quick.end(), {{"max_acceleration", 4.0}, {"max_angular_acceleration", 6.0}});
  problem.motion_model = kind.make(Options::validate(*kind.component, quick));
  problem.space = state_space(problem.space, *problem.motion_model);
  problem.start.resize(problem.space.dimension());
  for (Configuration& goal : problem.goals) goal.resize(problem.space.dimension());
  problem.goal_tolerance = 0.6;
  problem.name += " by " + model;
  return problem;
}

/// A point among random discs in R^2; start and goal in the lower left and upper right corner, kept clear.
inline Problem point_problem(std::uint64_t seed, int discs = 12) {
  Stream stream(seed, "", "point problem");
  std::vector<Obstacle> obstacles;
  while (static_cast<int>(obstacles.size()) < discs) {
    const Disc disc{{stream.uniform(0, 10), stream.uniform(0, 10)}, stream.uniform(0.2, 0.9)};
    if (norm(disc.centre - Vec2{0.5, 0.5}) < disc.radius + 0.6 ||
        norm(disc.centre - Vec2{9.5, 9.5}) < disc.radius + 0.6) {
      continue;
    }
    obstacles.push_back({fmt::format("disc {}", obstacles.size() + 1), disc});
  }
  return make_problem("discs", World(Box2{{0, 0}, {10, 10}}, std::move(obstacles)), Robot::point(), {0.5, 0.5},
                      {9.5, 9.5});
}

}  // namespace trellis::test
