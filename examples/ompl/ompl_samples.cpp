// SPDX-License-Identifier: MIT-0
// ompl_samples FOLDER: plans with OMPL's RRT, with and without a guide, and writes the input of `trellis measure` to
// FOLDER. docs/tutorials/measure.md describes it. It does not use Trellis: other programs can record their samples in
// the same format.
//
// For each planner (rrt, guided) and seed: PLANNER-SEED-tree.csv, the nodes of the tree; PLANNER-SEED-proposals.csv,
// the states that the tree was asked to grow towards; and of each two cases, against the run's own path (-own.json) and
// against the path of the plain RRT of the next seed (-cross.json).

#include <ompl/base/SpaceInformation.h>
#include <ompl/base/StateSampler.h>
#include <ompl/base/goals/GoalState.h>
#include <ompl/base/spaces/RealVectorStateSpace.h>
#include <ompl/base/spaces/SE2StateSpace.h>
#include <ompl/base/terminationconditions/IterationTerminationCondition.h>
#include <ompl/geometric/PathGeometric.h>
#include <ompl/geometric/PathSimplifier.h>
#include <ompl/geometric/planners/rrt/RRT.h>
#include <ompl/util/Console.h>
#include <ompl/util/RandomNumbers.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iostream>
#include <limits>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace ob = ompl::base;
namespace og = ompl::geometric;
namespace fs = std::filesystem;

namespace {

using Pose = std::array<double, 3>;  // x, y, theta
using Poses = std::vector<Pose>;
using Point = std::array<double, 2>;
using Valid = std::function<bool(const ob::State*)>;

constexpr std::uint_fast32_t seeds = 5;
constexpr double step = 0.5;
constexpr double goal_bias = 0.05;
constexpr double goal_tolerance = 0.2;
constexpr double half_length = 0.3;
constexpr double half_width = 0.1;
constexpr double world_size = 10.0;
constexpr double guide_deviation = 0.3;
constexpr unsigned iteration_limit = 200'000;

// The world
// ---------------------------------------------------------------------------------------------------------------

struct Box {
  double xmin, ymin, xmax, ymax;
};

// scenes.trap of Trellis: four gaps too narrow for the robot, two dead ends, and one wide passage, at y = 9.
constexpr auto obstacles = std::to_array<Box>({{4.5, 0, 5.5, 1.925},
                                               {4.5, 2.075, 5.5, 3.325},
                                               {4.5, 3.475, 5.5, 4.525},
                                               {4.5, 4.675, 5.5, 5.05},
                                               {5.3, 5.05, 5.5, 5.55},
                                               {4.5, 5.55, 5.5, 5.925},
                                               {4.5, 6.075, 5.5, 6.95},
                                               {5.3, 6.95, 5.5, 7.45},
                                               {4.5, 7.45, 5.5, 8.75},
                                               {4.5, 9.25, 5.5, 10}});
constexpr Pose start = {1, 4, 0};
constexpr Pose goal = {9, 4, 0};

Pose pose_of(const ob::State* state) {
  const auto* q = state->as<ob::SE2StateSpace::StateType>();
  return {q->getX(), q->getY(), q->getYaw()};
}

/// Separating axes: the world's two, then the robot's.
bool robot_fits(const Pose& q) {
  const double c = std::abs(std::cos(q[2]));
  const double s = std::abs(std::sin(q[2]));
  const double extent_x = c * half_length + s * half_width;
  const double extent_y = s * half_length + c * half_width;
  if (std::min(q[0], world_size - q[0]) < extent_x || std::min(q[1], world_size - q[1]) < extent_y) return false;
  return std::none_of(obstacles.begin(), obstacles.end(), [&](const Box& box) {
    const double half_x = (box.xmax - box.xmin) / 2;
    const double half_y = (box.ymax - box.ymin) / 2;
    const double dx = box.xmin + half_x - q[0];
    const double dy = box.ymin + half_y - q[1];
    const double ahead = dx * std::cos(q[2]) + dy * std::sin(q[2]);
    const double aside = dy * std::cos(q[2]) - dx * std::sin(q[2]);
    return std::abs(dx) <= extent_x + half_x && std::abs(dy) <= extent_y + half_y &&
           std::abs(ahead) <= half_length + c * half_x + s * half_y &&
           std::abs(aside) <= half_width + s * half_x + c * half_y;
  });
}

/// For the guide: the largest disc within the robot.
bool disc_fits(double x, double y) {
  if (std::min({x, y, world_size - x, world_size - y}) < half_width) return false;
  return std::none_of(obstacles.begin(), obstacles.end(), [&](const Box& box) {
    return std::hypot(x - std::clamp(x, box.xmin, box.xmax), y - std::clamp(y, box.ymin, box.ymax)) <= half_width;
  });
}

// What is recorded
// ---------------------------------------------------------------------------------------------------------------

/// Forwards to another sampler and records its samples. RRT calls `sampleUniform` only.
class RecordingSampler final : public ob::StateSampler {
 public:
  RecordingSampler(const ob::StateSpace* space, ob::StateSamplerPtr inner, Poses& drawn)
      : ob::StateSampler(space), inner_(std::move(inner)), drawn_(drawn) {}

  void sampleUniform(ob::State* state) override {
    inner_->sampleUniform(state);
    drawn_.push_back(pose_of(state));
  }
  void sampleUniformNear(ob::State* state, const ob::State* near, double distance) override {
    inner_->sampleUniformNear(state, near, distance);
    drawn_.push_back(pose_of(state));
  }
  void sampleGaussian(ob::State* state, const ob::State* mean, double deviation) override {
    inner_->sampleGaussian(state, mean, deviation);
    drawn_.push_back(pose_of(state));
  }

 private:
  ob::StateSamplerPtr inner_;
  Poses& drawn_;
};

/// The goal bias does not pass through the sampler: RRT asks the goal.
class RecordingGoal final : public ob::GoalState {
 public:
  RecordingGoal(const ob::SpaceInformationPtr& information, Poses& drawn) : ob::GoalState(information), drawn_(drawn) {}

  void sampleGoal(ob::State* state) const override {
    ob::GoalState::sampleGoal(state);
    drawn_.push_back(pose_of(state));
  }

 private:
  Poses& drawn_;
};

// Planning
// ---------------------------------------------------------------------------------------------------------------

/// Returns the shortcut path of an RRT; `drawn` receives the samples that the sampler and the goal record.
og::PathGeometric solve(const std::shared_ptr<og::RRT>& planner, const ob::ProblemDefinitionPtr& problem) {
  planner->setRange(step);
  planner->setGoalBias(goal_bias);
  planner->setProblemDefinition(problem);
  planner->setup();
  // A time limit would not be reproducible.
  ob::IterationTerminationCondition limit(iteration_limit);
  if (planner->solve(limit) != ob::PlannerStatus::EXACT_SOLUTION) {
    throw std::runtime_error("no path within the limit of iterations");
  }
  og::PathGeometric path = *problem->getSolutionPath()->as<og::PathGeometric>();
  og::PathSimplifier(planner->getSpaceInformation()).shortcutPath(path);
  return path;
}

ob::SpaceInformationPtr information_of(const ob::StateSpacePtr& space, const Valid& valid) {
  const auto information = std::make_shared<ob::SpaceInformation>(space);
  information->setStateValidityChecker(valid);
  information->setStateValidityCheckingResolution(0.002);
  information->setup();
  return information;
}

ob::RealVectorBounds bounds() {
  ob::RealVectorBounds result(2);
  result.setLow(0.0);
  result.setHigh(world_size);
  return result;
}

/// The guide: a path of the disc in the plane, start to goal.
std::vector<Point> path_of_disc() {
  const auto space = std::make_shared<ob::RealVectorStateSpace>(2);
  space->setBounds(bounds());
  const auto information = information_of(space, [](const ob::State* state) {
    const auto* p = state->as<ob::RealVectorStateSpace::StateType>();
    return disc_fits((*p)[0], (*p)[1]);
  });
  ob::ScopedState<ob::RealVectorStateSpace> from(space);
  ob::ScopedState<ob::RealVectorStateSpace> to(space);
  for (unsigned i = 0; i < 2; ++i) {
    from[i] = start[i];
    to[i] = goal[i];
  }
  const auto problem = std::make_shared<ob::ProblemDefinition>(information);
  problem->setStartAndGoalStates(from, to, goal_tolerance);
  og::PathGeometric path = solve(std::make_shared<og::RRT>(information), problem);
  path.interpolate(200);  // evenly along the path, so that its points can be drawn with equal chance
  std::vector<Point> points;
  for (const ob::State* state : path.getStates()) {
    const auto* p = state->as<ob::RealVectorStateSpace::StateType>();
    points.push_back({(*p)[0], (*p)[1]});
  }
  return points;
}

/// Half uniform; half normal about a point of the guide, with the angle uniform.
class GuidedSampler final : public ob::StateSampler {
 public:
  GuidedSampler(const ob::StateSpace* space, std::vector<Point> guide)
      : ob::StateSampler(space), uniform_(space->allocDefaultStateSampler()), guide_(std::move(guide)) {}

  void sampleUniform(ob::State* state) override {
    uniform_->sampleUniform(state);
    if (rng_.uniform01() < 0.5) return;
    auto* q = state->as<ob::SE2StateSpace::StateType>();
    const Point& at = guide_[static_cast<std::size_t>(rng_.uniformInt(0, static_cast<int>(guide_.size()) - 1))];
    q->setXY(rng_.gaussian(at[0], guide_deviation), rng_.gaussian(at[1], guide_deviation));
    space_->enforceBounds(state);
  }
  void sampleUniformNear(ob::State* state, const ob::State* near, double distance) override {
    uniform_->sampleUniformNear(state, near, distance);
  }
  void sampleGaussian(ob::State* state, const ob::State* mean, double deviation) override {
    uniform_->sampleGaussian(state, mean, deviation);
  }

 private:
  ob::StateSamplerPtr uniform_;
  std::vector<Point> guide_;
};

struct Run {
  Poses path, tree, proposals;
};

Run plan(bool guided, std::uint_fast32_t seed) {
  // A run is reproducible if all random generators are created after this.
  ompl::RNG::setSeed(seed);
  Run run;
  const auto space = std::make_shared<ob::SE2StateSpace>();
  space->setBounds(bounds());
  const std::vector<Point> guide = guided ? path_of_disc() : std::vector<Point>();
  space->setStateSamplerAllocator([&](const ob::StateSpace* of) -> ob::StateSamplerPtr {
    const ob::StateSamplerPtr sampler =
        guided ? std::make_shared<GuidedSampler>(of, guide) : of->allocDefaultStateSampler();
    return std::make_shared<RecordingSampler>(of, sampler, run.proposals);
  });
  const auto information = information_of(space, [](const ob::State* state) { return robot_fits(pose_of(state)); });

  ob::ScopedState<ob::SE2StateSpace> from(space);
  ob::ScopedState<ob::SE2StateSpace> to(space);
  for (unsigned i = 0; i < 3; ++i) {
    from[i] = start[i];
    to[i] = goal[i];
  }
  const auto target = std::make_shared<RecordingGoal>(information, run.proposals);
  target->setState(to);
  target->setThreshold(goal_tolerance);
  const auto problem = std::make_shared<ob::ProblemDefinition>(information);
  problem->addStartState(from);
  problem->setGoal(target);

  const auto planner = std::make_shared<og::RRT>(information);
  run.proposals.clear();  // set-up may draw
  og::PathGeometric path = solve(planner, problem);
  for (const ob::State* state : path.getStates()) run.path.push_back(pose_of(state));
  ob::PlannerData data(information);
  planner->getPlannerData(data);
  for (unsigned i = 0; i < data.numVertices(); ++i) run.tree.push_back(pose_of(data.getVertex(i).getState()));
  return run;
}

// The files
// ---------------------------------------------------------------------------------------------------------------

std::ofstream created(const fs::path& file) {
  std::ofstream out(file);
  out.exceptions(std::ios::failbit | std::ios::badbit);
  out.precision(std::numeric_limits<double>::max_digits10);
  return out;
}

void write_samples(const fs::path& file, const Poses& samples) {
  std::ofstream out = created(file);
  out << "x,y,theta\n";
  for (const Pose& q : samples) out << q[0] << ',' << q[1] << ',' << q[2] << '\n';
}

void write_case(const fs::path& file, const Poses& path, const std::string& samples) {
  std::ofstream out = created(file);
  out << R"({
  "dim": 3,
  "coords": ["x", "y", "theta"],
  "weights": [1, 1, 0.5],
  "lo": [0, 0, -3.141592653589793],
  "hi": [10, 10, 3.141592653589793],
  "periodic": [false, false, true],
  "delta": 0.5,
  "free": "trap",
  "samples": ")"
      << samples << "\",\n  \"path\": [";
  const char* separator = "\n";
  for (const Pose& q : path) {
    out << separator << "    [" << q[0] << ", " << q[1] << ", " << q[2] << ']';
    separator = ",\n";
  }
  out << "\n  ]\n}\n";
}

}  // namespace

int main(int argc, char** argv) {
  try {
    if (argc != 2) throw std::runtime_error("usage: ompl_samples FOLDER");
    const fs::path folder = argv[1];
    fs::create_directories(folder);
    ompl::msg::noOutputHandler();  // it warns of every seed after the first
    std::vector<Run> plain;
    for (std::uint_fast32_t seed = 1; seed <= seeds; ++seed) plain.push_back(plan(false, seed));
    for (std::uint_fast32_t seed = 1; seed <= seeds; ++seed) {
      const Poses& other = plain[seed % seeds].path;  // of the next seed
      for (const bool guided : {false, true}) {
        const Run run = guided ? plan(true, seed) : plain[seed - 1];
        for (const bool tree : {false, true}) {
          const std::string name =
              std::string(guided ? "guided" : "rrt") + "-" + std::to_string(seed) + "-" + (tree ? "tree" : "proposals");
          write_samples(folder / (name + ".csv"), tree ? run.tree : run.proposals);
          write_case(folder / (name + "-own.json"), run.path, name + ".csv");
          write_case(folder / (name + "-cross.json"), other, name + ".csv");
        }
      }
    }
  } catch (const std::exception& error) {
    std::cerr << "ompl_samples: " << error.what() << '\n';
    return 1;
  }
  return 0;
}
