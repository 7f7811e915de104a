// SPDX-License-Identifier: GPL-3.0-or-later
// Cells of free space: free, disjoint, joined where they meet, found where their samples are; of the plane and of
// space.
#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include <trellis/base/error.hpp>
#include <trellis/base/random.hpp>
#include <trellis/scene/cells.hpp>
#include <trellis/scene/spatial/free_distance.hpp>
#include <trellis/scene/spatial/octree_cells.hpp>
#include <trellis/scene/spatial/scene.hpp>

#include "support/catch.hpp"
#include "unit/scene_spatial.hpp"

using namespace trellis;

namespace {

World3 blocks(Contain contain = Contain::robot) {
  Stream stream(3, "0", "blocks");
  std::vector<Obstacle3> all;
  for (int i = 0; i < 10; ++i) {
    const Vec3 centre{stream.uniform(1, 9), stream.uniform(1, 5), stream.uniform(1, 3)};
    all.push_back(
        {"block", {Cuboid{{stream.uniform(0.5, 2), stream.uniform(0.5, 2), stream.uniform(0.5, 2)}}, {centre, {}}}});
  }
  const auto torus = std::make_shared<const Mesh>(spatial_tests::torus(1.0, 0.3, 12, 8).mesh("torus"));
  all.push_back({"torus", {torus, {{5, 3, 2}, {}}}});
  return {{{0, 0, 0}, {10, 6, 4}}, all, contain};
}

bool meet(const Box3& a, const Box3& b) {
  constexpr double touch = 1e-9;
  const auto along = [&](double lo, double hi, double from, double to) {
    return std::min(hi, to) - std::max(lo, from);
  };
  const double x = along(a.lo.x, a.hi.x, b.lo.x, b.hi.x);
  const double y = along(a.lo.y, a.hi.y, b.lo.y, b.hi.y);
  const double z = along(a.lo.z, a.hi.z, b.lo.z, b.hi.z);
  const int sides = (x > touch ? 1 : 0) + (y > touch ? 1 : 0) + (z > touch ? 1 : 0);
  return sides == 2 && std::min({x, y, z}) > -touch;
}

bool inside(const Box3& box, const Vec3& p) {
  return p.x >= box.lo.x && p.y >= box.lo.y && p.z >= box.lo.z && p.x <= box.hi.x && p.y <= box.hi.y && p.z <= box.hi.z;
}

}  // namespace

TEST_CASE("boxes of an octree are free, and each has those beyond its sides as neighbours", "[scene][cells]") {
  const World3 world = blocks();
  const OctreeCells cells(world, 1.0, 0.2);
  const FreeDistance distance(world);
  REQUIRE(cells.size() > 500);
  double volume = 0.0;
  Stream stream(1, "0", "cells");
  Configuration p(3);
  for (std::uint32_t a = 0; a < cells.size(); ++a) {
    const Box3 box = cells.box(a);
    volume += cells.volume(a);
    for (int i = 0; i < 20; ++i) {
      cells.sample(a, stream, p);
      CHECK(distance({p[0], p[1], p[2]}) > 0.0);
      CHECK(cells.find(p) == a);
    }
    cells.centre(a, p);
    CHECK(cells.find(p) == a);
    std::vector<std::uint32_t> expected;
    for (std::uint32_t b = 0; b < cells.size(); ++b) {
      if (b != a && meet(box, cells.box(b))) expected.push_back(b);
    }
    std::vector<std::uint32_t> found;
    for (const auto& neighbour : cells.neighbours(a)) {
      found.push_back(neighbour.cell);
      const Vec3 middle{neighbour.middle[0], neighbour.middle[1], neighbour.middle[2]};
      const Vec3 slack{1e-9, 1e-9, 1e-9};
      CHECK(inside({box.lo - slack, box.hi + slack}, middle));
      const Box3 other = cells.box(neighbour.cell);
      CHECK(inside({other.lo - slack, other.hi + slack}, middle));
    }
    CHECK(found == expected);
  }
  CHECK(volume == Approx(cells.volume()));
}

TEST_CASE("points with the distance that is needed lie in a cell, those in obstacles in none", "[scene][cells]") {
  for (const Contain contain : {Contain::robot, Contain::reference}) {
    const World3 world = blocks(contain);
    const OctreeCells cells(world, 1.0, 0.25);
    const FreeDistance distance(world);
    const double needed = std::max(0.25, norm(cells.smallest()));
    CHECK(needed < 0.5);
    Stream stream(2, "0", "points");
    int wide = 0;
    for (int i = 0; i < 20000; ++i) {
      const std::array<double, 3> p = {stream.uniform(0, 10), stream.uniform(0, 6), stream.uniform(0, 4)};
      const double here = distance({p[0], p[1], p[2]});
      if (here < 0.0) CHECK_FALSE(cells.find(p));
      if (here < needed) continue;
      ++wide;
      CHECK(cells.find(p));
    }
    CHECK(wide > 1000);
    CHECK_FALSE(cells.find(std::array{-0.1, 1.0, 1.0}));
  }
}

TEST_CASE("a world without obstacles is all cells, a full one has none, and too small cells are refused",
          "[scene][cells]") {
  const SpatialScene open(World3({{0, 0, 0}, {3, 2, 1}}, {}, Contain::reference), Robot3::point());
  const auto cells = free_cells(open, 1.0, 0.0);
  CHECK(cells->size() == 6);
  CHECK(cells->volume() == Approx(6.0));
  const SpatialScene full(World3({{0, 0, 0}, {1, 1, 1}}, {{"all", {Cuboid{{4, 4, 4}}, {}}}}), Robot3::point());
  CHECK(free_cells(full, 0.5, 0.0)->size() == 0);
  CHECK_THROWS_AS(free_cells(open, 0.001, 0.0), Error);
}

TEST_CASE("threads with copies of a world share its cells, those with other worlds or sizes do not", "[scene][cells]") {
  const SpatialScene first(blocks(), Robot3::point());
  const SpatialScene copy(first.world, Robot3::point());
  const SpatialScene alike(blocks(), Robot3::point());
  std::vector<std::shared_ptr<const Cells>> of(4);
  {
    std::vector<std::jthread> threads;
    for (std::size_t i = 0; i < of.size(); ++i) {
      threads.emplace_back([&, i] { of[i] = free_cells(i % 2 == 0 ? first : copy, 1.0, 0.3); });
    }
  }
  for (const auto& cells : of) CHECK(cells == of.front());
  CHECK(free_cells(alike, 1.0, 0.3) != of.front());
  CHECK(free_cells(alike, 1.0, 0.3)->size() == of.front()->size());
  for (const double size : {0.8, 0.9, 1.1, 1.2, 1.3}) CHECK(free_cells(first, size, 0.3) != of.front());
  // Only the last few sizes are kept; the cells of others are made again.
  CHECK(free_cells(first, 1.0, 0.3)->size() == of.front()->size());
  CHECK(free_cells(first, 1.0, 0.3) == free_cells(copy, 1.0, 0.3));
}
