// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/scene/spatial/aggregate.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <memory>
#include <numbers>
#include <optional>
#include <utility>
#include <variant>
#include <vector>

#include <trellis/base/error.hpp>
#include <trellis/scene/merging.hpp>
#include <trellis/scene/spatial/point_cloud.hpp>
#include <trellis/scene/spatial/ranges.hpp>

namespace trellis {

namespace {

/// A mesh with more triangles stays as it is: distances to it take too long.
constexpr std::size_t most_triangles = 5000;
/// The number of sides of the circumscribed prism that replaces a cylinder in a hull.
constexpr int sides = 16;

/// Obstacles and the points of their common hull.
struct Cluster {
  std::vector<std::size_t> obstacles;
  std::vector<Solid> solids;
  std::vector<Box3> boxes;  ///< of the solids
  std::vector<Vec3> points;
  Box3 box;
};

/// The vertices of a polyhedron about the unit ball: an icosahedron whose edges were halved once, so large that its
/// faces touch the ball at least.
const std::vector<Vec3>& about_unit_ball() {
  static const std::vector<Vec3> all = [] {
    std::vector<Vec3> points;
    const double g = std::numbers::phi;
    for (const double a : {-1.0, 1.0}) {
      for (const double b : {-g, g}) {
        points.push_back({0.0, a, b});
        points.push_back({a, b, 0.0});
        points.push_back({b, 0.0, a});
      }
    }
    const std::size_t corners = points.size();
    for (std::size_t i = 0; i < corners; ++i) {
      for (std::size_t j = i + 1; j < corners; ++j) {
        if (norm(points[i] - points[j]) < 2.1) points.push_back(0.5 * (points[i] + points[j]));
      }
    }
    for (Vec3& p : points) p = (1.0 / norm(p)) * p;
    // The largest ball inside the hull of points on the unit sphere.
    const Mesh hull = Mesh::hull(points, "ball");
    const double inner = distance_to_surface(hull, {});
    for (Vec3& p : points) p = (1.0 / inner) * p;
    return points;
  }();
  return all;
}

/// The vertices of a polyhedron about a shape, in its frame.
struct Corners {
  std::vector<Vec3> operator()(const Sphere& s) const {
    std::vector<Vec3> all = about_unit_ball();
    for (Vec3& p : all) p = s.radius * p;
    return all;
  }
  std::vector<Vec3> operator()(const Cuboid& s) const {
    std::vector<Vec3> all;
    for (const double x : {-0.5, 0.5}) {
      for (const double y : {-0.5, 0.5}) {
        for (const double z : {-0.5, 0.5}) all.push_back({x * s.size.x, y * s.size.y, z * s.size.z});
      }
    }
    return all;
  }
  std::vector<Vec3> operator()(const Cylinder& s) const {
    std::vector<Vec3> all;
    const double step = 2.0 * std::numbers::pi / sides;
    const double corner = s.radius / std::cos(0.5 * step);
    for (int i = 0; i < sides; ++i) {
      for (const double z : {-0.5, 0.5}) {
        all.push_back({corner * std::cos(i * step), corner * std::sin(i * step), z * s.length});
      }
    }
    return all;
  }
  std::vector<Vec3> operator()(const Capsule& s) const {
    std::vector<Vec3> all;
    for (const double z : {-0.5, 0.5}) {
      for (const Vec3& p : about_unit_ball()) all.push_back(s.radius * p + Vec3{0.0, 0.0, z * s.length});
    }
    return all;
  }
  std::vector<Vec3> operator()(const std::shared_ptr<const Mesh>& mesh) const { return mesh->vertices(); }
  std::vector<Vec3> operator()(const std::shared_ptr<const PointCloud>&) const { throw Fault("a hull of a cloud"); }
};

bool mergeable(const Solid& solid) {
  if (std::holds_alternative<std::shared_ptr<const PointCloud>>(solid.shape)) return false;
  const auto* mesh = std::get_if<std::shared_ptr<const Mesh>>(&solid.shape);
  return mesh == nullptr || (*mesh)->triangles().size() <= most_triangles;
}

Cluster cluster_of(std::size_t obstacle, const Solid& solid) {
  Cluster cluster{{obstacle}, {solid}, {}, std::visit(Corners(), solid.shape), {}};
  for (Vec3& p : cluster.points) p = solid.pose(p);
  cluster.box = bounds_of(cluster.points);
  cluster.boxes = {cluster.box};
  return cluster;
}

Mesh hull_of(const Cluster& a, const Cluster& b) {
  std::vector<Vec3> points = a.points;
  points.insert(points.end(), b.points.begin(), b.points.end());
  return Mesh::hull(points, "hull");
}

/// Merges two clusters; the result stores only the points of their common hull.
Cluster merged(const Cluster& a, const Cluster& b) {
  Cluster both = a;
  both.obstacles.insert(both.obstacles.end(), b.obstacles.begin(), b.obstacles.end());
  both.solids.insert(both.solids.end(), b.solids.begin(), b.solids.end());
  both.boxes.insert(both.boxes.end(), b.boxes.begin(), b.boxes.end());
  both.points = hull_of(a, b).vertices();
  both.box = bounds_of(both.points);
  return both;
}

/// The distance of a point from a box; 0 inside.
double distance_to(const Box3& box, const Vec3& p) {
  const auto beyond = [](double x, double lo, double hi) { return std::max({lo - x, 0.0, x - hi}); };
  return norm({beyond(p.x, box.lo.x, box.hi.x), beyond(p.y, box.lo.y, box.hi.y), beyond(p.z, box.lo.z, box.hi.z)});
}

/// How far the points of a triangle are from the solids of two clusters.
class TriangleError {
 public:
  TriangleError(const Cluster& a, const Cluster& b, double most) : clusters_{&a, &b}, most_(most) {}

  /// Returns the largest distance found; infinity where one exceeds the limit. Distances change by no more than one
  /// moves: so a triangle whose centre is near enough has no point beyond the limit, and only others are split.
  [[nodiscard]] double operator()(const Vec3& a, const Vec3& b, const Vec3& c) const {
    const Vec3 centre = (1.0 / 3.0) * (a + b + c);
    double distance = std::numeric_limits<double>::infinity();
    for (const Cluster* cluster : clusters_) {
      for (std::size_t i = 0; i < cluster->solids.size(); ++i) {
        if (distance_to(cluster->boxes[i], centre) >= distance) continue;
        distance = std::min(distance, trellis::distance_to(cluster->solids[i], centre));
      }
    }
    if (distance > most_) return std::numeric_limits<double>::infinity();
    const double reach = std::max({norm(a - centre), norm(b - centre), norm(c - centre)});
    if (distance + reach <= most_ || reach <= finest * most_) return distance;
    const Vec3 ab = 0.5 * (a + b), bc = 0.5 * (b + c), ca = 0.5 * (c + a);
    for (const auto& part : {std::array{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}}) {
      distance = std::max(distance, (*this)(part[0], part[1], part[2]));
      if (distance > most_) break;
    }
    return distance;
  }

 private:
  static constexpr double finest = 0.1;  ///< of the limit: the size of triangles that are not split

  std::array<const Cluster*, 2> clusters_;
  double most_;
};

bool near(const Box3& a, const Box3& b, double gap) {
  return a.lo.x - b.hi.x <= gap && b.lo.x - a.hi.x <= gap && a.lo.y - b.hi.y <= gap && b.lo.y - a.hi.y <= gap &&
         a.lo.z - b.hi.z <= gap && b.lo.z - a.hi.z <= gap;
}

/// Returns the error of the hull of two clusters if it is small enough. In the middle of a gap, a hull's point is half
/// the gap's width from either obstacle.
std::optional<double> error_of_both(const Cluster& a, const Cluster& b, double most) {
  if (!near(a.box, b.box, 2.0 * most)) return std::nullopt;
  if (!mergeable(a.solids.front()) || !mergeable(b.solids.front())) return std::nullopt;
  std::optional<Mesh> hull;
  try {
    hull = hull_of(a, b);
  } catch (const Error&) {
    return std::nullopt;  // surfaces in one plane
  }
  const TriangleError error_of(a, b, most);
  double error = 0.0;
  const auto& v = hull->vertices();
  for (const auto& [i, j, k] : hull->triangles()) {
    error = std::max(error, error_of(v[i], v[j], v[k]));
    if (error > most) return std::nullopt;
  }
  return error;
}

}  // namespace

World3 aggregated(const World3& world, double error) {
  if (!(error > 0.0)) return world;
  std::vector<Cluster> clusters;
  clusters.reserve(world.obstacles().size());
  for (std::size_t i = 0; i < world.obstacles().size(); ++i) {
    clusters.push_back(cluster_of(i, world.obstacles()[i].solid));
  }
  const std::vector<char> gone = merge_bottom_up(
      clusters, [&](std::size_t a, std::size_t b) { return error_of_both(clusters[a], clusters[b], error); }, merged);
  std::vector<Obstacle3> obstacles;
  for (std::size_t i = 0; i < clusters.size(); ++i) {
    if (gone[i] != 0) continue;
    const Obstacle3& first = world.obstacles()[clusters[i].obstacles.front()];
    const std::size_t count = clusters[i].obstacles.size();
    if (count == 1) {
      obstacles.push_back(first);
      continue;
    }
    std::string name = fmt::format("hull of {} obstacles, {} and others", count, first.name);
    auto hull = std::make_shared<const Mesh>(Mesh::hull(clusters[i].points, name));
    obstacles.push_back({std::move(name), {std::move(hull), {}}});
  }
  return world.with(std::move(obstacles));
}

}  // namespace trellis
