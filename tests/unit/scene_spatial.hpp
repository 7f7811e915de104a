// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include <trellis/base/random.hpp>
#include <trellis/scene/spatial/shapes.hpp>

#include "support/fault.hpp"

// Meshes and random parts for the tests of scenes in space.

namespace trellis::spatial_tests {

using test::fault_of;

constexpr double pi = std::numbers::pi;
constexpr double inf = std::numeric_limits<double>::infinity();

/// A box in the format OBJ.
inline std::string box_text(double x, double y, double z) {
  std::string text;
  for (const double a : {0.0, x}) {
    for (const double b : {0.0, y}) {
      for (const double c : {0.0, z}) {
        text += "v " + std::to_string(a) + " " + std::to_string(b) + " " + std::to_string(c) + "\n";
      }
    }
  }
  return text + "f 1 2 4 3\nf 5 7 8 6\nf 1 5 6 2\nf 3 4 8 7\nf 1 3 7 5\nf 2 6 8 4\n";
}

/// Vertices and triangles before they are a mesh.
struct Soup {
  std::vector<Vec3> vertices;
  std::vector<Triangle> triangles;

  void append(const Soup& other) {
    const auto offset = static_cast<std::uint32_t>(vertices.size());
    vertices.insert(vertices.end(), other.vertices.begin(), other.vertices.end());
    for (const Triangle& t : other.triangles) triangles.push_back({t[0] + offset, t[1] + offset, t[2] + offset});
  }
  [[nodiscard]] Soup turned() const {
    Soup result = *this;
    for (Triangle& t : result.triangles) std::swap(t[1], t[2]);
    return result;
  }
  [[nodiscard]] Mesh mesh(const std::string& what = "mesh") const { return {vertices, triangles, what}; }
};

inline Soup box(const Vec3& lo, const Vec3& hi) {
  Soup soup;
  for (unsigned i = 0; i < 8; ++i) {
    soup.vertices.push_back({(i & 1U) != 0 ? hi.x : lo.x, (i & 2U) != 0 ? hi.y : lo.y, (i & 4U) != 0 ? hi.z : lo.z});
  }
  soup.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                    {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return soup;
}

/// A torus about z, which is closed and not convex.
inline Soup torus(double large, double small, std::uint32_t around, std::uint32_t along) {
  Soup soup;
  for (std::uint32_t i = 0; i < around; ++i) {
    for (std::uint32_t k = 0; k < along; ++k) {
      const double a = 2.0 * pi * i / around, b = 2.0 * pi * k / along;
      const double r = large + small * std::cos(b);
      soup.vertices.push_back({r * std::cos(a), r * std::sin(a), small * std::sin(b)});
      const auto id = [&](std::uint32_t m, std::uint32_t n) { return (m % around) * along + n % along; };
      soup.triangles.push_back({id(i, k), id(i + 1, k), id(i + 1, k + 1)});
      soup.triangles.push_back({id(i, k), id(i + 1, k + 1), id(i, k + 1)});
    }
  }
  return soup;
}

inline Vec3 random_point(Stream& stream, double half) {
  const double x = stream.uniform(-half, half), y = stream.uniform(-half, half), z = stream.uniform(-half, half);
  return {x, y, z};
}

inline Pose3 random_pose(Stream& stream, double half) {
  const double u = stream.uniform(), v = stream.uniform(), w = stream.uniform();
  return {random_point(stream, half), rotation_from_unit({u, v, w})};
}

}  // namespace trellis::spatial_tests
