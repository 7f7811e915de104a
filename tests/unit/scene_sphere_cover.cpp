// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <vector>

#include "support/catch.hpp"
#include "unit/scene_spatial.hpp"
#include "unit/scene_spatial_worlds.hpp"

#include <trellis/scene/spatial/sphere_cover.hpp>

using namespace trellis;
using namespace trellis::spatial_tests;

namespace {

using Node = SphereCover::Node;

bool is_mesh(const Solid& solid) { return std::holds_alternative<std::shared_ptr<const Mesh>>(solid.shape); }

bool is_closed(const Solid& solid) {
  return !is_mesh(solid) || std::get<std::shared_ptr<const Mesh>>(solid.shape)->closed();
}

Vec3 point_in(const Box3& box, Stream& stream) {
  const double x = stream.uniform(box.lo.x, box.hi.x), y = stream.uniform(box.lo.y, box.hi.y);
  return {x, y, stream.uniform(box.lo.z, box.hi.z)};
}

/// A point of a random triangle.
Vec3 surface_point(const Mesh& mesh, Stream& stream) {
  const auto at = static_cast<std::size_t>(stream.uniform() * static_cast<double>(mesh.triangles().size()));
  const Triangle& t = mesh.triangles()[at];
  double u = stream.uniform(), v = stream.uniform();
  if (u + v > 1.0) {
    u = 1.0 - u;
    v = 1.0 - v;
  }
  const Vec3 &a = mesh.vertices()[t[0]], &b = mesh.vertices()[t[1]], &c = mesh.vertices()[t[2]];
  return a + u * (b - a) + v * (c - a);
}

bool in_ball(const Node& node, const Vec3& p) { return norm(p - node.centre) <= node.outer + 1e-12; }

/// Whether p is in the balls of some leaf and of all nodes above it.
bool covers(const std::vector<Node>& nodes, std::size_t at, const Vec3& p) {
  const Node& node = nodes[at];
  if (!in_ball(node, p)) return false;
  if (node.count == 0) return true;
  for (std::uint32_t i = 0; i < node.count; ++i) {
    if (covers(nodes, node.first + i, p)) return true;
  }
  return false;
}

}  // namespace

TEST_CASE("a cover's balls contain the solid, at the leaves as at the root") {
  Stream stream(1, "cover", "outer");
  for (int round = 0; round < 60; ++round) {
    const Solid solid{random_shape(stream), random_pose(stream, 2.0)};
    const bool surface = round % 2 == 0;
    const SphereCover cover(solid, surface, stream.uniform(0.1, 0.5));
    const Box3 box = bounding_box(solid);
    for (int i = 0; i < 300; ++i) {
      Vec3 p = point_in(box, stream);
      if (is_mesh(solid) && (surface || !is_closed(solid) || i % 2 == 0)) {
        p = solid.pose(surface_point(*std::get<std::shared_ptr<const Mesh>>(solid.shape), stream));
      } else if (distance_to(solid, p) > 0.0) {
        continue;
      }
      INFO(round << ": " << p.x << " " << p.y << " " << p.z);
      CHECK(covers(cover.nodes(), 0, p));
    }
  }
}

TEST_CASE("a cover's inner balls lie in the solid") {
  Stream stream(2, "cover", "inner");
  std::size_t found = 0;
  for (int round = 0; round < 60; ++round) {
    const Solid solid{random_shape(stream), random_pose(stream, 2.0)};
    const bool surface = round % 2 == 0;
    const SphereCover cover(solid, surface, 0.2);
    for (const Node& node : cover.nodes()) {
      if (!(node.inner > 0.0)) continue;
      ++found;
      CHECK(!(is_mesh(solid) && (surface || !is_closed(solid))));
      const Vec3 u = random_point(stream, 1.0);
      CHECK(distance_to(solid, node.centre + (0.999 * node.inner / norm(u)) * u) <= 1e-12);
    }
  }
  CHECK(found > 1000);
}

TEST_CASE("a cover's balls shrink down to the finest radius, or until there are enough") {
  Stream stream(3, "cover", "tree");
  for (int round = 0; round < 60; ++round) {
    const Solid solid{random_shape(stream), random_pose(stream, 2.0)};
    const double finest = round % 10 == 0 ? 1e-6 : 0.3;
    const SphereCover cover(solid, false, finest);
    const auto& nodes = cover.nodes();
    CHECK(nodes.size() <= SphereCover::most_nodes);
    if (std::holds_alternative<Sphere>(solid.shape)) {
      CHECK(nodes.size() == 1);
      continue;
    }
    if (std::holds_alternative<Capsule>(solid.shape)) continue;
    const bool all = nodes.size() + 2 <= SphereCover::most_nodes;
    for (std::size_t at = 0; at < nodes.size(); ++at) {
      const Node& node = nodes[at];
      if (node.count == 0 && all) CHECK(node.outer <= finest);
      for (std::uint32_t i = 0; i < node.count; ++i) CHECK(node.first + i > at);
    }
  }
}
