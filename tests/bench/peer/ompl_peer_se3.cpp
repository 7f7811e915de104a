// SPDX-License-Identifier: GPL-3.0-or-later
// OMPL's RRT-Connect for a rigid body among meshes, set up as OMPL.app does: one FCL model of the robot, one of all
// obstacles, and a call of fcl::collide for each state.

#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/narrowphase/collision.h>
#include <ompl/base/SpaceInformation.h>
#include <ompl/base/StateSampler.h>
#include <ompl/base/goals/GoalState.h>
#include <ompl/base/spaces/SE3StateSpace.h>
#include <ompl/geometric/planners/rrt/RRTConnect.h>
#include <ompl/util/Console.h>
#include <ompl/util/RandomNumbers.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <exception>
#include <memory>
#include <utility>
#include <vector>

#include "se3_bench.hpp"

namespace ob = ompl::base;
namespace og = ompl::geometric;

namespace {

using Model = fcl::BVHModel<fcl::OBBRSSd>;
using State = ob::SE3StateSpace::StateType;

std::unique_ptr<Model> model_of(const bench::Triangles& mesh) {
  std::vector<fcl::Vector3d> vertices;
  for (const auto& v : mesh.vertices) vertices.emplace_back(v[0], v[1], v[2]);
  std::vector<fcl::Triangle> triangles;
  for (const auto& t : mesh.triangles) triangles.emplace_back(t[0], t[1], t[2]);
  auto model = std::make_unique<Model>();
  model->beginModel(static_cast<int>(triangles.size()), static_cast<int>(vertices.size()));
  model->addSubModel(vertices, triangles);
  model->endModel();
  model->computeLocalAABB();
  return model;
}

class Checker {
 public:
  explicit Checker(const bench::Body& body)
      : body_(body), robot_(model_of(body.robot)), obstacles_(model_of(body.obstacles)) {
    for (const auto& v : body.robot.vertices) vertices_.emplace_back(v[0], v[1], v[2]);
  }

  [[nodiscard]] bool valid(const State& state) const {
    const auto& turn = state.rotation();
    fcl::Transform3d pose = fcl::Transform3d::Identity();
    pose.linear() = fcl::Quaterniond(turn.w, turn.x, turn.y, turn.z).toRotationMatrix();
    pose.translation() = fcl::Vector3d(state.getX(), state.getY(), state.getZ());
    if (!inside(pose)) return false;
    const fcl::CollisionRequestd request;
    fcl::CollisionResultd result;
    return fcl::collide(robot_.get(), pose, obstacles_.get(), fcl::Transform3d::Identity(), request, result) == 0;
  }

 private:
  [[nodiscard]] bool inside(const fcl::Transform3d& pose) const {
    const auto within = [&](const fcl::Vector3d& p, double radius) {
      for (int j = 0; j < 3; ++j) {
        if (p[j] - radius < body_.bounds[j] || p[j] + radius > body_.bounds[j + 3]) return false;
      }
      return true;
    };
    if (!body_.whole) return within(pose.translation(), 0.0);
    if (within(pose.translation(), body_.radius)) return true;
    for (const auto& vertex : vertices_) {
      if (!within(pose * vertex, 0.0)) return false;
    }
    return true;
  }

  const bench::Body& body_;
  std::unique_ptr<Model> robot_, obstacles_;
  std::vector<fcl::Vector3d> vertices_;
};

/// An iteration of RRT-Connect draws one state.
class CountingSampler final : public ob::StateSampler {
 public:
  CountingSampler(const ob::StateSpace* space, ob::StateSamplerPtr inner, std::uint64_t& count)
      : ob::StateSampler(space), inner_(std::move(inner)), count_(count) {}

  void sampleUniform(ob::State* state) override {
    ++count_;
    inner_->sampleUniform(state);
  }
  void sampleUniformNear(ob::State* state, const ob::State* near, double distance) override {
    inner_->sampleUniformNear(state, near, distance);
  }
  void sampleGaussian(ob::State* state, const ob::State* mean, double deviation) override {
    inner_->sampleGaussian(state, mean, deviation);
  }

 private:
  ob::StateSamplerPtr inner_;
  std::uint64_t& count_;
};

bench::Run plan(const bench::Body& body, const Checker& checker, std::uint64_t seed) {
  bench::Run run;
  ompl::RNG::setSeed(static_cast<std::uint_fast32_t>(seed));
  const auto space = std::make_shared<ob::SE3StateSpace>();
  ob::RealVectorBounds bounds(3);
  for (unsigned j = 0; j < 3; ++j) {
    bounds.setLow(j, body.bounds[j]);
    bounds.setHigh(j, body.bounds[j + 3]);
  }
  space->setBounds(bounds);
  // OMPL's distance of rotations is half the angle of the turn between them.
  space->setSubspaceWeight(1, 2.0 * body.weight);
  // The longest valid segments as shares of each part's extent: the resolution for the position, and for the rotation
  // the turn that moves the robot's farthest point by as much.
  const double turn = 0.5 * body.resolution / body.radius;
  space->getSubspace(0)->setLongestValidSegmentFraction(body.resolution / space->getSubspace(0)->getMaximumExtent());
  space->getSubspace(1)->setLongestValidSegmentFraction(turn / space->getSubspace(1)->getMaximumExtent());
  space->setStateSamplerAllocator([&run](const ob::StateSpace* of) -> ob::StateSamplerPtr {
    return std::make_shared<CountingSampler>(of, of->allocDefaultStateSampler(), run.iterations);
  });

  const auto information = std::make_shared<ob::SpaceInformation>(space);
  information->setStateValidityChecker([&](const ob::State* state) {
    ++run.checks;
    return checker.valid(*state->as<State>());
  });
  information->setup();

  const auto set = [](ob::ScopedState<ob::SE3StateSpace>& state, const std::array<double, 7>& q) {
    state->setXYZ(q[0], q[1], q[2]);
    auto& rotation = state->rotation();
    rotation.x = q[3];
    rotation.y = q[4];
    rotation.z = q[5];
    rotation.w = q[6];
  };
  ob::ScopedState<ob::SE3StateSpace> start(space);
  ob::ScopedState<ob::SE3StateSpace> goal(space);
  set(start, body.start);
  set(goal, body.goal);
  const auto problem = std::make_shared<ob::ProblemDefinition>(information);
  problem->setStartAndGoalStates(start, goal, bench::goal_tolerance);

  const auto planner = std::make_shared<og::RRTConnect>(information);
  planner->setRange(body.step);
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
    const bench::BodyArguments arguments = bench::parse_body(argc, argv);
    ompl::msg::noOutputHandler();
    const bench::Body body = bench::read(arguments.file);
    const Checker checker(body);
    bench::measure(arguments, "ompl", body.name, [&](std::uint64_t seed) { return plan(body, checker, seed); });
  } catch (const std::exception& error) {
    std::fprintf(stderr, "ompl_peer_se3: %s\n", error.what());
    return 1;
  }
  return 0;
}
