// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/instance/instance.hpp>

namespace trellis {

std::unique_ptr<Instance> make_instance(const Problem& problem) {
  auto instance = std::make_unique<Instance>();
  instance->space = problem.space;
  instance->scene = problem.scene;
  instance->validity = std::make_shared<CollisionValidity>(
      make_checker(problem.collision, problem.scene, problem.space, problem.resolution));
  instance->start = problem.start;
  instance->goal = problem.goal;
  instance->goal_tolerance = problem.goal_tolerance;
  instance->resolution = problem.resolution;
  instance->collision = problem.collision;
  if (problem.scene->robot.translates()) instance->position_axes = {0, 1};
  return instance;
}

}  // namespace trellis
