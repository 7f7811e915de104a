// SPDX-License-Identifier: GPL-3.0-or-later
// Views of configurations, vectors and rotations as objects of Eigen, without a copy, and poses as isometries. No other
// header includes this one: who includes it needs Eigen 3.4 (Debian: libeigen3-dev).
//
//     as_eigen(q).head<3>() += as_eigen(displacement);              // q: a MutableView; displacement: a Vec3
//     const Eigen::VectorXd mean = as_eigen(rows).colwise().mean();  // rows: Configurations
//
// An object of Eigen that a function returns by `Eigen::Map` refers to the memory of the argument: it is valid as long
// as that, and as long as a view of that would be. So arguments that are temporary objects do not compile. Values of an
// Eigen expression are assigned through such a map: `as_eigen(v) = Eigen::Vector3d::UnitZ();`.
#pragma once

#include <cstddef>
#include <type_traits>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <trellis/base/configurations.hpp>
#include <trellis/scene/planar/shapes.hpp>
#include <trellis/space/rotation.hpp>

namespace trellis {

// The coordinates of each type lie in memory as an array of doubles, in the order that Eigen gives them.
static_assert(std::is_standard_layout_v<Vec2> && sizeof(Vec2) == 2 * sizeof(double));
static_assert(offsetof(Vec2, x) == 0 && offsetof(Vec2, y) == sizeof(double));
static_assert(std::is_standard_layout_v<Vec3> && sizeof(Vec3) == 3 * sizeof(double));
static_assert(offsetof(Vec3, x) == 0 && offsetof(Vec3, y) == sizeof(double) && offsetof(Vec3, z) == 2 * sizeof(double));
static_assert(std::is_standard_layout_v<Quaternion> && sizeof(Quaternion) == 4 * sizeof(double));
static_assert(offsetof(Quaternion, x) == 0 && offsetof(Quaternion, y) == sizeof(double) &&
              offsetof(Quaternion, z) == 2 * sizeof(double) && offsetof(Quaternion, w) == 3 * sizeof(double));
static_assert(std::is_same_v<View::element_type, const double> && std::is_same_v<MutableView::element_type, double>);

/// Rows of configurations as a matrix: one configuration a row, one coordinate a column.
using RowsOfConfigurations = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Views a point or vector of the plane as a column of 2 numbers: x, y.
/// \param v  outlives the result
inline Eigen::Map<const Eigen::Vector2d> as_eigen(const Vec2& v) { return Eigen::Map<const Eigen::Vector2d>(&v.x); }
/// As above, to write to.
/// \param v  outlives the result
inline Eigen::Map<Eigen::Vector2d> as_eigen(Vec2& v) { return Eigen::Map<Eigen::Vector2d>(&v.x); }
Eigen::Map<const Eigen::Vector2d> as_eigen(const Vec2&&) = delete;

/// Views a point or vector of space as a column of 3 numbers: x, y, z.
/// \param v  outlives the result
inline Eigen::Map<const Eigen::Vector3d> as_eigen(const Vec3& v) { return Eigen::Map<const Eigen::Vector3d>(&v.x); }
/// As above, to write to.
/// \param v  outlives the result
inline Eigen::Map<Eigen::Vector3d> as_eigen(Vec3& v) { return Eigen::Map<Eigen::Vector3d>(&v.x); }
Eigen::Map<const Eigen::Vector3d> as_eigen(const Vec3&&) = delete;

/// Views a rotation as a quaternion of Eigen, which stores its coefficients in the same order: x, y, z, w. The
/// constructor `Eigen::Quaterniond(w, x, y, z)` takes them in another one.
/// \param q  outlives the result; its norm is not changed
inline Eigen::Map<const Eigen::Quaterniond> as_eigen(const Quaternion& q) {
  return Eigen::Map<const Eigen::Quaterniond>(&q.x);
}
/// As above, to write to.
/// \param q  outlives the result; of norm 1 again when Trellis reads it next
inline Eigen::Map<Eigen::Quaterniond> as_eigen(Quaternion& q) { return Eigen::Map<Eigen::Quaterniond>(&q.x); }
Eigen::Map<const Eigen::Quaterniond> as_eigen(const Quaternion&&) = delete;

/// Views a configuration as a column of as many numbers as it has coordinates.
/// \param q  its numbers outlive the result; a row of `Configurations` is valid until their next push
inline Eigen::Map<const Eigen::VectorXd> as_eigen(View q) { return {q.data(), static_cast<Eigen::Index>(q.size())}; }
/// As above, to write to.
/// \param q  its numbers outlive the result
inline Eigen::Map<Eigen::VectorXd> as_eigen(MutableView q) { return {q.data(), static_cast<Eigen::Index>(q.size())}; }
/// Views a configuration that owns its numbers.
/// \param q  outlives the result; a change of its size ends the validity of the result
inline Eigen::Map<const Eigen::VectorXd> as_eigen(const Configuration& q) { return as_eigen(View(q)); }
/// As above, to write to.
/// \param q  outlives the result
inline Eigen::Map<Eigen::VectorXd> as_eigen(Configuration& q) { return as_eigen(MutableView(q)); }
Eigen::Map<const Eigen::VectorXd> as_eigen(const Configuration&&) = delete;

/// Views configurations as a matrix of `size()` rows and `dimension()` columns. To write to a row, view it alone:
/// `as_eigen(rows[i])`.
/// \param rows  outlives the result; the next push, `reserve` or assignment ends the validity of the result
inline Eigen::Map<const RowsOfConfigurations> as_eigen(const Configurations& rows) {
  return {rows.values().data(), static_cast<Eigen::Index>(rows.size()), static_cast<Eigen::Index>(rows.dimension())};
}
Eigen::Map<const RowsOfConfigurations> as_eigen(const Configurations&&) = delete;

/// Returns the isometry of a pose, a copy: it takes points of the body's frame to the world's, as the pose does.
/// \param pose  its orientation has norm 1
inline Eigen::Isometry3d isometry_of(const Pose3& pose) {
  Eigen::Isometry3d isometry = Eigen::Isometry3d::Identity();
  isometry.linear() = as_eigen(pose.orientation).toRotationMatrix();
  isometry.translation() = as_eigen(pose.position);
  return isometry;
}
/// Returns the pose of an isometry, a copy. Of the two quaternions of its rotation the pose has that of `normalised`,
/// so a pose that is converted forth and back may have the other one.
/// \param isometry  its linear part is a rotation: orthogonal up to rounding, without a reflection; in metres
inline Pose3 pose_of(const Eigen::Isometry3d& isometry) {
  Pose3 pose;
  as_eigen(pose.position) = isometry.translation();
  as_eigen(pose.orientation) = Eigen::Quaterniond(isometry.linear());
  pose.orientation = normalised(pose.orientation);
  return pose;
}

}  // namespace trellis
