// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/collision/planar/distance.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace trellis {

namespace {

double squared_distance_to_segment(Vec2 p, Vec2 a, Vec2 b) {
  const Vec2 along = b - a;
  const double t = std::clamp(dot(p - a, along) / dot(along, along), 0.0, 1.0);
  const Vec2 apart = p - (a + t * along);
  return dot(apart, apart);
}

/// Calls f(from, to) for each edge.
template <class F>
void each_edge(const Polygon& polygon, F&& f) {
  const auto& v = polygon.vertices;
  for (std::size_t i = 0, j = v.size() - 1; i < v.size(); j = i++) f(v[j], v[i]);
}

bool contains(const Polygon& polygon, Vec2 p) {
  bool inside = true;
  each_edge(polygon, [&](Vec2 a, Vec2 b) { inside = inside && cross(b - a, p - a) >= 0.0; });
  return inside;
}

/// Whether an edge of `a` separates: all of `b` lies strictly on its outer side.
bool edge_separates(const Polygon& a, const Polygon& b) {
  bool found = false;
  each_edge(a, [&](Vec2 from, Vec2 to) {
    found = found ||
            std::all_of(b.vertices.begin(), b.vertices.end(), [&](Vec2 p) { return cross(to - from, p - from) < 0.0; });
  });
  return found;
}

double squared_distance_to_edges(const Polygon& polygon, Vec2 p) {
  double best = std::numeric_limits<double>::infinity();
  each_edge(polygon, [&](Vec2 a, Vec2 b) { best = std::min(best, squared_distance_to_segment(p, a, b)); });
  return best;
}

double distance(const Disc& a, const Disc& b) { return std::max(0.0, norm(a.centre - b.centre) - a.radius - b.radius); }

double distance(const Disc& a, const Polygon& b) {
  if (contains(b, a.centre)) return 0.0;
  return std::max(0.0, std::sqrt(squared_distance_to_edges(b, a.centre)) - a.radius);
}

double distance(const Polygon& a, const Disc& b) { return distance(b, a); }

double distance(const Polygon& a, const Polygon& b) {
  if (!edge_separates(a, b) && !edge_separates(b, a)) return 0.0;
  // For two disjoint convex polygons, a nearest pair of points contains a vertex of one of them.
  double best = std::numeric_limits<double>::infinity();
  for (const Vec2 p : a.vertices) best = std::min(best, squared_distance_to_edges(b, p));
  for (const Vec2 p : b.vertices) best = std::min(best, squared_distance_to_edges(a, p));
  return std::sqrt(best);
}

/// Returns the nearest point of the segment from a to b.
Vec2 nearest_on_segment(Vec2 p, Vec2 a, Vec2 b) {
  const Vec2 along = b - a;
  return a + std::clamp(dot(p - a, along) / dot(along, along), 0.0, 1.0) * along;
}

/// Returns the nearest point of the polygon's outline.
Vec2 nearest_on_outline(const Polygon& polygon, Vec2 p) {
  Vec2 nearest = polygon.vertices.front();
  double best = std::numeric_limits<double>::infinity();
  each_edge(polygon, [&](Vec2 a, Vec2 b) {
    const Vec2 point = nearest_on_segment(p, a, b);
    const double squared = dot(p - point, p - point);
    if (squared >= best) return;
    best = squared;
    nearest = point;
  });
  return nearest;
}

/// Returns the point of the disc in the direction of p, which lies outside of it.
Vec2 towards(const Disc& disc, Vec2 p) {
  const Vec2 away = p - disc.centre;
  return disc.centre + disc.radius / norm(away) * away;
}

Vec2 nearest_point(const Disc& from, const Disc& of) { return towards(of, from.centre); }
Vec2 nearest_point(const Disc& from, const Polygon& of) { return nearest_on_outline(of, from.centre); }
Vec2 nearest_point(const Polygon& from, const Disc& of) { return towards(of, nearest_on_outline(from, of.centre)); }

Vec2 nearest_point(const Polygon& from, const Polygon& of) {
  Vec2 nearest = of.vertices.front();
  double best = std::numeric_limits<double>::infinity();
  const auto add = [&](Vec2 point, Vec2 other) {
    const double squared = dot(point - other, point - other);
    if (squared >= best) return;
    best = squared;
    nearest = point;
  };
  for (const Vec2 p : from.vertices) add(nearest_on_outline(of, p), p);
  for (const Vec2 p : of.vertices) add(p, nearest_on_outline(from, p));
  return nearest;
}

double penetration_depth(const Disc& a, const Disc& b) { return a.radius + b.radius - norm(a.centre - b.centre); }

// The disc's radius plus the signed distance from its centre to the polygon's outline, positive inside.
double penetration_depth(const Disc& a, const Polygon& b) {
  const double outline = std::sqrt(squared_distance_to_edges(b, a.centre));
  return a.radius + (contains(b, a.centre) ? outline : -outline);
}

double penetration_depth(const Polygon& a, const Disc& b) { return penetration_depth(b, a); }

// Returns the least overlap along the normals of a's edges.
double overlap_along_normals(const Polygon& a, const Polygon& b) {
  double least = std::numeric_limits<double>::infinity();
  each_edge(a, [&](Vec2 from, Vec2 to) {
    const Vec2 along = to - from;
    const Vec2 normal = 1.0 / norm(along) * Vec2{along.y, -along.x};
    double deepest = 0.0;
    for (const Vec2 p : b.vertices) deepest = std::max(deepest, dot(normal, from - p));
    least = std::min(least, deepest);
  });
  return least;
}

// The edge normals of the Minkowski difference are those of the two polygons.
double penetration_depth(const Polygon& a, const Polygon& b) {
  return std::min(overlap_along_normals(a, b), overlap_along_normals(b, a));
}

}  // namespace

void move_shape(const ConvexShape& shape, const Pose2& pose, ConvexShape& out) {
  if (const auto* disc = std::get_if<Disc>(&shape)) {
    out = Disc{pose(disc->centre), disc->radius};
    return;
  }
  const auto& from = std::get<Polygon>(shape).vertices;
  if (!std::holds_alternative<Polygon>(out)) out = Polygon{};
  auto& to = std::get<Polygon>(out).vertices;
  to.resize(from.size());
  std::transform(from.begin(), from.end(), to.begin(), [&](Vec2 p) { return pose(p); });
}

double distance(const ConvexShape& a, const ConvexShape& b) {
  return std::visit([](const auto& s, const auto& t) { return distance(s, t); }, a, b);
}

Vec2 nearest_point(const ConvexShape& from, const ConvexShape& of) {
  return std::visit([](const auto& s, const auto& t) { return nearest_point(s, t); }, from, of);
}

double penetration_depth(const ConvexShape& a, const ConvexShape& b) {
  return std::max(0.0, std::visit([](const auto& s, const auto& t) { return penetration_depth(s, t); }, a, b));
}

double box_distance(const Box2& a, const Box2& b) {
  const double x = std::max({0.0, a.lo.x - b.hi.x, b.lo.x - a.hi.x});
  const double y = std::max({0.0, a.lo.y - b.hi.y, b.lo.y - a.hi.y});
  return norm(Vec2{x, y});
}

double margin_inside(const Box2& inner, const Box2& outer) {
  return std::min({inner.lo.x - outer.lo.x, outer.hi.x - inner.hi.x, inner.lo.y - outer.lo.y, outer.hi.y - inner.hi.y});
}

}  // namespace trellis
