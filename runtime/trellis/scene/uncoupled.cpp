// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/scene/uncoupled.hpp>

#include <algorithm>
#include <optional>

#include <trellis/scene/planar/scene.hpp>
#include <trellis/scene/spatial/manipulator_scene.hpp>
#include <trellis/scene/spatial/scene.hpp>

namespace trellis {

namespace {

bool has_pair(const std::vector<RobotPair>& pairs, std::size_t a, std::size_t b) {
  return std::any_of(pairs.begin(), pairs.end(), [&](const RobotPair& pair) {
    return pair == RobotPair{a, b} || pair == RobotPair{b, a};
  });
}

Robot uncoupled(const Robot& robot, const std::vector<RobotPair>& pairs) {
  std::vector<std::pair<std::size_t, std::size_t>> kept;
  for (const auto& [first, second] : robot.pairs()) {
    const Robot::Member& one = robot.members()[robot.member_of(first)];
    const Robot::Member& other = robot.members()[robot.member_of(second)];
    if (!has_pair(pairs, one.number, other.number)) kept.emplace_back(first, second);
  }
  return robot.apart(std::move(kept));
}

SphereModel uncoupled(const SphereModel& model, const std::vector<RobotPair>& pairs) {
  const Manipulator& robot = model.robot();
  const std::vector<TeamMember> members = model.members();
  // The member that moves a body; none moves the base.
  const auto mover = [&](std::size_t body) -> std::optional<std::size_t> {
    if (body == 0) return std::nullopt;
    for (const TeamMember& member : members) {
      if (std::binary_search(member.axes.begin(), member.axes.end(), robot.bodies()[body].column)) return member.number;
    }
    return std::nullopt;
  };
  SphereModel::Pairs touching;
  const std::size_t links = robot.tree().links().size();
  for (std::size_t a = 0; a < links; ++a) {
    for (std::size_t b = a + 1; b < links; ++b) {
      const auto one = mover(robot.body_of(a)), other = mover(robot.body_of(b));
      if (one && other && has_pair(pairs, *one, *other)) touching.emplace_back(a, b);
    }
  }
  return model.with_permissions(touching);
}

}  // namespace

std::shared_ptr<const Scene> uncoupled(const Scene& scene, const std::vector<RobotPair>& pairs) {
  if (const PlanarScene* planar = scene.planar()) {
    if (planar->robot.members().empty()) return nullptr;
    return std::make_shared<PlanarScene>(planar->world, uncoupled(planar->robot, pairs));
  }
  if (const ManipulatorScene* manipulator = scene.manipulator()) {
    return std::make_shared<ManipulatorScene>(manipulator->world, uncoupled(manipulator->robot, pairs));
  }
  if (const SpatialScene* bodies = scene.spatial(); bodies != nullptr && !bodies->robot.members().empty()) {
    return std::make_shared<SpatialScene>(bodies->world, bodies->robot.uncoupled(pairs));
  }
  return nullptr;
}

}  // namespace trellis
