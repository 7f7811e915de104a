// SPDX-License-Identifier: GPL-3.0-or-later
// Our RRT, RRT-Connect and PRM on the scenes of the paper through the C++ interface, with either collision backend
// (checkers "planar" and "fcl"): what scripts/bench-ompl puts beside OMPL's.

#include <cstdint>
#include <cstdio>
#include <exception>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <trellis/scene/planar/scene.hpp>
#include <trellis/strategy/executor.hpp>
#include <trellis/strategy/spec.hpp>

#include "rrt_bench.hpp"

namespace {

trellis::Problem problem(const bench::Scene& scene, const std::string& collision) {
  std::vector<trellis::Obstacle> obstacles;
  for (const bench::Rectangle& r : scene.obstacles) {
    obstacles.push_back({"obstacle " + std::to_string(obstacles.size() + 1),
                         trellis::Box2{.lo = {r.xmin, r.ymin}, .hi = {r.xmax, r.ymax}}});
  }
  const trellis::Vec2 half{bench::robot_length / 2, bench::robot_width / 2};
  trellis::Problem result;
  result.name = scene.name;
  result.scene = std::make_shared<trellis::PlanarScene>(
      trellis::World({.lo = {0, 0}, .hi = {bench::world_size, bench::world_size}}, std::move(obstacles)),
      trellis::Robot::rigid({trellis::Box2{.lo = {-half.x, -half.y}, .hi = half}}));
  result.space = trellis::Space::se2({0, bench::world_size}, {0, bench::world_size});
  result.start.assign(scene.start.begin(), scene.start.end());
  result.goals.emplace_back(scene.goal.begin(), scene.goal.end());
  result.goal_tolerance = bench::goal_tolerance;
  result.resolution = bench::resolution;
  result.collision = collision;
  return result;
}

trellis::StrategySpec strategy_of(const std::string& planner) {
  const auto limit = static_cast<double>(bench::iteration_limit);
  if (planner == "prm") return {trellis::PlannerSpec::make(planner, {{"proposals", limit}})};
  if (planner == "rrt_connect") {
    return {trellis::PlannerSpec::make(planner, {{"step", bench::step}, {"proposals", limit}})};
  }
  // OMPL's RRT reaches the goal only with a goal proposal, so this RRT does the same here.
  return {trellis::PlannerSpec::make(
      planner,
      {{"step", bench::step}, {"goal_bias", bench::goal_bias}, {"connect_goal", false}, {"proposals", limit}})};
}

bench::Run plan(const trellis::StrategySpec& strategy, const trellis::Problem& of, std::uint64_t seed) {
  const double before = bench::cpu_seconds();
  const trellis::RunRecord record = trellis::execute(strategy, of, seed);
  const double after = bench::cpu_seconds();
  const trellis::LevelRecord& root = record.levels.front();
  return {.solved = record.solved,
          .cpu = after - before,
          .planning = root.search.seconds,
          .iterations = root.search.proposals.size(),
          .checks = record.validity_checks,
          .nodes = root.search.nodes.size()};
}

}  // namespace

int main(int argc, char** argv) {
  try {
    const bench::Arguments arguments = bench::parse(argc, argv, {"planar", "fcl"});
    const trellis::StrategySpec strategy = strategy_of(arguments.planner);
    bench::measure(arguments, "trellis", [&](const bench::Scene& scene, std::uint64_t seed) {
      return plan(strategy, problem(scene, arguments.checker), seed);
    });
  } catch (const std::exception& error) {
    std::fprintf(stderr, "bench_rrt: %s\n", error.what());
    return 1;
  }
  return 0;
}
