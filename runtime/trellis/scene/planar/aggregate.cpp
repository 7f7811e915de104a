// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/scene/planar/aggregate.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <tuple>
#include <utility>

#include <trellis/scene/merging.hpp>

namespace trellis {

namespace {

/// The number of edges of the circumscribed polygon that replaces a disc in a hull.
constexpr int disc_vertices = 32;

/// Obstacles and their common hull.
struct Cluster {
  std::vector<std::size_t> obstacles;
  std::vector<Polygon> parts;  ///< convex, counter-clockwise; circumscribed polygons of discs
  std::vector<Vec2> points;    ///< the hull's vertices
  Box2 box;
};

double distance_to_segment(Vec2 p, Vec2 a, Vec2 b) {
  const Vec2 along = b - a;
  const double squared = dot(along, along);
  const double t = squared > 0.0 ? std::clamp(dot(p - a, along) / squared, 0.0, 1.0) : 0.0;
  return norm(p - (a + t * along));
}

/// Returns the distance from a point to a closed convex polygon.
double distance_to(const Polygon& polygon, Vec2 p) {
  const auto& vertices = polygon.vertices;
  bool inside = true;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    const Vec2 a = vertices[i];
    const Vec2 b = vertices[(i + 1) % vertices.size()];
    inside = inside && cross(b - a, p - a) >= 0.0;
    least = std::min(least, distance_to_segment(p, a, b));
  }
  return inside ? 0.0 : least;
}

double distance_to(const std::vector<Polygon>& parts, Vec2 p) {
  double least = std::numeric_limits<double>::infinity();
  for (const auto& part : parts) least = std::min(least, distance_to(part, p));
  return least;
}

/// Returns the largest distance from the hull's outline to the parts; infinity where it exceeds `most`.
double error_of(const Polygon& hull, const std::vector<Polygon>& parts, double most) {
  double error = 0.0;
  for (std::size_t i = 0; i < hull.vertices.size(); ++i) {
    const Vec2 a = hull.vertices[i];
    const Vec2 b = hull.vertices[(i + 1) % hull.vertices.size()];
    const auto pieces = static_cast<int>(std::ceil(norm(b - a) / (0.1 * most)));
    for (int k = 1; k < pieces; ++k) {
      error = std::max(error, distance_to(parts, a + (static_cast<double>(k) / pieces) * (b - a)));
      if (error > most) return std::numeric_limits<double>::infinity();
    }
  }
  return error;
}

Polygon about(const Disc& disc) {
  Polygon polygon;
  const double step = 2.0 * std::numbers::pi / disc_vertices;
  const double corner = disc.radius / std::cos(0.5 * step);
  for (int i = 0; i < disc_vertices; ++i) {
    const double angle = (i + 0.5) * step;
    polygon.vertices.push_back(disc.centre + corner * Vec2{std::cos(angle), std::sin(angle)});
  }
  return polygon;
}

std::vector<Cluster> singles(const World& world) {
  std::vector<Cluster> clusters(world.obstacles().size());
  for (const auto& part : world.parts()) {
    Cluster& cluster = clusters[part.obstacle];
    const auto* disc = std::get_if<Disc>(&part.shape);
    cluster.parts.push_back(disc != nullptr ? about(*disc) : std::get<Polygon>(part.shape));
  }
  for (std::size_t i = 0; i < clusters.size(); ++i) {
    clusters[i].obstacles = {i};
    for (const auto& part : clusters[i].parts) {
      clusters[i].points.insert(clusters[i].points.end(), part.vertices.begin(), part.vertices.end());
    }
    clusters[i].box = bounding_box(clusters[i].points);
  }
  return clusters;
}

/// Merges two clusters; the result stores only the points of their common hull.
Cluster merged(const Cluster& a, const Cluster& b) {
  Cluster both = a;
  both.obstacles.insert(both.obstacles.end(), b.obstacles.begin(), b.obstacles.end());
  both.parts.insert(both.parts.end(), b.parts.begin(), b.parts.end());
  both.points.insert(both.points.end(), b.points.begin(), b.points.end());
  both.points = convex_hull(std::move(both.points)).vertices;
  both.box = bounding_box(both.points);
  return both;
}

bool near(const Box2& a, const Box2& b, double gap) {
  return a.lo.x - b.hi.x <= gap && b.lo.x - a.hi.x <= gap && a.lo.y - b.hi.y <= gap && b.lo.y - a.hi.y <= gap;
}

/// Returns the error of the hull of two clusters if it is small enough. In the middle of a gap, a hull's point is half
/// the gap's width from either obstacle.
std::optional<double> error_of_both(const std::vector<Cluster>& clusters, std::size_t a, std::size_t b, double most) {
  if (!near(clusters[a].box, clusters[b].box, 2.0 * most)) return std::nullopt;
  const Cluster both = merged(clusters[a], clusters[b]);
  const double error = error_of({both.points}, both.parts, most);
  if (error > most) return std::nullopt;
  return error;
}

}  // namespace

Polygon convex_hull(std::vector<Vec2> points) {
  std::sort(points.begin(), points.end(), [](Vec2 a, Vec2 b) { return std::tie(a.x, a.y) < std::tie(b.x, b.y); });
  Polygon hull;
  auto& chain = hull.vertices;
  const auto extend = [&](Vec2 p, std::size_t least) {
    while (chain.size() > least && cross(chain.back() - chain[chain.size() - 2], p - chain.back()) <= 0.0) {
      chain.pop_back();
    }
    chain.push_back(p);
  };
  for (const Vec2 p : points) extend(p, 1);
  const std::size_t lower = chain.size();
  for (auto p = points.rbegin() + 1; p != points.rend(); ++p) extend(*p, lower);
  chain.pop_back();
  return hull;
}

World aggregated(const World& world, double error) {
  if (!(error > 0.0)) return world;
  std::vector<Cluster> clusters = singles(world);
  const std::vector<char> gone = merge_bottom_up(
      clusters, [&](std::size_t a, std::size_t b) { return error_of_both(clusters, a, b, error); }, merged);
  std::vector<Obstacle> obstacles;
  for (std::size_t i = 0; i < clusters.size(); ++i) {
    if (gone[i] != 0) continue;
    const auto& members = clusters[i].obstacles;
    if (members.size() > 1) {
      obstacles.push_back(
          {fmt::format("hull of {} obstacles, {} and others", members.size(), world.obstacles()[members.front()].name),
           Polygon{clusters[i].points}});
    } else {
      obstacles.push_back(world.obstacles()[members.front()]);
    }
  }
  return {world.bounds(), std::move(obstacles)};
}

}  // namespace trellis
