// SPDX-License-Identifier: GPL-3.0-or-later
// Shapes at the edge of what is a shape: touching edges, collinear vertices, slivers, coordinates of 1e-6 and 1e6. The
// two backends give the same result at every pose that is farther from contact than the tolerance.
//
// TRELLIS_POSES sets the number of poses of each case (default 20000; half of them are bisected towards contact).
#include <algorithm>
#include <cstddef>
#include <cstdlib>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "collision_worlds.hpp"
#include "support/catch.hpp"

using namespace collision_test;
using Catch::Matchers::Contains;

namespace {

constexpr double contact = 1e-9;  // metres

std::size_t poses() {
  const char* set = std::getenv("TRELLIS_POSES");  // NOLINT(concurrency-mt-unsafe): nothing here sets it
  return set != nullptr ? std::strtoull(set, nullptr, 10) : 20'000;
}

/// A checker may count a gap of up to 2^-43 of the world's size as touching.
double tolerance(const Case& c) {
  const Box2& bounds = planar(*c.scene).world.bounds();
  const Vec2 size = bounds.hi - bounds.lo;
  const double largest = std::max(
      {std::abs(bounds.lo.x), std::abs(bounds.lo.y), std::abs(bounds.hi.x), std::abs(bounds.hi.y), size.x, size.y});
  return std::max(contact, 0x1p-41 * largest);
}

/// Whether the reference's answer changes within the tolerance.
bool at_contact(const Case& c, View q) {
  const double reach = tolerance(c);
  const bool valid = reference_valid(c, q);
  if (valid && reference_clearance(c, q) <= reach) return true;
  constexpr int directions = 32;
  Configuration moved(q.begin(), q.end());
  for (int i = 0; i < directions; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / directions;
    moved[0] = q[0] + reach * std::cos(angle);
    moved[1] = q[1] + reach * std::sin(angle);
    if (reference_valid(c, moved) != valid) return true;
  }
  return false;
}

/// Draws a pose; every second one is bisected between a valid and an invalid one.
void draw(Stream& stream, const Case& c, const Checker& checker, bool near, Configuration& q) {
  c.space.sample_uniform(stream, q);
  if (!near) return;
  Configuration other(q.size());
  c.space.sample_uniform(stream, other);
  const bool valid = checker.valid(q);
  if (checker.valid(other) == valid) return;
  Configuration middle(q.size());
  for (std::uint64_t steps = 5 + stream.below(45); steps > 0; --steps) {
    c.space.interpolate(q, other, 0.5, middle);
    (checker.valid(middle) == valid ? q : other) = middle;
  }
}

struct Differences {
  std::size_t at_contact = 0;
  std::size_t beyond = 0;
};

Differences compare(const Case& c, std::size_t count) {
  const auto planar = make_planar_checker(c.scene, c.space, 0.05);
  const auto fcl = make_fcl_checker(c.scene, c.space, 0.05);
  Stream stream(21, c.name, "edges");
  Configuration q(c.space.dimension());
  Differences found;
  for (std::size_t i = 0; i < count; ++i) {
    draw(stream, c, *planar, i % 2 == 1, q);
    if (planar->valid(q) == fcl->valid(q)) continue;
    const bool near = at_contact(c, q);
    ++(near ? found.at_contact : found.beyond);
    if (!near) {
      UNSCOPED_INFO(c.name << ": (" << q[0] << ", " << q[1] << ", " << (q.size() > 2 ? q[2] : 0.0) << "): planar "
                           << planar->valid(q) << ", reference " << reference_valid(c, q));
    }
  }
  return found;
}

Obstacle polygon(std::vector<Vec2> vertices) { return {"", Polygon{std::move(vertices)}}; }

/// Edges and corners that touch, an edge on the boundary, a vertex on an edge.
World touching() {
  return World({{0, 0}, {10, 10}}, {box(2, 2, 4, 4),
                                    box(4, 2, 6, 4),
                                    box(6, 4, 8, 6),
                                    box(0, 8, 3, 10),
                                    polygon({{3, 4}, {4, 6}, {2, 6}}),
                                    polygon({{8, 4}, {10, 3}, {10, 5}}),
                                    {"", Disc{{5, 7}, 1}},
                                    {"", Disc{{5, 5}, 1}}});
}

/// Vertices in the middle of straight edges, some of them 1e-9 m from each other.
World collinear() {
  return World({{0, 0}, {10, 10}},
               {polygon({{2, 2}, {3, 2}, {3 + 1e-9, 2}, {4, 2}, {5, 2}, {5, 3}, {5, 4}, {4, 4}, {2, 4}, {2, 3}}),
                polygon({{6, 6}, {7, 6}, {8, 6}, {8, 9}, {7.5, 9}, {7, 9}, {7, 8}, {7, 7}, {6.5, 7}, {6, 7}}),
                polygon({{1, 6}, {2, 6.5}, {3, 7}, {2, 8}})});
}

/// Shapes of a length of metres and a width of 1 mm, 1 um and 1 nm; teeth of a comb.
World slivers() {
  return World({{0, 0}, {10, 10}},
               {polygon({{1, 1}, {9, 1}, {5, 1 + 1e-3}}), polygon({{1, 3}, {9, 3.5}, {9, 3.5 + 1e-6}}),
                polygon({{1, 5}, {9, 5}, {9, 5 + 1e-9}}), box(2, 6, 2 + 1e-6, 9),
                polygon({{4, 7}, {8, 7}, {8, 9}, {8 - 1e-4, 7.5}, {6, 7.5}, {6, 9}, {6 - 1e-4, 7.5}, {4, 7.5}})});
}

Vec2 moved_by(Vec2 p, double scale, Vec2 offset) { return {scale * p.x + offset.x, scale * p.y + offset.y}; }

/// The mixed world, scaled and moved.
World scaled(double scale, Vec2 offset) {
  const World world = mixed_world();
  const auto at = [&](Vec2 p) { return moved_by(p, scale, offset); };
  std::vector<Obstacle> obstacles;
  for (const Obstacle& obstacle : world.obstacles()) {
    if (const auto* disc = std::get_if<Disc>(&obstacle.shape)) {
      obstacles.push_back({"", Disc{at(disc->centre), scale * disc->radius}});
    } else if (const auto* rectangle = std::get_if<Box2>(&obstacle.shape)) {
      obstacles.push_back({"", Box2{at(rectangle->lo), at(rectangle->hi)}});
    } else {
      Polygon all = std::get<Polygon>(obstacle.shape);
      for (Vec2& v : all.vertices) v = at(v);
      obstacles.push_back({"", std::move(all)});
    }
  }
  return World({at(world.bounds().lo), at(world.bounds().hi)}, std::move(obstacles));
}

/// The world with each kind of robot, `size` times as large as in a world of ten metres.
void add(std::vector<Case>& cases, const std::string& name, const World& world, double size) {
  const Shape rectangle = Box2{{-0.4 * size, -0.15 * size}, {0.4 * size, 0.15 * size}};
  const Shape sliver = Polygon{{{-0.5 * size, 0}, {0.5 * size, -1e-7 * size}, {0.5 * size, 1e-7 * size}}};
  const Shape ell = Polygon{{{-0.3 * size, -0.3 * size},
                             {0.6 * size, -0.3 * size},
                             {0.6 * size, -0.05 * size},
                             {0, -0.05 * size},
                             {0, 0.5 * size},
                             {-0.3 * size, 0.5 * size}}};
  cases.push_back(make_case(name + ", disc", world, Robot::disc(0.3 * size), {{Disc{{}, 0.3 * size}}}));
  for (const auto& [kind, shape] :
       {std::pair("rectangle", rectangle), std::pair("sliver", sliver), std::pair("ell", ell)}) {
    cases.push_back(make_case(name + ", " + kind, world, Robot::rigid({shape}), {{shape}}));
  }
}

std::vector<Case> all_cases() {
  std::vector<Case> cases;
  add(cases, "touching", touching(), 1.0);
  add(cases, "collinear", collinear(), 1.0);
  add(cases, "slivers", slivers(), 1.0);
  add(cases, "micrometres", scaled(1e-6, {0, 0}), 1e-6);
  add(cases, "far away", scaled(1.0, {1e6, -1e6}), 1.0);
  add(cases, "megametres", scaled(1e6, {0, 0}), 1e6);
  return cases;
}

}  // namespace

TEST_CASE("the backends agree on touching edges, collinear vertices, slivers, and coordinates of 1e-6 and 1e6",
          "[edges][slow]") {
  for (const Case& c : all_cases()) {
    const Differences found = compare(c, poses());
    INFO(c.name << ": " << found.at_contact << " differences at contact");
    CHECK(found.beyond == 0);
  }
}

TEST_CASE("a degenerate shape is refused, and its vertex named") {
  const auto refused = [](std::vector<Vec2> vertices) {
    try {
      World({{0, 0}, {10, 10}}, {polygon(std::move(vertices))});
    } catch (const Error& error) {
      return std::string(error.what());
    }
    return std::string("accepted");
  };
  CHECK_THAT(refused({{1, 1}, {2, 1}, {2, 1}, {1, 2}}), Contains("vertices 2 and 3 are the same point (2, 1)"));
  CHECK_THAT(refused({{1, 1}, {2, 1}, {1, 2}, {1, 1}}),
             Contains("vertices 1 and 4 are the same point") && Contains("joined to the first by itself"));
  CHECK_THAT(refused({{1, 1}, {2, 2}, {3, 3}}), Contains("all vertices lie on one line"));
  CHECK_THAT(refused({{1, 1}, {4, 1}, {2, 1}, {2, 3}}), Contains("the edge from vertex 2 to vertex 3 runs back over"));
  CHECK_THAT(refused({{1, 1}, {3, 3}, {3, 1}, {1, 3}}),
             Contains("the edge from vertex 1 to vertex 2 meets the edge from vertex 3 to vertex 4"));
  CHECK_THAT(refused({{1, 1}, {5, 1}, {5, 5}, {3, 1}, {1, 5}}), Contains("meets the edge from vertex"));
  CHECK_THAT(refused({{1, 1}, {2, 1}, {1e10, 2}}), Contains("vertex 3 must lie within"));
  CHECK_THAT(refused({{1, 1}, {2, std::numeric_limits<double>::quiet_NaN()}, {1, 2}}), Contains("vertex 2"));
}
