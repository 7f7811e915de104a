// SPDX-License-Identifier: GPL-3.0-or-later
// OMPL's RRT, RRT-Connect and PRM on the scenes of the paper, set up as its users would: SE(2) with OMPL's own metric
// |dxy| + 0.5 |dtheta|, or, with --metric trellis, with ours; its default nearest neighbours, obstacles as FCL boxes
// under a dynamic tree (checker "fcl") or by plain separating axes (checker "axes").

#include <fcl/broadphase/broadphase_dynamic_AABB_tree.h>
#include <fcl/broadphase/default_broadphase_callbacks.h>
#include <fcl/geometry/shape/box.h>
#include <fcl/narrowphase/collision_object.h>
#include <ompl/base/SpaceInformation.h>
#include <ompl/base/StateSampler.h>
#include <ompl/base/goals/GoalState.h>
#include <ompl/base/spaces/SE2StateSpace.h>
#include <ompl/geometric/planners/prm/PRM.h>
#include <ompl/geometric/planners/rrt/RRT.h>
#include <ompl/geometric/planners/rrt/RRTConnect.h>
#include <ompl/util/Console.h>
#include <ompl/util/RandomNumbers.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <exception>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "axes_obstacles.hpp"
#include "rrt_bench.hpp"
#include "space.hpp"

namespace ob = ompl::base;
namespace og = ompl::geometric;
using bench::AxesObstacles;
using bench::Obstacles;
using bench::Placed;

namespace {

/// Boxes of height 1 under FCL's dynamic tree.
class FclObstacles final : public Obstacles {
 public:
  explicit FclObstacles(const bench::Scene& scene)
      : robot_(std::make_shared<fcl::Boxd>(bench::robot_length, bench::robot_width, 1.0)) {
    for (const bench::Rectangle& r : scene.obstacles) {
      objects_.push_back(std::make_unique<fcl::CollisionObjectd>(
          std::make_shared<fcl::Boxd>(r.xmax - r.xmin, r.ymax - r.ymin, 1.0), fcl::Matrix3d::Identity(),
          fcl::Vector3d((r.xmin + r.xmax) / 2, (r.ymin + r.ymax) / 2, 0.0)));
      manager_.registerObject(objects_.back().get());
    }
    manager_.setup();
  }

  [[nodiscard]] bool touch(const Placed& robot) override {
    fcl::Matrix3d turn;
    turn << robot.c, -robot.s, 0, robot.s, robot.c, 0, 0, 0, 1;
    robot_.setTransform(turn, fcl::Vector3d(robot.x, robot.y, 0.0));
    robot_.computeAABB();
    fcl::DefaultCollisionData<double> data;
    manager_.collide(&robot_, &data, fcl::DefaultCollisionFunction<double>);
    return data.result.isCollision();
  }

 private:
  fcl::CollisionObjectd robot_;
  std::vector<std::unique_ptr<fcl::CollisionObjectd>> objects_;
  fcl::DynamicAABBTreeCollisionManagerd manager_;
};

/// An iteration of RRT draws one state, from this or from the goal.
class CountingSampler final : public ob::StateSampler {
 public:
  // The inner sampler comes ready made, so that its random numbers are those it would have without the counting.
  CountingSampler(const ob::StateSpace* space, ob::StateSamplerPtr inner, std::uint64_t& count)
      : ob::StateSampler(space), inner_(std::move(inner)), count_(count) {}

  void sampleUniform(ob::State* state) override {
    ++count_;
    inner_->sampleUniform(state);
  }
  void sampleUniformNear(ob::State* state, const ob::State* near, double distance) override {
    ++count_;
    inner_->sampleUniformNear(state, near, distance);
  }
  void sampleGaussian(ob::State* state, const ob::State* mean, double deviation) override {
    ++count_;
    inner_->sampleGaussian(state, mean, deviation);
  }

 private:
  ob::StateSamplerPtr inner_;
  std::uint64_t& count_;
};

class CountingGoal final : public ob::GoalState {
 public:
  CountingGoal(const ob::SpaceInformationPtr& information, std::uint64_t& count)
      : ob::GoalState(information), count_(count) {}

  void sampleGoal(ob::State* state) const override {
    ++count_;
    ob::GoalState::sampleGoal(state);
  }

 private:
  std::uint64_t& count_;
};

/// OMPL's PRM grows its roadmap in one thread, while a second one looks once in a millisecond whether start and goal
/// are connected, so that no run repeats. This one looks after each milestone, and ends there.
class OneThreadPrm final : public og::PRM {
 public:
  using og::PRM::PRM;

  ob::PlannerStatus solve(const ob::PlannerTerminationCondition& stop) override {
    checkValidity();
    const Vertex start = addMilestone(si_->cloneState(pis_.nextStart()));
    const Vertex goal = addMilestone(si_->cloneState(pis_.nextGoal()));
    growRoadmap(ob::PlannerTerminationCondition([&] { return sameComponent(start, goal) || stop(); }));
    if (!sameComponent(start, goal)) return ob::PlannerStatus::TIMEOUT;
    pdef_->addSolutionPath(constructSolution(start, goal));
    return ob::PlannerStatus::EXACT_SOLUTION;
  }
};

/// The planner of our name.
ob::PlannerPtr planner_of(const std::string& name, const ob::SpaceInformationPtr& information) {
  if (name == "prm") return std::make_shared<OneThreadPrm>(information);
  if (name == "rrt_connect") {
    const auto planner = std::make_shared<og::RRTConnect>(information);
    planner->setRange(bench::step);
    return planner;
  }
  const auto planner = std::make_shared<og::RRT>(information);
  planner->setRange(bench::step);
  planner->setGoalBias(bench::goal_bias);
  return planner;
}

bench::Run plan(const bench::Scene& scene, const bench::Arguments& arguments, Obstacles& obstacles,
                std::uint64_t seed) {
  bench::Run run;
  // A run repeats only when everything that draws random numbers is made anew after this.
  ompl::RNG::setSeed(static_cast<std::uint_fast32_t>(seed));

  const auto space =
      arguments.metric == "trellis" ? std::make_shared<bench::Space>() : std::make_shared<ob::SE2StateSpace>();
  ob::RealVectorBounds bounds(2);
  bounds.setLow(0.0);
  bounds.setHigh(bench::world_size);
  space->setBounds(bounds);
  // The longest valid segments as shares of each part's extent: the resolution for the position, and for the angle the
  // turn that moves the robot's corner by as much.
  const double turn = bench::resolution / std::hypot(bench::half_length, bench::half_width);
  space->getSubspace(0)->setLongestValidSegmentFraction(bench::resolution / space->getSubspace(0)->getMaximumExtent());
  space->getSubspace(1)->setLongestValidSegmentFraction(turn / space->getSubspace(1)->getMaximumExtent());
  space->setStateSamplerAllocator([&run](const ob::StateSpace* of) -> ob::StateSamplerPtr {
    return std::make_shared<CountingSampler>(of, of->allocDefaultStateSampler(), run.iterations);
  });

  const auto information = std::make_shared<ob::SpaceInformation>(space);
  information->setStateValidityChecker([&](const ob::State* state) {
    ++run.checks;
    const auto* q = state->as<ob::SE2StateSpace::StateType>();
    const Placed robot(q->getX(), q->getY(), q->getYaw());
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
  problem->addStartState(start);
  const auto target = std::make_shared<CountingGoal>(information, run.iterations);
  target->setState(goal.get());
  target->setThreshold(bench::goal_tolerance);
  problem->setGoal(target);

  const ob::PlannerPtr planner = planner_of(arguments.planner, information);
  planner->setProblemDefinition(problem);
  planner->setup();

  // Set-up may draw samples and check states; only what `solve` does counts.
  run.iterations = 0;
  run.checks = 0;
  const ob::PlannerTerminationCondition stop([&run] { return run.iterations >= bench::iteration_limit; });
  const double before = bench::cpu_seconds();
  const ob::PlannerStatus status = planner->solve(stop);
  run.cpu = bench::cpu_seconds() - before;
  run.planning = run.cpu;
  run.solved = status == ob::PlannerStatus::EXACT_SOLUTION;

  ob::PlannerData data(information);
  planner->getPlannerData(data);
  run.nodes = data.numVertices();
  return run;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    const bench::Arguments arguments = bench::parse(argc, argv, {"fcl", "axes"});
    // It warns of every seed after the first.
    ompl::msg::noOutputHandler();
    bench::measure(arguments, "ompl", [&](const bench::Scene& scene, std::uint64_t seed) {
      std::unique_ptr<Obstacles> obstacles;
      if (arguments.checker == "fcl") {
        obstacles = std::make_unique<FclObstacles>(scene);
      } else {
        obstacles = std::make_unique<AxesObstacles>(scene);
      }
      return plan(scene, arguments, *obstacles, seed);
    });
  } catch (const std::exception& error) {
    std::fprintf(stderr, "ompl_peer: %s\n", error.what());
    return 1;
  }
  return 0;
}
