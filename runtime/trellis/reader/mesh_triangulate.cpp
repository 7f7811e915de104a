// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/reader/mesh_formats.hpp>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace trellis {

namespace {

struct Flat {
  double x = 0.0;
  double y = 0.0;
  friend bool operator==(const Flat&, const Flat&) = default;
};

/// Twice the area of the triangle, positive where it runs counter-clockwise.
double area(const Flat& a, const Flat& b, const Flat& c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

/// Returns the sum of the cross products along the polygon: twice its area times its normal (Newell).
Vec3 normal_of(const std::vector<Vec3>& vertices, std::span<const std::uint32_t> corners) {
  const Vec3& origin = vertices[corners[0]];
  Vec3 normal;
  for (std::size_t i = 1; i + 1 < corners.size(); ++i) {
    normal = normal + cross(vertices[corners[i]] - origin, vertices[corners[i + 1]] - origin);
  }
  return normal;
}

/// Drops the coordinate along which the normal is longest, such that the polygon is counter-clockwise.
std::vector<Flat> flattened(const std::vector<Vec3>& vertices, std::span<const std::uint32_t> corners,
                            const Vec3& normal) {
  const double x = std::abs(normal.x), y = std::abs(normal.y), z = std::abs(normal.z);
  std::vector<Flat> flat;
  flat.reserve(corners.size());
  for (const std::uint32_t corner : corners) {
    const Vec3& v = vertices[corner];
    if (z >= x && z >= y) {
      flat.push_back({normal.z > 0.0 ? v.x : -v.x, v.y});
    } else if (y >= x) {
      flat.push_back({normal.y > 0.0 ? v.z : -v.z, v.x});
    } else {
      flat.push_back({normal.x > 0.0 ? v.y : -v.y, v.z});
    }
  }
  return flat;
}

bool in_triangle(const Flat& p, const Flat& a, const Flat& b, const Flat& c) {
  return area(a, b, p) >= 0.0 && area(b, c, p) >= 0.0 && area(c, a, p) >= 0.0;
}

/// Whether the triangle at place i of the rest of a polygon lies inside it: no other corner touches it.
bool is_ear(const std::vector<Flat>& flat, const std::vector<std::size_t>& rest, std::size_t i) {
  const std::size_t n = rest.size();
  const Flat& a = flat[rest[(i + n - 1) % n]];
  const Flat& b = flat[rest[i]];
  const Flat& c = flat[rest[(i + 1) % n]];
  if (!(area(a, b, c) > 0.0)) return false;
  return std::none_of(rest.begin(), rest.end(), [&](std::size_t k) {
    const Flat& p = flat[k];
    return p != a && p != b && p != c && in_triangle(p, a, b, c);
  });
}

/// Whether all triangles from the first corner run counter-clockwise, as those of a convex polygon do.
bool is_fan(const std::vector<Flat>& flat) {
  double turns = 0.0;
  for (std::size_t i = 1; i + 1 < flat.size(); ++i) {
    if (!(area(flat[0], flat[i], flat[i + 1]) > 0.0)) return false;
    // The polygon might wind about the first corner more than once.
    const Flat u{flat[i].x - flat[0].x, flat[i].y - flat[0].y}, v{flat[i + 1].x - flat[0].x, flat[i + 1].y - flat[0].y};
    turns += std::atan2(u.x * v.y - u.y * v.x, u.x * v.x + u.y * v.y);
  }
  constexpr double once = 6.2;  // a little less than a full turn
  return turns < once;
}

}  // namespace

bool triangulate(const std::vector<Vec3>& vertices, std::span<const std::uint32_t> corners,
                 std::vector<Triangle>& triangles) {
  if (corners.size() == 3) {
    triangles.push_back({corners[0], corners[1], corners[2]});
    return true;
  }
  const Vec3 normal = normal_of(vertices, corners);
  const std::vector<Flat> flat = flattened(vertices, corners, normal);
  // What has no area as a whole is no polygon whose inside could be missed.
  if (normal == Vec3{} || is_fan(flat)) {
    for (std::size_t i = 1; i + 1 < corners.size(); ++i) triangles.push_back({corners[0], corners[i], corners[i + 1]});
    return true;
  }
  std::vector<std::size_t> rest(corners.size());
  std::iota(rest.begin(), rest.end(), std::size_t{0});
  while (rest.size() > 3) {
    std::size_t i = 0;
    while (i < rest.size() && !is_ear(flat, rest, i)) ++i;
    if (i == rest.size()) return false;
    const std::size_t n = rest.size();
    triangles.push_back({corners[rest[(i + n - 1) % n]], corners[rest[i]], corners[rest[(i + 1) % n]]});
    rest.erase(rest.begin() + static_cast<std::ptrdiff_t>(i));
  }
  // What is left of a polygon whose sides cross may be clockwise.
  constexpr double rounding = 1e-9;
  if (area(flat[rest[0]], flat[rest[1]], flat[rest[2]]) < -rounding * norm(normal)) return false;
  triangles.push_back({corners[rest[0]], corners[rest[1]], corners[rest[2]]});
  return true;
}

}  // namespace trellis
