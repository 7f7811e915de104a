// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/scene/spatial/robot.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include <trellis/base/error.hpp>
#include <trellis/scene/limits.hpp>
#include <trellis/scene/team_members.hpp>

namespace trellis {

namespace {

/// The radius of the largest ball about a point of the shape's frame inside the shape; negative or 0 outside.
struct Inscribed {
  Vec3 at;

  double operator()(const Sphere& s) const { return s.radius - norm(at); }
  double operator()(const Cuboid& s) const {
    return std::min(
        {0.5 * s.size.x - std::abs(at.x), 0.5 * s.size.y - std::abs(at.y), 0.5 * s.size.z - std::abs(at.z)});
  }
  double operator()(const Cylinder& s) const {
    return std::min(s.radius - std::hypot(at.x, at.y), 0.5 * s.length - std::abs(at.z));
  }
  double operator()(const Capsule& s) const {
    return s.radius - norm({at.x, at.y, std::max(0.0, std::abs(at.z) - 0.5 * s.length)});
  }
  double operator()(const std::shared_ptr<const Mesh>& mesh) const {
    return contains(*mesh, at) ? distance_to_surface(*mesh, at) : 0.0;
  }
  double operator()(const std::shared_ptr<const PointCloud>&) const { throw Fault("a robot of points"); }
};

}  // namespace

Robot3::Robot3(std::string name, std::vector<Solid> solids, bool rotates)
    : name_(std::move(name)), solids_(std::move(solids)), rotates_(rotates), dimension_(rotates ? 7 : 3) {
  if (solids_.empty()) throw Error(fmt::format("robot '{}': it needs at least one shape", name_));
  if (solids_.size() > most_shapes) {
    throw Error(fmt::format("robot '{}': at most {} shapes, got {}", name_, most_shapes, solids_.size()));
  }
  for (std::size_t i = 0; i < solids_.size(); ++i) {
    const std::string what = fmt::format("robot '{}': shape {}", name_, i + 1);
    check_no_cloud(solids_[i], what);
    check_solid(solids_[i], what, true);
    bounding_radius_ = std::max(bounding_radius_, farthest_from_origin(solids_[i]));
    inscribed_radius_ =
        std::max(inscribed_radius_, std::visit(Inscribed{solids_[i].pose.inverse().position}, solids_[i].shape));
  }
}

Robot3 Robot3::team(const std::vector<Robot3>& robots) {
  std::vector<Member> members;
  // Robots of one shape share it: checkers prepare each pair of shapes once.
  join_members(robots, "ball", [&](const Robot3& one, std::size_t column, std::size_t number) {
    const auto alike =
        std::find_if(members.begin(), members.end(), [&](const Member& other) { return other.robot->same_shape(one); });
    members.push_back({alike != members.end() ? alike->robot : std::make_shared<const Robot3>(one), column, number});
  });
  return team_of(std::move(members));
}

Robot3 Robot3::team_of(std::vector<Member> members) {
  if (members.size() == 1 && members.front().column == 0) return *members.front().robot;
  Robot3 team;
  team.solids_.clear();
  team.dimension_ = 0;
  std::vector<std::string> names;
  for (const Member& member : members) {
    const Robot3& robot = *member.robot;
    team.solids_.insert(team.solids_.end(), robot.solids_.begin(), robot.solids_.end());
    team.rotates_ = team.rotates_ || robot.rotates_;
    team.dimension_ = std::max(team.dimension_, member.column + robot.dimension_);
    team.bounding_radius_ = std::max(team.bounding_radius_, robot.bounding_radius_);
    if (std::find(names.begin(), names.end(), robot.name_) == names.end()) names.push_back(robot.name_);
  }
  team.name_ = fmt::format("{} robots ({})", members.size(), fmt::join(names, ", "));
  team.members_ = std::move(members);
  return team;
}

Robot3 Robot3::uncoupled(std::vector<std::pair<std::size_t, std::size_t>> pairs) const {
  Robot3 team = *this;
  team.passing_ = std::move(pairs);
  return team;
}

bool Robot3::are_coupled(std::size_t one, std::size_t other) const {
  return std::none_of(passing_.begin(), passing_.end(),
                      [&](const auto& pair) { return pair == std::pair(one, other) || pair == std::pair(other, one); });
}

bool Robot3::same_shape(const Robot3& other) const {
  const auto same = [](const Solid& a, const Solid& b) {
    return a.shape == b.shape && a.pose.position == b.pose.position && a.pose.orientation == b.pose.orientation;
  };
  return name_ == other.name_ && rotates_ == other.rotates_ && solids_.size() == other.solids_.size() &&
         std::equal(solids_.begin(), solids_.end(), other.solids_.begin(), same);
}

Robot3 Robot3::scaled(double factor) const {
  if (!(factor > 0.0)) {
    throw Error(fmt::format("robot '{}': it cannot be scaled by {}, the factor must be greater than 0", name_, factor));
  }
  if (!members_.empty()) {
    std::map<const Robot3*, std::shared_ptr<const Robot3>> known;
    std::vector<Member> members = members_;
    for (Member& member : members) {
      auto& smaller = known[member.robot.get()];
      if (!smaller) smaller = std::make_shared<const Robot3>(member.robot->scaled(factor));
      member.robot = smaller;
    }
    return team_of(std::move(members)).uncoupled(passing_);
  }
  // Solids that share a mesh do so afterwards.
  std::map<const Mesh*, Shape3> meshes;
  std::vector<Solid> solids;
  solids.reserve(solids_.size());
  for (const Solid& solid : solids_) {
    const auto* mesh = std::get_if<std::shared_ptr<const Mesh>>(&solid.shape);
    const auto known = mesh == nullptr ? meshes.end() : meshes.find(mesh->get());
    if (known != meshes.end()) {
      solids.push_back({known->second, {factor * solid.pose.position, solid.pose.orientation}});
      continue;
    }
    solids.push_back(trellis::scaled(solid, factor));
    if (mesh != nullptr) meshes.emplace(mesh->get(), solids.back().shape);
  }
  return {name_, std::move(solids), rotates_};
}

Pose3 Robot3::pose(View q) const {
  if (!members_.empty()) throw Fault("the pose of a team");
  Pose3 result{{q[0], q[1], q[2]}, {}};
  if (rotates_) result.orientation = {q[3], q[4], q[5], q[6]};
  return result;
}

double Robot3::displacement_bound(View a, View b) const {
  if (!members_.empty()) {
    double most = 0.0;
    for (const Member& member : members_) {
      most = std::max(most, member.robot->displacement_bound(member.own(a), member.own(b)));
    }
    return most;
  }
  const Pose3 from = pose(a);
  const Pose3 to = pose(b);
  const double turn = rotates_ ? angle_between(from.orientation, to.orientation) : 0.0;
  return norm(to.position - from.position) + bounding_radius_ * turn;
}

}  // namespace trellis
