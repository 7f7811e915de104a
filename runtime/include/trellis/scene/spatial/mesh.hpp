// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <trellis/space/rotation.hpp>

namespace trellis {

/// A box along the axes of space, closed, in metres.
struct Box3 {
  Vec3 lo;
  Vec3 hi;
  friend bool operator==(const Box3&, const Box3&) = default;
};

/// Three indices of vertices, counter-clockwise from outside where the mesh is closed.
using Triangle = std::array<std::uint32_t, 3>;

/// A triangle mesh. Immutable; safe to share between threads.
///
/// A mesh is closed where as many triangles run along each edge in one direction as in the other one, so that it bounds
/// a solid: what is inside is part of it. (Two triangles as a rule; four where solids of one file touch in an edge.)
/// Another mesh is a surface without an inside.
class Mesh {
 public:
  /// The largest number of triangles, and of vertices.
  static constexpr std::size_t most_triangles = 2'000'000;

  /// Validates vertices (finite, within `most_distant`) and triangles (indices in range, not two the same, an area
  /// greater than 0); merges vertices with the same coordinates and drops unused ones. Triangles of a closed mesh that
  /// run clockwise from outside are turned: an outermost component that does is turned with all inside it. So a
  /// clockwise component inside a counter-clockwise one stays: it is a cavity.
  /// \param vertices  metres
  /// \param triangles  indices into `vertices`, from 0 on; at least one
  /// \param what  the mesh's name in messages
  /// \throws Error that names the vertex or the triangle, counted from 1
  Mesh(std::vector<Vec3> vertices, std::vector<Triangle> triangles, const std::string& what);

  [[nodiscard]] const std::vector<Vec3>& vertices() const { return vertices_; }
  [[nodiscard]] const std::vector<Triangle>& triangles() const { return triangles_; }
  [[nodiscard]] bool closed() const { return closed_; }
  /// Whether the mesh is closed and convex.
  [[nodiscard]] bool convex() const { return convex_; }
  [[nodiscard]] const Box3& bounds() const { return bounds_; }
  /// A hash of vertices and triangles, the same in every process.
  [[nodiscard]] std::uint64_t hash() const { return hash_; }
  /// Returns the volume of a closed mesh in cubic metres, 0 of another.
  [[nodiscard]] double volume() const;
  /// Returns the mesh scaled by `factor` > 0 about the origin.
  /// \param factor  finite, greater than 0
  /// \throws Error for a factor that is not greater than 0, and where vertices would leave `most_distant`
  [[nodiscard]] Mesh scaled(double factor) const;

  /// Returns the convex hull of points, as a mesh.
  /// \param points  metres, at least four
  /// \param what  the mesh's name in messages
  /// \throws Error for too many points or one outside `most_distant`, and where all points lie in a plane within
  ///     rounding
  static Mesh hull(const std::vector<Vec3>& points, const std::string& what);

 private:
  Mesh() = default;
  /// Computes what follows from vertices and triangles, and turns triangles.
  void analyse(const std::string& what);

  std::vector<Vec3> vertices_;
  std::vector<Triangle> triangles_;
  Box3 bounds_;
  bool closed_ = false;
  bool convex_ = false;
  std::uint64_t hash_ = 0;
};

/// Whether p lies inside a closed mesh, cavities left out; a point of the surface may count either direction. False for
/// a mesh that is not closed. It takes time proportional to the number of triangles.
/// \param mesh  closed or not
/// \param p  metres, in the mesh's frame
bool contains(const Mesh& mesh, const Vec3& p);
/// Returns the distance of p from the mesh's surface, in time proportional to the number of triangles.
/// \param mesh  closed or not
/// \param p  metres, in the mesh's frame
/// \return metres; greater than 0 for a point inside, too
double distance_to_surface(const Mesh& mesh, const Vec3& p);
/// Returns the distance of p from the triangle a b c, in metres. Source: Ericson, Real-Time Collision Detection, 2005,
/// section 5.1.5.
/// \param p  the point
/// \param a, b, c  the corners, with an area greater than 0, in either order
double distance_to_triangle(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c);

}  // namespace trellis
