// SPDX-License-Identifier: GPL-3.0-or-later
// A problem of space and strategies for it, for tests of pictures and files.
#pragma once

#include <cmath>
#include <memory>
#include <string>
#include <utility>

#include <trellis/experiment/experiment.hpp>
#include <trellis/scene/spatial/scene.hpp>

namespace trellis::test {

/// A plank that has to turn to pass the slot between two blocks, with solids of the other kinds beside it.
inline Problem slot_problem() {
  const auto tetrahedron =
      std::make_shared<const Mesh>(Mesh::hull({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, "tetrahedron"));
  World3 world({{0, 0, 0}, {10, 10, 10}}, {{"lower block", {Cuboid{{2, 10, 4.4}}, {{5, 5, 2.2}, {}}}},
                                           {"upper block", {Cuboid{{2, 10, 4.4}}, {{5, 5, 7.8}, {}}}},
                                           {"ball", {Sphere{0.6}, {{2.5, 5, 5}, {}}}},
                                           {"post", {Cylinder{0.3, 4.0}, {{8, 8, 2}, {}}}},
                                           {"rod", {Capsule{0.2, 2.0}, {{2, 8, 2}, {}}}},
                                           {"tetrahedron", {tetrahedron, {{8, 4, 4}, {}}}}});
  Robot3 plank("plank", {{Cuboid{{1.6, 1.0, 0.2}}, {}}});
  Problem problem;
  problem.name = "slot";
  problem.scene = std::make_shared<const SpatialScene>(std::move(world), std::move(plank));
  problem.space = problem.scene->default_space(problem.scene->bounding_radius());
  const double half = std::sqrt(0.5);
  problem.start = {1, 5, 5, 0, half, 0, half};
  problem.goals = {{9, 5, 6, half, 0, 0, half}};
  problem.collision = "fcl";
  return problem;
}

/// The slot with a strategy without guides and one with two levels of guides, unscored.
inline Experiment slot_experiment() {
  const PlannerSpec planner = PlannerSpec::make("rrt_connect", {{"step", 1.0}, {"proposals", 20000.0}, {"bound", 0.0}});
  Experiment experiment;
  experiment.problems = {slot_problem()};
  experiment.strategies = {
      {"rrt_connect", {planner}},
      {"nested", GuideSpec::make("workspace", {}) >> GuideSpec::make("shrink", {{"scale", 0.5}}) >> planner}};
  experiment.seeds = {1};
  experiment.measure.reset();
  return experiment;
}

}  // namespace trellis::test
