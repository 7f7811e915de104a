// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/scene/planar/triangulation.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include <trellis/base/error.hpp>
#include <trellis/scene/planar/constrained_delaunay.hpp>
#include <trellis/scene/planar/planar_box_tree.hpp>

namespace trellis {

namespace {

constexpr double most_triangles = 1e6;
constexpr int disc_vertices = 16;
constexpr double clear = 0.4;  // of the size: the distance of free points from outlines

/// Returns a shape's vertices; for a disc, those of a circumscribed polygon.
std::vector<Vec2> outline(const ConvexShape& shape) {
  if (const auto* polygon = std::get_if<Polygon>(&shape)) return polygon->vertices;
  const auto& disc = std::get<Disc>(shape);
  const double radius = disc.radius / std::cos(std::numbers::pi / disc_vertices);
  std::vector<Vec2> vertices;
  vertices.reserve(disc_vertices);
  for (int i = 0; i < disc_vertices; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / disc_vertices;
    vertices.push_back({disc.centre.x + radius * std::cos(angle), disc.centre.y + radius * std::sin(angle)});
  }
  return vertices;
}

/// Whether p lies in a convex counter-clockwise polygon, or no farther than `margin` metres outside of it.
bool within(const std::vector<Vec2>& polygon, Vec2 p, double margin) {
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vec2 side = polygon[(i + 1) % polygon.size()] - polygon[i];
    if (cross(side, p - polygon[i]) < -margin * norm(side)) return false;
  }
  return true;
}

bool inside(const Box2& box, Vec2 p, double margin) {
  return p.x >= box.lo.x + margin && p.x <= box.hi.x - margin && p.y >= box.lo.y + margin && p.y <= box.hi.y - margin;
}

/// The outlines of a world's parts, in cells, so that a point is compared with few of them.
class Outlines {
 public:
  /// \param margin  the largest one of `covers`
  Outlines(const World& world, double margin) : bounds_(world.bounds()) {
    all.reserve(world.parts().size());
    for (const auto& part : world.parts()) all.push_back(outline(part.shape));
    constexpr double most_side = 512.0;
    side_ = static_cast<std::size_t>(std::clamp(std::sqrt(static_cast<double>(all.size())), 1.0, most_side));
    cells_.resize(side_ * side_);
    for (std::uint32_t k = 0; k < all.size(); ++k) enter(k, margin);
  }

  /// Whether p, a point of the world, lies in an outline or no farther than `margin` metres outside of it.
  [[nodiscard]] bool covers(Vec2 p, double margin) const {
    const auto& cell = cells_[row(p.y) * side_ + column(p.x)];
    return std::any_of(cell.begin(), cell.end(), [&](std::uint32_t k) { return within(all[k], p, margin); });
  }

  std::vector<std::vector<Vec2>> all;

 private:
  void enter(std::uint32_t k, double margin) {
    const Box2 box = bounding_box(all[k]);
    // `within` moves each side outwards, so that a pointed corner reaches farther than the margin.
    const double reach = pointed(all[k]) ? norm(bounds_.hi - bounds_.lo) : 2.0 * margin;
    for (std::size_t j = row(box.lo.y - reach); j <= row(box.hi.y + reach); ++j) {
      for (std::size_t i = column(box.lo.x - reach); i <= column(box.hi.x + reach); ++i) {
        cells_[j * side_ + i].push_back(k);
      }
    }
  }
  /// Whether a corner has less than 60 degrees: from there on the moved sides meet within twice the margin.
  static bool pointed(const std::vector<Vec2>& polygon) {
    const std::size_t n = polygon.size();
    for (std::size_t i = 0; i < n; ++i) {
      const Vec2 a = polygon[(i + n - 1) % n] - polygon[i];
      const Vec2 b = polygon[(i + 1) % n] - polygon[i];
      if (dot(a, b) > 0.5 * norm(a) * norm(b)) return true;
    }
    return false;
  }
  [[nodiscard]] std::size_t place(double share) const {
    const auto side = static_cast<double>(side_);
    return static_cast<std::size_t>(std::clamp(std::floor(share * side), 0.0, side - 1.0));
  }
  [[nodiscard]] std::size_t column(double x) const { return place((x - bounds_.lo.x) / (bounds_.hi.x - bounds_.lo.x)); }
  [[nodiscard]] std::size_t row(double y) const { return place((y - bounds_.lo.y) / (bounds_.hi.y - bounds_.lo.y)); }

  Box2 bounds_;
  std::size_t side_ = 1;
  std::vector<std::vector<std::uint32_t>> cells_;
};

/// The input of the triangulation: outlines in segments of about `size`, and a lattice of points in the free space, the
/// coarser, the farther they are from outlines.
class Input {
 public:
  Input(const Outlines& obstacles, const Box2& bounds, double size) : size_(size), bounds_(bounds) {
    add(rectangle_vertices(bounds));
    std::vector<Box2> boxes;
    for (const auto& obstacle : obstacles.all) {
      add(obstacle);
      boxes.push_back(bounding_box(Polygon{obstacle}));
    }
    tree_ = PlanarBoxTree(boxes);
    boxes_.reserve(boxes.size());
    for (const std::uint32_t k : tree_.order()) boxes_.push_back(boxes[k]);
    const double row = size * std::numbers::sqrt3 / 2.0;
    for (std::size_t j = 0;; ++j) {
      const double y = bounds.lo.y + static_cast<double>(j + 1) * row;
      if (y >= bounds.hi.y) break;
      for (std::size_t i = 0;; ++i) {
        const Vec2 p{bounds.lo.x + (static_cast<double>(i) + (j % 2 == 0 ? 1.0 : 0.5)) * size, y};
        if (p.x >= bounds.hi.x) break;
        if (!inside(bounds, p, clear * size) || obstacles.covers(p, clear * size)) continue;
        const std::size_t step = std::size_t{1} << static_cast<unsigned>(coarseness(p));
        if (i % step == 0 && j % step == 0) points.push_back(p);
      }
    }
  }

  std::vector<Vec2> points;
  std::vector<std::pair<std::size_t, std::size_t>> segments;

 private:
  void add(const std::vector<Vec2>& loop) {
    const std::size_t first = points.size();
    for (std::size_t i = 0; i < loop.size(); ++i) {
      const Vec2 a = loop[i];
      const Vec2 side = loop[(i + 1) % loop.size()] - a;
      const double stretches = std::max(1.0, std::round(norm(side) / size_));
      const auto [begin, end] = near_bounds(a, side);
      const double from = std::max(1.0, std::ceil(begin * stretches));
      const double to = std::min(stretches - 1.0, std::floor(end * stretches));
      const double wanted = 1.0 + std::max(0.0, to - from + 1.0);
      if (static_cast<double>(points.size()) + wanted > most_triangles) {
        throw Error(fmt::format(
            "segments of {:g} m along the obstacles would be more than {:g}; a larger option 'size' makes fewer", size_,
            most_triangles));
      }
      points.push_back(a);
      for (double k = from; k <= to; ++k) points.push_back(a + (k / stretches) * side);
    }
    for (std::size_t i = first; i < points.size(); ++i) segments.emplace_back(i, i + 1 < points.size() ? i + 1 : first);
  }

  /// The part of a side that is within two stretches of the bounds: the rest has no points of its own, as no triangle
  /// beyond the bounds is kept. \return its ends as shares of the side; an end before the beginning: no part is
  [[nodiscard]] std::pair<double, double> near_bounds(Vec2 a, Vec2 side) const {
    double begin = 0.0;
    double end = 1.0;
    const auto clip = [&](double at, double along, double lo, double hi) {
      if (along == 0.0) {
        if (at < lo || at > hi) end = -1.0;
        return;
      }
      const double first = (lo - at) / along;
      const double last = (hi - at) / along;
      begin = std::max(begin, std::min(first, last));
      end = std::min(end, std::max(first, last));
    };
    const double margin = 2.0 * size_;
    clip(a.x, side.x, bounds_.lo.x - margin, bounds_.hi.x + margin);
    clip(a.y, side.y, bounds_.lo.y - margin, bounds_.hi.y + margin);
    return {begin, end};
  }

  /// How often the distance between points of the lattice is doubled at p: each time the distance from the outlines'
  /// boxes is twice that between the points.
  [[nodiscard]] int coarseness(Vec2 p) const {
    constexpr int most = 3;
    const double enough = std::ldexp(2.0 * size_, most);
    double distance =
        std::min({p.x - bounds_.lo.x, bounds_.hi.x - p.x, p.y - bounds_.lo.y, bounds_.hi.y - p.y, enough});
    const auto to = [&](const Box2& box) {
      return norm(
          Vec2{std::max({box.lo.x - p.x, p.x - box.hi.x, 0.0}), std::max({box.lo.y - p.y, p.y - box.hi.y, 0.0})});
    };
    tree_.nearest(distance, to, [&](std::size_t rank) { distance = std::min(distance, to(boxes_[rank])); });
    int doubled = 0;
    while (doubled < most && distance >= std::ldexp(2.0 * size_, doubled + 1)) ++doubled;
    return doubled;
  }

  double size_;
  Box2 bounds_;
  PlanarBoxTree tree_;
  std::vector<Box2> boxes_;  ///< of the outlines, in the tree's order
};

}  // namespace

double Triangulation::at_most(const Box2& bounds, double size) {
  const Vec2 extent = bounds.hi - bounds.lo;
  // Each lattice point gives two triangles and represents an area of size^2 * sqrt(3) / 2.
  const double all = 4.0 * extent.x * extent.y / (std::numbers::sqrt3 * size * size);
  if (size > 0.0 && all <= most_triangles) return all;
  throw Error(fmt::format("triangles of {:g} m would be more than {:g} in a world of {:g} x {:g} m", size,
                          most_triangles, extent.x, extent.y));
}

Triangulation::Triangulation(const World& world, double size) : bounds_(world.bounds()), cell_(size) {
  static_cast<void>(at_most(bounds_, size));
  const Vec2 extent = bounds_.hi - bounds_.lo;
  const Outlines obstacles(world, clear * size);
  const Input input(obstacles, bounds_, size);
  const auto all = constrained_delaunay(input.points, input.segments);

  std::vector<std::optional<std::uint32_t>> number(all.size());
  for (std::size_t i = 0; i < all.size(); ++i) {
    Triangle triangle{all[i].corners, {}, 0.0};
    triangle.area = 0.5 * cross(triangle.corners[1] - triangle.corners[0], triangle.corners[2] - triangle.corners[0]);
    const Vec2 middle = triangle.centroid();
    const bool free = triangle.area > 0.0 && inside(bounds_, middle, 0.0) && !obstacles.covers(middle, 0.0);
    if (!free) continue;
    number[i] = static_cast<std::uint32_t>(triangles_.size());
    area_ += triangle.area;
    triangles_.push_back(triangle);
  }
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (!number[i]) continue;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t across = all[i].neighbours[k];
      if (across != DelaunayTriangle::none) triangles_[*number[i]].neighbours[k] = number[across];
    }
  }

  columns_ = static_cast<std::size_t>(std::ceil(extent.x / cell_));
  rows_ = static_cast<std::size_t>(std::ceil(extent.y / cell_));
  cells_.resize(columns_ * rows_);
  for (std::uint32_t t = 0; t < triangles_.size(); ++t) {
    const auto& c = triangles_[t].corners;
    const auto [left, right] = std::minmax({c[0].x, c[1].x, c[2].x});
    const auto [low, high] = std::minmax({c[0].y, c[1].y, c[2].y});
    for (std::size_t j = bucket(low, bounds_.lo.y, rows_); j <= bucket(high, bounds_.lo.y, rows_); ++j) {
      for (std::size_t i = bucket(left, bounds_.lo.x, columns_); i <= bucket(right, bounds_.lo.x, columns_); ++i) {
        cells_[j * columns_ + i].push_back(t);
      }
    }
  }
}

std::size_t Triangulation::bucket(double x, double lo, std::size_t n) const {
  const double place = std::floor((x - lo) / cell_);
  return static_cast<std::size_t>(std::clamp(place, 0.0, static_cast<double>(n - 1)));
}

std::optional<std::uint32_t> Triangulation::find(Vec2 p) const {
  if (!inside(bounds_, p, 0.0)) return std::nullopt;
  for (const std::uint32_t t :
       cells_[bucket(p.y, bounds_.lo.y, rows_) * columns_ + bucket(p.x, bounds_.lo.x, columns_)]) {
    const auto& c = triangles_[t].corners;
    if (cross(c[1] - c[0], p - c[0]) >= 0.0 && cross(c[2] - c[1], p - c[1]) >= 0.0 &&
        cross(c[0] - c[2], p - c[2]) >= 0.0) {
      return t;
    }
  }
  return std::nullopt;
}

Vec2 Triangulation::sample(std::uint32_t triangle, Stream& stream) const {
  const auto& c = triangles_[triangle].corners;
  double u = stream.uniform();
  double v = stream.uniform();
  if (u + v > 1.0) {
    u = 1.0 - u;
    v = 1.0 - v;
  }
  const Vec2 p = c[0] + u * (c[1] - c[0]) + v * (c[2] - c[0]);
  // Clamp: rounding must not move the point out of the world.
  return {std::clamp(p.x, bounds_.lo.x, bounds_.hi.x), std::clamp(p.y, bounds_.lo.y, bounds_.hi.y)};
}

}  // namespace trellis
