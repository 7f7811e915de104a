// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/collision/planar/segment.hpp>

#include <algorithm>
#include <cmath>
#include <utility>
#include <variant>

#include <trellis/collision/planar/distance.hpp>

namespace trellis {

namespace {

/// Parameters between which a segment is in contact; empty where lo > hi.
struct Clip {
  double lo = 0.0;
  double hi = 1.0;

  /// Keeps the parameters t with at + t * change <= limit.
  void below(double at, double change, double limit) {
    if (change > 0.0) hi = std::min(hi, (limit - at) / change);
    if (change < 0.0) lo = std::max(lo, (limit - at) / change);
  }
  [[nodiscard]] double middle() const { return std::clamp(0.5 * (lo + hi), 0.0, 1.0); }
};

double nearest_parameter(const Segment2& segment, Vec2 p) {
  const double squared = dot(segment.along, segment.along);
  return squared > 0.0 ? std::clamp(dot(p - segment.from, segment.along) / squared, 0.0, 1.0) : 0.0;
}

std::optional<double> contact_of_rectangle(const Segment2& s, const kernel::Piece& o, double reach) {
  const Vec2 to = s.from + s.along;
  const auto [x_lo, x_hi] = std::minmax(s.from.x, to.x);
  const auto [y_lo, y_hi] = std::minmax(s.from.y, to.y);
  if (x_lo > o.xhi + reach || x_hi < o.xlo - reach || y_lo > o.yhi + reach || y_hi < o.ylo - reach) return {};
  // The segment's normal, times the segment's length.
  const Vec2 towards = Vec2{o.x, o.y} - s.from;
  const double extent = o.hx * std::abs(s.along.y) + o.hy * std::abs(s.along.x) + reach * norm(s.along);
  if (std::abs(cross(s.along, towards)) > extent) return {};
  Clip clip;
  clip.below(s.from.x, s.along.x, o.xhi + reach);
  clip.below(-s.from.x, -s.along.x, reach - o.xlo);
  clip.below(s.from.y, s.along.y, o.yhi + reach);
  clip.below(-s.from.y, -s.along.y, reach - o.ylo);
  return clip.middle();
}

std::optional<double> contact_of_disc(const Segment2& s, const kernel::Piece& o, double reach) {
  const double t = nearest_parameter(s, {o.x, o.y});
  if (norm(Vec2{o.x, o.y} - (s.from + t * s.along)) > o.radius + reach) return {};
  return t;
}

std::optional<double> contact_of_polygon(const Segment2& s, const kernel::Piece& o, double reach) {
  const Vec2 to = s.from + s.along;
  const double length = norm(s.along);
  bool left = true;
  bool right = true;
  Clip clip;
  for (unsigned k = 0; k < o.edge_count; ++k) {
    const kernel::Edge& e = o.edges[k];
    const Vec2 normal{e.nx, e.ny};
    const double limit = e.offset + reach;
    if (std::min(dot(normal, s.from), dot(normal, to)) > limit) return {};
    clip.below(dot(normal, s.from), dot(normal, s.along), limit);
    const double side = cross(s.along, Vec2{e.x, e.y} - s.from);
    left = left && side > 2.0 * reach * length;
    right = right && side < -2.0 * reach * length;
  }
  if (left || right) return {};
  return clip.middle();
}

Polygon moved_outwards(const Polygon& polygon, double by) {
  const auto& v = polygon.vertices;
  const auto normal_of = [&](std::size_t i) {
    const Vec2 edge = v[(i + 1) % v.size()] - v[i];
    return 1.0 / norm(edge) * Vec2{edge.y, -edge.x};
  };
  Polygon result;
  result.vertices.reserve(2 * v.size());
  Vec2 before = normal_of(v.size() - 1);
  for (std::size_t i = 0; i < v.size(); ++i) {
    const Vec2 after = normal_of(i);
    const auto corner = [&](Vec2 first, Vec2 second) {
      result.vertices.push_back(v[i] + by / (1.0 + dot(first, second)) * (first + second));
    };
    if (dot(before, after) >= 0.0) {
      corner(before, after);
    } else {
      const double half = 0.5 * std::atan2(cross(before, after), dot(before, after));
      const Vec2 between = std::cos(half) * before + std::sin(half) * Vec2{-before.y, before.x};
      corner(before, between);
      corner(between, after);
    }
    before = after;
  }
  return result;
}

bool is_rectangle(const Polygon& polygon, const Box2& box) {
  const auto corners = rectangle_vertices(box);
  return polygon.vertices.size() == corners.size() &&
         std::is_permutation(corners.begin(), corners.end(), polygon.vertices.begin());
}

}  // namespace

std::optional<double> contact(const Segment2& segment, const kernel::Piece& piece, double reach) {
  switch (piece.kind) {
    case kernel::Kind::rectangle: return contact_of_rectangle(segment, piece, reach);
    case kernel::Kind::disc: return contact_of_disc(segment, piece, reach);
    case kernel::Kind::polygon: return contact_of_polygon(segment, piece, reach);
  }
  return {};
}

double distance(const Segment2& segment, const ConvexShape& shape) {
  if (segment.along == Vec2{}) return distance(ConvexShape(Disc{segment.from, 0.0}), shape);
  if (const auto* disc = std::get_if<Disc>(&shape)) {
    const double t = nearest_parameter(segment, disc->centre);
    return std::max(0.0, norm(disc->centre - (segment.from + t * segment.along)) - disc->radius);
  }
  return distance(ConvexShape(Polygon{{segment.from, segment.from + segment.along}}), shape);
}

Polygon swept(const Polygon& polygon, Vec2 along) {
  const auto& v = polygon.vertices;
  const auto leads = [&](std::size_t i) { return cross(v[(i + 1) % v.size()] - v[i], along) < 0.0; };
  Polygon result;
  result.vertices.reserve(v.size() + 2);
  bool before = leads(v.size() - 1);
  for (std::size_t i = 0; i < v.size(); ++i) {
    const bool after = leads(i);
    result.vertices.push_back(before ? v[i] + along : v[i]);
    if (before != after) result.vertices.push_back(after ? v[i] + along : v[i]);
    before = after;
  }
  return result;
}

ConvexShape inflated(const ConvexShape& shape, double by) {
  if (const auto* disc = std::get_if<Disc>(&shape)) return Disc{disc->centre, disc->radius + by};
  const auto& polygon = std::get<Polygon>(shape);
  const Box2 box = bounding_box(shape);
  const Vec2 margin{by, by};
  if (is_rectangle(polygon, box)) return Polygon{rectangle_vertices({box.lo - margin, box.hi + margin})};
  return moved_outwards(polygon, by);
}

}  // namespace trellis
