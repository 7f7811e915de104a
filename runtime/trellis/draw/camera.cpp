// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/draw/camera.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

namespace trellis::draw {

namespace {

double radians(double degrees) { return degrees * std::numbers::pi / 180.0; }

double along(const Point3& p, std::size_t axis) { return axis == 0 ? p.x : axis == 1 ? p.y : p.z; }

}  // namespace

Point3 Camera::direction() const {
  const double a = radians(azimuth);
  const double e = radians(elevation);
  return {std::cos(e) * std::cos(a), std::cos(e) * std::sin(a), std::sin(e)};
}

Point3 Camera::right() const { return {-std::sin(radians(azimuth)), std::cos(radians(azimuth)), 0.0}; }

Point3 Camera::up() const { return cross(direction(), right()); }

Camera camera_for(const Point3& lo, const Point3& hi) {
  constexpr double low = 30.0;
  constexpr double high = 58.0;
  constexpr double flat = 0.5;  // of the longer side
  const double height = (hi.z - lo.z) / std::max(hi.x - lo.x, hi.y - lo.y);
  return {.elevation = low + (high - low) * std::clamp(1.0 - height / flat, 0.0, 1.0)};
}

bool closes_view(const Surface& surface, const Point3& lo, const Point3& hi, const Camera& camera) {
  constexpr double depth = 0.05;   // of the longest side: so far inside it may reach
  constexpr double covered = 0.6;  // of the side, along both of its axes
  constexpr double facing = 0.05;
  if (surface.vertices.empty()) return false;
  Point3 least = surface.vertices[0];
  Point3 most = least;
  for (const Point3& p : surface.vertices) {
    least = {std::min(least.x, p.x), std::min(least.y, p.y), std::min(least.z, p.z)};
    most = {std::max(most.x, p.x), std::max(most.y, p.y), std::max(most.z, p.z)};
  }
  const double inside = depth * std::max({hi.x - lo.x, hi.y - lo.y, hi.z - lo.z});
  const Point3 direction = camera.direction();
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double towards = along(direction, axis);
    const bool beyond = towards > facing    ? along(least, axis) >= along(hi, axis) - inside
                        : towards < -facing ? along(most, axis) <= along(lo, axis) + inside
                                            : false;
    if (!beyond) continue;
    double share = 1.0;
    for (std::size_t other = 0; other < 3; ++other) {
      if (other == axis) continue;
      const double from = std::max(along(least, other), along(lo, other));
      const double to = std::min(along(most, other), along(hi, other));
      share = std::min(share, (to - from) / (along(hi, other) - along(lo, other)));
    }
    if (share >= covered) return true;
  }
  return false;
}

}  // namespace trellis::draw
