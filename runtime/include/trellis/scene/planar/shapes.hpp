// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cmath>
#include <variant>
#include <vector>

namespace trellis {

/// The limit of coordinates and radii, in metres: beyond it, doubles are too coarse for collision checks (1e-7 m
/// there).
inline constexpr double most_distant = 1e9;

/// A point or vector of the plane, in metres.
struct Vec2 {
  double x = 0.0;
  double y = 0.0;

  friend Vec2 operator+(Vec2 a, Vec2 b) { return {a.x + b.x, a.y + b.y}; }
  friend Vec2 operator-(Vec2 a, Vec2 b) { return {a.x - b.x, a.y - b.y}; }
  friend Vec2 operator*(double s, Vec2 a) { return {s * a.x, s * a.y}; }
  friend bool operator==(const Vec2&, const Vec2&) = default;
};

/// Returns the scalar product.
/// \param a, b  vectors of the same frame
inline double dot(Vec2 a, Vec2 b) { return a.x * b.x + a.y * b.y; }
/// The z component of the cross product: positive when b lies counter-clockwise of a.
/// \param a, b  vectors of the same frame
inline double cross(Vec2 a, Vec2 b) { return a.x * b.y - a.y * b.x; }
/// Returns the Euclidean norm.
/// \param a  in metres gives metres
inline double norm(Vec2 a) { return std::sqrt(dot(a, a)); }
/// Whether both coordinates are numbers within `most_distant` of 0.
/// \param a  metres; NaN is out of range
inline bool in_range(Vec2 a) { return std::abs(a.x) <= most_distant && std::abs(a.y) <= most_distant; }

/// An axis-aligned rectangle, closed, in metres.
struct Box2 {
  Vec2 lo;
  Vec2 hi;
  friend bool operator==(const Box2&, const Box2&) = default;
};

/// Returns the smallest box that contains both.
/// \param a, b  boxes of the same frame
inline Box2 united(const Box2& a, const Box2& b) {
  return {{std::min(a.lo.x, b.lo.x), std::min(a.lo.y, b.lo.y)}, {std::max(a.hi.x, b.hi.x), std::max(a.hi.y, b.hi.y)}};
}

/// A closed disc, in metres; radius 0 is a point (allowed for robots only).
struct Disc {
  Vec2 centre;
  double radius = 0.0;
  friend bool operator==(const Disc&, const Disc&) = default;
};

/// A closed polygon given by its vertices in order, in metres. Those of a World or Robot are simple and
/// counter-clockwise.
struct Polygon {
  std::vector<Vec2> vertices;
  friend bool operator==(const Polygon&, const Polygon&) = default;
};

/// The shapes of obstacles and robot parts that a user may give.
using Shape = std::variant<Box2, Disc, Polygon>;
/// The shapes of collision checks: a disc or a convex counter-clockwise polygon.
using ConvexShape = std::variant<Disc, Polygon>;

/// A rigid motion of the plane: p -> (x + c px - s py, y + s px + c py).
struct Pose2 {
  double x = 0.0;
  double y = 0.0;
  double c = 1.0;
  double s = 0.0;

  /// Returns the point p of the moved frame in the frame of the pose.
  /// \param p  metres
  [[nodiscard]] Vec2 operator()(Vec2 p) const { return {x + c * p.x - s * p.y, y + s * p.x + c * p.y}; }
};

/// Returns the smallest rectangle along the axes that contains the shape.
/// \param shape  a disc, or a polygon with at least one vertex
Box2 bounding_box(const ConvexShape& shape);
/// Returns the smallest rectangle along the axes that contains the points.
/// \param points  at least one
Box2 bounding_box(const std::vector<Vec2>& points);
/// Returns the four corners, counter-clockwise.
/// \param box  its `lo` is the first corner
std::vector<Vec2> rectangle_vertices(const Box2& box);

}  // namespace trellis
