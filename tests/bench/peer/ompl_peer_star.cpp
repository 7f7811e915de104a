// SPDX-License-Identifier: GPL-3.0-or-later
// OMPL's RRT* and Informed RRT* with their default range and factor on the scenes of the paper: the length of the best
// path over CPU time. The space has the metric of Trellis, so that both sides minimise the same length; obstacles by
// plain separating axes. Prints a line for each improvement, the fields separated by tabs: STAR, planner, scene, seed,
// CPU seconds, length.
// usage: ompl_peer_star SEEDS SECONDS

#include <ompl/base/SpaceInformation.h>
#include <ompl/base/goals/GoalState.h>
#include <ompl/base/objectives/PathLengthOptimizationObjective.h>
#include <ompl/geometric/planners/rrt/InformedRRTstar.h>
#include <ompl/geometric/planners/rrt/RRTstar.h>
#include <ompl/util/Console.h>
#include <ompl/util/RandomNumbers.h>

#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <memory>

#include "axes_obstacles.hpp"
#include "rrt_bench.hpp"
#include "space.hpp"

namespace ob = ompl::base;
namespace og = ompl::geometric;

namespace {

template <class Planner>
void plan(const char* name, const bench::Scene& scene, std::uint64_t seed, double seconds) {
  // A run repeats only when everything that draws random numbers is made anew after this.
  ompl::RNG::setSeed(static_cast<std::uint_fast32_t>(seed));
  const auto space = std::make_shared<bench::Space>();
  ob::RealVectorBounds bounds(2);
  bounds.setLow(0.0);
  bounds.setHigh(bench::world_size);
  space->setBounds(bounds);
  const double turn = bench::resolution / std::hypot(bench::robot_length / 2, bench::robot_width / 2);
  space->getSubspace(0)->setLongestValidSegmentFraction(bench::resolution / space->getSubspace(0)->getMaximumExtent());
  space->getSubspace(1)->setLongestValidSegmentFraction(turn / space->getSubspace(1)->getMaximumExtent());
  const auto information = std::make_shared<ob::SpaceInformation>(space);
  bench::AxesObstacles obstacles(scene);
  information->setStateValidityChecker([&](const ob::State* state) {
    const auto* q = state->as<ob::SE2StateSpace::StateType>();
    const bench::Placed robot(q->getX(), q->getY(), q->getYaw());
    return robot.inside_boundary() && !obstacles.touch(robot);
  });
  information->setup();
  const auto set = [](ob::ScopedState<ob::SE2StateSpace>& state, const bench::Pose& pose) {
    state->setXY(pose[0], pose[1]);
    state->setYaw(pose[2]);
  };
  ob::ScopedState<ob::SE2StateSpace> start(space);
  ob::ScopedState<ob::SE2StateSpace> goal(space);
  set(start, scene.start);
  set(goal, scene.goal);
  const auto problem = std::make_shared<ob::ProblemDefinition>(information);
  problem->setStartAndGoalStates(start, goal, bench::goal_tolerance);
  problem->setOptimizationObjective(std::make_shared<ob::PathLengthOptimizationObjective>(information));
  const double before = bench::cpu_seconds();
  problem->setIntermediateSolutionCallback(
      [&](const ob::Planner*, const std::vector<const ob::State*>&, const ob::Cost cost) {
        std::printf("STAR\t%s\t%s\t%llu\t%.9f\t%.9f\n", name, scene.name.c_str(), static_cast<unsigned long long>(seed),
                    bench::cpu_seconds() - before, cost.value());
      });
  const auto planner = std::make_shared<Planner>(information);
  planner->setProblemDefinition(problem);
  planner->setup();
  planner->solve(ob::PlannerTerminationCondition([&] { return bench::cpu_seconds() - before >= seconds; }));
}

}  // namespace

int main(int argc, char** argv) {
  const std::uint64_t seeds = argc > 1 ? std::strtoull(argv[1], nullptr, 10) : 20;
  const double seconds = argc > 2 ? std::strtod(argv[2], nullptr) : 0.2;
  ompl::msg::noOutputHandler();
  for (const bench::Scene& scene : bench::scenes()) {
    for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
      plan<og::RRTstar>("rrt_star", scene, seed, seconds);
      plan<og::InformedRRTstar>("informed_rrt_star", scene, seed, seconds);
    }
  }
  return 0;
}
