// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/scene/spatial/obstacle_distance.hpp>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>
#include <variant>

#include <trellis/scene/spatial/point_cloud.hpp>
#include <trellis/scene/spatial/ranges.hpp>
#include <trellis/scene/spatial/surface.hpp>

namespace trellis {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

/// Distances of boxes are lowered by this share before they are compared, so that rounding does not leave the nearest
/// item out.
constexpr double rounding = 1e-12;

/// The square of the distance from a box, 0 inside.
inline double squared_distance(const Box3& box, const Vec3& p) {
  const double x = std::max(std::max(box.lo.x - p.x, p.x - box.hi.x), 0.0);
  const double y = std::max(std::max(box.lo.y - p.y, p.y - box.hi.y), 0.0);
  const double z = std::max(std::max(box.lo.z - p.z, p.z - box.hi.z), 0.0);
  return x * x + y * y + z * z;
}

/// The signed distance from a box: negative inside.
double signed_box_distance(const Box3& box, const Vec3& p) {
  const double x = std::max(box.lo.x - p.x, p.x - box.hi.x);
  const double y = std::max(box.lo.y - p.y, p.y - box.hi.y);
  const double z = std::max(box.lo.z - p.z, p.z - box.hi.z);
  const double most = std::max({x, y, z});
  return most <= 0.0 ? most : std::sqrt(squared_distance(box, p));
}

/// The signed distance where the outside is split along one or two independent directions, each with its signed
/// distance.
double combined(double a, double b) {
  return a > 0.0 || b > 0.0 ? std::hypot(std::max(a, 0.0), std::max(b, 0.0)) : std::max(a, b);
}

/// The signed distance from a shape that is no mesh, in its frame; of a cloud that of its nearest ball.
struct SignedDistance {
  const Vec3& p;

  double operator()(const Sphere& s) const { return norm(p) - s.radius; }
  double operator()(const Cuboid& s) const { return signed_box_distance({-0.5 * s.size, 0.5 * s.size}, p); }
  double operator()(const Cylinder& s) const {
    return combined(std::hypot(p.x, p.y) - s.radius, std::abs(p.z) - 0.5 * s.length);
  }
  double operator()(const Capsule& s) const {
    return norm({p.x, p.y, std::max(0.0, std::abs(p.z) - 0.5 * s.length)}) - s.radius;
  }
  double operator()(const std::shared_ptr<const Mesh>&) const { return infinity; }
  double operator()(const std::shared_ptr<const PointCloud>& cloud) const {
    return cloud->nearest(p).distance - cloud->radius();
  }
};

/// Returns v at this length; along `other` where v is 0.
Vec3 with_length(const Vec3& v, double length, const Vec3& other) {
  const double now = norm(v);
  return now > 0.0 ? (length / now) * v : length * other;
}

/// The nearest point of the surface of a shape that is no mesh, in its frame.
struct NearestPoint {
  const Vec3& p;

  Vec3 operator()(const Sphere& s) const { return with_length(p, s.radius, {1, 0, 0}); }
  Vec3 operator()(const Cuboid& s) const {
    const Vec3 half = 0.5 * s.size;
    const Vec3 inside{std::clamp(p.x, -half.x, half.x), std::clamp(p.y, -half.y, half.y),
                      std::clamp(p.z, -half.z, half.z)};
    if (inside != p) return inside;
    const double x = half.x - std::abs(p.x), y = half.y - std::abs(p.y), z = half.z - std::abs(p.z);
    if (x <= y && x <= z) return {std::copysign(half.x, p.x), p.y, p.z};
    if (y <= z) return {p.x, std::copysign(half.y, p.y), p.z};
    return {p.x, p.y, std::copysign(half.z, p.z)};
  }
  Vec3 operator()(const Cylinder& s) const {
    const double half = 0.5 * s.length, beside = std::hypot(p.x, p.y) - s.radius, above = std::abs(p.z) - half;
    const Vec3 rim = with_length({p.x, p.y, 0.0}, s.radius, {1, 0, 0});
    if (beside > 0.0) return {rim.x, rim.y, std::clamp(p.z, -half, half)};
    if (above > beside) return {p.x, p.y, std::copysign(half, p.z)};
    return {rim.x, rim.y, p.z};
  }
  Vec3 operator()(const Capsule& s) const {
    const Vec3 axis{0.0, 0.0, std::clamp(p.z, -0.5 * s.length, 0.5 * s.length)};
    return axis + with_length(p - axis, s.radius, {1, 0, 0});
  }
  Vec3 operator()(const std::shared_ptr<const Mesh>&) const { return {}; }
  Vec3 operator()(const std::shared_ptr<const PointCloud>& cloud) const {
    const Vec3& centre = cloud->points()[cloud->nearest(p).index];
    return centre + with_length(p - centre, cloud->radius(), {1, 0, 0});
  }
};

/// The nearest point of a triangle.
struct OnTriangle {
  Vec3 from;       ///< from that point to p
  double squared;  ///< its length's square
};

OnTriangle from_vector(const Vec3& from) { return {from, dot(from, from)}; }

// Source: Ericson, Real-Time Collision Detection, 2005, section 5.1.5.
OnTriangle nearest_on_triangle(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 ab = b - a, ac = c - a, ap = p - a;
  const double d1 = dot(ab, ap), d2 = dot(ac, ap);
  if (d1 <= 0.0 && d2 <= 0.0) return from_vector(ap);
  const Vec3 bp = p - b;
  const double d3 = dot(ab, bp), d4 = dot(ac, bp);
  if (d3 >= 0.0 && d4 <= d3) return from_vector(bp);
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0) return from_vector(ap - d1 / (d1 - d3) * ab);
  const Vec3 cp = p - c;
  const double d5 = dot(ab, cp), d6 = dot(ac, cp);
  if (d6 >= 0.0 && d5 <= d6) return from_vector(cp);
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0) return from_vector(ap - d2 / (d2 - d6) * ac);
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0.0 && d4 - d3 >= 0.0 && d5 - d6 >= 0.0) {
    return from_vector(bp - (d4 - d3) / ((d4 - d3) + (d5 - d6)) * (c - b));
  }
  const Vec3 normal = cross(ab, ac);
  const double height = dot(normal, ap), area = dot(normal, normal);
  return {height / area * normal, height * height / area};
}

std::vector<Box3> boxes_of(const Mesh& mesh) {
  std::vector<Box3> boxes;
  boxes.reserve(mesh.triangles().size());
  for (const auto& [a, b, c] : mesh.triangles()) {
    const auto& v = mesh.vertices();
    boxes.push_back({least_of(least_of(v[a], v[b]), v[c]), greatest_of(greatest_of(v[a], v[b]), v[c])});
  }
  return boxes;
}

}  // namespace

MeshDistance::MeshDistance(std::shared_ptr<const Mesh> mesh) : mesh_(std::move(mesh)), tree_(boxes_of(*mesh_)) {
  corners_.reserve(mesh_->triangles().size());
  const auto& v = mesh_->vertices();
  for (const std::uint32_t triangle : tree_.order()) {
    const auto& [a, b, c] = mesh_->triangles()[triangle];
    corners_.push_back({v[a], v[b], v[c]});
  }
}

double MeshDistance::to_surface(const Vec3& p, double at_most) const {
  const double most = at_most * at_most;
  const Found found = search(p, most);
  return found.squared < most ? std::sqrt(found.squared) : at_most;
}

Vec3 MeshDistance::nearest(const Vec3& p) const { return p - search(p, infinity).from; }

MeshDistance::Found MeshDistance::search(const Vec3& p, double most) const {
  Found found{{}, most};
  tree_.nearest(
      found.squared, [&](const Box3& box) { return (1.0 - rounding) * squared_distance(box, p); },
      [&](std::uint32_t rank) {
        const auto& [a, b, c] = corners_[rank];
        const OnTriangle there = nearest_on_triangle(p, a, b, c);
        if (there.squared < found.squared) found = {there.from, there.squared};
      });
  return found;
}

bool MeshDistance::contains(const Vec3& p) const {
  const Box3& box = mesh_->bounds();
  if (!mesh_->closed() || least_of(box.lo, p) != box.lo || greatest_of(box.hi, p) != box.hi) return false;
  int winding = 0;
  // Triangles elsewhere do not cross the ray from p along x.
  const auto meets_ray = [&](const Box3& b) {
    return b.hi.x > p.x && b.lo.y <= p.y && p.y <= b.hi.y && b.lo.z <= p.z && p.z <= b.hi.z;
  };
  tree_.each(meets_ray,
             [&](std::uint32_t triangle) { winding += crossing(p, mesh_->vertices(), mesh_->triangles()[triangle]); });
  return winding > 0;
}

ObstacleDistance::ObstacleDistance(const std::vector<Solid>& obstacles, bool surface) {
  std::map<std::shared_ptr<const Mesh>, std::size_t> known;
  std::vector<Box3> boxes;
  obstacles_.reserve(obstacles.size());
  boxes.reserve(obstacles.size());
  for (const Solid& solid : obstacles) {
    Obstacle obstacle{solid, solid.pose.inverse()};
    if (const auto* mesh = std::get_if<std::shared_ptr<const Mesh>>(&solid.shape)) {
      const auto [place, added] = known.emplace(*mesh, meshes_.size());
      if (added) meshes_.emplace_back(*mesh);
      obstacle.mesh = place->second;
      obstacle.has_inside = !surface && (*mesh)->closed();
    }
    boxes.push_back(bounding_box(solid));
    obstacles_.push_back(std::move(obstacle));
  }
  tree_ = BoxTree(boxes);
}

Box3 ObstacleDistance::bounds() const {
  return tree_.empty() ? Box3{{infinity, infinity, infinity}, {-infinity, -infinity, -infinity}} : tree_.bounds();
}

double ObstacleDistance::of_obstacle(const Obstacle& obstacle, const Vec3& p, double best) const {
  const Vec3 local = obstacle.inverse(p);
  if (const auto* cloud = std::get_if<std::shared_ptr<const PointCloud>>(&obstacle.solid.shape)) {
    const double most = best + (*cloud)->radius();
    const double found = (*cloud)->nearest(local, std::max(most, 0.0)).distance;
    return found < most ? found - (*cloud)->radius() : best;
  }
  if (!std::holds_alternative<std::shared_ptr<const Mesh>>(obstacle.solid.shape)) {
    return std::visit(SignedDistance{local}, obstacle.solid.shape);
  }
  const MeshDistance& mesh = meshes_[obstacle.mesh];
  if (obstacle.has_inside && mesh.contains(local)) return -mesh.to_surface(local);
  return best > 0.0 ? mesh.to_surface(local, best) : best;
}

ObstacleDistance::Found ObstacleDistance::search(const Vec3& p) const {
  Found found;
  const auto bound = [&](const Box3& box) {
    const double distance = signed_box_distance(box, p);
    return distance - rounding * (std::abs(distance) + norm(box.hi - box.lo));
  };
  tree_.nearest(found.distance, bound, [&](std::uint32_t rank) {
    const std::uint32_t item = tree_.order()[rank];
    const double distance = of_obstacle(obstacles_[item], p, found.distance);
    if (distance < found.distance) found = {distance, item};
  });
  return found;
}

NearestObstacle ObstacleDistance::nearest(const Vec3& p) const {
  NearestObstacle result;
  if (obstacles_.empty()) return result;
  const Found found = search(p);
  result.distance = found.distance;
  result.obstacle = found.obstacle;
  const Obstacle& obstacle = obstacles_[found.obstacle];
  const Vec3 local = obstacle.inverse(p);
  const bool is_mesh = std::holds_alternative<std::shared_ptr<const Mesh>>(obstacle.solid.shape);
  result.point = obstacle.solid.pose(is_mesh ? meshes_[obstacle.mesh].nearest(local)
                                             : std::visit(NearestPoint{local}, obstacle.solid.shape));
  return result;
}

}  // namespace trellis
