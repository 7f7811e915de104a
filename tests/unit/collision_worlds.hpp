// SPDX-License-Identifier: GPL-3.0-or-later
// Scenes, queries and a slow reference for the tests of collision checking. The reference shares nothing with the
// backends: it works on the shapes as given (no convex parts), with crossing edges and points in polygons instead of
// separating axes, configuration by configuration.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include <trellis/base/random.hpp>
#include <trellis/collision/checker.hpp>
#include <trellis/scene/planar/scene.hpp>

namespace collision_test {

using namespace trellis;

/// A robot in the reference's form: the given shapes, per body.
struct Case {
  std::string name;
  std::shared_ptr<const Scene> scene;
  Space space;
  std::vector<std::vector<Shape>> bodies;  ///< of the robot, body by body
};

inline Obstacle box(double xmin, double ymin, double xmax, double ymax) {
  return {"", Box2{{xmin, ymin}, {xmax, ymax}}};
}

inline Case make_case(std::string name, World world, Robot robot, std::vector<std::vector<Shape>> bodies) {
  Space space = default_space(robot, world, 1.0 / std::numbers::pi);
  auto scene = std::make_shared<const PlanarScene>(std::move(world), std::move(robot));
  return {std::move(name), std::move(scene), std::move(space), std::move(bodies)};
}

/// The three scenes of the paper.
inline std::vector<Case> paper_cases() {
  const Box2 bounds{{0, 0}, {10, 10}};
  const Shape rectangle = Box2{{-0.3, -0.1}, {0.3, 0.1}};
  const std::vector<std::pair<std::string, std::vector<Obstacle>>> scenes = {
      {"simple_passage", {box(4, 0, 6, 4.75), box(4, 5.25, 6, 10)}},
      {"trap",
       {box(4.5, 0, 5.5, 1.925), box(4.5, 2.075, 5.5, 3.325), box(4.5, 3.475, 5.5, 4.525), box(4.5, 4.675, 5.5, 5.05),
        box(5.3, 5.05, 5.5, 5.55), box(4.5, 5.55, 5.5, 5.925), box(4.5, 6.075, 5.5, 6.95), box(5.3, 6.95, 5.5, 7.45),
        box(4.5, 7.45, 5.5, 8.75), box(4.5, 9.25, 5.5, 10)}},
      {"cup", {box(6.5, 1.5, 7, 8.5), box(3, 1.5, 6.5, 2), box(3, 8, 6.5, 8.5)}}};
  std::vector<Case> cases;
  for (const auto& [name, obstacles] : scenes) {
    cases.push_back(make_case(name, World(bounds, obstacles), Robot::rigid({rectangle}), {{rectangle}}));
  }
  return cases;
}

/// Discs, convex and non-convex polygons and boxes.
inline World mixed_world() {
  return World({{-5, -3}, {6, 5}},
               {{"", Disc{{-3, 2}, 0.8}},
                {"", Disc{{4.5, -1.5}, 0.35}},
                {"", Box2{{-1, -2.5}, {-0.25, -0.5}}},
                {"", Polygon{{{1, 1}, {2.2, 1.3}, {1.9, 2.6}, {0.8, 2.2}}}},
                {"", Polygon{{{-3.5, -2}, {-2, -2}, {-2, -1.6}, {-3.1, -1.6}, {-3.1, -0.2}, {-3.5, -0.2}}}},
                {"", Polygon{{{3, 2}, {5, 2}, {5, 4}, {4.6, 4}, {4.6, 2.4}, {3.4, 2.4}, {3.4, 4}, {3, 4}}}},
                {"", Polygon{{{2, -2}, {2.7, -1.2}, {2, -0.4}, {1.3, -1.2}}}},
                {"", Polygon{{{-1, 3}, {-0.2, 3.2}, {-0.7, 4}}}}});
}

inline std::vector<ConvexShape> convex(const std::vector<Shape>& shapes) {
  return Robot::rigid(shapes).bodies()[0].parts;
}

/// The mixed world with a robot of every kind.
inline std::vector<Case> mixed_cases() {
  const Shape point = Disc{};
  const Shape disc = Disc{{}, 0.3};
  const Shape rectangle = Box2{{-0.4, -0.15}, {0.4, 0.15}};
  const Shape ell = Polygon{{{-0.3, -0.3}, {0.6, -0.3}, {0.6, -0.05}, {0, -0.05}, {0, 0.5}, {-0.3, 0.5}}};
  const Shape kite = Polygon{{{-0.5, 0}, {0, -0.2}, {0.4, 0.1}, {0.1, 0.4}}};
  const Shape off_centre = Disc{{0.4, 0.1}, 0.15};
  const Shape trailer = Box2{{-0.7, -0.12}, {-0.1, 0.12}};
  const Shape link = Box2{{0, -0.05}, {1.2, 0.05}};
  const Shape hand = Polygon{{{0, -0.1}, {0.5, 0}, {0, 0.1}}};

  std::vector<Case> cases;
  cases.push_back(make_case("point", mixed_world(), Robot::point(), {{point}}));
  cases.push_back(make_case("disc", mixed_world(), Robot::disc(0.3), {{disc}}));
  cases.push_back(make_case("rectangle", mixed_world(), Robot::rigid({rectangle}), {{rectangle}}));
  cases.push_back(make_case("rectangle, not turning", mixed_world(), Robot::rigid({rectangle}, false), {{rectangle}}));
  cases.push_back(make_case("ell", mixed_world(), Robot::rigid({ell}), {{ell}}));
  cases.push_back(make_case("kite and disc", mixed_world(), Robot::rigid({kite, off_centre}), {{kite, off_centre}}));
  // In R^2 x SO(2)^2: both angles refer to the world.
  cases.push_back(make_case(
      "car with trailer", mixed_world(),
      Robot("car with trailer", {{convex({rectangle}), -1, {}, 2, true}, {convex({trailer}), 0, {-0.4, 0}, 3, true}}),
      {{rectangle}, {trailer}}));
  cases.push_back(make_case("arm", mixed_world(),
                            Robot("arm",
                                  {{convex({link}), -1, {}, 0, false},
                                   {convex({link}), 0, {1.2, 0}, 1, false},
                                   {convex({hand, disc}), 1, {1.2, 0}, 2, false}},
                                  false, {0.3, 0.1}),
                            {{link}, {link}, {hand, disc}}));
  // Self-collision pairs: links that fold back, and shapes of every kind.
  Arm folding;
  folding.links = {0.9, 0.7, 0.8, 0.6};
  folding.widths = {0.1, 0.08, 0.06, 0.1};
  folding.base = {0.3, 0.1};
  folding.limits = {std::nullopt, std::pair(-2.5, 2.5), std::nullopt, std::pair(-3.0, 1.0)};
  std::vector<std::vector<Shape>> folding_links;
  for (std::size_t i = 0; i < folding.links.size(); ++i) {
    const double half = 0.5 * folding.widths[i];
    folding_links.push_back({Box2{{0, -half}, {folding.links[i], half}}});
  }
  cases.push_back(make_case("folding arm", mixed_world(), Robot::arm(folding), folding_links));
  cases.push_back(make_case("tree of odd bodies", mixed_world(),
                            Robot("tree", {{convex({disc}), -1, {}, 2, false},
                                           {convex({ell}), 0, {0.5, 0}, 3, false},
                                           {convex({kite, off_centre}), 0, {-0.5, 0.2}, 4, true},
                                           {convex({hand, disc}), 1, {0.2, 0.6}, 5, false}})
                                .apart({{3, 0}, {1, 2}, {2, 3}}),
                            {{disc}, {ell}, {kite, off_centre}, {hand, disc}}));
  return cases;
}

// The reference.

inline double to_segment(Vec2 p, Vec2 a, Vec2 b) {
  const Vec2 along = b - a;
  const double t = dot(p - a, along) / dot(along, along);
  return norm(p - (t <= 0 ? a : t >= 1 ? b : a + t * along));
}

inline bool in_polygon(const std::vector<Vec2>& v, Vec2 p) {
  bool inside = false;
  for (std::size_t i = 0, j = v.size() - 1; i < v.size(); j = i++) {
    if ((v[i].y > p.y) != (v[j].y > p.y) && p.x < (v[j].x - v[i].x) * (p.y - v[i].y) / (v[j].y - v[i].y) + v[i].x) {
      inside = !inside;
    }
  }
  return inside;
}

inline bool cross_each_other(Vec2 a, Vec2 b, Vec2 c, Vec2 d) {
  const auto side = [](Vec2 p, Vec2 q, Vec2 r) { return cross(q - p, r - p); };
  return (side(a, b, c) <= 0) != (side(a, b, d) <= 0) && (side(c, d, a) <= 0) != (side(c, d, b) <= 0);
}

inline std::vector<Vec2> outline(const Shape& shape) {
  if (const auto* b = std::get_if<Box2>(&shape)) return rectangle_vertices(*b);
  return std::get<Polygon>(shape).vertices;
}

/// The distance between two closed shapes, 0 in contact.
inline double reference_distance(const Shape& a, const Shape& b) {
  const auto* disc_a = std::get_if<Disc>(&a);
  const auto* disc_b = std::get_if<Disc>(&b);
  if (disc_a != nullptr && disc_b != nullptr) {
    return std::max(0.0, norm(disc_a->centre - disc_b->centre) - disc_a->radius - disc_b->radius);
  }
  if (disc_a != nullptr) return reference_distance(b, a);
  const auto v = outline(a);
  double best = std::numeric_limits<double>::infinity();
  if (disc_b != nullptr) {
    if (in_polygon(v, disc_b->centre)) return 0.0;
    for (std::size_t i = 0, j = v.size() - 1; i < v.size(); j = i++) {
      best = std::min(best, to_segment(disc_b->centre, v[j], v[i]));
    }
    return std::max(0.0, best - disc_b->radius);
  }
  const auto w = outline(b);
  if (in_polygon(v, w[0]) || in_polygon(w, v[0])) return 0.0;
  for (std::size_t i = 0, j = v.size() - 1; i < v.size(); j = i++) {
    for (std::size_t k = 0, l = w.size() - 1; k < w.size(); l = k++) {
      if (cross_each_other(v[j], v[i], w[l], w[k])) return 0.0;
      best = std::min({best, to_segment(v[i], w[l], w[k]), to_segment(w[k], v[j], v[i])});
    }
  }
  return best;
}

inline Shape moved(const Shape& shape, const Pose2& pose) {
  if (const auto* disc = std::get_if<Disc>(&shape)) return Disc{pose(disc->centre), disc->radius};
  Polygon polygon{outline(shape)};
  for (Vec2& v : polygon.vertices) v = pose(v);
  return polygon;
}

/// The distance of the shape to the bounds from inside; negative outside.
inline double reference_margin(const Shape& shape, const Box2& bounds) {
  const auto of_point = [&](Vec2 p) {
    return std::min({p.x - bounds.lo.x, bounds.hi.x - p.x, p.y - bounds.lo.y, bounds.hi.y - p.y});
  };
  if (const auto* disc = std::get_if<Disc>(&shape)) return of_point(disc->centre) - disc->radius;
  double margin = std::numeric_limits<double>::infinity();
  for (const Vec2 v : outline(shape)) margin = std::min(margin, of_point(v));
  return margin;
}

/// The clearance at q: of all bodies to all obstacles and the boundary, and between the bodies of self-collision pairs.
/// Not positive in collision.
inline double reference_clearance(const Case& c, View q) {
  std::vector<Pose2> poses(c.bodies.size());
  planar(*c.scene).robot.place(q, poses);
  double best = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < c.bodies.size(); ++i) {
    for (const Shape& part : c.bodies[i]) {
      const Shape shape = moved(part, poses[i]);
      best = std::min(best, reference_margin(shape, planar(*c.scene).world.bounds()));
      if (best < 0) return best;
      for (const auto& obstacle : planar(*c.scene).world.obstacles()) {
        best = std::min(best, reference_distance(shape, obstacle.shape));
        if (best == 0) return 0;
      }
    }
  }
  for (const auto& [first, second] : planar(*c.scene).robot.pairs()) {
    for (const Shape& part : c.bodies[first]) {
      for (const Shape& other : c.bodies[second]) {
        best = std::min(best, reference_distance(moved(part, poses[first]), moved(other, poses[second])));
        if (best == 0) return 0;
      }
    }
  }
  return best;
}

inline bool reference_valid(const Case& c, View q) { return reference_clearance(c, q) > 0; }

inline MotionReport reference_motion(const Case& c, double resolution, View a, View b) {
  const double bound = planar(*c.scene).robot.displacement_bound(c.space, a, b);
  const int n = std::max(1, static_cast<int>(std::ceil(bound / resolution)));
  Configuration q(c.space.dimension());
  MotionReport report;
  for (const std::uint32_t i : bisection_order(static_cast<std::uint32_t>(n))) {
    const double share = static_cast<double>(i) / n;
    c.space.interpolate(a, b, share, q);
    ++report.checks;
    if (!reference_valid(c, q)) {
      report.invalid_at = share;
      return report;
    }
  }
  report.valid = true;
  return report;
}

inline bool same(const MotionReport& p, const MotionReport& q) {
  return p.valid == q.valid && p.checks == q.checks &&
         (p.invalid_at == q.invalid_at || (std::isnan(p.invalid_at) && std::isnan(q.invalid_at)));
}

/// A random motion: most as long as a planner's steps, some across the space, some from the point on.
inline void random_motion(Stream& stream, const Space& space, Configuration& a, Configuration& b) {
  space.sample_uniform(stream, a);
  space.sample_uniform(stream, b);
  const double distance = space.distance(a, b);
  const double length = stream.uniform() < 0.05 ? stream.uniform(0.0, 5.0) : stream.uniform(0.0, 1.0);
  const Configuration far = b;
  if (length < distance) space.interpolate(a, far, length / distance, b);
}

}  // namespace collision_test
