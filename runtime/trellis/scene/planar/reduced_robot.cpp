// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/scene/planar/reduced_robot.hpp>

#include <algorithm>
#include <map>
#include <set>
#include <utility>

namespace trellis {

namespace {

class Reduction {
 public:
  Reduction(const Robot& robot, const std::vector<std::size_t>& axes) : robot_(robot) {
    for (std::size_t j = 0; j < axes.size(); ++j) {
      if (axes[j] < robot.dimension()) place_of_[axes[j]] = static_cast<int>(j);
    }
  }

  /// None if no shape is determined.
  std::optional<Robot> robot() {
    const bool placed = !robot_.translates() || (known(0) && known(1));
    if (!placed) return std::nullopt;
    for (const Body& body : robot_.bodies()) add(body);
    if (std::none_of(bodies_.begin(), bodies_.end(), [](const Body& body) { return !body.parts.empty(); })) {
      return std::nullopt;
    }
    add_idle_axes();
    std::vector<std::pair<std::size_t, std::size_t>> pairs;
    for (const auto& [first, second] : robot_.pairs()) {
      if (places_[first] >= 0 && places_[second] >= 0) {
        pairs.emplace_back(static_cast<std::size_t>(places_[first]), static_cast<std::size_t>(places_[second]));
      }
    }
    return Robot(robot_.name(), std::move(bodies_), robot_.translates(), robot_.base()).apart(std::move(pairs));
  }

 private:
  [[nodiscard]] bool known(int axis) const { return place_of_.contains(static_cast<std::size_t>(axis)); }

  void add(const Body& body) {
    const bool rooted = body.parent < 0;
    const auto parent = static_cast<std::size_t>(rooted ? 0 : body.parent);
    const bool origin = rooted || (places_[parent] >= 0 && (turns_known_[parent] || body.joint == Vec2{}));
    const bool own = body.angle_axis < 0 || known(body.angle_axis);
    const bool turn = own && (rooted || turns_known_[parent] || (body.absolute && body.angle_axis >= 0));
    const double radius = origin && !turn ? inscribed(body) : 0.0;
    turns_known_.push_back(origin && turn);
    if (!origin || (!turn && !(radius > 0.0))) {
      places_.push_back(-1);
      return;
    }
    places_.push_back(static_cast<int>(bodies_.size()));
    Body kept = body;
    if (!rooted) kept.parent = places_[parent];
    if (!turn) {
      kept.parts = {Disc{{}, radius}};
      kept.angle_axis = -1;
    } else if (kept.angle_axis >= 0) {
      kept.angle_axis = place_of_.at(static_cast<std::size_t>(body.angle_axis));
    }
    bodies_.push_back(std::move(kept));
  }

  /// The radius of the largest disc about the body's origin inside it.
  static double inscribed(const Body& body) {
    if (body.parts.empty()) return 0.0;
    Body alone;
    alone.parts = body.parts;
    return Robot("body", {std::move(alone)}).inscribed_radius();
  }

  /// Adds kept axes that rotate no kept body, each with a body: a robot requires a body for each of its axes.
  void add_idle_axes() {
    const int first_angle = robot_.translates() ? 2 : 0;
    int last = -1;
    for (const Body& body : bodies_) last = std::max(last, body.angle_axis);
    for (int axis = first_angle; axis < last; ++axis) {
      if (std::any_of(bodies_.begin(), bodies_.end(), [&](const Body& b) { return b.angle_axis == axis; })) continue;
      Body idle;
      idle.angle_axis = axis;
      bodies_.push_back(std::move(idle));
    }
  }

  const Robot& robot_;
  std::map<std::size_t, int> place_of_;  ///< for each kept axis of the robot, its axis in the reduced robot
  std::vector<Body> bodies_;
  std::vector<int> places_;        ///< for each body of the robot, its index in the reduced robot; -1: dropped
  std::vector<bool> turns_known_;  ///< for each body, whether its position and angle are determined
};

}  // namespace

std::optional<Robot> reduced_robot(const Robot& robot, const std::vector<std::size_t>& axes) {
  if (!robot.members().empty()) {
    std::vector<Robot::Member> left;
    for (const Robot::Member& member : robot.members()) {
      const auto begin = std::lower_bound(axes.begin(), axes.end(), member.axis);
      const auto end = std::lower_bound(begin, axes.end(), member.axis + member.robot->dimension());
      if (begin == end) continue;
      std::vector<std::size_t> own(begin, end);
      for (std::size_t& axis : own) axis -= member.axis;
      auto part = Reduction(*member.robot, own).robot();
      if (!part) continue;
      left.push_back({std::make_shared<const Robot>(std::move(*part)), static_cast<std::size_t>(begin - axes.begin()),
                      0, member.number});
    }
    if (left.empty()) return std::nullopt;
    return uncoupled_as(robot, Robot::team_of(std::move(left)));
  }
  return Reduction(robot, axes).robot();
}

Robot uncoupled_as(const Robot& whole, const Robot& team) {
  std::set<std::pair<std::size_t, std::size_t>> coupled;
  for (const auto& [first, second] : whole.pairs()) {
    const std::size_t one = whole.members()[whole.member_of(first)].number;
    const std::size_t other = whole.members()[whole.member_of(second)].number;
    if (one != other) coupled.emplace(one, other);
  }
  const std::size_t all = whole.members().size();
  if (team.members().empty() || coupled.size() >= all * (all - 1) / 2) return team;
  std::vector<std::pair<std::size_t, std::size_t>> kept;
  for (const auto& [first, second] : team.pairs()) {
    const std::size_t one = team.members()[team.member_of(first)].number;
    const std::size_t other = team.members()[team.member_of(second)].number;
    if (one == other || coupled.contains({one, other})) kept.emplace_back(first, second);
  }
  return team.apart(std::move(kept));
}

}  // namespace trellis
