// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/collision/spatial/separation.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <memory>
#include <variant>
#include <vector>

namespace trellis {

namespace {

constexpr std::size_t most_vertices = 64;

/// A convex solid: all points within `radius` of the hull of the corners; of a cylinder, of the discs about them.
struct Hull {
  std::vector<Vec3> corners;
  std::vector<Vec3> normals;  ///< of its faces, of unit length; of two opposite faces one
  std::vector<Vec3> edges;    ///< directions of its edges, of unit length; of meshes none
  Vec3 middle;
  double radius = 0.0;
  Vec3 disc_axis;            ///< of the discs
  double disc_radius = 0.0;  ///< of a cylinder; else 0

  /// The largest n.p of its points.
  [[nodiscard]] double farthest(const Vec3& n) const {
    double most = -std::numeric_limits<double>::infinity();
    for (const Vec3& corner : corners) most = std::max(most, dot(n, corner));
    return most + radius + disc_reach(n);
  }
  /// The largest v.p of the points of a disc about its middle.
  [[nodiscard]] double disc_reach(const Vec3& v) const {
    return disc_radius > 0.0 ? disc_radius * norm(v - dot(v, disc_axis) * disc_axis) : 0.0;
  }
};

/// Writes a solid as its hull; false for a mesh with too many vertices. A mesh lies inside of the hull of its vertices.
class WriteHull {
 public:
  WriteHull(const Pose3& pose, Hull& hull) : pose_(pose), hull_(hull) {
    hull_.corners.clear();
    hull_.normals.clear();
    hull_.edges.clear();
    hull_.middle = pose.position;
    hull_.radius = 0.0;
    hull_.disc_axis = {};
    hull_.disc_radius = 0.0;
  }

  bool operator()(const Sphere& sphere) const {
    hull_.corners.push_back(pose_.position);
    hull_.radius = sphere.radius;
    return true;
  }
  bool operator()(const Cuboid& cuboid) const {
    const Vec3 half = 0.5 * cuboid.size;
    for (const double x : {-half.x, half.x}) {
      for (const double y : {-half.y, half.y}) {
        for (const double z : {-half.z, half.z}) hull_.corners.push_back(pose_({x, y, z}));
      }
    }
    for (const Vec3& axis : {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}}) {
      hull_.normals.push_back(pose_.orientation(axis));
    }
    hull_.edges = hull_.normals;
    return true;
  }
  bool operator()(const Cylinder& cylinder) const {
    add_segment(cylinder.length);
    hull_.disc_axis = pose_.orientation({0, 0, 1});
    hull_.disc_radius = cylinder.radius;
    hull_.normals.push_back(hull_.disc_axis);
    return true;
  }
  bool operator()(const Capsule& capsule) const {
    add_segment(capsule.length);
    hull_.edges.push_back(pose_.orientation({0, 0, 1}));
    hull_.radius = capsule.radius;
    return true;
  }
  bool operator()(const std::shared_ptr<const Mesh>& mesh) const {
    if (mesh->vertices().size() > most_vertices) return false;
    Vec3 sum;
    for (const Vec3& vertex : mesh->vertices()) {
      hull_.corners.push_back(pose_(vertex));
      sum = sum + hull_.corners.back();
    }
    hull_.middle = 1.0 / static_cast<double>(hull_.corners.size()) * sum;
    for (const auto& [a, b, c] : mesh->triangles()) {
      const Vec3& corner = hull_.corners[a];
      const Vec3 normal = cross(hull_.corners[b] - corner, hull_.corners[c] - corner);
      if (const double length = norm(normal); length > 0.0) hull_.normals.push_back(1.0 / length * normal);
    }
    return true;
  }

  bool operator()(const std::shared_ptr<const PointCloud>&) const { return false; }

 private:
  void add_segment(double length) const {
    for (const double z : {-0.5 * length, 0.5 * length}) hull_.corners.push_back(pose_({0, 0, z}));
  }

  const Pose3& pose_;
  Hull& hull_;
};

/// The least n.p of the points of a hull, at the middle of a motion and throughout it.
SeparationGap least_along(const Hull& hull, const BodyMotion& motion, const Vec3& n) {
  // At a share s in [-1, 1] a point p about the reference point lies at e + u cos(s turn) + z sin(s turn) along n,
  // where e + u = n.p, and e is the part along the axis. The sine differs from its angle by at most a sixth of its
  // cube, and the cosine from 1 by half its square; translation and turn together are linear in s.
  const double translation = dot(n, motion.translation);
  const double along_axis = dot(n, motion.axis);
  const Vec3 swept = cross(n, motion.axis);  // n.(axis x p) = p.(n x axis)
  const Vec3 across = n - along_axis * motion.axis;
  // What the points of a disc add to u and z.
  const double more_u = hull.disc_reach(across), more_z = hull.disc_reach(swept);
  SeparationGap least{std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
  for (const Vec3& corner : hull.corners) {
    const Vec3 p = corner - motion.reference;
    const double at = dot(n, corner);
    const double u = dot(across, p) + more_u;
    const double z = dot(swept, p);
    const double loss =
        std::abs(translation + z * motion.turn) + more_z * motion.turn +
        motion.turn * motion.turn * (0.5 * std::max(u, 0.0) + (std::abs(z) + more_z) * motion.turn / 6.0);
    least.middle = std::min(least.middle, at);
    least.throughout = std::min(least.throughout, at - loss);
  }
  const double about = hull.radius + hull.disc_reach(n);
  return {least.middle - about, least.throughout - about};
}

}  // namespace

SeparationGap separation_gap(const Solid& moving, const BodyMotion& motion, const Solid& still) {
  thread_local Hull hull;
  thread_local Hull obstacle;
  if (!std::visit(WriteHull(moving.pose, hull), moving.shape)) return {};
  if (!std::visit(WriteHull(still.pose, obstacle), still.shape)) return {};
  SeparationGap best;
  const auto try_along = [&](const Vec3& n) {
    const SeparationGap least = least_along(hull, motion, n);
    const double end = obstacle.farthest(n);
    best.middle = std::max(best.middle, least.middle - end);
    best.throughout = std::max(best.throughout, least.throughout - end);
  };
  const auto try_both = [&](const Vec3& n) {
    try_along(n);
    try_along(-1.0 * n);
  };
  const Vec3 between = hull.middle - obstacle.middle;
  for (const auto* normals : {&obstacle.normals, &hull.normals})
    std::for_each(normals->begin(), normals->end(), try_both);
  for (const Vec3& edge : hull.edges) {
    for (const Vec3& other : obstacle.edges) {
      constexpr double parallel = 1e-6;
      const Vec3 n = cross(edge, other);
      if (const double length = norm(n); length > parallel) try_both(1.0 / length * n);
    }
  }
  if (const double length = norm(between); length > 0.0) try_along(1.0 / length * between);
  return best;
}

SeparationGap gap_inside(const Solid& moving, const BodyMotion& motion, const Box3& bounds) {
  thread_local Hull hull;
  if (!std::visit(WriteHull(moving.pose, hull), moving.shape)) return {};
  SeparationGap all{std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
  const auto add = [&](const Vec3& n, double end) {
    const SeparationGap least = least_along(hull, motion, n);
    all.middle = std::min(all.middle, least.middle - end);
    all.throughout = std::min(all.throughout, least.throughout - end);
  };
  add({1, 0, 0}, bounds.lo.x);
  add({0, 1, 0}, bounds.lo.y);
  add({0, 0, 1}, bounds.lo.z);
  add({-1, 0, 0}, -bounds.hi.x);
  add({0, -1, 0}, -bounds.hi.y);
  add({0, 0, -1}, -bounds.hi.z);
  return all;
}

}  // namespace trellis
