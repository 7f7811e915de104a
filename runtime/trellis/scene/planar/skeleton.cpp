// SPDX-License-Identifier: GPL-3.0-or-later
// The medial axis in four steps: the boundary of the free space as segments (union of obstacles and boundary walls),
// their Voronoi diagram, its edges as sampled pieces clipped to the free space, and the graph of the joined pieces.
#include <trellis/scene/planar/skeleton.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <functional>
#include <iterator>
#include <limits>
#include <numbers>
#include <numeric>
#include <optional>
#include <tuple>
#include <utility>

#include <trellis/base/error.hpp>
#include <trellis/scene/planar/planar_box_tree.hpp>
#include <trellis/scene/planar/polygon.hpp>
#include <trellis/scene/planar/segment_voronoi.hpp>
#include <trellis/scene/set_up_cache.hpp>

namespace trellis {

namespace {

bool before(Vec2 a, Vec2 b) { return std::tie(a.x, a.y) < std::tie(b.x, b.y); }

/// The distance to the nearest obstacle or to the boundary. Zero or negative at points that are not free.
class Clearance {
 public:
  Clearance(const Box2& bounds, const std::vector<ConvexShape>& shapes) : bounds_(bounds) {
    std::vector<Box2> boxes;
    boxes.reserve(shapes.size());
    for (const auto& shape : shapes) boxes.push_back(bounding_box(shape));
    tree_ = PlanarBoxTree(boxes);
    shapes_.reserve(shapes.size());
    for (const std::uint32_t i : tree_.order()) shapes_.push_back(shapes[i]);
  }

  double operator()(Vec2 p) const {
    double nearest = std::min({p.x - bounds_.lo.x, bounds_.hi.x - p.x, p.y - bounds_.lo.y, bounds_.hi.y - p.y});
    if (nearest <= 0.0) return nearest;
    // Allow for rounding, so that the order of equally near obstacles does not change the last digit.
    double squared = (1.0 + 1e-12) * nearest * nearest;
    const auto bound = [&](const Box2& box) {
      const double dx = std::max({box.lo.x - p.x, p.x - box.hi.x, 0.0});
      const double dy = std::max({box.lo.y - p.y, p.y - box.hi.y, 0.0});
      return dx * dx + dy * dy;
    };
    tree_.nearest(squared, bound, [&](std::size_t rank) {
      nearest = std::min(nearest, to(shapes_[rank], p));
      squared = nearest > 0.0 ? (1.0 + 1e-12) * nearest * nearest : 0.0;
    });
    return nearest;
  }

 private:
  static double to(const ConvexShape& shape, Vec2 p) {
    if (const auto* disc = std::get_if<Disc>(&shape)) return norm(p - disc->centre) - disc->radius;
    const auto& vertices = std::get<Polygon>(shape).vertices;
    double squared = std::numeric_limits<double>::infinity();
    bool inside = true;
    for (std::size_t i = 0; i < vertices.size(); ++i) {
      const Vec2 along = vertices[(i + 1) % vertices.size()] - vertices[i];
      const Vec2 off = p - vertices[i];
      inside = inside && cross(along, off) >= 0.0;
      const Vec2 rest = off - std::clamp(dot(off, along) / dot(along, along), 0.0, 1.0) * along;
      squared = std::min(squared, dot(rest, rest));
    }
    return inside ? -std::sqrt(squared) : std::sqrt(squared);
  }

  Box2 bounds_;
  PlanarBoxTree tree_;
  std::vector<ConvexShape> shapes_;  ///< in the tree's order
};

// ---- the boundary of the free space ----------------------------------------------------------------------------

constexpr int no_disc = -1;

/// The boundary of the free space as segments, with the disc, if any, that each end point and segment approximates.
struct Border {
  std::vector<Vec2> points;
  std::vector<int> point_disc;
  std::vector<std::pair<std::size_t, std::size_t>> segments;
  std::vector<int> segment_disc;
  std::vector<Disc> discs;
};

/// Returns a regular polygon inscribed in the disc. Inscribed, so that the polygonal free space contains the true one:
/// the diagram then has every passage of the true free space. The exact clearance later clips points that are too near.
Polygon inscribed_polygon(const Disc& disc, int vertices) {
  Polygon polygon;
  for (int i = 0; i < vertices; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / vertices;
    polygon.vertices.push_back(disc.centre + disc.radius * Vec2{std::cos(angle), std::sin(angle)});
  }
  return polygon;
}

/// Returns the world's parts, with discs as polygons where `disc_vertices` > 0.
std::vector<ConvexShape> shapes_of(const World& world, int disc_vertices) {
  std::vector<ConvexShape> shapes;
  for (const auto& part : world.parts()) {
    const auto* disc = std::get_if<Disc>(&part.shape);
    shapes.push_back(disc != nullptr && disc_vertices > 0 ? ConvexShape(inscribed_polygon(*disc, disc_vertices))
                                                          : part.shape);
  }
  return shapes;
}

/// Whether the segment (a, b) lies on an edge of the polygon.
bool along_edge(const Polygon& polygon, Vec2 a, Vec2 b, double tolerance) {
  const auto& v = polygon.vertices;
  for (std::size_t i = 0; i < v.size(); ++i) {
    const Vec2 start = v[i], edge = v[(i + 1) % v.size()] - v[i];
    const double length = norm(edge);
    const auto on_edge = [&](Vec2 p) {
      const double t = dot(p - start, edge) / length;
      return std::abs(cross(edge, p - start)) <= tolerance * length && t >= -tolerance && t <= length + tolerance;
    };
    if (on_edge(a) && on_edge(b)) return true;
  }
  return false;
}

Border border_of(const World& world, int disc_vertices, double tolerance) {
  Border border;
  std::vector<Polygon> solid;
  for (const auto& obstacle : world.obstacles()) {
    if (const auto* box = std::get_if<Box2>(&obstacle.shape)) {
      solid.push_back({rectangle_vertices(*box)});
    } else if (const auto* disc = std::get_if<Disc>(&obstacle.shape)) {
      border.discs.push_back(*disc);
    } else {
      solid.push_back(std::get<Polygon>(obstacle.shape));
    }
  }
  // CGAL's union has a canonical order; sort the discs too, so that the order of the input does not matter.
  std::sort(border.discs.begin(), border.discs.end(), [](const Disc& a, const Disc& b) {
    return std::tie(a.centre.x, a.centre.y, a.radius) < std::tie(b.centre.x, b.centre.y, b.radius);
  });
  std::vector<Polygon> disc_polygons;
  for (const Disc& disc : border.discs) disc_polygons.push_back(inscribed_polygon(disc, disc_vertices));
  solid.insert(solid.end(), disc_polygons.begin(), disc_polygons.end());

  Box2 extent = world.bounds();
  for (const Polygon& polygon : solid) extent = united(extent, bounding_box(polygon.vertices));
  // Walls around the boundary that are thick enough to contain all obstacles' parts beyond it: the free space is then
  // the region inside the union's outermost loop.
  const auto& [lo, hi] = world.bounds();
  const double margin = norm(hi - lo);
  extent.lo = extent.lo - Vec2{margin, margin};
  extent.hi = extent.hi + Vec2{margin, margin};
  solid.push_back({rectangle_vertices({extent.lo, {lo.x, extent.hi.y}})});
  solid.push_back({rectangle_vertices({{hi.x, extent.lo.y}, extent.hi})});
  solid.push_back({rectangle_vertices({extent.lo, {extent.hi.x, lo.y}})});
  solid.push_back({rectangle_vertices({{extent.lo.x, hi.y}, extent.hi})});

  std::vector<Polygon> loops;
  for (auto& piece : polygon_union(solid)) {
    // The outermost loop bounds no free space.
    const auto& outer = piece.outer.vertices;
    if (std::find(outer.begin(), outer.end(), extent.lo) == outer.end()) loops.push_back(std::move(piece.outer));
    std::move(piece.holes.begin(), piece.holes.end(), std::back_inserter(loops));
  }

  std::vector<Box2> disc_boxes;
  for (const Disc& disc : border.discs) {
    const Vec2 reach{disc.radius + tolerance, disc.radius + tolerance};
    disc_boxes.push_back({disc.centre - reach, disc.centre + reach});
  }
  const PlanarBoxTree disc_tree(disc_boxes);
  for (const auto& loop : loops) {
    const std::size_t first = border.points.size(), n = loop.vertices.size();
    for (std::size_t i = 0; i < n; ++i) {
      const Vec2 a = loop.vertices[i], b = loop.vertices[(i + 1) % n];
      int source = no_disc;
      disc_tree.each(
          [&](const Box2& box) { return box.lo.x <= a.x && a.x <= box.hi.x && box.lo.y <= a.y && a.y <= box.hi.y; },
          [&](std::uint32_t item) {
            const int d = static_cast<int>(item);
            if (source != no_disc && source < d) return;
            if (norm(a - border.discs[item].centre) > border.discs[item].radius + tolerance) return;
            if (along_edge(disc_polygons[item], a, b, tolerance)) source = d;
          });
      border.points.push_back(a);
      border.segments.emplace_back(first + i, first + (i + 1) % n);
      border.segment_disc.push_back(source);
    }
    for (std::size_t i = 0; i < n; ++i) {
      const int incoming = border.segment_disc[first + (i + n - 1) % n], outgoing = border.segment_disc[first + i];
      border.point_disc.push_back(incoming == outgoing ? outgoing : no_disc);
    }
  }
  return border;
}

// ---- features of the sites -------------------------------------------------------------------------------------

/// The feature of a site: a circle (radius 0 for a point), or the line that contains a segment.
struct Feature {
  bool line = false;
  Vec2 at;      // the centre, or a point of the line
  Vec2 normal;  // of the line
  double radius = 0.0;

  [[nodiscard]] double distance(Vec2 p) const { return line ? std::abs(dot(normal, p - at)) : norm(p - at) - radius; }
  [[nodiscard]] Vec2 gradient(Vec2 p) const {
    const Vec2 off = p - at;
    if (line) return dot(normal, off) < 0.0 ? -1.0 * normal : normal;
    const double length = norm(off);
    return length > 0.0 ? (1.0 / length) * off : Vec2{};
  }
};

/// A condition on a point: equal distance from two features, or a position on the perpendicular of a segment at its
/// end.
struct Condition {
  Feature first, second;
  bool perpendicular = false;
  Vec2 end, along;

  static Condition equidistant(const Feature& first, const Feature& second) { return {first, second, false, {}, {}}; }
  static Condition at_end(Vec2 end, Vec2 along) { return {{}, {}, true, end, along}; }

  [[nodiscard]] double value(Vec2 p) const {
    return perpendicular ? dot(along, p - end) : first.distance(p) - second.distance(p);
  }
  [[nodiscard]] Vec2 gradient(Vec2 p) const { return perpendicular ? along : first.gradient(p) - second.gradient(p); }
};

/// Newton's method from p: two conditions determine a point, one the nearest point of a curve. Returns the best
/// iterate.
Vec2 refined(Vec2 p, const std::vector<Condition>& conditions, double limit) {
  const auto error = [&](Vec2 x) {
    double worst = 0.0;
    for (const auto& condition : conditions) worst = std::max(worst, std::abs(condition.value(x)));
    return worst;
  };
  constexpr int most_steps = 30;
  Vec2 best = p, x = p;
  double least = error(p);
  for (int step = 0; step < most_steps && least > 0.0 && !conditions.empty(); ++step) {
    const double f = conditions[0].value(x);
    const Vec2 g = conditions[0].gradient(x);
    Vec2 move;
    if (conditions.size() == 1) {
      const double squared = dot(g, g);
      if (squared < 1e-12) break;
      move = (-f / squared) * g;
    } else {
      const double f2 = conditions[1].value(x);
      const Vec2 g2 = conditions[1].gradient(x);
      const double determinant = cross(g, g2);
      if (std::abs(determinant) < 1e-12) break;
      move = (1.0 / determinant) * Vec2{g.y * f2 - g2.y * f, g2.x * f - g.x * f2};
    }
    const double length = norm(move);
    if (!std::isfinite(length)) break;
    x = x + (length > limit ? limit / length : 1.0) * move;
    const double now = error(x);
    if (now < least) {
      least = now;
      best = x;
    } else if (step > 3 && length < 1e-9 * limit) {
      break;
    }
  }
  return best;
}

/// The point of closest approach of two features, on their bisector, and the direction between them.
struct Narrowest {
  Vec2 point, across;
};

std::optional<Narrowest> narrowest_between(Feature a, Feature b) {
  if (a.line && b.line) return std::nullopt;
  if (a.line) std::swap(a, b);
  const Vec2 to = b.line ? -dot(b.normal, a.at - b.at) * b.normal : b.at - a.at;
  const double length = norm(to);
  if (length <= 0.0) return std::nullopt;
  const Vec2 across = (1.0 / length) * to;
  const Vec2 border_a = a.at + a.radius * across;
  const Vec2 border_b = a.at + (length - b.radius) * across;
  return Narrowest{0.5 * (border_a + border_b), across};
}

// ---- graphs of polylines ---------------------------------------------------------------------------------------

struct Chain {
  std::size_t from = 0, to = 0;
  std::vector<Vec2> points;
  std::vector<double> clearance;

  void reverse() {
    std::swap(from, to);
    std::reverse(points.begin(), points.end());
    std::reverse(clearance.begin(), clearance.end());
  }
  void append(const Chain& next) {
    points.insert(points.end(), next.points.begin() + 1, next.points.end());
    clearance.insert(clearance.end(), next.clearance.begin() + 1, next.clearance.end());
    to = next.to;
  }
};

std::vector<std::vector<std::size_t>> incidence(const std::vector<Chain>& chains, std::size_t nodes) {
  std::vector<std::vector<std::size_t>> at(nodes);
  for (std::size_t i = 0; i < chains.size(); ++i) {
    at[chains[i].from].push_back(i);
    at[chains[i].to].push_back(i);
  }
  return at;
}

/// Joins chains at nodes where exactly two ends meet. Closed loops keep one of their nodes.
std::vector<Chain> joined(const std::vector<Chain>& chains, std::size_t nodes) {
  const auto at = incidence(chains, nodes);
  std::vector<bool> used(chains.size(), false);
  std::vector<Chain> result;
  const auto follow = [&](std::size_t start, std::size_t node) {
    Chain chain = chains[start];
    used[start] = true;
    if (chain.from != node) chain.reverse();
    while (chain.to != node && at[chain.to].size() == 2) {
      const auto& pair = at[chain.to];
      const std::size_t next = used[pair[0]] ? pair[1] : pair[0];
      if (used[next]) break;
      used[next] = true;
      Chain piece = chains[next];
      if (piece.from != chain.to) piece.reverse();
      chain.append(piece);
    }
    result.push_back(std::move(chain));
  };
  for (std::size_t node = 0; node < nodes; ++node) {
    if (at[node].size() == 2) continue;
    for (const std::size_t i : at[node]) {
      if (!used[i]) follow(i, node);
    }
  }
  for (std::size_t i = 0; i < chains.size(); ++i) {
    if (!used[i]) follow(i, chains[i].from);
  }
  return result;
}

/// Rotates an isolated closed loop to start at its least point, and orients it towards the lesser neighbour.
void rotate_loop(Chain& loop) {
  const auto least = std::min_element(loop.points.begin(), loop.points.end() - 1, before);
  const auto shift = least - loop.points.begin();
  loop.points.pop_back();
  loop.clearance.pop_back();
  std::rotate(loop.points.begin(), least, loop.points.end());
  std::rotate(loop.clearance.begin(), loop.clearance.begin() + shift, loop.clearance.end());
  loop.points.push_back(loop.points.front());
  loop.clearance.push_back(loop.clearance.front());
}

// ---- from the diagram to the graph -----------------------------------------------------------------------------

class Builder {
 public:
  Builder(const World& world, double spacing, int disc_vertices)
      : diagonal_(norm(world.bounds().hi - world.bounds().lo)),
        // Far above rounding and far below the size of any robot.
        tiny_(1e-9 * diagonal_),
        spacing_(spacing > 0.0 ? spacing : diagonal_ / 200.0),
        clearance_(world.bounds(), shapes_of(world, 0)),
        flat_clearance_(world.bounds(), shapes_of(world, disc_vertices)),
        border_(border_of(world, disc_vertices, tiny_)) {}

  Skeleton build() {
    if (!border_.segments.empty()) {
      diagram_ = segment_voronoi(border_.points, border_.segments);
      name_features();
      place_vertices();
      contract();
      for (const auto& edge : diagram_.edges) add_pieces(edge);
    }
    Skeleton skeleton = assembled();
    if (skeleton.vertices.empty()) throw Error("skeleton: the obstacles leave no free space inside the boundary");
    return skeleton;
  }

 private:
  void name_features() {
    for (const auto& site : diagram_.sites) {
      int disc = no_disc;
      Feature flat;
      flat.at = site.a;
      if (!site.point) {
        const auto [a, b] = border_.segments[site.source];
        const Vec2 start = border_.points[a], to = border_.points[b] - start;
        const Vec2 along = (1.0 / norm(to)) * to;
        flat = {true, start, {-along.y, along.x}};
        disc = border_.segment_disc[site.source];
      } else if (site.source != SegmentVoronoi::no_source) {
        disc = border_.point_disc[site.source];
      }
      disc_.push_back(disc);
      flat_.push_back(flat);
      if (disc == no_disc) {
        exact_.push_back(flat);
      } else {
        const auto& given = border_.discs[static_cast<std::size_t>(disc)];
        exact_.push_back({false, given.centre, {}, given.radius});
      }
    }
  }

  [[nodiscard]] bool same_disc(std::size_t a, std::size_t b) const {
    return disc_[a] != no_disc && disc_[a] == disc_[b];
  }

  /// Whether the sites are a segment and its own end point, or points separated only by rounding: their bisector is not
  /// part of the medial axis.
  [[nodiscard]] bool attached(std::size_t a, std::size_t b) const {
    const auto &first = diagram_.sites[a], &second = diagram_.sites[b];
    if (!first.point && !second.point) return false;
    if (first.point && second.point) return norm(first.a - second.a) <= tiny_;
    const auto& point = first.point ? first : second;
    const auto& segment = first.point ? second : first;
    return norm(point.a - segment.a) <= tiny_ || norm(point.a - segment.b) <= tiny_;
  }

  /// Whether the vertex belongs to a point where a disc touches another shape. That point is a convex corner of the
  /// polygonal free space only, so the axis ends before it.
  [[nodiscard]] bool at_notch(const SegmentVoronoi::Vertex& vertex) const {
    return std::any_of(vertex.sites.begin(), vertex.sites.end(), [&](std::size_t point) {
      return diagram_.sites[point].point && disc_[point] == no_disc &&
             std::any_of(vertex.sites.begin(), vertex.sites.end(),
                         [&](std::size_t other) { return disc_[other] != no_disc && attached(point, other); });
    });
  }

  /// Returns the conditions that determine a vertex of the diagram of these features (those of the polygons, or the
  /// exact ones).
  [[nodiscard]] std::vector<Condition> conditions(const SegmentVoronoi::Vertex& vertex, bool exact) const {
    const auto& features = exact ? exact_ : flat_;
    std::vector<std::size_t> distinct;
    for (const std::size_t site : vertex.sites) {
      const bool known = exact && std::any_of(distinct.begin(), distinct.end(),
                                              [&](std::size_t other) { return same_disc(site, other); });
      if (!known) distinct.push_back(site);
    }
    std::vector<Condition> result;
    std::vector<std::size_t> free;  // sites whose equality no perpendicular implies
    for (const std::size_t site : distinct) {
      // For a segment and its own end point, the difference of distances has a double root. The condition that the
      // point lies on the perpendicular is equivalent and well conditioned.
      bool tied = false;
      if (diagram_.sites[site].point && (!exact || disc_[site] == no_disc)) {
        for (const std::size_t other : distinct) {
          if (other == site || !features[other].line || !attached(site, other)) continue;
          const Vec2 normal = features[other].normal;
          result.push_back(Condition::at_end(diagram_.sites[site].a, {normal.y, -normal.x}));
          tied = true;
        }
      }
      if (!tied) free.push_back(site);
    }
    for (std::size_t i = 1; i < free.size() && result.size() < 2; ++i) {
      result.push_back(Condition::equidistant(features[free[0]], features[free[i]]));
    }
    return result;
  }

  void place_vertices() {
    for (const auto& vertex : diagram_.vertices) {
      const Vec2 flat = refined(vertex.position, conditions(vertex, false), diagonal_);
      const bool round = std::any_of(vertex.sites.begin(), vertex.sites.end(),
                                     [&](std::size_t site) { return disc_[site] != no_disc; }) &&
                         !at_notch(vertex);
      flat_position_.push_back(flat);
      position_.push_back(round ? refined(flat, conditions(vertex, true), spacing_) : flat);
    }
  }

  /// Where more than three sites are equally near, the diagram has several coincident vertices; merges them into one
  /// node.
  void contract() {
    node_.resize(diagram_.vertices.size());
    std::iota(node_.begin(), node_.end(), std::size_t{0});
    const auto root = [&](std::size_t v) {
      while (node_[v] != v) v = node_[v] = node_[node_[v]];
      return v;
    };
    for (const auto& edge : diagram_.edges) {
      if (norm(position_[edge.from] - position_[edge.to]) > tiny_) continue;
      std::size_t a = root(edge.from), b = root(edge.to);
      if (before(position_[b], position_[a])) std::swap(a, b);
      node_[b] = a;
    }
    for (std::size_t v = 0; v < node_.size(); ++v) node_[v] = root(v);
    nodes_ = node_.size();
  }

  /// Returns points from one end of an edge to the other, at most `spacing` metres from each other, on the bisector of
  /// the exact features; none for an edge inside the obstacles.
  [[nodiscard]] std::vector<Vec2> sampled(const SegmentVoronoi::Edge& edge) const {
    const std::size_t a = edge.first_site, b = edge.second_site;
    const Vec2 start = flat_position_[edge.from], end = flat_position_[edge.to];
    const bool round = disc_[a] != no_disc || disc_[b] != no_disc;
    std::function<Vec2(double)> flat = [=](double t) { return start + t * (end - start); };
    const Feature &line = flat_[a].line ? flat_[a] : flat_[b], &focus = flat_[a].line ? flat_[b] : flat_[a];
    const double side = dot(line.normal, focus.at - line.at);
    if (flat_[a].line != flat_[b].line && std::abs(side) > tiny_) {
      // A point and a segment: a parabola over the segment's line, in coordinates along and across that line. A point
      // on the line has the chord.
      const Vec2 across = side < 0.0 ? -1.0 * line.normal : line.normal;
      const Vec2 along{across.y, -across.x};
      const double height = std::abs(side);
      const double from = dot(along, start - focus.at), to = dot(along, end - focus.at);
      const Vec2 foot = focus.at - height * across;
      flat = [=](double t) {
        const double x = from + t * (to - from);
        return foot + x * along + ((x * x + height * height) / (2.0 * height)) * across;
      };
    }
    // No edge crosses the boundary, so one point shows whether the edge lies inside the obstacles. Test it before
    // points move to the exact bisector, which is meaningless there.
    if (flat_clearance_(flat(0.5)) <= tiny_) return {};

    const std::vector<Condition> bisector = {Condition::equidistant(exact_[a], exact_[b])};
    const auto point = [&](double t) { return round ? refined(flat(t), bisector, spacing_) : flat(t); };

    std::vector<Vec2> points = {position_[node_[edge.from]]};
    // No arc inside the boundary is nearly as long.
    const auto most = static_cast<std::size_t>(16.0 * diagonal_ / spacing_) + 16;
    const std::function<void(double, double, Vec2)> fill = [&](double t0, double t1, Vec2 last) {
      constexpr double finest = 1e-6;
      if (norm(last - points.back()) <= spacing_ || t1 - t0 < finest || points.size() > most) {
        points.push_back(last);
        return;
      }
      const double t = 0.5 * (t0 + t1);
      fill(t0, t, point(t));
      fill(t, t1, last);
    };
    const auto count = static_cast<int>(std::ceil(norm(end - start) / spacing_));
    for (int i = 1; i < count; ++i) {
      const double t = static_cast<double>(i) / count;
      fill(static_cast<double>(i - 1) / count, t, point(t));
    }
    fill(static_cast<double>(std::max(count, 1) - 1) / std::max(count, 1), 1.0, position_[node_[edge.to]]);
    if (points.size() == 2) points.insert(points.begin() + 1, point(0.5));

    // The narrowest point decides which robots pass, so it is always a sample.
    if (const auto narrowest = narrowest_between(exact_[a], exact_[b])) {
      const auto beyond = [&](Vec2 p) { return cross(narrowest->across, p - narrowest->point); };
      for (std::size_t i = 1; i < points.size(); ++i) {
        const double length = norm(points[i] - points[i - 1]);
        if (beyond(points[i - 1]) * beyond(points[i]) < 0.0 && norm(narrowest->point - points[i - 1]) < length &&
            norm(narrowest->point - points[i]) < length) {
          points.insert(points.begin() + static_cast<std::ptrdiff_t>(i), narrowest->point);
          break;
        }
      }
    }
    return points;
  }

  /// Adds the free pieces of an edge. A piece that ends at zero clearance ends at a node of its own.
  void add_pieces(const SegmentVoronoi::Edge& edge) {
    const std::size_t a = edge.first_site, b = edge.second_site;
    if (attached(a, b) || same_disc(a, b)) return;
    const std::size_t from = node_[edge.from], to = node_[edge.to];
    if (from == to) return;
    const auto points = sampled(edge);
    Chain piece;
    bool whole_start = false;
    const auto finish = [&](bool whole_end) {
      if (piece.points.size() > 1) {
        piece.from = whole_start ? from : touching_node();
        piece.to = whole_end ? to : touching_node();
        pieces_.push_back(std::move(piece));
      }
      piece = Chain();
    };
    for (std::size_t i = 0; i < points.size(); ++i) {
      const bool end = i == 0 || i + 1 == points.size();
      // Points whose distance is a rounding error would give edges without a direction.
      if (!end && norm(points[i] - points[i - 1]) <= tiny_) continue;
      const double clearance = clearance_(points[i]);
      if (clearance <= tiny_) {
        finish(false);
        continue;
      }
      if (piece.points.empty()) whole_start = i == 0;
      piece.points.push_back(points[i]);
      piece.clearance.push_back(clearance);
    }
    finish(true);
  }

  std::size_t touching_node() {
    touching_.push_back(nodes_);
    return nodes_++;
  }

  Skeleton assembled() {
    std::vector<bool> touches(nodes_, false);
    for (const std::size_t node : touching_) touches[node] = true;
    std::vector<Chain> chains = joined(pieces_, nodes_);
    const auto with_spurs = incidence(chains, nodes_);

    std::vector<Vec2> lone;
    std::vector<Chain> kept;
    for (auto& chain : chains) {
      if (!touches[chain.from] && !touches[chain.to]) {
        kept.push_back(std::move(chain));
      } else if (touches[chain.from] && touches[chain.to]) {
        // The chain is the whole medial axis of a pocket: represent the pocket by its widest point.
        const auto widest = std::max_element(chain.clearance.begin(), chain.clearance.end());
        lone.push_back(chain.points[static_cast<std::size_t>(widest - chain.clearance.begin())]);
      }
    }
    const auto without = incidence(kept, nodes_);
    for (std::size_t node = 0; node < nodes_; ++node) {
      // A pocket whose axis consists of spurs alone, such as a square.
      if (with_spurs[node].size() > 2 && without[node].empty()) lone.push_back(position_[node]);
    }
    chains = joined(kept, nodes_);
    const auto at = incidence(chains, nodes_);
    for (auto& chain : chains) {
      if (chain.from == chain.to && at[chain.from].size() == 2) rotate_loop(chain);
    }
    return numbered(std::move(chains), lone);
  }

  /// Numbers vertices and edges in an order that depends on their positions only.
  static Skeleton numbered(std::vector<Chain> chains, const std::vector<Vec2>& lone) {
    Skeleton skeleton;
    auto& vertices = skeleton.vertices;
    vertices = lone;
    for (const auto& chain : chains) {
      vertices.push_back(chain.points.front());
      vertices.push_back(chain.points.back());
    }
    std::sort(vertices.begin(), vertices.end(), before);
    vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
    const auto number = [&](Vec2 p) {
      return static_cast<std::uint32_t>(std::lower_bound(vertices.begin(), vertices.end(), p, before) -
                                        vertices.begin());
    };
    for (auto& chain : chains) {
      const auto& p = chain.points;
      const bool backwards = p.front() == p.back() ? before(p[p.size() - 2], p[1]) : before(p.back(), p.front());
      if (backwards) chain.reverse();
      Skeleton::Edge& edge = skeleton.edges.emplace_back();
      edge.from = number(p.front());
      edge.to = number(p.back());
      edge.points = std::move(chain.points);
      edge.clearance = std::move(chain.clearance);
      for (std::size_t i = 1; i < edge.points.size(); ++i) edge.length += norm(edge.points[i] - edge.points[i - 1]);
    }
    std::sort(skeleton.edges.begin(), skeleton.edges.end(), [](const Skeleton::Edge& a, const Skeleton::Edge& b) {
      if (std::tie(a.from, a.to) != std::tie(b.from, b.to)) return std::tie(a.from, a.to) < std::tie(b.from, b.to);
      return std::lexicographical_compare(a.points.begin(), a.points.end(), b.points.begin(), b.points.end(), before);
    });
    return skeleton;
  }

  double diagonal_, tiny_, spacing_;
  Clearance clearance_;       // of the world itself
  Clearance flat_clearance_;  // of the polygons of the diagram
  Border border_;
  SegmentVoronoi diagram_;
  std::vector<int> disc_;            // per site
  std::vector<Feature> flat_;        // per site, as inserted
  std::vector<Feature> exact_;       // per site, a disc where the site is part of a disc's polygon
  std::vector<Vec2> flat_position_;  // per vertex of the diagram, equidistant from the flat features
  std::vector<Vec2> position_;       // per vertex of the diagram, equidistant from the exact features
  std::vector<std::size_t> node_;    // per vertex of the diagram
  std::size_t nodes_ = 0;
  std::vector<std::size_t> touching_;  // nodes at zero clearance
  std::vector<Chain> pieces_;
};

}  // namespace

Skeleton medial_axis(const World& world, double spacing, int disc_vertices) {
  if (!std::isfinite(spacing)) throw Error(fmt::format("skeleton: spacing must be finite, got {}", spacing));
  if (disc_vertices < 3) {
    throw Error(fmt::format("skeleton: a disc needs at least 3 vertices, got {}", disc_vertices));
  }
  const auto begin = std::chrono::steady_clock::now();
  Skeleton skeleton = Builder(world, spacing, disc_vertices).build();
  skeleton.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return skeleton;
}

std::shared_ptr<const Skeleton> cached_medial_axis(const World& world) {
  static SetUpCache<Skeleton> cache;
  return cache.get(world, [](const World& of) { return medial_axis(of); });
}

}  // namespace trellis
