// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/scene/spatial/medial_cover.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <queue>
#include <tuple>
#include <utility>
#include <variant>

#include <trellis/scene/spatial/obstacle_distance.hpp>
#include <trellis/scene/spatial/ranges.hpp>
#include <trellis/scene/spatial/surface.hpp>

// A greedy cover by balls near the medial axis.
//
// What is to be covered is divided into convex parts, each given by points whose hull contains it. A ball is convex: it
// contains a part where it contains these points. So the cover is checked for finitely many points, and holds for all
// of the surface. The cells of a grid whose centres are inside are parts, too: a point x of the solid lies at most half
// a diagonal from the centre of its cell, so where x is deeper than that, the centre is inside and x is covered.
//
// A ball about a point inside at the depth d, with the radius d + e, protrudes at most e: each of its points outside is
// on a ray from the centre that meets the surface after d at the earliest. So does a ball about a point of the surface
// with the radius e. Every part is small enough for one of the latter, so that a cover exists always.

namespace trellis {

namespace {

/// The longest edge of a piece of the surface, in units of the excess. Pieces with their middles in one cell of half
/// that size are one part, so a part lies within (sqrt(3) / 2 + 2 / 3) edges of each middle: less than the excess.
constexpr double longest_edge = 0.6;
/// The step of the grid, in units of the excess.
constexpr double least_step = 0.4, most_step = 1.1;
/// The same of the grid whose cells inside are covered. A point at the depth of the excess is in such a cell, as twice
/// half a diagonal is less.
constexpr double fine_step = 0.57;
/// The number of cells beyond which the grid has a step of more than `least_step`, and of more than `most_step`.
constexpr double some_cells = 8'000.0, most_cells = 2'000'000.0;
/// The area of a link in units of the square of its excess is at most this, times `work`.
constexpr double most_area = 4'000.0;
/// The number of points of a part beyond which those of its box replace them.
constexpr std::size_t most_points = 16;
/// A cell is no centre where a neighbour is deeper by more than this share of their distance: it is not near the medial
/// axis then.
constexpr double steep = 0.75;
/// What rounding may add to a distance, as a share.
constexpr double rounding = 1e-9;

/// Returns the cube root of x >= 0, by Newton's method: the same bits on every machine.
double cube_root(double x) {
  double root = std::max(x, 1.0);
  for (;;) {
    const double next = (2.0 * root + x / (root * root)) / 3.0;
    if (!(next < root)) return root;
    root = next;
  }
}

struct Range {
  std::size_t first = 0;
  std::size_t last = 0;  ///< the first one behind
};

/// Convex parts of what is to be covered. Each is contained in the hull of its points.
class Parts {
 public:
  [[nodiscard]] std::size_t size() const { return begin_.size() - 1; }
  [[nodiscard]] std::span<const Vec3> points(std::size_t part) const {
    return {points_.data() + begin_[part], begin_[part + 1] - begin_[part]};
  }
  /// Returns the points of several parts that follow each other, which are one at least.
  [[nodiscard]] std::span<const Vec3> points(std::size_t first, std::size_t last) const {
    return {points_.data() + begin_[first], begin_[last] - begin_[first]};
  }
  /// A point of the solid that is in the part, or near it.
  [[nodiscard]] const Vec3& middle(std::size_t part) const { return middles_[part]; }

  void add(std::span<const Vec3> points, const Vec3& middle) {
    points_.insert(points_.end(), points.begin(), points.end());
    begin_.push_back(points_.size());
    middles_.push_back(middle);
  }

  /// \param order  of the parts
  void reorder(const std::vector<std::uint32_t>& order) {
    Parts ordered;
    ordered.points_.reserve(points_.size());
    ordered.begin_.reserve(begin_.size());
    ordered.middles_.reserve(middles_.size());
    for (const std::uint32_t part : order) ordered.add(points(part), middle(part));
    *this = std::move(ordered);
  }

  /// Returns the square of the distance of the part's farthest point from c.
  [[nodiscard]] double farthest(std::size_t part, const Vec3& c) const {
    double most = 0.0;
    for (const Vec3& p : points(part)) most = std::max(most, dot(p - c, p - c));
    return most;
  }
  [[nodiscard]] bool within(std::size_t part, const Vec3& c, double squared) const {
    const std::span<const Vec3> own = points(part);
    return std::all_of(own.begin(), own.end(), [&](const Vec3& p) { return dot(p - c, p - c) <= squared; });
  }

 private:
  std::vector<Vec3> points_;
  std::vector<std::size_t> begin_ = {0};
  std::vector<Vec3> middles_;
};

/// A grid of cubes.
struct Grid {
  Vec3 lo;
  double step = 0.0;
  std::array<std::size_t, 3> count = {};

  Grid(const Box3& box, double size) : lo(box.lo), step(size) {
    const Vec3 extent = box.hi - box.lo;
    count = {cells(extent.x), cells(extent.y), cells(extent.z)};
    // The cells lie about the middle of the box.
    lo = 0.5 * (box.lo + box.hi) - 0.5 * step * Vec3{double(count[0]), double(count[1]), double(count[2])};
  }

  [[nodiscard]] std::size_t size() const { return count[0] * count[1] * count[2]; }
  [[nodiscard]] std::size_t index(std::size_t i, std::size_t j, std::size_t k) const {
    return (i * count[1] + j) * count[2] + k;
  }
  [[nodiscard]] Vec3 centre(std::size_t i, std::size_t j, std::size_t k) const {
    return lo + step * Vec3{double(i) + 0.5, double(j) + 0.5, double(k) + 0.5};
  }
  [[nodiscard]] std::array<std::size_t, 3> place(const Vec3& p) const {
    const Vec3 at = p - lo;
    return {cell(at.x, 0), cell(at.y, 1), cell(at.z, 2)};
  }
  /// Calls `visit(i, j, k)` for the cells that meet the box of a ball.
  template <class Visit>
  void about(const Vec3& c, double radius, const Visit& visit) const {
    const auto from = place(c - Vec3{radius, radius, radius}), to = place(c + Vec3{radius, radius, radius});
    for (std::size_t i = from[0]; i <= to[0]; ++i) {
      for (std::size_t j = from[1]; j <= to[1]; ++j) {
        for (std::size_t k = from[2]; k <= to[2]; ++k) visit(i, j, k);
      }
    }
  }
  /// Calls `visit(i, j, k)` for all cells.
  template <class Visit>
  void each(const Visit& visit) const {
    for (std::size_t i = 0; i < count[0]; ++i) {
      for (std::size_t j = 0; j < count[1]; ++j) {
        for (std::size_t k = 0; k < count[2]; ++k) visit(i, j, k);
      }
    }
  }

 private:
  [[nodiscard]] std::size_t cells(double extent) const {
    return static_cast<std::size_t>(std::max(1.0, std::ceil(extent / step)));
  }
  [[nodiscard]] std::size_t cell(double at, std::size_t axis) const {
    const auto last = static_cast<double>(count[axis] - 1);
    return static_cast<std::size_t>(std::clamp(std::floor(at / step), 0.0, last));
  }
};

/// The grid's coordinates turned such that those along `axis` come first.
Vec3 turned(const Vec3& p, unsigned axis) {
  if (axis == 1) return {p.y, p.z, p.x};
  if (axis == 2) return {p.z, p.x, p.y};
  return p;
}

/// The triangles of a mesh or of a box, in the link's frame.
struct Triangles {
  std::vector<Vec3> vertices;
  std::vector<Triangle> triangles;
};

Triangles triangles_of(const Cuboid& cuboid) {
  Triangles box;
  const auto corners = corners_of({-0.5 * cuboid.size, 0.5 * cuboid.size});
  box.vertices.assign(corners.begin(), corners.end());
  for (const auto& [a, b, c, d] : std::array<std::array<std::uint32_t, 4>, 6>{
           {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}}}) {
    box.triangles.push_back({a, b, c});
    box.triangles.push_back({a, c, d});
  }
  return box;
}

/// Returns at least `least` directions in the plane with equal angles between them, by halving right angles.
std::vector<Vec3> directions(double least) {
  std::vector<Vec3> all = {{1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, -1, 0}};
  while (all.size() < 8 || static_cast<double>(all.size()) < least) {
    std::vector<Vec3> finer;
    for (std::size_t i = 0; i < all.size(); ++i) {
      const Vec3 sum = all[i] + all[(i + 1) % all.size()];
      finer.push_back(all[i]);
      finer.push_back(1.0 / norm(sum) * sum);
    }
    all = std::move(finer);
  }
  return all;
}

/// A solid of the link that is not a sphere.
class Region {
 public:
  explicit Region(const Solid& solid) : shape_(solid.shape), pose_(solid.pose), inverse_(solid.pose.inverse()) {
    if (const auto* mesh = std::get_if<std::shared_ptr<const Mesh>>(&shape_)) {
      distance_.emplace(*mesh);
      surface_ = {(*mesh)->vertices(), (*mesh)->triangles()};
    } else if (const auto* cuboid = std::get_if<Cuboid>(&shape_)) {
      surface_ = triangles_of(*cuboid);
    }
    for (Vec3& v : surface_.vertices) v = pose_(v);
    bounds_ = surface_.vertices.empty() ? bounding_box(solid) : bounds_of(surface_.vertices);
    for (const auto& [a, b, c] : surface_.triangles) {
      const auto& v = surface_.vertices;
      area_ += 0.5 * norm(cross(v[b] - v[a], v[c] - v[a]));
    }
    if (const auto* cylinder = std::get_if<Cylinder>(&shape_)) {
      area_ = 6.3 * cylinder->radius * (cylinder->radius + cylinder->length);
    }
  }

  [[nodiscard]] const Box3& bounds() const { return bounds_; }
  [[nodiscard]] double area() const { return area_; }

  /// A point inside, and where the surface is nearest.
  struct Depth {
    double depth = 0.0;
    Vec3 inwards;  ///< of norm 1: away from the nearest point of the surface
  };
  /// Returns the depth of a point inside. Of a mesh it is the distance from the surface, also outside.
  [[nodiscard]] Depth at(const Vec3& p) const {
    const Vec3 local = inverse_(p);
    if (distance_) {
      const Vec3 from = local - distance_->nearest(local);
      const double depth = norm(from);
      return {depth, depth > 0.0 ? pose_.orientation(1.0 / depth * from) : Vec3{}};
    }
    double depth = 0.0;
    Vec3 inwards;
    const auto side = [&](double distance, const Vec3& direction) {
      if (inwards == Vec3{} || distance < depth) {
        depth = distance;
        inwards = direction;
      }
    };
    const auto facing = [](double from) { return from < 0.0 ? 1.0 : -1.0; };
    if (const auto* box = std::get_if<Cuboid>(&shape_)) {
      side(0.5 * box->size.x - std::abs(local.x), {facing(local.x), 0, 0});
      side(0.5 * box->size.y - std::abs(local.y), {0, facing(local.y), 0});
      side(0.5 * box->size.z - std::abs(local.z), {0, 0, facing(local.z)});
    } else if (const auto* cylinder = std::get_if<Cylinder>(&shape_)) {
      const double beside = norm({local.x, local.y, 0.0});
      side(cylinder->radius - beside, beside > 0.0 ? Vec3{-local.x / beside, -local.y / beside, 0.0} : Vec3{1, 0, 0});
      side(0.5 * cylinder->length - std::abs(local.z), {0, 0, facing(local.z)});
    }
    return {depth, pose_.orientation(inwards)};
  }

  /// Calls `visit(i, j, k)` for the cells whose centres are inside, in order.
  template <class Visit>
  void each_inside(const Grid& grid, const Visit& visit) const {
    const std::vector<char> inside = distance_ ? cells_inside(grid) : std::vector<char>();
    grid.each([&](std::size_t i, std::size_t j, std::size_t k) {
      const bool is = distance_ ? inside[grid.index(i, j, k)] != 0 : at(grid.centre(i, j, k)).depth > 0.0;
      if (is) visit(i, j, k);
    });
  }

  /// Sets the depths of the cells with centres inside to this solid's, and `region` to `number`, where they are less.
  void add_depths(const Grid& grid, std::uint32_t number, std::vector<double>& depths,
                  std::vector<std::uint32_t>& regions) const {
    // The distance changes by at most the step from one cell to the next.
    double most = std::numeric_limits<double>::infinity();
    std::size_t last = 0;
    each_inside(grid, [&](std::size_t i, std::size_t j, std::size_t k) {
      const std::size_t cell = grid.index(i, j, k);
      const Vec3 centre = grid.centre(i, j, k);
      if (k == 0 || cell != last + 1) most = std::numeric_limits<double>::infinity();
      const double depth = distance_ ? distance_->to_surface(inverse_(centre), most) : at(centre).depth;
      most = (1.0 + rounding) * (depth + grid.step);
      last = cell;
      if (!(depth > depths[cell])) return;
      depths[cell] = depth;
      regions[cell] = number;
    });
  }

  /// Appends the parts of its surface.
  void add_surface(double edge, Parts& parts) const {
    if (const auto* cylinder = std::get_if<Cylinder>(&shape_)) {
      add_cylinder(*cylinder, edge, parts);
    } else {
      add_triangles(surface_, edge, parts);
    }
  }

 private:
  /// The cells whose centres are inside the mesh. Where the mesh is closed, the winding number says which: the sum over
  /// the triangles that a ray crosses. Elsewhere the rays along all six directions of the axes must agree: all wind in
  /// the same direction, or all cross an odd number of triangles.
  [[nodiscard]] std::vector<char> cells_inside(const Grid& grid) const {
    const bool closed = distance_->mesh().closed();
    std::vector<char> forward(grid.size(), 1), backward(grid.size(), closed ? 0 : 1), odd(backward);
    for (unsigned axis = 0; axis < (closed ? 1U : 3U); ++axis) {
      const std::array<std::size_t, 3> count{grid.count[axis], grid.count[(axis + 1) % 3], grid.count[(axis + 2) % 3]};
      const Vec3 lo = turned(grid.lo, axis);
      std::vector<Vec3> vertices;
      vertices.reserve(surface_.vertices.size());
      for (const Vec3& v : surface_.vertices) vertices.push_back(turned(v, axis));
      // Of each row along the axis, the crossings by the number of centres before them.
      struct Crossings {
        int winding = 0;
        int number = 0;
      };
      std::vector<Crossings> crossings(count[1] * count[2] * (count[0] + 1));
      // The centres at `from` or above, and at most `to`, of those with numbers 0 to n - 1.
      const auto centres = [&](double from, double to, std::size_t n) {
        const double first = std::clamp(std::ceil(from / grid.step - 0.5), 0.0, double(n));
        const double last = std::clamp(std::floor(to / grid.step - 0.5) + 1.0, first, double(n));
        return Range{static_cast<std::size_t>(first), static_cast<std::size_t>(last)};
      };
      for (const Triangle& triangle : surface_.triangles) {
        const Vec3 &a = vertices[triangle[0]], &b = vertices[triangle[1]], &c = vertices[triangle[2]];
        const Vec3 low = least_of(least_of(a, b), c), high = greatest_of(greatest_of(a, b), c);
        const Vec3 normal = cross(b - a, c - a);
        const Range js = centres(low.y - lo.y, high.y - lo.y, count[1]);
        const Range ks = centres(low.z - lo.z, high.z - lo.z, count[2]);
        for (std::size_t j = js.first; j < js.last; ++j) {
          for (std::size_t k = ks.first; k < ks.last; ++k) {
            const double y = lo.y + grid.step * (double(j) + 0.5), z = lo.z + grid.step * (double(k) + 0.5);
            const int winding = crossing({low.x - grid.step, y, z}, vertices, triangle);
            if (winding == 0) continue;
            const double x = a.x - (normal.y * (y - a.y) + normal.z * (z - a.z)) / normal.x;
            const std::size_t before = centres(0.0, std::clamp(x, low.x, high.x) - lo.x, count[0]).last;
            Crossings& here = crossings[(j * count[2] + k) * (count[0] + 1) + before];
            here.winding += winding;
            ++here.number;
          }
        }
      }
      for (std::size_t j = 0; j < count[1]; ++j) {
        for (std::size_t k = 0; k < count[2]; ++k) {
          const Crossings* row = &crossings[(j * count[2] + k) * (count[0] + 1)];
          Crossings ahead, behind;
          for (std::size_t i = 0; i <= count[0]; ++i)
            ahead = {ahead.winding + row[i].winding, ahead.number + row[i].number};
          for (std::size_t i = 0; i < count[0]; ++i) {
            behind = {behind.winding + row[i].winding, behind.number + row[i].number};
            ahead = {ahead.winding - row[i].winding, ahead.number - row[i].number};
            const std::size_t cell = axis == 0   ? grid.index(i, j, k)
                                     : axis == 1 ? grid.index(k, i, j)
                                                 : grid.index(j, k, i);
            if (ahead.winding <= 0) forward[cell] = 0;
            if (closed) continue;
            if (behind.winding >= 0) forward[cell] = 0;
            if (ahead.winding >= 0 || behind.winding <= 0) backward[cell] = 0;
            if (ahead.number % 2 == 0 || behind.number % 2 == 0) odd[cell] = 0;
          }
        }
      }
    }
    for (std::size_t cell = 0; cell < forward.size(); ++cell) {
      if (backward[cell] != 0 || odd[cell] != 0) forward[cell] = 1;
    }
    return forward;
  }

  /// Appends the triangles, halved at their longest edges until these are short. Those with their middles in one cell
  /// of a grid are one part.
  static void add_triangles(const Triangles& surface, double edge, Parts& parts) {
    struct Piece {
      std::array<std::int64_t, 3> cell;
      std::array<Vec3, 3> corners;
    };
    std::vector<Piece> pieces;
    const Vec3 lo = bounds_of(surface.vertices).lo;
    std::vector<std::array<Vec3, 3>> waiting;
    for (const auto& [first, second, third] : surface.triangles) {
      waiting.push_back({surface.vertices[first], surface.vertices[second], surface.vertices[third]});
      while (!waiting.empty()) {
        const auto [a, b, c] = waiting.back();
        waiting.pop_back();
        const double ab = dot(b - a, b - a), bc = dot(c - b, c - b), ca = dot(a - c, a - c);
        if (std::max({ab, bc, ca}) > edge * edge) {
          if (ab >= bc && ab >= ca) {
            const Vec3 middle = 0.5 * (a + b);
            waiting.push_back({a, middle, c});
            waiting.push_back({middle, b, c});
          } else if (bc >= ca) {
            const Vec3 middle = 0.5 * (b + c);
            waiting.push_back({a, b, middle});
            waiting.push_back({a, middle, c});
          } else {
            const Vec3 middle = 0.5 * (c + a);
            waiting.push_back({a, b, middle});
            waiting.push_back({middle, b, c});
          }
          continue;
        }
        const Vec3 at = 2.0 / edge * (1.0 / 3.0 * (a + b + c) - lo);
        pieces.push_back({{static_cast<std::int64_t>(std::floor(at.x)), static_cast<std::int64_t>(std::floor(at.y)),
                           static_cast<std::int64_t>(std::floor(at.z))},
                          {a, b, c}});
      }
    }
    std::stable_sort(pieces.begin(), pieces.end(), [](const Piece& a, const Piece& b) { return a.cell < b.cell; });
    std::vector<Vec3> points;
    for (std::size_t first = 0; first < pieces.size();) {
      std::size_t last = first;
      points.clear();
      for (; last < pieces.size() && pieces[last].cell == pieces[first].cell; ++last) {
        points.insert(points.end(), pieces[last].corners.begin(), pieces[last].corners.end());
      }
      const auto& [a, b, c] = pieces[first].corners;
      first = last;
      std::sort(points.begin(), points.end(),
                [](const Vec3& p, const Vec3& q) { return std::tie(p.x, p.y, p.z) < std::tie(q.x, q.y, q.z); });
      points.erase(std::unique(points.begin(), points.end()), points.end());
      if (points.size() > most_points) {
        const Box3 box = bounds_of(points);
        const auto corners = corners_of(box);
        if (norm(box.hi - box.lo) <= 1.6 * edge) points.assign(corners.begin(), corners.end());
      }
      parts.add(points, 1.0 / 3.0 * (a + b + c));
    }
  }

  /// Appends the surface of a cylinder. An arc lies in the triangle of its ends and of the point where the tangents
  /// there meet. So the ends lie in the polygon of these points.
  void add_cylinder(const Cylinder& cylinder, double edge, Parts& parts) const {
    const double radius = cylinder.radius, half = 0.5 * cylinder.length;
    const std::vector<Vec3> along = directions(6.3 * radius / (0.9 * edge));
    const auto layers = static_cast<std::size_t>(std::max(1.0, std::ceil(cylinder.length / (0.9 * edge))));
    Triangles discs;
    for (const double z : {-half, half}) {
      const auto first = static_cast<std::uint32_t>(discs.vertices.size());
      discs.vertices.push_back(pose_({0, 0, z}));
      const auto n = static_cast<std::uint32_t>(along.size());
      for (std::uint32_t i = 0; i < n; ++i) {
        const Vec3& a = along[i];
        const Vec3& b = along[(i + 1) % n];
        const double out = radius / (1.0 + dot(a, b));
        const Vec3 tangents{out * (a.x + b.x), out * (a.y + b.y), z};
        discs.vertices.push_back(pose_(tangents));
        discs.triangles.push_back({first, first + 1 + i, first + 1 + (i + 1) % n});
        if (z > 0.0) continue;
        for (std::size_t layer = 0; layer < layers; ++layer) {
          std::array<Vec3, 6> points;
          for (std::size_t k = 0; k < 2; ++k) {
            const double height = -half + cylinder.length * double(layer + k) / double(layers);
            points[3 * k] = pose_({radius * a.x, radius * a.y, height});
            points[3 * k + 1] = pose_({tangents.x, tangents.y, height});
            points[3 * k + 2] = pose_({radius * b.x, radius * b.y, height});
          }
          const double middle = -half + cylinder.length * (double(layer) + 0.5) / double(layers);
          parts.add(points, pose_({radius * a.x, radius * a.y, middle}));
        }
      }
    }
    add_triangles(discs, edge, parts);
  }

  const Shape3& shape_;
  Pose3 pose_;
  Pose3 inverse_;
  std::optional<MeshDistance> distance_;  ///< of a mesh
  Triangles surface_;                     ///< of a mesh or a box
  Box3 bounds_;
  double area_ = 0.0;
};

/// Returns a radius that contains what rounding leaves out of a ball.
double rounded_up(double radius, const Vec3& centre) { return radius + rounding * (radius + 1e-3 * norm(centre)); }

/// A ball that may be selected.
struct Candidate {
  Vec3 centre;
  double depth = 0.0;   ///< of the centre; 0 on the surface
  double radius = 0.0;  ///< the greatest one allowed
};

/// The parts by where they are.
class PartIndex {
 public:
  /// Orders the parts by the cells of a grid that their mean points are in.
  PartIndex(Parts& parts, const Box3& box, double step) : parts_(parts), grid_(box, step) {
    std::vector<std::size_t> cell(parts.size());
    begin_.assign(grid_.size() + 1, 0);
    for (std::size_t p = 0; p < parts.size(); ++p) {
      Vec3 sum;
      for (const Vec3& corner : parts.points(p)) sum = sum + corner;
      const auto [i, j, k] = grid_.place(1.0 / static_cast<double>(parts.points(p).size()) * sum);
      cell[p] = grid_.index(i, j, k);
      ++begin_[cell[p] + 1];
    }
    std::partial_sum(begin_.begin(), begin_.end(), begin_.begin());
    std::vector<std::uint32_t> next(begin_.begin(), begin_.end() - 1);
    std::vector<std::uint32_t> order(parts.size());
    for (std::size_t p = 0; p < parts.size(); ++p) order[next[cell[p]]++] = static_cast<std::uint32_t>(p);
    parts.reorder(order);
    bounds_.resize(grid_.size());
    for (std::size_t c = 0; c < grid_.size(); ++c) {
      if (begin_[c] < begin_[c + 1]) bounds_[c] = bounds_of(parts.points(begin_[c], begin_[c + 1]));
    }
  }

  /// Calls `visit(part)` for the parts in a ball: their mean points are in it, too.
  template <class Visit>
  void within(const Vec3& c, double radius, const Visit& visit) const {
    const double squared = radius * radius;
    grid_.about(c, radius, [&](std::size_t i, std::size_t j, std::size_t k) {
      const std::size_t cell = grid_.index(i, j, k);
      const std::uint32_t first = begin_[cell], last = begin_[cell + 1];
      if (first == last) return;
      const Vec3 from = bounds_[cell].lo - c, to = bounds_[cell].hi - c;
      const Vec3 far = greatest_of(-1.0 * from, to);
      if (dot(far, far) <= squared) {
        for (std::uint32_t part = first; part < last; ++part) visit(part);
        return;
      }
      const Vec3 near = greatest_of(greatest_of(from, -1.0 * to), {});
      if (dot(near, near) > squared) return;
      for (std::uint32_t part = first; part < last; ++part) {
        if (parts_.within(part, c, squared)) visit(part);
      }
    });
  }

 private:
  const Parts& parts_;
  Grid grid_;
  std::vector<std::uint32_t> begin_;  ///< the first part of each cell
  std::vector<Box3> bounds_;          ///< of the points of a cell's parts
};

/// Selects candidates until each part is in one that `covered` does not mark: always the one with most parts that no
/// other has (lazy greedy set cover: Minoux 1978). Returns less than all where `most` do not suffice.
std::vector<std::uint32_t> select(const PartIndex& index, const std::vector<Candidate>& candidates, std::size_t most,
                                  std::vector<char>& covered) {
  std::vector<std::size_t> begin = {0};
  std::vector<std::uint32_t> items;
  using Entry = std::pair<std::size_t, std::uint32_t>;
  const auto less = [](const Entry& a, const Entry& b) {
    return a.first != b.first ? a.first < b.first : a.second > b.second;
  };
  std::vector<Entry> entries;
  for (const Candidate& candidate : candidates) {
    index.within(candidate.centre, candidate.radius, [&](std::uint32_t part) {
      if (covered[part] == 0) items.push_back(part);
    });
    if (items.size() > begin.back()) {
      entries.emplace_back(items.size() - begin.back(), static_cast<std::uint32_t>(begin.size() - 1));
    }
    begin.push_back(items.size());
  }
  std::vector<std::size_t> end(begin.begin() + 1, begin.end());
  std::priority_queue<Entry, std::vector<Entry>, decltype(less)> waiting(less, std::move(entries));
  std::vector<std::uint32_t> selected;
  while (!waiting.empty() && selected.size() < most) {
    const auto [bound, number] = waiting.top();
    waiting.pop();
    const auto first = items.begin() + static_cast<std::ptrdiff_t>(begin[number]);
    const auto last = std::remove_if(first, items.begin() + static_cast<std::ptrdiff_t>(end[number]),
                                     [&](std::uint32_t part) { return covered[part] != 0; });
    end[number] = static_cast<std::size_t>(last - items.begin());
    const std::size_t gain = end[number] - begin[number];
    if (gain == 0) continue;
    if (gain < bound && !waiting.empty() && less({gain, number}, waiting.top())) {
      waiting.emplace(gain, number);
      continue;
    }
    std::for_each(first, last, [&](std::uint32_t part) { covered[part] = 1; });
    selected.push_back(number);
  }
  return selected;
}

/// The solids of a link that are no spheres or capsules.
class LinkSurface {
 public:
  explicit LinkSurface(std::vector<Region> regions) : regions_(std::move(regions)), box_(regions_.front().bounds()) {
    for (const Region& region : regions_) {
      box_ = {least_of(box_.lo, region.bounds().lo), greatest_of(box_.hi, region.bounds().hi)};
      area_ += region.area();
    }
    const Vec3 extent = box_.hi - box_.lo;
    volume_ = extent.x * extent.y * extent.z;
  }

  /// The least excess at which the cover takes bounded time.
  [[nodiscard]] double least_excess(double work) const {
    return std::max(std::sqrt(area_ / (work * most_area)), cube_root(volume_ / most_cells) / most_step);
  }

  /// A cover, or none where more balls would be needed than allowed.
  struct Attempt {
    std::optional<MedialCover> cover;
    std::size_t needed = 0;  ///< the number of balls, counted up to a few times the number allowed
  };
  [[nodiscard]] Attempt cover(double excess, std::size_t most) const {
    Parts parts;
    for (const Region& region : regions_) region.add_surface(longest_edge * excess, parts);
    // A cell in the grid of parts has a few of them.
    const PartIndex index(parts, box_, std::max(excess, cube_root(volume_ / some_cells)));
    const double step = std::clamp(cube_root(volume_ / some_cells), least_step * excess, most_step * excess);
    const Grid grid(box_, step);
    std::vector<double> depths(grid.size(), 0.0);
    std::vector<std::uint32_t> regions(grid.size(), 0);
    for (std::size_t r = 0; r < regions_.size(); ++r) {
      regions_[r].add_depths(grid, static_cast<std::uint32_t>(r), depths, regions);
    }
    std::vector<Candidate> candidates = inner(grid, depths, regions, excess);
    add_outer(parts, excess, candidates);
    std::vector<char> covered(parts.size(), 0);
    std::vector<Candidate> balls;
    const std::size_t counted = most < parts.size() ? 4 * most : parts.size();
    for (const std::uint32_t number : select(index, candidates, counted, covered)) balls.push_back(candidates[number]);
    for (std::size_t part = 0; part < parts.size(); ++part) {
      if (covered[part] != 0) continue;
      if (balls.size() >= counted) return {std::nullopt, balls.size()};
      const Vec3& middle = parts.middle(part);
      balls.push_back({middle, 0.0, std::max(excess, std::sqrt(parts.farthest(part, middle)) * (1.0 + rounding))});
      index.within(middle, balls.back().radius, [&](std::uint32_t other) { covered[other] = 1; });
    }
    drop_needless(index, parts.size(), balls);
    if (balls.size() > most) return {std::nullopt, balls.size()};
    const Grid fine(box_, fine_step * excess);
    const std::vector<std::uint32_t> inside = cover_inside(fine, excess, balls);
    if (balls.size() > most) return {std::nullopt, balls.size()};
    return {trimmed(parts, index, fine, inside, balls), balls.size()};
  }

 private:
  /// The balls about cells near the medial axis, moved onto it.
  [[nodiscard]] std::vector<Candidate> inner(const Grid& grid, const std::vector<double>& depths,
                                             const std::vector<std::uint32_t>& regions, double excess) const {
    std::vector<Candidate> candidates;
    grid.each([&](std::size_t i, std::size_t j, std::size_t k) {
      const std::size_t cell = grid.index(i, j, k);
      const double depth = depths[cell];
      if (!(depth > 0.0) || on_slope(grid, depths, {i, j, k})) return;
      Candidate ball{grid.centre(i, j, k), depth, 0.0};
      climb(regions_[regions[cell]], grid.step, ball);
      ball.radius = ball.depth + excess;
      candidates.push_back(ball);
    });
    return candidates;
  }

  static bool on_slope(const Grid& grid, const std::vector<double>& depths, const std::array<std::size_t, 3>& at) {
    // By the number of coordinates that differ.
    const std::array<double, 4> rise{0.0, steep * grid.step, steep * 1.4142135623730951 * grid.step,
                                     steep * 1.7320508075688772 * grid.step};
    const double depth = depths[grid.index(at[0], at[1], at[2])];
    const auto from = [&](std::size_t axis) { return at[axis] > 0 ? at[axis] - 1 : 0; };
    const auto to = [&](std::size_t axis) { return std::min(at[axis] + 1, grid.count[axis] - 1); };
    for (std::size_t i = from(0); i <= to(0); ++i) {
      for (std::size_t j = from(1); j <= to(1); ++j) {
        for (std::size_t k = from(2); k <= to(2); ++k) {
          const std::size_t differing = (i != at[0] ? 1U : 0U) + (j != at[1] ? 1U : 0U) + (k != at[2] ? 1U : 0U);
          if (depths[grid.index(i, j, k)] > depth + rise[differing]) return true;
        }
      }
    }
    return false;
  }

  /// Moves a centre away from the surface while it gets deeper. No step leaves the ball inside.
  static void climb(const Region& region, double step, Candidate& ball) {
    Region::Depth here = region.at(ball.centre);
    for (int k = 0; k < 3; ++k) {
      const double length = std::min(0.5 * step, 0.9 * here.depth);
      const Vec3 next = ball.centre + length * here.inwards;
      const Region::Depth there = region.at(next);
      if (there.depth > here.depth + 0.1 * length) {
        ball.centre = next;
        ball.depth = there.depth;
        here = there;
      } else {
        step *= 0.5;
      }
    }
  }

  /// The balls about points of the surface, of each cell of a grid one.
  void add_outer(const Parts& parts, double excess, std::vector<Candidate>& candidates) const {
    const double step = 0.7 * excess;
    std::vector<std::array<std::int64_t, 3>> cells;
    std::vector<std::uint32_t> order(parts.size());
    cells.reserve(parts.size());
    for (std::size_t p = 0; p < parts.size(); ++p) {
      const Vec3 at = 1.0 / step * (parts.middle(p) - box_.lo);
      cells.push_back({static_cast<std::int64_t>(std::floor(at.x)), static_cast<std::int64_t>(std::floor(at.y)),
                       static_cast<std::int64_t>(std::floor(at.z))});
    }
    std::iota(order.begin(), order.end(), 0U);
    std::sort(order.begin(), order.end(),
              [&](std::uint32_t a, std::uint32_t b) { return std::tie(cells[a], a) < std::tie(cells[b], b); });
    for (std::size_t i = 0; i < order.size(); ++i) {
      if (i > 0 && cells[order[i]] == cells[order[i - 1]]) continue;
      candidates.push_back({parts.middle(order[i]), 0.0, excess});
    }
  }

  /// Removes balls whose parts are all in others.
  static void drop_needless(const PartIndex& index, std::size_t parts, std::vector<Candidate>& balls) {
    std::vector<std::uint32_t> number(parts, 0);
    for (const Candidate& ball : balls) {
      index.within(ball.centre, ball.radius, [&](std::uint32_t part) { ++number[part]; });
    }
    std::erase_if(balls, [&](const Candidate& ball) {
      bool needed = false;
      index.within(ball.centre, ball.radius, [&](std::uint32_t part) { needed = needed || number[part] == 1; });
      if (!needed) index.within(ball.centre, ball.radius, [&](std::uint32_t part) { --number[part]; });
      return !needed;
    });
  }

  /// Appends balls until each cell that is inside as a whole lies in one. Returns these cells.
  [[nodiscard]] std::vector<std::uint32_t> cover_inside(const Grid& grid, double excess,
                                                        std::vector<Candidate>& balls) const {
    std::vector<char> covered(grid.size(), 0);
    for (const Candidate& ball : balls) {
      grid.about(ball.centre, ball.radius, [&](std::size_t i, std::size_t j, std::size_t k) {
        const double most = ball.radius * ball.radius;
        if (farthest(grid, {i, j, k}, ball.centre) <= most) covered[grid.index(i, j, k)] = 1;
      });
    }
    const double half = (0.5 + 2.0 * rounding) * grid.step;
    const Vec3 to_corner{half, half, half};
    Parts cells;
    std::vector<Candidate> candidates;
    std::vector<std::uint32_t> inside;
    Box3 box;
    std::vector<char> known(grid.size(), 0);
    for (const Region& region : regions_) {
      region.each_inside(grid, [&](std::size_t i, std::size_t j, std::size_t k) {
        const std::size_t cell = grid.index(i, j, k);
        if (known[cell] != 0) return;
        const Vec3 centre = grid.centre(i, j, k);
        if (covered[cell] == 0) {
          const double depth = region.at(centre).depth;
          if (depth < norm(to_corner)) return;
          box = cells.size() == 0 ? Box3{centre, centre} : Box3{least_of(box.lo, centre), greatest_of(box.hi, centre)};
          cells.add(corners_of({centre - to_corner, centre + to_corner}), centre);
          candidates.push_back({centre, depth, depth + excess});
        }
        known[cell] = 1;
        inside.push_back(static_cast<std::uint32_t>(cell));
      });
    }
    if (cells.size() > 0) {
      const PartIndex index(cells, box, std::max(excess, grid.step));
      std::vector<char> done(cells.size(), 0);
      for (const std::uint32_t number : select(index, candidates, candidates.size(), done)) {
        balls.push_back(candidates[number]);
      }
    }
    return inside;
  }

  /// The square of the distance of a cell's farthest corner.
  static double farthest(const Grid& grid, const std::array<std::size_t, 3>& cell, const Vec3& from) {
    const Vec3 d = grid.centre(cell[0], cell[1], cell[2]) - from;
    const double half = (0.5 + rounding) * grid.step;
    const Vec3 far{std::abs(d.x) + half, std::abs(d.y) + half, std::abs(d.z) + half};
    return dot(far, far);
  }

  /// Makes the balls as small as their parts allow: each part is that of the ball which it makes protrude least.
  static MedialCover trimmed(const Parts& parts, const PartIndex& index, const Grid& grid,
                             const std::vector<std::uint32_t>& inside, const std::vector<Candidate>& balls) {
    struct Best {
      double excess = std::numeric_limits<double>::infinity();
      double squared = 0.0;
      std::uint32_t ball = 0;
    };
    std::vector<Best> of_part(parts.size()), of_cell(grid.size());
    const auto compare = [&](Best& best, double squared, std::uint32_t ball) {
      const double excess = std::sqrt(squared) - balls[ball].depth;
      if (excess < best.excess) best = {excess, squared, ball};
    };
    for (std::uint32_t b = 0; b < balls.size(); ++b) {
      const auto& [centre, depth, radius] = balls[b];
      index.within(centre, radius,
                   [&, &c = centre](std::uint32_t part) { compare(of_part[part], parts.farthest(part, c), b); });
      grid.about(centre, radius, [&, &c = centre, &r = radius](std::size_t i, std::size_t j, std::size_t k) {
        const double squared = farthest(grid, {i, j, k}, c);
        if (squared <= r * r) compare(of_cell[grid.index(i, j, k)], squared, b);
      });
    }
    std::vector<double> radii(balls.size());
    std::vector<char> used(balls.size(), 0);
    for (std::size_t b = 0; b < balls.size(); ++b) radii[b] = balls[b].depth;
    const auto enlarge = [&](const Best& best) {
      used[best.ball] = 1;
      radii[best.ball] = std::max(radii[best.ball], std::sqrt(best.squared));
    };
    for (const Best& best : of_part) enlarge(best);
    for (const std::uint32_t cell : inside) {
      if (of_cell[cell].squared > 0.0) enlarge(of_cell[cell]);
    }
    MedialCover cover;
    for (std::size_t b = 0; b < balls.size(); ++b) {
      if (used[b] == 0) continue;
      cover.balls.push_back({balls[b].centre, rounded_up(radii[b], balls[b].centre)});
      cover.excess = std::max(cover.excess, radii[b] - balls[b].depth);
    }
    return cover;
  }

  std::vector<Region> regions_;
  Box3 box_;
  double area_ = 0.0;
  double volume_ = 0.0;
};

/// Covers a capsule by balls along its segment: between two centres at the distance s, the balls contain all points
/// within sqrt(r^2 - s^2 / 4) of the segment.
void add_capsule(const Capsule& capsule, const Pose3& pose, double excess, MedialCover& cover) {
  const double radius = capsule.radius + excess;
  const double spacing = 2.0 * std::sqrt(excess * (2.0 * capsule.radius + excess));
  const auto steps = static_cast<std::size_t>(std::ceil(capsule.length / spacing));
  const double step = steps > 0 ? capsule.length / static_cast<double>(steps) : 0.0;
  const double needed = std::min(radius, std::sqrt(capsule.radius * capsule.radius + 0.25 * step * step));
  for (std::size_t i = 0; i <= steps; ++i) {
    const Vec3 centre = pose({0.0, 0.0, -0.5 * capsule.length + step * static_cast<double>(i)});
    cover.balls.push_back({centre, rounded_up(needed, centre)});
  }
  cover.excess = std::max(cover.excess, needed - capsule.radius);
}

/// The solids that are no spheres or capsules.
std::vector<Region> regions_of(std::span<const Solid> solids) {
  std::vector<Region> regions;
  for (const Solid& solid : solids) {
    if (std::holds_alternative<Sphere>(solid.shape) || std::holds_alternative<Capsule>(solid.shape)) continue;
    regions.emplace_back(solid);
  }
  return regions;
}

}  // namespace

double least_cover_excess(std::span<const Solid> solids, const CoverOptions& options) {
  std::vector<Region> regions = regions_of(solids);
  return regions.empty() ? 0.0 : LinkSurface(std::move(regions)).least_excess(options.work);
}

MedialCover medial_cover(std::span<const Solid> solids, const CoverOptions& options) {
  MedialCover cover;
  for (const Solid& solid : solids) {
    if (const auto* sphere = std::get_if<Sphere>(&solid.shape)) {
      cover.balls.push_back({solid.pose.position, sphere->radius});
    } else if (const auto* capsule = std::get_if<Capsule>(&solid.shape)) {
      add_capsule(*capsule, solid.pose, options.excess, cover);
    }
  }
  if (std::vector<Region> regions = regions_of(solids); !regions.empty()) {
    const LinkSurface link(std::move(regions));
    double excess = std::max(options.excess, link.least_excess(options.work));
    std::optional<MedialCover> rest;
    while (!rest) {
      const bool last = !(excess < options.most_excess);
      auto attempt = link.cover(excess, last ? std::numeric_limits<std::size_t>::max() : options.most_balls);
      // The number of balls falls with a power of the excess between one and two.
      const double ratio = static_cast<double>(attempt.needed) / static_cast<double>(options.most_balls);
      const double factor = std::clamp(std::sqrt(ratio * std::sqrt(ratio)), 1.1, 2.0);
      excess = std::min(factor * excess, options.most_excess);
      rest = std::move(attempt.cover);
    }
    cover.balls.insert(cover.balls.end(), rest->balls.begin(), rest->balls.end());
    cover.excess = std::max(cover.excess, rest->excess);
  }
  return cover;
}

}  // namespace trellis
