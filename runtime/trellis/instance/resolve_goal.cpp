// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/instance/resolve_goal.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <numbers>
#include <utility>
#include <vector>

#include <trellis/base/error.hpp>
#include <trellis/base/random.hpp>
#include <trellis/collision/checker.hpp>
#include <trellis/instance/end_fault.hpp>
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
    throw InvalidEnd(
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

/// Brings the links of a manipulator to their targets, one after the other until all are there.
class LinkSolver {
 public:
  LinkSolver(const SphereModel& robot, const Space& space, const std::vector<LinkTarget>& targets) {
    for (const LinkTarget& target : targets) {
      const Pose3& in_body = robot.robot().pose_in_body(target.link);
      const PointOnBody point{robot.robot().body_of(target.link), in_body(target.point)};
      arms_.push_back({std::make_unique<ManipulatorKinematics>(robot, space, point),
                       {target.pose.position, target.pose.orientation * in_body.orientation.inverse()},
                       target.near,
                       target.turn});
    }
  }

  /// \return whether all links are at their targets
  bool bring(MutableView q) {
    constexpr int most_rounds = 10;  // links that share joints move each other
    for (int round = 0; round < (arms_.size() > 1 ? most_rounds : 1); ++round) {
      for (Arm& arm : arms_) {
        // Half of the tolerance is left for rounding.
        const bool there = arm.turn >= std::numbers::pi
                               ? arm.kinematics->bring(q, arm.wanted.position, 0.5 * arm.near)
                               : arm.kinematics->bring(q, arm.wanted, 0.5 * arm.near, 0.5 * arm.turn);
        if (!there) return false;
      }
      if (arms_.size() == 1 || std::all_of(arms_.begin(), arms_.end(), [&](Arm& arm) { return arm.arrived(q); })) {
        return true;
      }
    }
    return false;
  }

 private:
  struct Arm {
    std::unique_ptr<ManipulatorKinematics> kinematics;
    Pose3 wanted;
    double near;
    double turn;

    [[nodiscard]] bool arrived(View q) const {
      const Pose3 at = kinematics->frame(q);
      return norm(wanted.position - at.position) <= near &&
             norm(rotation_vector(wanted.orientation * at.orientation.inverse())) <= turn;
    }
  };
  std::vector<Arm> arms_;
};

}  // namespace

ReachAnswer reach_configurations(const Problem& problem, const ReachQuery& query) {
  constexpr int tries = 2000;
  constexpr double distinct = 0.05;            // metres in the metric between two configurations
  constexpr std::size_t most_in_contact = 50;  // solutions whose shapes are compared
  const SphereModel& robot = problem.scene->manipulator()->robot;
  const auto checker = make_checker(problem.collision, problem.scene, problem.space, problem.resolution);
  LinkSolver solver(robot, problem.space, query.targets);
  Stream stream(query.seed, problem.name, query.name);
  using Found = std::vector<std::pair<double, Configuration>>;  // with the distance from the first
  Found found, in_contact;
  Configuration q(problem.space.dimension());
  std::size_t reached = 0;
  const auto keep = [&](Found& list) {
    const bool known = std::any_of(list.begin(), list.end(),
                                   [&](const auto& one) { return problem.space.distance(one.second, q) < distinct; });
    if (!known) list.emplace_back(query.first.empty() ? 0.0 : problem.space.distance(query.first, q), q);
  };
  for (int i = 0; i < tries && found.size() < 2 * query.most; ++i) {
    if (i == 0 && !query.first.empty()) {
      q = query.first;
    } else {
      problem.space.sample_uniform(stream, q);
    }
    for (std::size_t j = 0; j < query.given.size(); ++j) {
      if (!std::isnan(query.given[j])) q[j] = query.given[j];
    }
    if (!solver.bring(q)) continue;
    ++reached;
    if (checker->valid(q)) {
      keep(found);
    } else if (in_contact.size() < most_in_contact) {
      keep(in_contact);
    }
  }
  std::string fault;
  if (found.empty()) {
    EndChecker ends(problem);
    for (const auto& one : in_contact) {
      const EndFault of_end = ends.fault(one.second);
      if (fault.empty()) fault = of_end.text;
      if (of_end.fits) found.push_back(one);
    }
  }
  ReachAnswer answer;
  if (found.empty()) {
    std::vector<std::string> links;
    for (const LinkTarget& target : query.targets) {
      links.push_back(fmt::format("'{}'", robot.robot().tree().links()[target.link].name));
    }
    answer.failure = fmt::format(
        "{} of {} starts of inverse kinematics bring link{} {} to {} goal, and {}", reached, tries,
        links.size() > 1 ? "s" : "", fmt::join(links, " and "), links.size() > 1 ? "their" : "its",
        reached == 0 ? "so it is likely out of reach" : "each of them touches something: of the first, " + fault);
    return answer;
  }
  std::stable_sort(found.begin(), found.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  for (std::size_t i = 0; i < std::min(found.size(), query.most); ++i) {
    answer.configurations.push_back(std::move(found[i].second));
  }
  return answer;
}

namespace {

std::vector<Configuration> configurations_of(const Problem& problem, const LinkTarget& target) {
  ReachQuery query;
  query.targets = {target};
  query.first = problem.start;
  ReachAnswer answer = reach_configurations(problem, query);
  if (answer.configurations.empty()) {
    throw InvalidEnd(fmt::format("problem '{}': {}", problem.name, answer.failure));
  }
  return std::move(answer.configurations);
}

}  // namespace

std::vector<Configuration> configurations_at(const Problem& problem, std::size_t link, const Pose3& target, double near,
                                             double turn) {
  return configurations_of(problem, {link, target, near, turn});
}

std::vector<Configuration> configurations_near(const Problem& problem, std::size_t link, const Vec3& point,
                                               const Vec3& target, double near) {
  return configurations_of(problem, {link, {target, {}}, near, std::numbers::pi, point});
}

}  // namespace trellis
