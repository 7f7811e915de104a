// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/scene/spatial/erosion.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <optional>
#include <unordered_map>
#include <utility>
#include <variant>
#include <vector>

#include <trellis/base/error.hpp>
#include <trellis/scene/precision.hpp>
#include <trellis/scene/spatial/obstacle_distance.hpp>
#include <trellis/scene/spatial/point_cloud.hpp>

namespace trellis {

namespace {

std::optional<Shape3> eroded(const Sphere& sphere, double d) {
  if (sphere.radius > d) return Sphere{sphere.radius - d};
  return std::nullopt;
}

std::optional<Shape3> eroded(const Cuboid& cuboid, double d) {
  const Vec3 size = cuboid.size - Vec3{2.0 * d, 2.0 * d, 2.0 * d};
  if (size.x > 0.0 && size.y > 0.0 && size.z > 0.0) return Cuboid{size};
  return std::nullopt;
}

std::optional<Shape3> eroded(const Cylinder& cylinder, double d) {
  if (cylinder.radius > d && cylinder.length > 2.0 * d) return Cylinder{cylinder.radius - d, cylinder.length - 2.0 * d};
  return std::nullopt;
}

std::optional<Shape3> eroded(const Capsule& capsule, double d) {
  if (capsule.radius > d) return Capsule{capsule.radius - d, capsule.length};
  return std::nullopt;
}

/// The points x with dot(normal, x) <= offset, of a unit normal.
struct HalfSpace {
  Vec3 normal;
  double offset = 0.0;
};

std::vector<HalfSpace> half_spaces_of(const Mesh& mesh) {
  std::vector<HalfSpace> all;
  all.reserve(mesh.triangles().size());
  const auto& v = mesh.vertices();
  for (const auto& [a, b, c] : mesh.triangles()) {
    const Vec3 across = cross(v[b] - v[a], v[c] - v[a]);
    const Vec3 normal = (1.0 / norm(across)) * across;
    all.push_back({normal, dot(normal, v[a])});
  }
  return all;
}

/// Returns a point deep inside, by steps away from the nearest side that become shorter.
Vec3 deep_point(const Mesh& mesh, const std::vector<HalfSpace>& sides) {
  Vec3 at;
  for (const Vec3& v : mesh.vertices()) at = at + (1.0 / static_cast<double>(mesh.vertices().size())) * v;
  Vec3 best = at;
  double deepest = -std::numeric_limits<double>::infinity();
  const double size = norm(mesh.bounds().hi - mesh.bounds().lo);
  constexpr int steps = 500;
  for (int i = 0; i < steps; ++i) {
    const HalfSpace* nearest = nullptr;
    double depth = std::numeric_limits<double>::infinity();
    for (const HalfSpace& side : sides) {
      const double to = side.offset - dot(side.normal, at);
      if (to < depth) {
        depth = to;
        nearest = &side;
      }
    }
    if (depth > deepest) {
      deepest = depth;
      best = at;
    }
    at = at - (0.25 * size / (i + 1)) * nearest->normal;
  }
  return best;
}

/// A convex mesh, by its dual: the sides that moved inwards are points about a point inside, and the faces of the hull
/// of these are the vertices of what is left.
std::optional<Shape3> eroded_convex(const Mesh& mesh, double d) {
  const std::vector<HalfSpace> sides = half_spaces_of(mesh);
  const Vec3 inside = deep_point(mesh, sides);
  std::vector<Vec3> dual;
  dual.reserve(sides.size());
  // What is thinner than this is below the precision of the dual.
  const double least = 1e-9 * norm(mesh.bounds().hi - mesh.bounds().lo);
  for (const HalfSpace& side : sides) {
    const double to = side.offset - d - dot(side.normal, inside);
    if (!(to > least)) return std::nullopt;
    dual.push_back((1.0 / to) * side.normal);
  }
  const Mesh hull = Mesh::hull(dual, "dual");
  std::vector<Vec3> vertices;
  vertices.reserve(hull.triangles().size());
  const auto& v = hull.vertices();
  for (const auto& [a, b, c] : hull.triangles()) {
    const Vec3 across = cross(v[b] - v[a], v[c] - v[a]);
    vertices.push_back(inside + (1.0 / dot(across, v[a])) * across);
  }
  return std::make_shared<const Mesh>(Mesh::hull(vertices, "eroded mesh"));
}

/// A closed mesh that is not convex, from its signed distance on a grid: the surface between the grid's points that are
/// deep enough and the others, in tetrahedra. A point of a tetrahedron is no farther from its corners than the diagonal
/// of a cell is long, so all that is left is deep enough if the corners inside are deeper by that diagonal.
class GridErosion {
 public:
  GridErosion(const std::shared_ptr<const Mesh>& mesh, double d) : distance_({{mesh, {}}}, false) {
    const Vec3 extent = mesh->bounds().hi - mesh->bounds().lo;
    constexpr double most_points = 200'000.0;
    constexpr double along_distance = 6.0;  // cells
    spacing_ = std::max(d / along_distance, std::cbrt(extent.x * extent.y * extent.z / most_points));
    // One cell beyond the mesh, so that the outermost points are outside.
    origin_ = mesh->bounds().lo - Vec3{spacing_, spacing_, spacing_};
    const auto count = [&](double side) { return static_cast<std::uint32_t>(std::ceil(side / spacing_)) + 3; };
    counts_ = {count(extent.x), count(extent.y), count(extent.z)};
    const double iso = d + std::numbers::sqrt3 * spacing_;
    values_.reserve(std::size_t{counts_[0]} * counts_[1] * counts_[2]);
    for (std::uint32_t k = 0; k < counts_[2]; ++k) {
      for (std::uint32_t j = 0; j < counts_[1]; ++j) {
        for (std::uint32_t i = 0; i < counts_[0]; ++i) values_.push_back(distance_(point(i, j, k)) + iso);
      }
    }
  }

  [[nodiscard]] std::optional<Shape3> rest() {
    // The six tetrahedra about a diagonal of a cell; those of neighbouring cells share whole triangles.
    constexpr std::array<std::array<std::uint32_t, 3>, 6> turns = {
        {{1, 2, 4}, {2, 1, 4}, {1, 4, 2}, {4, 1, 2}, {2, 4, 1}, {4, 2, 1}}};
    for (std::uint32_t k = 0; k + 1 < counts_[2]; ++k) {
      for (std::uint32_t j = 0; j + 1 < counts_[1]; ++j) {
        for (std::uint32_t i = 0; i + 1 < counts_[0]; ++i) {
          for (const auto& turn : turns) {
            std::array<std::uint32_t, 4> corners{};
            std::uint32_t at = 0;
            for (std::size_t n = 0; n < 4; ++n) {
              corners[n] = index(i + (at & 1U), j + (at >> 1U & 1U), k + (at >> 2U & 1U));
              if (n < 3) at |= turn[n];
            }
            cut(corners);
          }
        }
      }
    }
    if (triangles_.empty()) return std::nullopt;
    return std::make_shared<const Mesh>(std::move(vertices_), std::move(triangles_), "eroded mesh");
  }

 private:
  [[nodiscard]] std::uint32_t index(std::uint32_t i, std::uint32_t j, std::uint32_t k) const {
    return (k * counts_[1] + j) * counts_[0] + i;
  }
  [[nodiscard]] Vec3 point(std::uint32_t i, std::uint32_t j, std::uint32_t k) const {
    return origin_ + Vec3{spacing_ * i, spacing_ * j, spacing_ * k};
  }
  [[nodiscard]] Vec3 point(std::uint32_t at) const {
    return point(at % counts_[0], at / counts_[0] % counts_[1], at / (counts_[0] * counts_[1]));
  }
  [[nodiscard]] bool inside(std::uint32_t at) const { return values_[at] < 0.0; }

  /// The vertex on the edge between a point inside and one outside. It keeps off the ends, so that triangles have an
  /// area.
  std::uint32_t vertex(std::uint32_t in, std::uint32_t out) {
    const std::uint64_t key = (std::uint64_t{std::min(in, out)} << 32U) | std::max(in, out);
    const auto [found, added] = on_edge_.try_emplace(key, static_cast<std::uint32_t>(vertices_.size()));
    if (added) {
      constexpr double margin = 0.05;
      const double t = std::clamp(values_[in] / (values_[in] - values_[out]), margin, 1.0 - margin);
      vertices_.push_back(point(in) + t * (point(out) - point(in)));
    }
    return found->second;
  }

  void triangle(std::uint32_t a, std::uint32_t b, std::uint32_t c, const Vec3& from_inside) {
    const Vec3 normal = cross(vertices_[b] - vertices_[a], vertices_[c] - vertices_[a]);
    if (dot(normal, vertices_[a] - from_inside) < 0.0) std::swap(b, c);
    triangles_.push_back({a, b, c});
  }

  void cut(const std::array<std::uint32_t, 4>& corners) {
    std::array<std::uint32_t, 4> in{}, out{};
    std::size_t ins = 0, outs = 0;
    for (const std::uint32_t corner : corners) {
      if (inside(corner)) {
        in[ins++] = corner;
      } else {
        out[outs++] = corner;
      }
    }
    if (ins == 0 || outs == 0) return;
    const Vec3 from = point(in[0]);
    if (ins == 1) {
      triangle(vertex(in[0], out[0]), vertex(in[0], out[1]), vertex(in[0], out[2]), from);
    } else if (ins == 3) {
      triangle(vertex(in[0], out[0]), vertex(in[1], out[0]), vertex(in[2], out[0]), from);
    } else {
      const std::uint32_t a = vertex(in[0], out[0]), b = vertex(in[0], out[1]);
      const std::uint32_t c = vertex(in[1], out[1]), d = vertex(in[1], out[0]);
      triangle(a, b, c, from);
      triangle(a, c, d, from);
    }
  }

  ObstacleDistance distance_;
  double spacing_ = 0.0;
  Vec3 origin_;
  std::array<std::uint32_t, 3> counts_{};
  std::vector<double> values_;  ///< signed distance plus the depth that is needed
  std::unordered_map<std::uint64_t, std::uint32_t> on_edge_;
  std::vector<Vec3> vertices_;
  std::vector<Triangle> triangles_;
};

std::optional<Shape3> eroded(const std::shared_ptr<const Mesh>& mesh, double d) {
  if (d == 0.0) return mesh;
  if (mesh->convex()) return eroded_convex(*mesh, d);
  if (mesh->closed()) return GridErosion(mesh, d).rest();
  throw Error("a mesh that is not closed has no inside that could be eroded");
}

/// The union of the smaller balls is a part of what is left of the union of all.
std::optional<Shape3> eroded(const std::shared_ptr<const PointCloud>& cloud, double d) {
  if (d == 0.0) return cloud;
  if (cloud->radius() <= d) return std::nullopt;
  return std::make_shared<const PointCloud>(cloud->with_radius(cloud->radius() - d));
}

/// The smallest of the sizes that `check_precision` checks.
double smallest_size(const Shape3& shape) {
  if (const auto* sphere = std::get_if<Sphere>(&shape)) return 2.0 * sphere->radius;
  if (const auto* cuboid = std::get_if<Cuboid>(&shape))
    return std::min({cuboid->size.x, cuboid->size.y, cuboid->size.z});
  if (const auto* cylinder = std::get_if<Cylinder>(&shape)) return std::min(2.0 * cylinder->radius, cylinder->length);
  if (const auto* capsule = std::get_if<Capsule>(&shape)) return 2.0 * capsule->radius;
  if (const auto* cloud = std::get_if<std::shared_ptr<const PointCloud>>(&shape)) return 2.0 * (*cloud)->radius();
  const Box3& box = std::get<std::shared_ptr<const Mesh>>(shape)->bounds();
  return std::max({box.hi.x - box.lo.x, box.hi.y - box.lo.y, box.hi.z - box.lo.z});
}

}  // namespace

World3 eroded(const World3& world, double distance) {
  std::vector<Obstacle3> obstacles;
  for (const Obstacle3& obstacle : world.obstacles()) {
    try {
      auto rest = std::visit([&](const auto& shape) { return eroded(shape, distance); }, obstacle.solid.shape);
      if (!rest) continue;
      Solid solid{std::move(*rest), obstacle.solid.pose};
      // What only rounding left vanishes too.
      const double farthest = std::max(farthest_of(world.bounds()), farthest_of(bounding_box(solid)));
      if (smallest_size(solid.shape) < least_size(farthest)) continue;
      obstacles.push_back({fmt::format("{} eroded by {:g}", obstacle.name, distance), std::move(solid)});
    } catch (const Error& error) {
      throw Error(fmt::format("{}: {}", obstacle.name, error.what()));
    }
  }
  return world.with(std::move(obstacles));
}

}  // namespace trellis
