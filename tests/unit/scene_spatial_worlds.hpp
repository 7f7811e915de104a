// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <memory>
#include <utility>
#include <vector>

#include "unit/scene_spatial.hpp"

#include <trellis/scene/spatial/world.hpp>

// Worlds of space with obstacles of every kind, for the tests of distances and collisions.

namespace trellis::spatial_tests {

constexpr double world_half = 5.0;
inline const Box3 bounds{{-world_half, -world_half, -world_half}, {world_half, world_half, world_half}};

inline std::shared_ptr<const Mesh> shared(const Soup& soup) { return std::make_shared<const Mesh>(soup.mesh()); }

inline Soup open_box(const Vec3& lo, const Vec3& hi) {
  Soup soup = box(lo, hi);
  soup.triangles.resize(10);
  return soup;
}

/// A box with a cavity.
inline Soup nested() {
  Soup soup = box({-1, -1, -1}, {1, 1, 1});
  soup.append(box({-0.6, -0.6, -0.6}, {0.6, 0.6, 0.6}).turned());
  return soup;
}

/// Two boxes that do not touch.
inline Soup apart(const Vec3& half) {
  Soup soup = box({-1.0 - half.x, -half.y, -half.z}, {-1.0, half.y, half.z});
  soup.append(box({1.0, -half.y, -half.z}, {1.0 + half.x, half.y, half.z}));
  return soup;
}

/// A shape with lengths of 0.2 m to `most`, each kind as often.
inline Shape3 random_shape(Stream& stream, double most = 2.0) {
  const double a = stream.uniform(0.2, most), b = stream.uniform(0.2, most), c = stream.uniform(0.2, most);
  switch (static_cast<int>(stream.uniform(0.0, 9.0))) {
    case 0: return Sphere{a};
    case 1: return Cuboid{{a, b, c}};
    case 2: return Cylinder{a, b};
    case 3: return Capsule{0.5 * a, b};
    case 4: return shared(box({-a, -b, -c}, {a, b, c}));
    case 5: return shared(torus(1.0 + a, 0.4 * b, 12, 8));
    case 6: return shared(nested());
    case 7: return shared(apart({a, b, c}));
    default: return shared(open_box({-a, -b, -c}, {a, b, c}));
  }
}

inline World3 random_world(Stream& stream, std::size_t count, bool surface, Contain contain = Contain::robot) {
  std::vector<Obstacle3> obstacles;
  for (std::size_t i = 0; i < count; ++i) {
    Shape3 shape = random_shape(stream);
    obstacles.push_back({"", {std::move(shape), random_pose(stream, world_half)}});
  }
  return {bounds, std::move(obstacles), contain, surface};
}

}  // namespace trellis::spatial_tests
