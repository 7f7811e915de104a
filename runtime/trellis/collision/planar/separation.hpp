// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include <trellis/scene/planar/shapes.hpp>

namespace trellis {

/// A closed convex shape: all points within `radius` of the hull of the corners.
struct Convex {
  std::vector<Vec2> corners;  ///< counter-clockwise
  std::vector<Vec2> normals;  ///< outward and of unit length: of the edge that begins at each corner; empty of a disc
  double radius = 0.0;
};

/// Writes a shape as its corners; reuses the memory of `out`.
void write_convex(const ConvexShape& shape, Convex& out);
void write_convex(const Box2& box, Convex& out);

/// A convex shape of a rigid body while the body moves straight: its origin along a segment, its angle at a constant
/// rate.
class MovingConvex {
 public:
  /// Sets the motion, of which the pose is the middle.
  /// \param translation  from the middle to the end, in metres
  /// \param turn  the angle from the middle to the end, in radians
  void set(const Convex& shape, const Pose2& middle, Vec2 translation, double turn);

  /// Returns a box that contains the shape throughout the motion.
  [[nodiscard]] Box2 box() const;
  /// Returns the smallest box around the shape at the middle of the motion.
  [[nodiscard]] Box2 middle_box() const;

  struct Gap {
    double middle = 0.0;      ///< the distance at the middle of the motion, in metres; 0 in contact
    double throughout = 0.0;  ///< a lower bound on the distance throughout the motion, in metres; may be negative
  };
  /// Returns the distance from a shape at rest. The bound is the least gap between the two shapes along the direction
  /// of their nearest points at the middle, so displacements along the obstacle do not lower it.
  [[nodiscard]] Gap gap(const Convex& obstacle) const;

 private:
  /// Returns the least n.p of all points p of the corners' hull throughout the motion, or less.
  [[nodiscard]] double least_along(Vec2 n) const;
  /// Returns by how much less than in the middle a corner lies along a direction during the motion, at most.
  /// \param translation  that of the body along the direction
  /// \param u, z  the corner's arm, and the arm turned by a right angle, along the direction
  [[nodiscard]] double loss(double translation, double u, double z) const;

  Vec2 origin_;
  Vec2 translation_;
  double turn_ = 0.0;
  double radius_ = 0.0;
  std::vector<Vec2> arms_;     ///< from the origin to the corners, at the middle
  std::vector<Vec2> normals_;  ///< at the middle
};

}  // namespace trellis
