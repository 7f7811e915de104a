// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <span>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "support/catch.hpp"

#include <trellis/base/random.hpp>
#include <trellis/scene/spatial/medial_cover.hpp>
#include <trellis/scene/spatial/ranges.hpp>

using namespace trellis;

namespace {

using Shared = std::shared_ptr<const Mesh>;

/// The triangles of a box, of which some may be turned or missing.
struct Soup {
  std::vector<Vec3> vertices;
  std::vector<Triangle> triangles;

  void add(const Box3& box, const std::vector<std::size_t>& turned = {}, const std::vector<std::size_t>& missing = {}) {
    const auto first = static_cast<std::uint32_t>(vertices.size());
    for (const Vec3& corner : corners_of(box)) vertices.push_back(corner);
    constexpr std::array<Triangle, 12> sides{{{0, 2, 3},
                                              {0, 3, 1},
                                              {4, 5, 7},
                                              {4, 7, 6},
                                              {0, 1, 5},
                                              {0, 5, 4},
                                              {2, 6, 7},
                                              {2, 7, 3},
                                              {0, 4, 6},
                                              {0, 6, 2},
                                              {1, 3, 7},
                                              {1, 7, 5}}};
    for (std::size_t i = 0; i < sides.size(); ++i) {
      if (std::find(missing.begin(), missing.end(), i) != missing.end()) continue;
      Triangle t = sides[i];
      if (std::find(turned.begin(), turned.end(), i) != turned.end()) std::swap(t[1], t[2]);
      triangles.push_back({first + t[0], first + t[1], first + t[2]});
    }
  }
  [[nodiscard]] Solid solid(const Pose3& pose = {}) const {
    return {std::make_shared<const Mesh>(vertices, triangles, "mesh"), pose};
  }
};

/// A surface point of a solid that is no sphere.
Vec3 surface_point(const Solid& solid, Stream& stream) {
  const auto angle = [&] { return stream.uniform(-std::numbers::pi, std::numbers::pi); };
  Vec3 p;
  if (const auto* mesh = std::get_if<Shared>(&solid.shape)) {
    const Triangle& t = (*mesh)->triangles()[stream.below((*mesh)->triangles().size())];
    double u = stream.uniform(), v = stream.uniform();
    if (u + v > 1.0) u = 1.0 - u, v = 1.0 - v;
    const auto& vertices = (*mesh)->vertices();
    const Vec3& a = vertices[t[0]];
    p = a + u * (vertices[t[1]] - a) + v * (vertices[t[2]] - a);
  } else if (const auto* box = std::get_if<Cuboid>(&solid.shape)) {
    std::array<double, 3> at{stream.uniform(-0.5, 0.5), stream.uniform(-0.5, 0.5), stream.uniform(-0.5, 0.5)};
    at[stream.below(3)] = stream.uniform() < 0.5 ? -0.5 : 0.5;
    p = {at[0] * box->size.x, at[1] * box->size.y, at[2] * box->size.z};
  } else if (const auto* cylinder = std::get_if<Cylinder>(&solid.shape)) {
    const double turn = angle(), side = stream.uniform();
    const double radius = cylinder->radius * (side < 0.5 ? 1.0 : std::sqrt(stream.uniform()));
    const double z = side < 0.5 ? stream.uniform(-0.5, 0.5) : side < 0.75 ? -0.5 : 0.5;
    p = {radius * std::cos(turn), radius * std::sin(turn), z * cylinder->length};
  } else if (const auto* capsule = std::get_if<Capsule>(&solid.shape)) {
    Vec3 out{stream.normal(), stream.normal(), stream.normal()};
    out = capsule->radius / norm(out) * out;
    const double z = stream.uniform(-0.5, 0.5) * capsule->length;
    p = Vec3{0.0, 0.0, std::copysign(std::max(0.0, 0.5 * capsule->length), out.z)} + out;
    if (stream.uniform() < 0.5) {
      const double turn = angle();
      p = {capsule->radius * std::cos(turn), capsule->radius * std::sin(turn), z};
    }
  }
  return solid.pose(p);
}

bool covered(const MedialCover& cover, const Vec3& p, double margin = 1e-12) {
  return std::any_of(cover.balls.begin(), cover.balls.end(),
                     [&](const BodySphere& ball) { return norm(p - ball.centre) <= ball.radius + margin; });
}

/// The largest distance of points on the balls from the solids.
double protrusion(const MedialCover& cover, const std::vector<Solid>& solids, Stream& stream) {
  double most = 0.0;
  for (const BodySphere& ball : cover.balls) {
    for (int i = 0; i < 100; ++i) {
      Vec3 out{stream.normal(), stream.normal(), stream.normal()};
      const Vec3 p = ball.centre + ball.radius / norm(out) * out;
      double least = std::numeric_limits<double>::infinity();
      for (const Solid& solid : solids) least = std::min(least, distance_to(solid, p));
      most = std::max(most, least);
    }
  }
  return most;
}

/// The distance of a point inside from the surface; negative outside.
double depth_of(const Solid& solid, const Vec3& point) {
  const Vec3 p = solid.pose.inverse()(point);
  if (const auto* mesh = std::get_if<Shared>(&solid.shape)) {
    return contains(**mesh, p) ? distance_to_surface(**mesh, p) : -1.0;
  }
  if (const auto* box = std::get_if<Cuboid>(&solid.shape)) {
    const Vec3 half = 0.5 * box->size;
    return std::min({half.x - std::abs(p.x), half.y - std::abs(p.y), half.z - std::abs(p.z)});
  }
  if (const auto* cylinder = std::get_if<Cylinder>(&solid.shape)) {
    return std::min(cylinder->radius - std::hypot(p.x, p.y), 0.5 * cylinder->length - std::abs(p.z));
  }
  const auto& capsule = std::get<Capsule>(solid.shape);
  return capsule.radius - norm({p.x, p.y, std::max(0.0, std::abs(p.z) - 0.5 * capsule.length)});
}

const Pose3 somewhere{{0.3, -0.2, 1.1}, normalised({0.3, -0.5, 0.2, 0.7})};

struct Case {
  std::string name;
  std::vector<Solid> solids;
  bool has_inside = true;
};

std::vector<Case> cases() {
  std::vector<Case> all;
  const auto add = [&](const std::string& name, std::vector<Solid> solids, bool has_inside = true) {
    all.push_back({name, std::move(solids), has_inside});
  };
  add("box", {{Cuboid{{0.2, 0.1, 0.3}}, somewhere}});
  add("cylinder", {{Cylinder{0.06, 0.25}, somewhere}});
  add("flat cylinder", {{Cylinder{0.12, 0.004}, somewhere}});
  add("capsule", {{Capsule{0.05, 0.4}, somewhere}});
  add("thin plate", {{Cuboid{{0.2, 0.15, 0.0005}}, {}}});
  add("needle", {{Cuboid{{0.3, 0.001, 0.001}}, somewhere}});
  Soup closed, mirrored, mixed, open, sheet, shells, corner, two;
  closed.add({{0, 0, 0}, {0.2, 0.1, 0.1}});
  add("closed mesh", {closed.solid(somewhere)});
  mirrored.add({{-0.2, 0, 0}, {0, 0.1, 0.1}}, {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11});
  add("mirrored mesh", {mirrored.solid()});
  mixed.add({{0, 0, 0}, {0.2, 0.1, 0.1}}, {1, 4, 7, 8});
  add("inconsistent mesh", {mixed.solid(somewhere)}, false);
  open.add({{0, 0, 0}, {0.2, 0.1, 0.1}}, {}, {2, 3});
  add("open mesh", {open.solid()}, false);
  sheet.vertices = {{0, 0, 0}, {0.3, 0, 0}, {0, 0.2, 0.1}};
  sheet.triangles = {{0, 1, 2}};
  add("sheet", {sheet.solid(somewhere)}, false);
  shells.add({{0, 0, 0}, {0.15, 0.1, 0.1}});
  shells.add({{0.1, 0.02, -0.05}, {0.2, 0.08, 0.07}});
  shells.add({{0.4, 0, 0}, {0.45, 0.1, 0.1}});
  add("overlapping and separate shells", {shells.solid()});
  // An L of two boxes that share a side: an edge with four triangles.
  corner.add({{0, 0, 0}, {0.3, 0.1, 0.1}});
  corner.add({{0, 0.1, 0}, {0.1, 0.3, 0.1}});
  add("L of two boxes", {corner.solid(somewhere)});
  add("several solids", {{Cylinder{0.05, 0.2}, somewhere},
                         {Cuboid{{0.1, 0.1, 0.1}}, {{0.35, -0.2, 1.1}, {}}},
                         {Sphere{0.04}, {{0.3, -0.1, 1.2}, {}}},
                         closed.solid(somewhere)});
  return all;
}

}  // namespace

TEST_CASE("medial balls cover every point of a surface, and what is deeper than the excess inside") {
  Stream stream(1, "medial cover", "cover");
  for (const Case& one : cases()) {
    for (const double excess : {0.01, 0.023}) {
      CAPTURE(one.name, excess);
      const MedialCover cover = medial_cover(one.solids, {.excess = excess});
      int outside = 0, deep = 0;
      for (const Solid& solid : one.solids) {
        if (std::holds_alternative<Sphere>(solid.shape)) continue;
        for (int i = 0; i < 4000; ++i) outside += covered(cover, surface_point(solid, stream)) ? 0 : 1;
        if (!one.has_inside) continue;
        const Box3 box = bounding_box(solid);
        for (int i = 0; i < 4000; ++i) {
          const Vec3 p{stream.uniform(box.lo.x, box.hi.x), stream.uniform(box.lo.y, box.hi.y),
                       stream.uniform(box.lo.z, box.hi.z)};
          if (depth_of(solid, p) >= cover.excess) deep += covered(cover, p) ? 0 : 1;
        }
      }
      CHECK(outside == 0);
      CHECK(deep == 0);
    }
  }
}

TEST_CASE("medial balls protrude at most the excess") {
  Stream stream(1, "medial cover", "excess");
  for (const Case& one : cases()) {
    CAPTURE(one.name);
    const CoverOptions options{.excess = 0.01, .most_excess = 0.01};
    const MedialCover cover = medial_cover(one.solids, options);
    CHECK(cover.excess <= options.excess * (1.0 + 1e-6));
    CHECK(medial_cover(one.solids).balls.size() <= CoverOptions().most_balls);
    // What the triangles of a mesh that is not closed enclose counts as inside it, for the balls alone.
    if (one.name == "inconsistent mesh") continue;
    CHECK(protrusion(cover, one.solids, stream) <= cover.excess + 1e-7);
  }
}

TEST_CASE("medial balls are few") {
  const CoverOptions options{.excess = 0.01};
  const Solid box{Cuboid{{0.1, 0.1, 0.3}}, {}};
  CHECK(medial_cover(std::span(&box, 1), options).balls.size() < 150);
  const Solid cylinder{Cylinder{0.06, 0.4}, {}};
  CHECK(medial_cover(std::span(&cylinder, 1), options).balls.size() < 60);
  const Solid capsule{Capsule{0.06, 0.4}, {}};
  CHECK(medial_cover(std::span(&capsule, 1), options).balls.size() < 12);
}

TEST_CASE("spheres are covered by themselves") {
  const std::vector<Solid> solids{{Sphere{0.1}, {{1, 2, 3}, {}}}, {Sphere{0.0}, {}}};
  const MedialCover cover = medial_cover(solids);
  CHECK(cover.excess == 0.0);
  CHECK(cover.balls == std::vector<BodySphere>{{{1, 2, 3}, 0.1}, {{}, 0.0}});
  CHECK(medial_cover({}).balls.empty());
}

TEST_CASE("a link that needs many balls has a larger excess, up to a limit") {
  const Solid large{Cuboid{{1.0, 0.6, 0.01}}, {}};
  const MedialCover cover = medial_cover(std::span(&large, 1));
  CHECK(cover.excess > CoverOptions().excess);
  CHECK(cover.excess <= 0.03 * (1.0 + 1e-6));
  // What a caller asks for holds, whatever it costs.
  const MedialCover exact = medial_cover(std::span(&large, 1), {.excess = 0.02, .most_excess = 0.02});
  CHECK(exact.excess <= 0.02 * (1.0 + 1e-6));
  CHECK(exact.balls.size() > 200);
  // Only the time is bounded.
  const Solid huge{Cuboid{{100, 100, 100}}, {}};
  const MedialCover coarse = medial_cover(std::span(&huge, 1), {.excess = 0.01, .most_excess = 0.01});
  CHECK(coarse.excess > 1.0);
  CHECK(coarse.excess < 5.0);
}

TEST_CASE("a cover depends on its arguments alone") {
  for (const Case& one : cases()) {
    CAPTURE(one.name);
    CHECK(medial_cover(one.solids).balls == medial_cover(one.solids).balls);
  }
}
