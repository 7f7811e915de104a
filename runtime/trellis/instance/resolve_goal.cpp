// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/instance/resolve_goal.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <functional>
#include <utility>
#include <vector>

#include <trellis/base/error.hpp>
#include <trellis/base/random.hpp>
#include <trellis/collision/checker.hpp>
#include <trellis/instance/inverse_kinematics.hpp>
#include <trellis/instance/manipulator_kinematics.hpp>
#include <trellis/scene/planar/scene.hpp>

namespace trellis {

bool reaches(const Robot& robot, const Reach& reach, View q) {
  std::vector<Pose2> poses(robot.bodies().size());
  robot.place(q, poses);
  const Vec2 p = poses.at(reach.body)(reach.point);
  const auto& [lo, hi] = reach.box;
  return lo.x <= p.x && p.x <= hi.x && lo.y <= p.y && p.y <= hi.y;
}

void resolve_goal(Problem& problem) {
  if (!problem.reach) return;
  constexpr int tries = 4000;
  constexpr int wanted = 40;
  constexpr std::size_t most_goals = 10;
  // Standard deviations of the samples about the start, used in turn; 0: sample the whole space. Near the start more
  // samples are valid, far from it they find other solutions.
  constexpr std::array<double, 6> spreads = {0.02, 0.1, 0.3, 0.6, 1.0, 0.0};
  const Reach& reach = *problem.reach;
  const auto checker = make_checker(problem.collision, problem.scene, problem.space, problem.resolution);
  const Robot& robot = planar(*problem.scene).robot;
  InverseKinematics kinematics(robot, problem.space, reach.body, reach.point);
  const Vec2 middle = 0.5 * (reach.box.lo + reach.box.hi);
  const Vec2 half = 0.5 * (reach.box.hi - reach.box.lo);
  const double near = 0.05 * std::min(half.x, half.y);
  Stream stream(0, problem.name, "goal");
  std::vector<std::pair<double, Configuration>> all;  // with the distance from the start
  Configuration q(problem.space.dimension());
  for (int i = 0, found = 0; i < tries && found < wanted; ++i) {
    problem.space.sample_uniform(stream, q);
    const double spread = spreads.at(static_cast<std::size_t>(i) % spreads.size());
    if (spread > 0.0) {
      for (std::size_t j = 0; j < q.size(); ++j) q[j] = problem.start[j] + spread * stream.normal();
      problem.space.reflect(q);
    }
    const Vec2 target =
        middle + Vec2{0.9 * half.x * stream.uniform(-1.0, 1.0), 0.9 * half.y * stream.uniform(-1.0, 1.0)};
    if (!kinematics.bring(q, target, near) || !reaches(robot, reach, q) || !checker->valid(q)) continue;
    ++found;
    all.emplace_back(problem.space.distance(problem.start, q), q);
  }
  if (all.empty()) {
    throw Error(
        fmt::format("problem '{}': no valid configuration brings {} into the box ({:g}, {:g}) to ({:g}, {:g}), of {} "
                    "that were tried",
                    problem.name, robot.body_name(reach.body), reach.box.lo.x, reach.box.lo.y, reach.box.hi.x,
                    reach.box.hi.y, tries));
  }
  std::stable_sort(all.begin(), all.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  problem.goals.clear();
  for (std::size_t i = 0; i < std::min(all.size(), most_goals); ++i) problem.goals.push_back(all[i].second);
}

namespace {

/// Returns valid configurations that `bring` finds from the start and from samples: at most ten, the nearest to the
/// start first.
/// \param link   in messages
/// \param bring  moves a configuration until it is a goal; false where it fails
std::vector<Configuration> goals_of(const Problem& problem, std::size_t link,
                                    const std::function<bool(MutableView)>& bring) {
  constexpr int tries = 2000;
  constexpr std::size_t most_goals = 10;
  constexpr double distinct = 0.05;  // metres in the metric between two goals
  const auto checker = make_checker(problem.collision, problem.scene, problem.space, problem.resolution);
  Stream stream(0, problem.name, "goal");
  std::vector<std::pair<double, Configuration>> found;  // with the distance from the start
  Configuration q(problem.space.dimension());
  std::size_t reached = 0;
  for (int i = 0; i < tries && found.size() < 2 * most_goals; ++i) {
    // The first attempt starts where the robot does.
    if (i == 0 && !problem.start.empty()) {
      q = problem.start;
    } else {
      problem.space.sample_uniform(stream, q);
    }
    if (!bring(q)) continue;
    ++reached;
    if (!checker->valid(q)) continue;
    const bool known = std::any_of(found.begin(), found.end(),
                                   [&](const auto& one) { return problem.space.distance(one.second, q) < distinct; });
    if (!known) found.emplace_back(problem.start.empty() ? 0.0 : problem.space.distance(problem.start, q), q);
  }
  if (found.empty()) {
    throw Error(fmt::format("problem '{}': {} of {} starts of inverse kinematics bring link '{}' to its goal, and {}",
                            problem.name, reached, tries,
                            problem.scene->manipulator()->robot.robot().tree().links()[link].name,
                            reached == 0 ? "so it is likely out of reach" : "each of them touches something"));
  }
  std::stable_sort(found.begin(), found.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<Configuration> goals;
  for (std::size_t i = 0; i < std::min(found.size(), most_goals); ++i) goals.push_back(found[i].second);
  return goals;
}

}  // namespace

std::vector<Configuration> configurations_at(const Problem& problem, std::size_t link, const Pose3& target, double near,
                                             double turn) {
  const SphereModel& robot = problem.scene->manipulator()->robot;
  const Pose3& in_body = robot.robot().pose_in_body(link);
  const Pose3 wanted{target.position, target.orientation * in_body.orientation.inverse()};
  ManipulatorKinematics kinematics(robot, problem.space, {robot.robot().body_of(link), in_body.position});
  // Half of the tolerance is left for rounding.
  return goals_of(problem, link, [&](MutableView q) { return kinematics.bring(q, wanted, 0.5 * near, 0.5 * turn); });
}

std::vector<Configuration> configurations_near(const Problem& problem, std::size_t link, const Vec3& point,
                                               const Vec3& target, double near) {
  const SphereModel& robot = problem.scene->manipulator()->robot;
  ManipulatorKinematics kinematics(robot, problem.space,
                                   {robot.robot().body_of(link), robot.robot().pose_in_body(link)(point)});
  return goals_of(problem, link, [&](MutableView q) { return kinematics.bring(q, target, 0.5 * near); });
}

}  // namespace trellis
