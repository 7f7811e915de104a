// SPDX-License-Identifier: GPL-3.0-or-later
// Pairs of meshes: what compare_surfaces says beside distances of points and intersections of segments.
#include <algorithm>
#include <cmath>
#include <memory>

#include "support/catch.hpp"
#include "unit/scene_spatial.hpp"
#include "unit/scene_spatial_worlds.hpp"

#include <trellis/collision/spatial/surface_pair.hpp>

using namespace trellis;
using namespace trellis::spatial_tests;

namespace {

using Corners = std::array<Vec3, 3>;

/// A second implementation: where the segment meets the triangle, by Cramer's rule.
bool crosses(const Vec3& p, const Vec3& q, const Corners& t) {
  const Vec3 u = t[1] - t[0], v = t[2] - t[0], w = p - q, from = p - t[0];
  const double det = dot(u, cross(v, w));
  const double a = dot(from, cross(v, w)) / det, b = dot(u, cross(from, w)) / det, s = dot(u, cross(v, from)) / det;
  return a >= 0.0 && b >= 0.0 && a + b <= 1.0 && s >= 0.0 && s <= 1.0;
}

bool cross_each_other(const Corners& a, const Corners& b) {
  for (std::size_t i = 0; i < 3; ++i) {
    if (crosses(a[i], a[(i + 1) % 3], b) || crosses(b[i], b[(i + 1) % 3], a)) return true;
  }
  return false;
}

Vec3 random_point_of(Stream& stream, const Corners& t) {
  double a = stream.uniform(), b = stream.uniform();
  if (a + b > 1.0) {
    a = 1.0 - a;
    b = 1.0 - b;
  }
  return t[0] + a * (t[1] - t[0]) + b * (t[2] - t[0]);
}

MeshDistance random_mesh(Stream& stream) {
  const double a = stream.uniform(0.2, 2.0), b = stream.uniform(0.2, 2.0), c = stream.uniform(0.2, 2.0);
  switch (stream.below(4)) {
    case 0: return MeshDistance(shared(box({-a, -b, -c}, {a, b, c})));
    case 1: return MeshDistance(shared(torus(1.0 + a, 0.4 * b, 12, 8)));
    case 2: return MeshDistance(shared(open_box({-a, -b, -c}, {a, b, c})));
    default: return MeshDistance(shared(apart({a, b, c})));
  }
}

}  // namespace

TEST_CASE("the comparison of two surfaces is right for their points and triangles") {
  Stream stream(1, "surfaces", "pairs");
  int apart_count = 0, meet_count = 0, unknown_count = 0;
  for (int round = 0; round < 3000; ++round) {
    const MeshDistance first = random_mesh(stream), second = random_mesh(stream);
    const Pose3 pose = random_pose(stream, 3.0);
    const double margin = round % 2 == 0 ? 1e-6 : 0.1;
    TrianglePair guess{static_cast<std::uint32_t>(stream.below(1000)), static_cast<std::uint32_t>(stream.below(1000))};
    const SurfacePair pair = compare_surfaces(first, second, Turn(pose), margin, guess);
    INFO(round);
    if (pair == SurfacePair::meet) {
      ++meet_count;
      Corners a = first.corners().at(guess.first);
      for (Vec3& corner : a) corner = pose(corner);
      CHECK(cross_each_other(a, second.corners().at(guess.second)));
      continue;
    }
    bool met = false;
    double least = inf;
    for (const Corners& corners : first.corners()) {
      Corners a = corners;
      for (Vec3& corner : a) corner = pose(corner);
      met = met || std::any_of(second.corners().begin(), second.corners().end(),
                               [&](const Corners& b) { return cross_each_other(a, b); });
      for (int i = 0; i < 5; ++i) least = std::min(least, second.to_surface(random_point_of(stream, a)));
    }
    if (pair == SurfacePair::apart) {
      ++apart_count;
      CHECK(!met);
      CHECK(least > margin);
    } else {
      ++unknown_count;
      // Only what is near contact is left open: no random pose is within a micrometre of it.
      CHECK(margin > 1e-3);
    }
  }
  CHECK(apart_count > 300);
  CHECK(meet_count > 300);
  CHECK(unknown_count > 10);
}

TEST_CASE("surfaces nearer than the margin are neither apart nor do they meet") {
  const MeshDistance cube(shared(box({-1, -1, -1}, {1, 1, 1})));
  TrianglePair guess;
  const auto at = [&](double x, double margin) {
    return compare_surfaces(cube, cube, Turn(Pose3{{x, 0.3, 0.2}, {}}), margin, guess);
  };
  CHECK(at(2.2, 0.1) == SurfacePair::apart);
  CHECK(at(2.2, 0.3) == SurfacePair::unknown);
  CHECK(at(2.0, 1e-9) == SurfacePair::unknown);
  CHECK(at(1.5, 0.01) == SurfacePair::meet);
  // One inside the other: no surface reaches the other one.
  const MeshDistance room(shared(box({-5, -5, -5}, {5, 5, 5})));
  CHECK(compare_surfaces(cube, room, Turn(Pose3{{1, 1, 1}, {}}), 0.1, guess) == SurfacePair::apart);
  CHECK(compare_surfaces(room, cube, Turn(Pose3{{1, 1, 1}, {}}), 0.1, guess) == SurfacePair::apart);
}
