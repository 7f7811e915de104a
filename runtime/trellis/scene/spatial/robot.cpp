// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/scene/spatial/robot.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include <trellis/base/error.hpp>
#include <trellis/scene/limits.hpp>

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
    : name_(std::move(name)), solids_(std::move(solids)), rotates_(rotates) {
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

Robot3 Robot3::scaled(double factor) const {
  if (!(factor > 0.0)) {
    throw Error(fmt::format("robot '{}': it cannot be scaled by {}, the factor must be greater than 0", name_, factor));
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
  Pose3 result{{q[0], q[1], q[2]}, {}};
  if (rotates_) result.orientation = {q[3], q[4], q[5], q[6]};
  return result;
}

double Robot3::displacement_bound(View a, View b) const {
  const Pose3 from = pose(a);
  const Pose3 to = pose(b);
  const double turn = rotates_ ? angle_between(from.orientation, to.orientation) : 0.0;
  return norm(to.position - from.position) + bounding_radius_ * turn;
}

}  // namespace trellis
