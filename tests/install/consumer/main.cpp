// SPDX-License-Identifier: GPL-3.0-or-later
// Solves a problem with a guided strategy through the C++ library, and prints how.
#include <iostream>
#include <memory>
#include <utility>

#include <trellis/scene/planar/scene.hpp>
#include <trellis/trellis.hpp>

int main() {
  using namespace trellis;
  World world(Box2{{0, 0}, {10, 10}}, {{"wall", Box2{{4, 0}, {6, 7}}}});
  Robot robot = Robot::rigid({Box2{{-0.3, -0.1}, {0.3, 0.1}}});
  Problem problem;
  problem.name = "wall";
  problem.space = default_space(robot, world, 1.0);
  problem.scene = std::make_shared<PlanarScene>(std::move(world), std::move(robot));
  problem.start = {1, 1, 0};
  problem.goals = {{9, 1, 0}};
  const StrategySpec strategy =
      GuideSpec::make("skeleton", {}) >> StrategySpec(PlannerSpec::make("rrt", {{"step", 0.5}}));
  const auto run = execute(strategy, problem, 1);
  std::cout << "trellis " << version() << ": " << strategy.text() << (run.solved ? " solved " : " did not solve ")
            << problem.name << '\n';
  return run.solved ? 0 : 1;
}
