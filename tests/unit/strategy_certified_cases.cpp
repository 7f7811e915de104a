// SPDX-License-Identifier: GPL-3.0-or-later
// Worlds in which a check of motions at a resolution reports paths through walls, and worlds without a path. Each path
// that a planner reports is judged by another method (support/path_judge.hpp).
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include <trellis/reader/readers.hpp>
#include <trellis/scene/spatial/scene.hpp>
#include <trellis/strategy/executor.hpp>

#include "support/catch.hpp"
#include "support/folder.hpp"
#include "support/path_judge.hpp"
#include "support/worlds.hpp"

using namespace trellis;
using namespace trellis::test;

namespace {

constexpr std::array few_planners = {"rrt", "rrt_connect", "prm"};
constexpr std::array planners = {"rrt", "rrt_connect", "prm", "lazy_prm", "rrt_star", "prm_star", "lazy_rrg_star"};
constexpr std::uint64_t seeds = 5;

PlannerSpec planner(const std::string& name, std::int64_t proposals = 2000) {
  return PlannerSpec::make(name, {{"proposals", proposals}});
}

/// Runs planners and checks that each path reported is free. Returns the number of paths.
template <class Planners>
std::size_t free_paths(const Problem& problem, const Planners& names) {
  const PathJudge judge(problem.scene, problem.space);
  std::size_t paths = 0;
  for (const char* const name : names) {
    for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
      const RunRecord run = execute(planner(name), problem, seed);
      if (!run.solved) continue;
      ++paths;
      const Judgement judgement = judge.path(run.path);
      INFO(problem.name << ": " << name << ", seed " << seed << ": leg " << judgement.leg << " touches "
                        << judgement.what);
      CHECK(judgement.verdict == Verdict::free);
    }
  }
  return paths;
}

template <class Planners>
void check_unsolved(const Problem& problem, const Planners& names, std::int64_t proposals = 1000) {
  for (const char* const name : names) {
    for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
      INFO(problem.name << ": " << name << ", seed " << seed << ", " << problem.collision << ", resolution "
                        << problem.resolution);
      CHECK_FALSE(execute(planner(name, proposals), problem, seed).solved);
    }
  }
}

World boxes(const Box2& bounds, const Rectangles& rectangles) {
  std::vector<Obstacle> obstacles;
  for (const auto& r : rectangles) {
    obstacles.push_back({fmt::format("obstacle {}", obstacles.size()), Box2{{r[0], r[1]}, {r[2], r[3]}}});
  }
  return {bounds, std::move(obstacles)};
}

/// Cells of '@', the first row at the top.
World grid(const std::vector<std::string>& rows, double size = 1.0) {
  Rectangles cells;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    for (std::size_t k = 0; k < rows[i].size(); ++k) {
      if (rows[i][k] != '@') continue;
      const auto x = static_cast<double>(k), y = static_cast<double>(rows.size() - 1 - i);
      cells.push_back({x * size, y * size, (x + 1) * size, (y + 1) * size});
    }
  }
  const Vec2 end{size * static_cast<double>(rows[0].size()), size * static_cast<double>(rows.size())};
  return boxes({{0, 0}, end}, cells);
}

}  // namespace

TEST_CASE("no path is reported through two walls of 3 mm", "[certified]") {
  Problem problem =
      make_problem("two walls of 3 mm", boxes({{0, 0}, {1, 1}}, {{0.5, 0, 0.503, 0.9}, {0.25, 0.1, 0.253, 1}}),
                   Robot::point(), {0.1, 0.1}, {0.9, 0.1});
  for (const char* const backend : {"planar", "fcl"}) {
    problem.collision = backend;
    // There is a path: below the first wall and above the second one.
    CHECK(free_paths(problem, few_planners) > 0);
  }
}

TEST_CASE("no path is reported through walls of 10, 4 and 1 mm in a world of 10 m", "[certified]") {
  for (const double width : {0.01, 0.004, 0.001}) {
    const Problem problem = make_problem(fmt::format("walls of {} m", width),
                                         rectangle_world({{5, 0, 5 + width, 9}, {2.5, 1, 2.5 + width, 10}}),
                                         Robot::point(), {1, 1}, {9, 1});
    CHECK(free_paths(problem, planners) > 0);
    const Problem closed = make_problem(fmt::format("a closed wall of {} m", width),
                                        rectangle_world({{5, 0, 5 + width, 10}}), Robot::point(), {1, 1}, {9, 1});
    check_unsolved(closed, few_planners);
  }
}

TEST_CASE("cells that touch in a corner leave no gap for a point", "[certified]") {
  const std::vector<std::string> rows = {"@@..", "@@..", "..@@", "..@@"};
  Problem problem = make_problem("cells", grid(rows), Robot::point(), {1, 1}, {3, 3});
  for (const char* const backend : {"planar", "fcl"}) {
    problem.collision = backend;
    for (const double resolution : {0.01, 0.05, 1.0}) {
      problem.resolution = resolution;
      check_unsolved(problem, planners);
    }
  }
}

TEST_CASE("a map of Moving AI whose cells touch in a corner has no path across it", "[certified]") {
  const Folder folder;
  const std::string map = folder.write("corner.map", "type octile\nheight 4\nwidth 4\nmap\n@@..\n@@..\n..@@\n..@@\n");
  ReadOptions options;
  options.start = {1, 1};
  options.goal = {3, 3};
  Problem problem = read_scene(map, options).problems.at(0);
  check_unsolved(problem, planners);
}

TEST_CASE("a diagonal wall of one pixel leaves no gap for a point", "[certified]") {
  for (const std::size_t n : {8U, 20U, 50U}) {
    std::vector<std::string> rows(n, std::string(n, '.'));
    for (std::size_t i = 0; i < n; ++i) rows[i][i] = '@';
    Problem problem =
        make_problem(fmt::format("diagonal of {} pixels", n), grid(rows, 0.05), Robot::point(), {0.05, 0.05},
                     {0.05 * static_cast<double>(n - 1), 0.05 * static_cast<double>(n - 1)});
    check_unsolved(problem, planners);
    problem.resolution = 0.5;
    check_unsolved(problem, few_planners);
  }
}

TEST_CASE("a resolution of 2 m beside a wall of 0.1 m reports no path through it", "[certified]") {
  const World world = rectangle_world({{5, 0, 5.1, 9}});
  const Shape bar = Box2{{-0.3, -0.02}, {0.3, 0.02}};
  std::size_t paths = 0;
  for (const auto& [robot, angle] :
       {std::pair(Robot::point(), false), std::pair(Robot::disc(0.01), false),
        std::pair(Robot::rigid({bar}, false), false), std::pair(Robot::rigid({bar}), true)}) {
    Configuration start = {1, 1}, goal = {9, 1};
    if (angle) {
      start.push_back(0.3);
      goal.push_back(2.0);
    }
    Problem problem = make_problem(fmt::format("coarse, {}", robot.name()), world, robot, start, goal);
    problem.resolution = 2.0;
    paths += free_paths(problem, planners);
  }
  CHECK(paths > 0);
}

TEST_CASE("a turn by half a circle is reported in the direction that is free", "[certified]") {
  // The bar turns about its end. A disc blocks one of the two directions.
  const Robot bar = Robot::rigid({Box2{{0, -0.05}, {1, 0.05}}});
  std::size_t paths = 0;
  for (const double side : {1.0, -1.0}) {
    for (const double end : {-std::numbers::pi, std::numbers::pi}) {
      World world({{0, 0}, {4, 4}}, {{"disc", Disc{{2, 2 + 0.9 * side}, 0.2}}});
      Problem problem = make_problem(fmt::format("half a turn to {}, the disc at {}", end, side), std::move(world), bar,
                                     {2, 2, 0}, {2, 2, end});
      paths += free_paths(problem, planners);
      problem.start = {2, 2, end};
      problem.goals = {{2, 2, 0}};
      paths += free_paths(problem, planners);
    }
  }
  CHECK(paths > 0);
}

TEST_CASE("a half turn in space is reported about an axis and in a direction that are free", "[certified][space]") {
  const Robot3 bar("bar", {{Cuboid{{1, 0.1, 0.1}}, {{0.5, 0, 0}, {}}}});
  std::size_t paths = 0;
  for (const double side : {1.0, -1.0}) {
    for (const double sign : {1.0, -1.0}) {
      World3 world({{0, 0, 0}, {4, 4, 4}}, {{"ball", {Sphere{0.3}, {{2, 2 + 0.9 * side, 2}, {}}}}});
      Problem problem;
      problem.name = fmt::format("half a turn in space, the ball at {}", side);
      problem.scene = std::make_shared<const SpatialScene>(std::move(world), bar);
      problem.space = problem.scene->default_space(1.0);
      problem.start = {2, 2, 2, 0, 0, 0, 1};
      problem.goals = {{2, 2, 2, 0, 0, sign, 0}};
      problem.collision = "fcl";
      paths += free_paths(problem, few_planners);
    }
  }
  CHECK(paths > 0);
}

TEST_CASE("no planner leaves a closed ring of shapes that touch", "[certified]") {
  const Vec2 middle{5, 5};
  std::vector<std::pair<std::string, std::vector<Obstacle>>> rings;
  const auto add = [&rings](Shape shape) { rings.back().second.push_back({"ring", std::move(shape)}); };

  rings.push_back({"cells that touch in corners", {}});
  constexpr int corner = 4;
  for (int i = 0; i < corner; ++i) {
    for (const double x : {1.0, -1.0}) {
      for (const double y : {1.0, -1.0}) {
        const double left = x * i, low = y * (corner - 1 - i);
        const Vec2 a{middle.x + std::min(left, left + x), middle.y + std::min(low, low + y)};
        add(Box2{a, a + Vec2{1, 1}});
      }
    }
  }
  rings.push_back({"plates that touch along edges", {}});
  constexpr double thin = 1e-4;
  add(Box2{{2, 2}, {8, 2 + thin}});
  add(Box2{{8, 2}, {8 + thin, 8}});
  add(Box2{{2, 8}, {8, 8 + thin}});
  add(Box2{{2 - thin, 2}, {2, 8}});
  rings.push_back({"triangles that share corners", {}});
  constexpr std::size_t sides = 24;
  const auto at = [&middle](std::size_t i, double radius) {
    const double angle = 2 * std::numbers::pi * static_cast<double>(i % sides) / sides;
    return Vec2{middle.x + radius * std::cos(angle), middle.y + radius * std::sin(angle)};
  };
  for (std::size_t i = 0; i < sides; ++i) {
    const Vec2 a = at(i, 3), b = at(i + 1, 3), apex = middle + 1.001 * (0.5 * (a + b) - middle);
    add(Polygon{{a, apex, b}});
  }
  rings.push_back({"discs that touch", {}});
  for (int i = 0; i < 8; ++i) {
    const double along = 3.25 + 0.5 * i;
    add(Disc{{along, 3.25}, 0.25});
    add(Disc{{along, 6.75}, 0.25});
    add(Disc{{3.25, along}, 0.25});
    add(Disc{{6.75, along}, 0.25});
  }
  rings.push_back({"a polygon with a slit closed by a sliver", {}});
  add(Polygon{{{3, 3},
               {7, 3},
               {7, 7},
               {3, 7},
               {3, 5.5},
               {3.001, 5.5},
               {3.001, 6.999},
               {6.999, 6.999},
               {6.999, 3.001},
               {3.001, 3.001},
               {3.001, 4.5},
               {3, 4.5}}});
  add(Polygon{{{3, 4.5}, {3.0005, 4.5}, {3, 5.5}}});

  for (const auto& [name, obstacles] : rings) {
    for (const Robot& robot : {Robot::point(), Robot::disc(1e-3)}) {
      Problem problem =
          make_problem(name + ", " + robot.name(), World({{0, 0}, {10, 10}}, obstacles), robot, {5, 5}, {0.5, 0.5});
      for (const double resolution : {0.05, 1.0}) {
        problem.resolution = resolution;
        check_unsolved(problem, planners, 600);
      }
      problem.collision = "fcl";
      check_unsolved(problem, few_planners, 600);
    }
  }
}

TEST_CASE("no planner leaves a closed box of plates that touch", "[certified][space]") {
  constexpr double thin = 1e-4;
  std::vector<Obstacle3> plates;
  const auto add = [&plates](const Vec3& lo, const Vec3& hi) {
    plates.push_back({"plate", {Cuboid{hi - lo}, {0.5 * (lo + hi), {}}}});
  };
  add({2, 2, 2 - thin}, {8, 8, 2});
  add({2, 2, 8}, {8, 8, 8 + thin});
  add({2, 2 - thin, 2}, {8, 2, 8});
  add({2, 8, 2}, {8, 8 + thin, 8});
  add({2 - thin, 2, 2}, {2, 8, 8});
  add({8, 2, 2}, {8 + thin, 8, 8});
  for (const Robot3& robot : {Robot3::point(), Robot3("ball", {Solid{Sphere{0.01}, {}}}, false)}) {
    Problem problem;
    problem.name = "closed box, " + robot.name();
    problem.scene = std::make_shared<const SpatialScene>(World3({{0, 0, 0}, {10, 10, 10}}, plates), robot);
    problem.space = problem.scene->default_space(1.0);
    problem.start = {5, 5, 5};
    problem.goals = {{0.5, 0.5, 0.5}};
    for (const char* const backend : {"fcl", "fcl_plain"}) {
      problem.collision = backend;
      for (const double resolution : {0.05, 1.0}) {
        problem.resolution = resolution;
        check_unsolved(problem, few_planners, 600);
      }
    }
  }
}
