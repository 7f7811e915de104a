// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cmath>

namespace trellis {

/// A vector or a point in space, in metres unless its name says otherwise.
struct Vec3 {
  double x = 0.0;
  double y = 0.0;
  double z = 0.0;

  friend bool operator==(const Vec3&, const Vec3&) = default;
  friend Vec3 operator+(const Vec3& a, const Vec3& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
  friend Vec3 operator-(const Vec3& a, const Vec3& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
  friend Vec3 operator*(double s, const Vec3& a) { return {s * a.x, s * a.y, s * a.z}; }
};

/// Returns the scalar product.
/// \param a, b  vectors of the same frame
inline double dot(const Vec3& a, const Vec3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
/// Returns the vector product: normal to both, right-handed.
/// \param a, b  vectors of the same frame
inline Vec3 cross(const Vec3& a, const Vec3& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
/// Returns the Euclidean norm.
/// \param a  in metres gives metres
inline double norm(const Vec3& a) { return std::sqrt(dot(a, a)); }

/// A rotation of space as a unit quaternion x i + y j + z k + w. q and -q are the same rotation. Rows of configurations
/// hold it in the order x, y, z, w.
struct Quaternion {
  double x = 0.0;
  double y = 0.0;
  double z = 0.0;
  double w = 1.0;

  friend bool operator==(const Quaternion&, const Quaternion&) = default;
  /// The rotation by b, then by a.
  /// \param a, b  unit quaternions; the product is not normalised again
  friend Quaternion operator*(const Quaternion& a, const Quaternion& b);
  /// Returns the inverse rotation. Requires norm 1.
  [[nodiscard]] Quaternion inverse() const { return {-x, -y, -z, w}; }
  /// Returns the vector v, rotated.
  /// \param v  of any length, which the rotation keeps
  [[nodiscard]] Vec3 operator()(const Vec3& v) const;
};

/// Returns q at norm 1 and, of q and -q, the one whose first coordinate unlike 0 of w, x, y, z is positive: each
/// rotation has one such quaternion. Of norm 0 it makes the identity.
/// \param q  of any norm; coordinates that are not finite make the identity, too
Quaternion normalised(const Quaternion& q);

/// Returns the rotation by |v| radians about the axis v (the exponential map). Any length of v is allowed.
/// \param v  rotation vector in radians
Quaternion rotation_of(const Vec3& v);
/// Returns the rotation vector of q: its length is the angle in [0, pi], its direction the axis (the logarithm). q need
/// not have norm 1 exactly.
/// \param q  of either sign: q and -q give the same vector, but for a half turn, whose axis has two directions
/// \return radians
Vec3 rotation_vector(const Quaternion& q);
/// Returns the angle of the rotation that turns a into b, in [0, pi] radians. It is a metric of the rotations, with the
/// same precision at small angles as at large ones.
/// \param a, b  of either sign; their norms need not be 1 exactly
double angle_between(const Quaternion& a, const Quaternion& b);
/// Returns the rotation at parameter t of the shortest turn from a to b, at constant speed (slerp), `normalised`.
/// \param a, b  the rotations at t = 0 and t = 1, of either sign
/// \param t  parameter in [0, 1]
Quaternion interpolated(const Quaternion& a, const Quaternion& b, double t);
/// Maps the unit cube to the rotations such that equal volumes of the cube have equal volumes there: uniform numbers
/// give uniform rotations. Source: Shoemake, Uniform random rotations, Graphics Gems III, 1992.
/// \param u  three numbers in [0, 1)
Quaternion rotation_from_unit(const std::array<double, 3>& u);

/// log of the volume of all rotations where a turn by an angle has that angle as its length: log(8 pi^2).
double log_volume_of_rotations();
/// log of the factor by which the exponential map changes volumes at a turn by `angle` radians in [0, pi]:
/// 2 log(sin(angle / 2) / (angle / 2)), at most 0.
/// \param angle  radians in [0, pi]; 0 gives 0
double log_jacobian_of_rotation(double angle);

/// A pose of a body in space: rotate, then translate.
struct Pose3 {
  Vec3 position;
  Quaternion orientation;

  friend bool operator==(const Pose3&, const Pose3&) = default;
  /// Returns the point p of the body's frame in the world's frame.
  /// \param p  metres
  [[nodiscard]] Vec3 operator()(const Vec3& p) const { return orientation(p) + position; }
  /// The pose b, given in the frame of a.
  /// \param a  the pose of the frame that b is given in
  /// \param b  in that frame
  friend Pose3 operator*(const Pose3& a, const Pose3& b) { return {a(b.position), a.orientation * b.orientation}; }
  /// Returns the inverse motion, which takes points of the world's frame to the body's.
  [[nodiscard]] Pose3 inverse() const {
    const Quaternion back = orientation.inverse();
    return {-1.0 * back(position), back};
  }
};

}  // namespace trellis
