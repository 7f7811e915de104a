// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <memory>
#include <vector>

#include <trellis/scene/spatial/box_tree.hpp>
#include <trellis/scene/spatial/shapes.hpp>

namespace trellis {

/// The distance of points from a mesh, and whether they are inside, in time that grows with the logarithm of the number
/// of its triangles.
class MeshDistance {
 public:
  explicit MeshDistance(std::shared_ptr<const Mesh> mesh);

  [[nodiscard]] const Mesh& mesh() const { return *mesh_; }
  /// Returns the tree over the triangles' boxes.
  [[nodiscard]] const BoxTree& tree() const { return tree_; }
  /// Returns the corners of the triangles, in the tree's order.
  [[nodiscard]] const std::vector<std::array<Vec3, 3>>& corners() const { return corners_; }
  /// Returns the distance of p from the surface, or `at_most` where it is not less.
  [[nodiscard]] double to_surface(const Vec3& p, double at_most = std::numeric_limits<double>::infinity()) const;
  /// Returns the nearest point of the surface.
  [[nodiscard]] Vec3 nearest(const Vec3& p) const;
  /// Whether p lies inside, as trellis::contains says.
  [[nodiscard]] bool contains(const Vec3& p) const;

 private:
  struct Found {
    Vec3 from;             ///< from the nearest point to p
    double squared = 0.0;  ///< its length's square
  };
  /// Returns the nearest point of those nearer than the square root of `most`.
  [[nodiscard]] Found search(const Vec3& p, double most) const;

  std::shared_ptr<const Mesh> mesh_;
  BoxTree tree_;
  std::vector<std::array<Vec3, 3>> corners_;  ///< of the triangles, in the tree's order
};

/// The nearest point of the obstacles' surfaces.
struct NearestObstacle {
  double distance = std::numeric_limits<double>::infinity();  ///< signed, as ObstacleDistance has it
  Vec3 point;
  std::size_t obstacle = 0;
};

/// The signed distance of points from the obstacles of a world, without a grid.
///
/// Outside all obstacles it is the distance from the nearest one. Inside it is negative: minus the greatest depth in
/// one of them, so that the point is at least that deep in their union. A mesh that is not closed, and in worlds of
/// surfaces any mesh, has no inside: there the distance from its surface counts. It changes by at most the distance
/// between two points. Immutable; threads share it.
class ObstacleDistance {
 public:
  /// \param surface  whether meshes have no inside
  ObstacleDistance(const std::vector<Solid>& obstacles, bool surface);

  /// Returns the signed distance of p; infinity without obstacles.
  [[nodiscard]] double operator()(const Vec3& p) const { return search(p).distance; }
  /// Returns the nearest point of the obstacles' surfaces, of those that contain p the one with the greatest depth.
  /// Where distance > 0, p - point leads away from the obstacles; where it is < 0, point - p leads out of one.
  [[nodiscard]] NearestObstacle nearest(const Vec3& p) const;
  /// Returns the smallest box along the axes that contains all obstacles; an inverted one without any.
  [[nodiscard]] Box3 bounds() const;

 private:
  struct Obstacle {
    Solid solid;
    Pose3 inverse;
    std::size_t mesh = 0;     ///< of meshes_, where it is one
    bool has_inside = false;  ///< a mesh that has one
  };
  struct Found {
    double distance = std::numeric_limits<double>::infinity();
    std::size_t obstacle = 0;
  };
  [[nodiscard]] Found search(const Vec3& p) const;
  /// Returns the signed distance from one obstacle, or `best` where it is not less.
  [[nodiscard]] double of_obstacle(const Obstacle& obstacle, const Vec3& p, double best) const;

  std::vector<Obstacle> obstacles_;
  std::vector<MeshDistance> meshes_;
  BoxTree tree_;
};

}  // namespace trellis
