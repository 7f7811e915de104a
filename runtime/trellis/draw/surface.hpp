// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

/// Surfaces of triangles in space, from plain numbers, for pictures, pages and files of other programs.
namespace trellis::draw {

/// A point or a vector in space, in metres; z up.
struct Point3 {
  double x = 0.0;
  double y = 0.0;
  double z = 0.0;

  friend bool operator==(const Point3&, const Point3&) = default;
  friend Point3 operator+(const Point3& a, const Point3& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
  friend Point3 operator-(const Point3& a, const Point3& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
  friend Point3 operator*(double s, const Point3& a) { return {s * a.x, s * a.y, s * a.z}; }
};

double dot(const Point3& a, const Point3& b);
Point3 cross(const Point3& a, const Point3& b);
/// Returns a at length 1, or a itself where its length is 0.
Point3 unit(const Point3& a);

/// A surface of triangles that share vertices.
struct Surface {
  std::vector<Point3> vertices{};
  /// Indices of vertices, counter-clockwise from outside where the surface is closed.
  std::vector<std::array<std::uint32_t, 3>> triangles{};
  bool closed = true;  ///< bounds a solid, so that a picture needs no triangle that faces away
};

/// Adds `part` to `whole`, which is closed afterwards if both were.
void append(Surface& whole, const Surface& part);

/// Returns the surface with the vertices of each cube of `cell` metres merged into their mean, without triangles that
/// lose their area or occur twice.
Surface clustered(const Surface& surface, double cell);

/// Returns the ends of the edges that show the form: those of one triangle, and those where triangles meet at more than
/// `degrees`; ascending.
std::vector<std::pair<std::uint32_t, std::uint32_t>> feature_edges(const Surface& surface, double degrees = 25.0);

/// Returns the ends of the edges that draw the form as it is seen: feature edges and outlines, without those of which
/// all triangles face away; ascending.
/// \param to_camera  the direction of the camera
std::vector<std::pair<std::uint32_t, std::uint32_t>> drawn_edges(const Surface& surface, const Point3& to_camera);

}  // namespace trellis::draw
