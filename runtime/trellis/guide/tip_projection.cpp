// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/guide/tip_projection.hpp>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <variant>
#include <vector>

#include <trellis/base/error.hpp>
#include <trellis/guide/arm_projection.hpp>
#include <trellis/guide/claims.hpp>
#include <trellis/guide/link_projection.hpp>
#include <trellis/scene/spatial/manipulator_scene.hpp>

namespace trellis {

Configurations TipProjection::lifted(const Configurations& path, View start, View goal) const {
  Configurations result(parent_.dimension());
  Configuration q(parent_.dimension());
  const double length = path_length(space(), path);
  double at = 0.0;
  for (std::size_t i = 0; i < path.size(); ++i) {
    if (i > 0) at += space().distance(path[i - 1], path[i]);
    parent_.interpolate(start, goal, length > 0.0 ? at / length : 0.0, q);
    if (follow(path[i], q)) result.push(q);
  }
  return result;
}

namespace {

/// The first link of a body.
const std::string& link_of(const Manipulator& robot, std::size_t body) {
  const auto& links = robot.tree().links();
  std::size_t link = 0;
  while (link + 1 < links.size() && robot.body_of(link) != body) ++link;
  return links[link].name;
}

/// The point that a link's frame's origin is, of a robot whose joints move it.
PointOnBody point_of(const std::string& guide, const SphereModel& robot, const std::string& link) {
  const KinematicTree& tree = robot.robot().tree();
  if (const std::vector<PointOnBody> tips = robot.tips(); link.empty() && tips.size() > 1) {
    std::vector<std::string> names;
    names.reserve(tips.size());
    for (const PointOnBody& tip : tips) names.push_back(fmt::format("\"{}\"", link_of(robot.robot(), tip.body)));
    throw Error(fmt::format(
        "{0}: the robot '{1}' has {2} tips, and option 'point' does not say which: {3}, or another link; or guide its "
        "arms one by one, as {0}() >> decouple() >> rrt_connect {{}}",
        guide, tree.name(), tips.size(), fmt::join(names, ", ")));
  }
  PointOnBody point = robot.tip();
  if (!link.empty()) {
    const auto found = tree.find_link(link);
    if (!found) {
      std::vector<std::string> known;
      for (const Link& one : tree.links()) known.push_back(one.name);
      throw Error(fmt::format("{}: option 'point' is \"{}\", and the robot '{}' has no such link{}; there are: {}",
                              guide, link, tree.name(), did_you_mean(link, known), fmt::join(known, ", ")));
    }
    point = {robot.robot().body_of(*found), robot.robot().pose_in_body(*found).position};
  }
  if (point.body == 0) {
    throw Error(fmt::format("{}: {} of the robot '{}' does not move", guide,
                            link.empty() ? "the tip" : "link '" + link + "'", tree.name()));
  }
  return point;
}

}  // namespace

std::shared_ptr<const TipProjection> tip_projection(const std::string& guide, const Instance& parent,
                                                    const std::string& link) {
  if (const ManipulatorScene* scene = parent.scene->manipulator()) {
    if (parent.validity_of || parent.space.dimension() < scene->robot_dimension()) {
      throw Error(fmt::format("{}: needs {}; the axes of this space ({}) are not the robot's", guide,
                              to_string(GuideClaims::Needs::position), parent.space.name()));
    }
    return std::make_shared<LinkProjection>(parent, point_of(guide, scene->robot, link));
  }
  if (!link.empty()) {
    throw Error(fmt::format("{}: option 'point' is \"{}\", and the robot '{}' is none of a URDF file", guide, link,
                            parent.scene->robot_name()));
  }
  if (parent.scene->members().size() > 1) {
    throw Error(fmt::format(
        "{0}: '{1}' is a team, which has no position of its own; guide its robots one by one, below team, decouple or "
        "prioritise, as {0}() >> prioritise() >> rrt_connect {{}}",
        guide, parent.scene->robot_name()));
  }
  auto chain = arm_chain(parent);
  if (const auto* why = std::get_if<std::string>(&chain)) {
    throw Error(fmt::format("{}: needs {}; {}", guide, to_string(GuideClaims::Needs::position), *why));
  }
  return std::make_shared<ArmProjection>(parent, std::get<ArmChain>(std::move(chain)));
}

}  // namespace trellis
