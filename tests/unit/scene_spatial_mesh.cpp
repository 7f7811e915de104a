// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "support/catch.hpp"
#include "unit/scene_spatial.hpp"

#include <trellis/scene/spatial/mesh.hpp>

using namespace trellis;
using namespace trellis::spatial_tests;
using Catch::Matchers::Contains;

namespace {

double norm_of_normals(const Mesh& mesh) {
  Vec3 sum;
  for (const Triangle& t : mesh.triangles()) {
    const Vec3& a = mesh.vertices()[t[0]];
    sum = sum + cross(mesh.vertices()[t[1]] - a, mesh.vertices()[t[2]] - a);
  }
  return norm(sum);
}

/// The distance from a triangle by minimisation over a fine lattice of its points.
double lattice_distance(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c, int steps) {
  double least = inf;
  for (int i = 0; i <= steps; ++i) {
    for (int k = 0; k <= steps - i; ++k) {
      const double s = static_cast<double>(i) / steps, t = static_cast<double>(k) / steps;
      least = std::min(least, norm(p - (a + s * (b - a) + t * (c - a))));
    }
  }
  return least;
}

}  // namespace

TEST_CASE("a box as a mesh is closed, convex and has its volume", "[scene][spatial]") {
  const Mesh mesh = box({-1, 0, 2}, {3, 1, 4}).mesh();
  CHECK(mesh.closed());
  CHECK(mesh.convex());
  CHECK(mesh.volume() == Approx(8));
  CHECK(mesh.bounds() == Box3{{-1, 0, 2}, {3, 1, 4}});
  CHECK(mesh.vertices().size() == 8);
}

TEST_CASE("triangles that share no vertices make the same mesh, but for the order", "[scene][spatial]") {
  const Soup shared = box({0, 0, 0}, {1, 2, 3});
  Soup apart;
  for (const Triangle& t : shared.triangles) {
    const auto first = static_cast<std::uint32_t>(apart.vertices.size());
    for (const std::uint32_t v : t) apart.vertices.push_back(shared.vertices[v]);
    apart.triangles.push_back({first, first + 1, first + 2});
  }
  const Mesh mesh = apart.mesh();
  CHECK(mesh.vertices().size() == 8);
  CHECK(mesh.closed());
  CHECK(mesh.volume() == Approx(6));
  SECTION("and -0 is 0") {
    Soup signs = apart;
    for (std::size_t i = 0; i < signs.vertices.size(); i += 2) {
      Vec3& v = signs.vertices[i];
      if (v.x == 0.0) v.x = -0.0;
    }
    CHECK(signs.mesh().vertices().size() == 8);
    CHECK(signs.mesh().hash() == mesh.hash());
  }
}

TEST_CASE("vertices that no triangle names are left out", "[scene][spatial]") {
  Soup soup = box({0, 0, 0}, {1, 1, 1});
  const std::uint64_t hash = soup.mesh().hash();
  soup.vertices.push_back({100, 100, 100});
  CHECK(soup.mesh().vertices().size() == 8);
  CHECK(soup.mesh().bounds().hi == Vec3{1, 1, 1});
  CHECK(soup.mesh().hash() == hash);
}

TEST_CASE("a mesh with a hole, a doubled triangle or an inconsistent one is not closed", "[scene][spatial]") {
  const Soup whole = box({0, 0, 0}, {1, 1, 1});
  for (std::size_t i = 0; i < whole.triangles.size(); ++i) {
    Soup hole = whole;
    hole.triangles.erase(hole.triangles.begin() + static_cast<std::ptrdiff_t>(i));
    CHECK_FALSE(hole.mesh().closed());
    CHECK(hole.mesh().volume() == 0.0);
    Soup doubled = whole;
    doubled.triangles.push_back(whole.triangles[i]);
    CHECK_FALSE(doubled.mesh().closed());
    Soup turned = whole;
    std::swap(turned.triangles[i][0], turned.triangles[i][1]);
    CHECK_FALSE(turned.mesh().closed());
    CHECK_FALSE(turned.mesh().convex());
    CHECK_FALSE(contains(turned.mesh(), {0.5, 0.5, 0.5}));
  }
}

TEST_CASE("clockwise components are turned, and cavities stay", "[scene][spatial]") {
  const Soup outer = box({0, 0, 0}, {4, 4, 4});
  const Soup inner = box({1, 1, 1}, {3, 3, 3});
  const Soup beside = box({10, 0, 0}, {11, 1, 1});
  SECTION("one component") { CHECK(outer.turned().mesh().volume() == Approx(64)); }
  SECTION("side by side, one of them clockwise") {
    Soup soup = outer;
    soup.append(beside.turned());
    CHECK(soup.mesh().volume() == Approx(65));
    CHECK_FALSE(soup.mesh().convex());
  }
  SECTION("a cavity, and the same with all turned") {
    Soup soup = outer;
    soup.append(inner.turned());
    soup.append(beside);
    for (const Soup& given : {soup, soup.turned()}) {
      const Mesh mesh = given.mesh();
      CHECK(mesh.volume() == Approx(64 - 8 + 1));
      CHECK(contains(mesh, {0.5, 2, 2}));
      CHECK_FALSE(contains(mesh, {2, 2, 2}));
      CHECK(contains(mesh, {10.5, 0.5, 0.5}));
      CHECK_FALSE(contains(mesh, {6, 2, 2}));
      CHECK_FALSE(mesh.convex());
    }
  }
  SECTION("a clockwise one whose box lies within a torus, but in its hole") {
    Soup soup = torus(4, 1, 40, 20);
    soup.append(box({-0.5, -0.5, -0.5}, {0.5, 0.5, 0.5}).turned());
    const Mesh mesh = soup.mesh();
    CHECK(contains(mesh, {0, 0, 0}));
    CHECK(contains(mesh, {4, 0, 0}));
    CHECK_FALSE(contains(mesh, {2, 0, 0}));
  }
  SECTION("a part inside a cavity") {
    Soup soup = outer;
    soup.append(inner.turned());
    soup.append(box({1.5, 1.5, 1.5}, {2.5, 2.5, 2.5}));
    CHECK(contains(soup.turned().mesh(), {2, 2, 2}));
    CHECK_FALSE(contains(soup.turned().mesh(), {1.2, 2, 2}));
  }
}

TEST_CASE("solids that touch in a face, an edge or a corner make a closed mesh", "[scene][spatial]") {
  const Soup first = box({0, 0, 0}, {1, 1, 1});
  for (const Vec3& at : {Vec3{1, 0, 0}, Vec3{1, 1, 0}, Vec3{1, 1, 1}}) {
    const Soup second = box(at, at + Vec3{1, 1, 1});
    for (const Soup& other : {second, second.turned()}) {
      Soup soup = first;
      soup.append(other);
      const Mesh mesh = soup.mesh();
      CHECK(mesh.closed());
      CHECK_FALSE(mesh.convex());
      CHECK(mesh.volume() == Approx(2));
      CHECK(contains(mesh, {0.5, 0.5, 0.5}));
      CHECK(contains(mesh, at + Vec3{0.5, 0.5, 0.5}));
      CHECK_FALSE(contains(mesh, {0.5, 0.5, 1.5}));
    }
  }
}

TEST_CASE("the inside of a mesh is that of the solid, also on rays through vertices and edges", "[scene][spatial]") {
  const Mesh ring = torus(3, 1, 24, 12).mesh();
  REQUIRE(ring.closed());
  CHECK_FALSE(ring.convex());
  CHECK(norm_of_normals(ring) < 1e-12);
  Stream stream(1, "0", "tests");
  std::size_t inside = 0;
  for (int i = 0; i < 3000; ++i) {
    const Vec3 p = random_point(stream, 4.2);
    const double off = std::hypot(std::hypot(p.x, p.y) - 3.0, p.z);
    // Between the tube of the flat facets and the round one, either may be.
    if (off > 0.93 && off < 1.01) continue;
    REQUIRE(contains(ring, p) == (off < 0.97));
    inside += off < 0.97 ? 1 : 0;
  }
  CHECK(inside > 100);
  // The lattice of a box's own coordinates: rays run through vertices, along edges and within faces.
  const Mesh cube = box({0, 0, 0}, {4, 4, 4}).mesh();
  for (int x = -1; x <= 5; ++x) {
    for (int y = -1; y <= 5; ++y) {
      for (int z = -1; z <= 5; ++z) {
        const bool in = std::min({x, y, z}) > 0 && std::max({x, y, z}) < 4;
        const bool out = std::min({x, y, z}) < 0 || std::max({x, y, z}) > 4;
        if (in || out) REQUIRE(contains(cube, {double(x), double(y), double(z)}) == in);
      }
    }
  }
}

TEST_CASE("a surface that bends outwards everywhere and winds twice is not convex", "[scene][spatial]") {
  // Two tips over a star of five points: each edge is convex, and the middle is inside twice.
  Soup soup;
  for (int i = 0; i < 5; ++i) {
    const double angle = 4.0 * pi * i / 5.0;
    soup.vertices.push_back({std::cos(angle), std::sin(angle), 0});
  }
  soup.vertices.push_back({0, 0, 1});
  soup.vertices.push_back({0, 0, -1});
  for (std::uint32_t i = 0; i < 5; ++i) {
    soup.triangles.push_back({i, (i + 1) % 5, 5});
    soup.triangles.push_back({(i + 1) % 5, i, 6});
  }
  const Mesh mesh = soup.mesh();
  CHECK(mesh.closed());
  CHECK_FALSE(mesh.convex());
}

TEST_CASE("the convex hull contains its points, is convex and has no other vertices", "[scene][spatial]") {
  Stream stream(2, "0", "tests");
  for (int round = 0; round < 40; ++round) {
    std::vector<Vec3> points;
    const std::size_t count = 4 + stream.below(60);
    // Every other one on a lattice, with many points in planes.
    for (std::size_t i = 0; i < count; ++i) {
      Vec3 p = random_point(stream, 2);
      if (round % 2 == 1) p = {std::round(p.x), std::round(p.y), std::round(p.z)};
      points.push_back(p);
    }
    if (round % 2 == 1) points.insert(points.end(), {{-2, -2, -2}, {2, -2, -2}, {-2, 2, -2}, {-2, -2, 2}});
    const Mesh hull = Mesh::hull(points, "hull");
    REQUIRE(hull.closed());
    REQUIRE(hull.convex());
    double greatest = -inf;
    for (const Triangle& t : hull.triangles()) {
      const Vec3& a = hull.vertices()[t[0]];
      const Vec3 normal = cross(hull.vertices()[t[1]] - a, hull.vertices()[t[2]] - a);
      for (const Vec3& p : points) greatest = std::max(greatest, dot(normal, p - a) / norm(normal));
    }
    CHECK(greatest < 1e-12);
    for (const Vec3& v : hull.vertices()) CHECK(std::count(points.begin(), points.end(), v) >= 1);
    // Brute force: a triangle of points with all others on one side belongs to the hull's surface.
    double support = 0.0;
    for (int i = 0; i < 20; ++i) {
      const Vec3 way = random_point(stream, 1);
      const auto farthest = [&](const std::vector<Vec3>& of) {
        double most = -inf;
        for (const Vec3& p : of) most = std::max(most, dot(way, p));
        return most;
      };
      support = std::max(support, std::abs(farthest(points) - farthest(hull.vertices())));
    }
    CHECK(support == 0.0);
    CHECK(Mesh(hull.vertices(), hull.triangles(), "again").convex());
  }
}

TEST_CASE("points in a plane have no hull", "[scene][spatial]") {
  CHECK_THAT(fault_of([] {
               Mesh::hull({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, "part 3");
             }),
             Contains("part 3: a convex hull needs four points that do not lie in one plane, got 3"));
  const std::vector<Vec3> flat{{0, 0, 1}, {1, 0, 1}, {0, 1, 1}, {1, 1, 1}, {0.5, 0.5, 1}};
  CHECK_THAT(fault_of([&] { Mesh::hull(flat, "part"); }), Contains("in one plane"));
  CHECK_THAT(fault_of([&] { Mesh::hull(std::vector<Vec3>(9, Vec3{1, 2, 3}), "part"); }), Contains("in one plane"));
  // In a plane but for rounding.
  std::vector<Vec3> tilted;
  tilted.reserve(flat.size());
  for (const Vec3& p : flat) tilted.push_back(rotation_of({0.3, 0.2, 0.1})(p));
  CHECK_THAT(fault_of([&] { Mesh::hull(tilted, "part"); }), Contains("in one plane"));
  CHECK_THAT(fault_of([] {
               Mesh::hull({{0, 0, 0}, {1, inf, 0}, {0, 1, 0}, {0, 0, 1}}, "part");
             }),
             Contains("part: point 2 must lie within"));
}

TEST_CASE("the distance from a triangle agrees with a search over its points", "[scene][spatial]") {
  Stream stream(3, "0", "tests");
  for (int i = 0; i < 300; ++i) {
    const Vec3 a = random_point(stream, 1), b = random_point(stream, 1), c = random_point(stream, 1);
    const Vec3 p = random_point(stream, 2);
    const double brute = lattice_distance(p, a, b, c, 60);
    const double exact = distance_to_triangle(p, a, b, c);
    REQUIRE(exact <= brute + 1e-12);
    REQUIRE(exact >= brute - 0.06);
  }
  CHECK(distance_to_surface(box({0, 0, 0}, {4, 4, 4}).mesh(), {2, 2, 3.5}) == Approx(0.5));
}

TEST_CASE("a scaled mesh is the same about the origin", "[scene][spatial]") {
  const Mesh mesh = torus(3, 1, 12, 8).mesh();
  const Mesh half = mesh.scaled(0.5);
  CHECK(half.closed());
  CHECK(half.volume() == Approx(mesh.volume() / 8));
  CHECK(half.bounds().hi == 0.5 * mesh.bounds().hi);
  CHECK(half.hash() != mesh.hash());
  CHECK(half.scaled(2).hash() == mesh.hash());
  CHECK_THAT(fault_of([&] { static_cast<void>(mesh.scaled(1e9)); }), Contains("cannot be scaled by 1000000000"));
  CHECK_THAT(fault_of([&] { static_cast<void>(mesh.scaled(0)); }), Contains("greater than 0"));
}

TEST_CASE("faults of a mesh name the vertex or the triangle", "[scene][spatial]") {
  const Soup good = box({0, 0, 0}, {1, 1, 1});
  const auto fault = [&](auto&& change) {
    Soup soup = good;
    change(soup);
    return fault_of([&] { static_cast<void>(soup.mesh("obstacle 3 (a.obj)")); });
  };
  CHECK(fault([](Soup&) {}).empty());
  CHECK_THAT(fault([](Soup& s) { s.vertices[4].y = std::nan(""); }),
             Contains("obstacle 3 (a.obj): vertex 5 must lie within 1e+09 m of 0"));
  CHECK_THAT(fault([](Soup& s) { s.vertices[0].z = -inf; }), Contains("vertex 1 must lie"));
  CHECK_THAT(fault([](Soup& s) { s.vertices[7].x = 1.1e9; }), Contains("vertex 8 must lie"));
  CHECK_THAT(fault([](Soup& s) { s.triangles[2][1] = 8; }), Contains("triangle 3 names vertex 9, but there are 8"));
  CHECK_THAT(fault([](Soup& s) { s.triangles[2][1] = 0xffffffff; }), Contains("names vertex 4294967296"));
  CHECK_THAT(fault([](Soup& s) {
               s.triangles[1] = {4, 5, 4};
             }),
             Contains("triangle 2 names vertices 5, 6 and 5; they must be three different ones"));
  CHECK_THAT(fault([](Soup& s) { s.vertices[1] = {0, 0.5, 0}; }), Contains("triangle 1 has no area"));
  CHECK_THAT(fault([](Soup& s) { s.triangles.clear(); }), Contains("at least one triangle"));
  CHECK_THAT(fault([](Soup& s) { s.triangles.resize(Mesh::most_triangles + 1, s.triangles[0]); }),
             Contains("at most 2000000 triangles, got 2000001"));
}
