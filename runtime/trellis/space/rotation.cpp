// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/space/rotation.hpp>

#include <cmath>
#include <numbers>

namespace trellis {

namespace {

/// sin(x) / x, continuous at 0.
double sinc(double x) {
  constexpr double small = 1e-4;
  return std::abs(x) < small ? 1.0 - x * x / 6.0 : std::sin(x) / x;
}

double length_of_vector_part(const Quaternion& q) { return norm({q.x, q.y, q.z}); }

}  // namespace

Quaternion operator*(const Quaternion& a, const Quaternion& b) {
  // Grouped so that the inverse of q times q has a vector part of exactly 0.
  return {(a.w * b.x + a.x * b.w) + (a.y * b.z - a.z * b.y), (a.w * b.y + a.y * b.w) + (a.z * b.x - a.x * b.z),
          (a.w * b.z + a.z * b.w) + (a.x * b.y - a.y * b.x), a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z};
}

Vec3 Quaternion::operator()(const Vec3& v) const {
  const Vec3 axis = {x, y, z};
  const Vec3 twice = 2.0 * cross(axis, v);
  return v + w * twice + cross(axis, twice);
}

Quaternion normalised(const Quaternion& q) {
  const double length = std::sqrt(q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w);
  if (length == 0.0 || !std::isfinite(length)) return {};
  double scale = 1.0 / length;
  for (const double c : {q.w, q.x, q.y, q.z}) {
    if (c == 0.0) continue;
    if (c < 0.0) scale = -scale;
    break;
  }
  // A coordinate of 0 stays +0: rows are compared bit by bit.
  return {q.x * scale + 0.0, q.y * scale + 0.0, q.z * scale + 0.0, q.w * scale + 0.0};
}

Quaternion rotation_of(const Vec3& v) {
  const double half = 0.5 * norm(v);
  const double s = 0.5 * sinc(half);
  return normalised({s * v.x, s * v.y, s * v.z, std::cos(half)});
}

Vec3 rotation_vector(const Quaternion& q) {
  const double length = length_of_vector_part(q);
  if (length == 0.0) return {};
  // Of q and -q, the one with w >= 0 has the angle of at most pi.
  const double angle = 2.0 * std::atan2(length, std::abs(q.w));
  const double scale = (q.w < 0.0 ? -angle : angle) / length;
  return {scale * q.x, scale * q.y, scale * q.z};
}

double angle_between(const Quaternion& a, const Quaternion& b) {
  const Quaternion turn = a.inverse() * b;
  return 2.0 * std::atan2(length_of_vector_part(turn), std::abs(turn.w));
}

Quaternion interpolated(const Quaternion& a, const Quaternion& b, double t) {
  return normalised(a * rotation_of(t * rotation_vector(a.inverse() * b)));
}

Quaternion rotation_from_unit(const std::array<double, 3>& u) {
  const double first = std::sqrt(1.0 - u[0]);
  const double second = std::sqrt(u[0]);
  const double alpha = 2.0 * std::numbers::pi * u[1];
  const double beta = 2.0 * std::numbers::pi * u[2];
  return normalised(
      {first * std::sin(alpha), first * std::cos(alpha), second * std::sin(beta), second * std::cos(beta)});
}

double log_volume_of_rotations() { return std::log(8.0 * std::numbers::pi * std::numbers::pi); }

double log_jacobian_of_rotation(double angle) { return 2.0 * std::log(sinc(0.5 * angle)); }

}  // namespace trellis
