// SPDX-License-Identifier: GPL-3.0-or-later
// The judge of paths (support/path_judge.hpp), and cases whose verdicts are known.
#include "support/path_judge.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <utility>

#include "support/catch.hpp"
#include "support/exact.hpp"
#include "unit/scene_spatial.hpp"

namespace trellis::test {

/// Not unnamed, because PathJudge::Work has members of these types.
namespace judging {

using Real = long double;

/// A vector of the plane (z = 0) or of space.
struct Vec {
  Real x = 0, y = 0, z = 0;

  friend Vec operator+(const Vec& a, const Vec& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
  friend Vec operator-(const Vec& a, const Vec& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
  friend Vec operator*(Real s, const Vec& a) { return {s * a.x, s * a.y, s * a.z}; }
};
Real dot(const Vec& a, const Vec& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
Vec cross(const Vec& a, const Vec& b) { return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x}; }
Real norm(const Vec& a) { return std::sqrt(dot(a, a)); }
Vec vec(Vec2 p) { return {p.x, p.y, 0}; }
Vec vec(const Vec3& p) { return {p.x, p.y, p.z}; }

/// Bounds on a distance in metres, negative or 0 in contact. `upper` is infinite where it is not known.
struct Gap {
  Real lower = 0;
  Real upper = std::numeric_limits<Real>::infinity();
  Vec direction;  ///< a unit vector along which bodies are apart by `lower`; 0: none is known
};

/// A bound on the speed at which the gap of two bodies changes, in metres per unit of a motion's parameter: that of a
/// translation, of which the share along the gap's direction matters, and all else.
struct Rate {
  Vec translation;
  Real rest = 0;

  [[nodiscard]] Real total() const { return norm(translation) + rest; }
  [[nodiscard]] Real along(const Vec& direction) const {
    return norm(direction) == 0 ? total() : std::abs(dot(translation, direction)) + rest;
  }
};

/// A cap on distance computations per motion.
constexpr std::uint64_t most_evaluations = 3'000'000;

// The plane.

/// A polygon, or a disc: one vertex and a radius.
struct Flat {
  std::vector<Vec> vertices;
  Real radius = 0;
  bool convex = true;
  Vec middle;      ///< of a disc around it
  Real reach = 0;  ///< the radius of that disc

  void bound() {
    middle = {};
    for (const Vec& v : vertices) middle = middle + (1.0L / static_cast<Real>(vertices.size())) * v;
    reach = 0;
    for (const Vec& v : vertices) reach = std::max(reach, norm(v - middle));
    reach += radius;
    convex = true;
    for (std::size_t i = 0, n = vertices.size(); i < n && n > 3; ++i) {
      const Vec &a = vertices[i], &b = vertices[(i + 1) % n], &c = vertices[(i + 2) % n];
      convex = convex && cross(b - a, c - b).z >= 0;
    }
  }
};

std::vector<Vec2> outline(const Polygon& polygon) { return polygon.vertices; }

Flat flat(const Shape& shape) {
  Flat result;
  if (const auto* disc = std::get_if<Disc>(&shape)) {
    result.vertices = {vec(disc->centre)};
    result.radius = disc->radius;
  } else if (const auto* box = std::get_if<Box2>(&shape)) {
    for (const Vec2 v : {box->lo, {box->hi.x, box->lo.y}, box->hi, {box->lo.x, box->hi.y}}) {
      result.vertices.push_back(vec(v));
    }
  } else {
    for (const Vec2 v : outline(std::get<Polygon>(shape))) result.vertices.push_back(vec(v));
  }
  result.bound();
  return result;
}

/// The vector to p from the nearest point of a segment.
Vec from_segment(const Vec& p, const Vec& a, const Vec& b) {
  const Vec along = b - a;
  const Real square = dot(along, along);
  const Real t = square > 0 ? std::clamp(dot(p - a, along) / square, 0.0L, 1.0L) : 0.0L;
  return p - (a + t * along);
}

bool within_polygon(const std::vector<Vec>& v, const Vec& p) {
  bool odd = false;
  for (std::size_t i = 0, j = v.size() - 1; i < v.size(); j = i++) {
    if ((v[i].y > p.y) == (v[j].y > p.y)) continue;
    if (p.x < (v[j].x - v[i].x) * (p.y - v[i].y) / (v[j].y - v[i].y) + v[i].x) odd = !odd;
  }
  return odd;
}

/// The distance of outlines, less the radii: 0 or less in contact.
Gap distance(const Flat& a, const Flat& b) {
  const auto &v = a.vertices, &w = b.vertices;
  if ((w.size() > 2 && within_polygon(w, v[0])) || (v.size() > 2 && within_polygon(v, w[0]))) return {0, 0, {}};
  Vec best;
  Real least = std::numeric_limits<Real>::infinity();
  const auto add = [&](const Vec& d) {
    const Real square = dot(d, d);
    if (square < least) {
      least = square;
      best = d;
    }
  };
  for (std::size_t i = 0, j = v.size() - 1; i < v.size(); j = i++) {
    for (std::size_t k = 0, l = w.size() - 1; k < w.size(); l = k++) {
      const Real p = cross(v[i] - v[j], w[k] - v[j]).z, q = cross(v[i] - v[j], w[l] - v[j]).z;
      const Real r = cross(w[k] - w[l], v[i] - w[l]).z, s = cross(w[k] - w[l], v[j] - w[l]).z;
      if (p * q < 0 && r * s < 0) return {0, 0, {}};
      add(from_segment(v[i], w[l], w[k]));
      add(from_segment(w[k], v[j], v[i]));
    }
  }
  const Real length = norm(best), gap = length - a.radius - b.radius;
  // The nearest points of convex bodies give a direction that separates them.
  if (!a.convex || !b.convex || length == 0) return {gap, gap, {}};
  return {gap, gap, (1 / length) * best};
}

// Space.

/// The convex hull of points, and of discs about them where `disc` > 0, grown by a radius.
struct Convex {
  std::vector<Vec> points;
  Real radius = 0;
  Real disc = 0;
  Vec first, second;  ///< orthogonal unit vectors along the discs
  Vec middle;
  Real reach = 0;  ///< the radius of a ball around it

  void bound() {
    middle = {};
    for (const Vec& p : points) middle = middle + (1.0L / static_cast<Real>(points.size())) * p;
    reach = 0;
    for (const Vec& p : points) reach = std::max(reach, norm(p - middle));
    reach += radius + disc;
  }
  /// Returns the point farthest in a direction, without the radius.
  [[nodiscard]] Vec support(const Vec& direction) const {
    const Vec* best = &points.front();
    for (const Vec& p : points) {
      if (dot(p, direction) > dot(*best, direction)) best = &p;
    }
    if (disc == 0) return *best;
    // Not as the direction less its share along the axis, of which rounding may leave a remainder along the axis alone.
    const Vec across = dot(direction, first) * first + dot(direction, second) * second;
    const Real length = norm(across);
    return length > 0 ? *best + (disc / length) * across : *best;
  }
};

/// The rotation by a quaternion that need not have norm 1.
struct Rotation {
  Real x = 0, y = 0, z = 0, w = 1;

  Rotation() = default;
  Rotation(Real i, Real j, Real k, Real real) : x(i), y(j), z(k), w(real) {
    const Real length = std::sqrt(x * x + y * y + z * z + w * w);
    for (Real* c : {&x, &y, &z, &w}) *c /= length;
  }
  explicit Rotation(const Quaternion& q) : Rotation(q.x, q.y, q.z, q.w) {}

  [[nodiscard]] Vec operator()(const Vec& v) const {
    const Vec axis{x, y, z};
    const Vec twice = 2.0L * cross(axis, v);
    return v + w * twice + cross(axis, twice);
  }
  friend Rotation operator*(const Rotation& a, const Rotation& b) {
    return {a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y, a.w * b.y + a.y * b.w + a.z * b.x - a.x * b.z,
            a.w * b.z + a.z * b.w + a.x * b.y - a.y * b.x, a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z};
  }
  [[nodiscard]] Rotation inverse() const { return {-x, -y, -z, w}; }
};

Convex moved(const Convex& shape, const Rotation& turn, const Vec& by) {
  Convex result = shape;
  for (Vec& p : result.points) p = turn(p) + by;
  result.first = turn(shape.first);
  result.second = turn(shape.second);
  result.middle = turn(shape.middle) + by;
  return result;
}

/// The convex pieces of a solid; of a mesh that is not a convex solid, its triangles.
std::vector<Convex> pieces(const Solid& solid, bool surface) {
  std::vector<Convex> result;
  Convex piece;
  if (const auto* sphere = std::get_if<Sphere>(&solid.shape)) {
    piece.points = {{}};
    piece.radius = sphere->radius;
  } else if (const auto* box = std::get_if<Cuboid>(&solid.shape)) {
    const Vec half = 0.5L * vec(box->size);
    for (const int corner : {0, 1, 2, 3, 4, 5, 6, 7}) {
      piece.points.push_back({(corner & 1) != 0 ? half.x : -half.x, (corner & 2) != 0 ? half.y : -half.y,
                              (corner & 4) != 0 ? half.z : -half.z});
    }
  } else if (const auto* cylinder = std::get_if<Cylinder>(&solid.shape)) {
    piece.points = {{0, 0, -0.5L * cylinder->length}, {0, 0, 0.5L * cylinder->length}};
    piece.disc = cylinder->radius;
    piece.first = {1, 0, 0};
    piece.second = {0, 1, 0};
  } else if (const auto* capsule = std::get_if<Capsule>(&solid.shape)) {
    piece.points = {{0, 0, -0.5L * capsule->length}, {0, 0, 0.5L * capsule->length}};
    piece.radius = capsule->radius;
  } else {
    const Mesh& mesh = *std::get<std::shared_ptr<const Mesh>>(solid.shape);
    if (mesh.convex() && !surface) {
      for (const Vec3& v : mesh.vertices()) piece.points.push_back(vec(v));
    } else {
      for (const Triangle& t : mesh.triangles()) {
        Convex triangle;
        for (const std::uint32_t v : t) triangle.points.push_back(vec(mesh.vertices()[v]));
        result.push_back(triangle);
      }
    }
  }
  if (result.empty()) result.push_back(piece);
  const Rotation turn(solid.pose.orientation);
  for (Convex& each : result) {
    each = moved(each, turn, vec(solid.pose.position));
    each.bound();
  }
  return result;
}

/// Replaces up to four points by those of them whose hull has the point nearest to the origin, and returns that point.
Vec nearest(std::vector<Vec>& simplex) {
  const std::size_t n = simplex.size();
  Real best = std::numeric_limits<Real>::infinity();
  Vec at;
  unsigned of = 0;
  for (unsigned set = 1; set < (1U << n); ++set) {
    std::array<Vec, 4> p;
    std::size_t count = 0;
    for (std::size_t i = 0; i < n; ++i) {
      if ((set >> i & 1U) != 0) p[count++] = simplex[i];
    }
    // The nearest point p0 + sum t_i (p_i - p0) of the affine hull, by Gram's equations.
    const std::size_t k = count - 1;
    std::array<std::array<Real, 4>, 3> rows = {};
    for (std::size_t i = 0; i < k; ++i) {
      for (std::size_t j = 0; j < k; ++j) rows[i][j] = dot(p[i + 1] - p[0], p[j + 1] - p[0]);
      rows[i][3] = -dot(p[i + 1] - p[0], p[0]);
    }
    bool singular = false;
    for (std::size_t i = 0; i < k; ++i) {
      std::size_t pivot = i;
      for (std::size_t j = i + 1; j < k; ++j) {
        if (std::abs(rows[j][i]) > std::abs(rows[pivot][i])) pivot = j;
      }
      std::swap(rows[i], rows[pivot]);
      if (rows[i][i] == 0) {
        singular = true;
        break;
      }
      for (std::size_t j = 0; j < k; ++j) {
        if (j == i) continue;
        const Real factor = rows[j][i] / rows[i][i];
        for (std::size_t c = i; c < 4; ++c) rows[j][c] -= factor * rows[i][c];
      }
    }
    if (singular) continue;
    Real first = 1;
    bool within = true;
    Vec point = p[0];
    for (std::size_t i = 0; i < k; ++i) {
      const Real t = rows[i][3] / rows[i][i];
      first -= t;
      within = within && t >= 0;
      point = point + t * (p[i + 1] - p[0]);
    }
    if (!within || first < 0) continue;
    const Real length = norm(point);
    if (length < best) {
      best = length;
      at = point;
      of = set;
    }
  }
  std::vector<Vec> kept;
  for (std::size_t i = 0; i < n; ++i) {
    if ((of >> i & 1U) != 0) kept.push_back(simplex[i]);
  }
  simplex = std::move(kept);
  return at;
}

/// Bounds on the distance of convex bodies by the algorithm of Gilbert, Johnson and Keerthi. The lower bound is that of
/// a separating direction, the upper one that of a point of both bodies' hulls.
/// \param enough  stops at a lower bound above it
Gap distance(const Convex& a, const Convex& b, Real enough, Real contact) {
  const Real radii = a.radius + b.radius;
  Gap gap;
  gap.lower = norm(a.middle - b.middle) - a.reach - b.reach;
  if (gap.lower > enough) return gap;
  Vec v = a.middle - b.middle;
  if (norm(v) == 0) v = {1, 0, 0};
  std::vector<Vec> simplex;
  constexpr int most_iterations = 60;
  for (int i = 0; i < most_iterations; ++i) {
    const Vec w = a.support(-1.0L * v) - b.support(v);
    const Real along = dot(v, w) / norm(v) - radii;
    if (along > gap.lower || norm(gap.direction) == 0) {
      gap.lower = along;
      gap.direction = (1 / norm(v)) * v;
    }
    if (gap.lower > enough) return gap;
    if (std::any_of(simplex.begin(), simplex.end(), [&w](const Vec& p) { return norm(p - w) == 0; })) break;
    simplex.push_back(w);
    v = nearest(simplex);
    const Real length = norm(v);
    gap.upper = length - radii;
    if (gap.upper <= contact || simplex.size() == 4 || gap.upper - gap.lower <= 1e-15L * length) break;
  }
  return gap;
}

/// Collects the verdict about one motion.
struct Search {
  Judgement judgement;
  std::uint64_t evaluations = 0;

  [[nodiscard]] bool hit() const { return judgement.verdict == Verdict::hit; }
  void contact(Real t, std::string what) {
    judgement.verdict = Verdict::hit;
    judgement.at = static_cast<double>(t);
    judgement.what = std::move(what);
  }
  void leave_open(Real t, std::string what) {
    if (judgement.verdict != Verdict::free) return;
    judgement.verdict = Verdict::undecided;
    judgement.at = static_cast<double>(t);
    judgement.what = std::move(what);
  }
};

}  // namespace judging

using namespace judging;

/// What both kinds of scenes have: pairs of things that must not touch, at a configuration of a motion.
struct PathJudge::Work {
  Work() = default;
  Work(const Work&) = delete;
  Work(Work&&) = delete;
  Work& operator=(const Work&) = delete;
  Work& operator=(Work&&) = delete;
  virtual ~Work() = default;

  /// One of the shortest motions between two configurations.
  struct Motion {
    std::vector<Real> from, by;  ///< of lines and circles: the start and the difference
    Rotation turn_from;          ///< of the rotation
    Vec turn_by;                 ///< its rotation vector
  };

  [[nodiscard]] virtual std::vector<Motion> motions(View a, View b) const = 0;
  virtual void place(const Motion& motion, Real t) const = 0;
  [[nodiscard]] virtual std::size_t pair_count() const = 0;
  /// Of the pair at the last placement.
  [[nodiscard]] virtual Gap gap(std::size_t pair, Real enough) const = 0;
  [[nodiscard]] virtual Rate rate(const Motion& motion, std::size_t pair) const = 0;
  [[nodiscard]] virtual std::string describe(std::size_t pair) const = 0;
  /// Whether the robot begins inside a body of which `gap` sees the surface alone; "" if not.
  [[nodiscard]] virtual std::string swallowed() const { return ""; }
  /// Of a point: decides a motion exactly.
  virtual void decide_point(View a, View b, Search& search) const = 0;

  bool point = false;
  Real contact = 0;  ///< metres below which rounding hides a contact
  Real slack = 0;    ///< the touching slack that the library documents

  void set_size(double size) {
    contact = 1e-17L * size;
    slack = std::ldexp(static_cast<Real>(size), -43);
  }

  void judge(View a, View b, Search& search) const {
    if (point) {
      decide_point(a, b, search);
    } else {
      divide(a, b, 0, search);
    }
  }

  /// Halves the parameters of a motion until each interval is free or a configuration in contact is found.
  /// \param least  metres, 0 or more: distances up to it count as contact
  void divide(View a, View b, Real least, Search& search) const {
    for (const Motion& motion : motions(a, b)) {
      std::vector<std::size_t> pairs(pair_count());
      for (std::size_t i = 0; i < pairs.size(); ++i) pairs[i] = i;
      for (const Real end : {0.0L, 1.0L}) {
        place(motion, end);
        for (const std::size_t pair : pairs) {
          if (gap(pair, least + slack).upper <= least + contact) search.contact(end, describe(pair));
          if (search.hit()) return;
        }
      }
      place(motion, 0.0L);
      if (const std::string what = swallowed(); !what.empty()) search.contact(0.0L, what);
      if (search.hit()) return;
      std::vector<Rate> rates;
      for (const std::size_t pair : pairs) rates.push_back(rate(motion, pair));
      halve(motion, rates, 0.0L, 1.0L, pairs, least, search);
      if (search.hit()) return;
    }
  }

  void halve(const Motion& motion, const std::vector<Rate>& rates, Real from, Real to,
             const std::vector<std::size_t>& pairs, Real least, Search& search) const {
    const Real half = 0.5L * (to - from), middle = from + half;
    place(motion, middle);
    std::vector<std::size_t> left;
    for (const std::size_t pair : pairs) {
      const Real displacement = rates[pair].total() * half;
      const Gap found = gap(pair, displacement + least);
      if (found.upper <= least + contact) search.contact(middle, describe(pair));
      if (search.hit()) return;
      if (found.lower - least > std::min(displacement, rates[pair].along(found.direction) * half)) continue;
      if (displacement < slack || ++search.evaluations > most_evaluations) {
        search.leave_open(middle, describe(pair));
      } else {
        left.push_back(pair);
      }
    }
    if (left.empty()) return;
    halve(motion, rates, from, middle, left, least, search);
    if (!search.hit()) halve(motion, rates, middle, to, left, least, search);
  }
};

namespace {

/// The differences of a circle's coordinate that lead to b: the shorter one; of half a period both.
std::vector<Real> differences(const Axis& axis, double a, double b) {
  const Real period = static_cast<Real>(axis.hi) - axis.lo;
  Real by = std::remainder(static_cast<Real>(b) - a, period);
  if (0.5L * period - std::abs(by) > 1e-12L * period) return {by};
  by = std::abs(by);
  return {by, by - period};
}

class PlanarWork final : public PathJudge::Work {
 public:
  PlanarWork(const PlanarScene& scene, Space space, const std::vector<std::vector<Shape>>& shapes)
      : scene_(scene), space_(std::move(space)) {
    const auto& [lo, hi] = scene_.world.bounds();
    Real reach = 0;
    for (const auto& obstacle : scene_.world.obstacles()) obstacles_.push_back(flat(obstacle.shape));
    for (std::size_t i = 0; i < scene_.robot.bodies().size(); ++i) {
      const Body& body = scene_.robot.bodies()[i];
      if (shapes.empty()) {
        for (const ConvexShape& part : body.parts) {
          add(i, std::visit([](const auto& of) { return Shape(of); }, part));
        }
      } else {
        for (const Shape& part : shapes[i]) add(i, part);
      }
      reach += norm(vec(body.joint)) + farthest(i);
    }
    set_size(std::max({std::abs(lo.x), std::abs(lo.y), std::abs(hi.x), std::abs(hi.y), static_cast<double>(reach)}));
    point = scene_.robot.bodies().size() == 1 && parts_.size() == 1 && parts_[0].shape.reach == 0 &&
            norm(parts_[0].shape.middle) == 0 && scene_.robot.translates();
    for (std::size_t i = 0; i < parts_.size(); ++i) {
      pairs_.push_back({i, boundary});
      for (std::size_t k = 0; k < obstacles_.size(); ++k) pairs_.push_back({i, k});
    }
    for (const auto& [first, second] : scene_.robot.pairs()) {
      for (std::size_t i = 0; i < parts_.size(); ++i) {
        for (std::size_t j = 0; j < parts_.size(); ++j) {
          if (parts_[i].body == first && parts_[j].body == second) pairs_.push_back({i, itself + j});
        }
      }
    }
    placed_.resize(parts_.size());
  }

  [[nodiscard]] std::vector<Motion> motions(View a, View b) const override {
    std::vector<Motion> all(1);
    all[0].from.assign(a.begin(), a.end());
    for (std::size_t j = 0; j < space_.dimension(); ++j) {
      const Axis& axis = space_.axes()[j];
      const std::vector<Real> by =
          axis.periodic ? differences(axis, a[j], b[j]) : std::vector<Real>{static_cast<Real>(b[j]) - a[j]};
      std::vector<Motion> longer;
      for (const Real d : by) {
        for (Motion motion : all) {
          motion.by.push_back(d);
          longer.push_back(std::move(motion));
        }
      }
      all = std::move(longer);
    }
    return all;
  }

  void place(const Motion& motion, Real t) const override {
    const auto at = [&](std::size_t j) { return motion.from[j] + t * motion.by[j]; };
    const Robot& robot = scene_.robot;
    frames_.resize(robot.bodies().size());
    for (std::size_t i = 0; i < frames_.size(); ++i) {
      const Body& body = robot.bodies()[i];
      Frame parent;
      if (body.parent >= 0) {
        parent = frames_[static_cast<std::size_t>(body.parent)];
      } else {
        parent.origin = robot.translates() ? Vec{at(0), at(1), 0} : vec(robot.base());
      }
      Frame& frame = frames_[i];
      frame.origin = parent(vec(body.joint));
      frame.angle = body.absolute ? 0 : parent.angle;
      if (body.angle_axis >= 0) {
        frame.angle += at(static_cast<std::size_t>(body.angle_axis));
      } else {
        frame.angle = parent.angle;
      }
      frame.c = std::cos(frame.angle);
      frame.s = std::sin(frame.angle);
    }
    for (std::size_t i = 0; i < parts_.size(); ++i) {
      placed_[i] = parts_[i].shape;
      for (Vec& v : placed_[i].vertices) v = frames_[parts_[i].body](v);
      placed_[i].middle = frames_[parts_[i].body](parts_[i].shape.middle);
    }
  }

  [[nodiscard]] std::size_t pair_count() const override { return pairs_.size(); }

  [[nodiscard]] Gap gap(std::size_t pair, Real enough) const override {
    const auto& [part, other] = pairs_[pair];
    const Flat& shape = placed_[part];
    if (other == boundary) {
      const auto& [lo, hi] = scene_.world.bounds();
      Real margin = std::numeric_limits<Real>::infinity();
      for (const Vec& v : shape.vertices) margin = std::min({margin, v.x - lo.x, hi.x - v.x, v.y - lo.y, hi.y - v.y});
      margin += 2 * slack - shape.radius;
      return {margin, margin, {}};
    }
    const Flat& against = other >= itself ? placed_[other - itself] : obstacles_[other];
    const Real least = norm(shape.middle - against.middle) - shape.reach - against.reach;
    if (least > enough) return {least, std::numeric_limits<Real>::infinity(), {}};
    return distance(shape, against);
  }

  [[nodiscard]] Rate rate(const Motion& motion, std::size_t pair) const override {
    const auto& [part, other] = pairs_[pair];
    // Two bodies of the robot move with its reference point.
    if (other != boundary && other >= itself)
      return {{}, turning_rate(motion, part) + turning_rate(motion, other - itself)};
    return {scene_.robot.translates() ? Vec{motion.by[0], motion.by[1], 0} : Vec{}, turning_rate(motion, part)};
  }

  [[nodiscard]] std::string describe(std::size_t pair) const override {
    const std::size_t other = pairs_[pair].other;
    if (other == boundary) return "the boundary";
    if (other >= itself) return "itself";
    return scene_.world.obstacles()[other].name + " (" + std::to_string(other) + ")";
  }

  void decide_point(View a, View b, Search& search) const override {
    const auto& [lo, hi] = scene_.world.bounds();
    for (const View q : {a, b}) {
      const Real out = std::max({static_cast<Real>(lo.x) - q[0], static_cast<Real>(q[0]) - hi.x,
                                 static_cast<Real>(lo.y) - q[1], static_cast<Real>(q[1]) - hi.y});
      if (out > 2 * slack) {
        search.contact(0, "the boundary");
        return;
      }
      if (out > 0) search.leave_open(0, "the boundary");
    }
    Flat segment;
    segment.vertices = {vec(Vec2{a[0], a[1]}), vec(Vec2{b[0], b[1]})};
    segment.bound();
    for (std::size_t k = 0; k < obstacles_.size(); ++k) {
      const Flat& obstacle = obstacles_[k];
      if (norm(segment.middle - obstacle.middle) - segment.reach - obstacle.reach > 2 * slack) continue;
      // Long double is wrong by less than 2^-60 of the world's size.
      if (distance(segment, obstacle).lower > 2 * slack) continue;
      const std::string& name = scene_.world.obstacles()[k].name;
      if (touches_shape(scene_.world.obstacles()[k].shape, a, b)) {
        search.contact(0, name + " (" + std::to_string(k) + ")");
        return;
      }
      search.leave_open(0, name);
    }
  }

 private:
  static constexpr std::size_t itself = std::size_t{1} << 32U;
  static constexpr std::size_t boundary = std::numeric_limits<std::size_t>::max();

  struct Part {
    std::size_t body;
    Flat shape;
  };
  struct Pair {
    std::size_t part;
    std::size_t other;  ///< an obstacle, `itself` and a part, or `boundary`
  };
  struct Frame {
    Vec origin;
    Real angle = 0, c = 1, s = 0;
    Vec operator()(const Vec& p) const { return {origin.x + c * p.x - s * p.y, origin.y + s * p.x + c * p.y, 0}; }
  };

  void add(std::size_t body, const Shape& shape) { parts_.push_back({body, flat(shape)}); }

  [[nodiscard]] Real farthest(std::size_t body) const {
    Real far = 0;
    for (const Part& part : parts_) {
      if (part.body != body) continue;
      for (const Vec& v : part.shape.vertices) far = std::max(far, norm(v) + part.shape.radius);
    }
    return far;
  }

  static bool touches_shape(const Shape& shape, View a, View b) {
    const Exact3 from{a[0], a[1], 0.0}, to{b[0], b[1], 0.0};
    if (const auto* disc = std::get_if<Disc>(&shape)) {
      return within(exact(disc->centre), from, to, Exact(disc->radius) * Exact(disc->radius));
    }
    std::vector<Exact3> polygon;
    if (const auto* box = std::get_if<Box2>(&shape)) {
      for (const Vec2 v : {box->lo, {box->hi.x, box->lo.y}, box->hi, {box->lo.x, box->hi.y}}) {
        polygon.push_back(exact(v));
      }
    } else {
      for (const Vec2 v : outline(std::get<Polygon>(shape))) polygon.push_back(exact(v));
    }
    return touches(polygon, from, to);
  }

  /// Angles change at constant rates, so that a point at distance r from its body's origin moves by at most r times the
  /// body's rate, and with the origin. The reference point counts as fixed.
  [[nodiscard]] Real turning_rate(const Motion& motion, std::size_t part) const {
    const Robot& robot = scene_.robot;
    std::vector<Real> origin(robot.bodies().size()), turn(robot.bodies().size());
    for (std::size_t i = 0; i < origin.size(); ++i) {
      const Body& body = robot.bodies()[i];
      const bool child = body.parent >= 0;
      const auto parent = static_cast<std::size_t>(child ? body.parent : 0);
      const Real parent_turn = child ? turn[parent] : 0;
      origin[i] = child ? origin[parent] + std::abs(parent_turn) * norm(vec(body.joint)) : 0;
      turn[i] = parent_turn;
      if (body.angle_axis >= 0) {
        turn[i] = (body.absolute ? 0 : parent_turn) + motion.by[static_cast<std::size_t>(body.angle_axis)];
      }
    }
    const Part& of = parts_[part];
    Real far = 0;
    // A disc that turns about its centre does not move.
    for (const Vec& v : of.shape.vertices) far = std::max(far, norm(v));
    return origin[of.body] + std::abs(turn[of.body]) * far;
  }

  const PlanarScene& scene_;
  Space space_;
  std::vector<Flat> obstacles_;
  std::vector<Part> parts_;
  std::vector<Pair> pairs_;
  mutable std::vector<Frame> frames_;
  mutable std::vector<Flat> placed_;
};

class SpatialWork final : public PathJudge::Work {
 public:
  SpatialWork(const SpatialScene& scene, Space space) : scene_(scene), space_(std::move(space)) {
    const World3& world = scene_.world;
    const auto& [lo, hi] = world.bounds();
    for (std::size_t k = 0; k < world.obstacles().size(); ++k) {
      for (Convex& piece : pieces(world.obstacles()[k].solid, world.surface())) {
        obstacles_.push_back(std::move(piece));
        obstacle_of_.push_back(k);
      }
    }
    Real reach = 0;
    for (const Solid& solid : scene_.robot.solids()) {
      for (Convex& piece : pieces(solid, false)) {
        reach = std::max(reach, norm(piece.middle) + piece.reach);
        parts_.push_back(std::move(piece));
      }
    }
    set_size(std::max({std::abs(lo.x), std::abs(lo.y), std::abs(lo.z), std::abs(hi.x), std::abs(hi.y), std::abs(hi.z),
                       static_cast<double>(reach)}));
    point = reach == 0 && !scene_.robot.rotates();
    placed_ = parts_;
    for (std::size_t i = 0; i < parts_.size(); ++i) {
      if (world.contain() != Contain::none) pairs_.push_back({i, boundary});
      for (std::size_t k = 0; k < obstacles_.size(); ++k) pairs_.push_back({i, k});
    }
  }

  [[nodiscard]] std::vector<Motion> motions(View a, View b) const override {
    Motion motion;
    for (std::size_t j = 0; j < 3; ++j) {
      motion.from.push_back(a[j]);
      motion.by.push_back(static_cast<Real>(b[j]) - a[j]);
    }
    if (!scene_.robot.rotates()) return {motion};
    motion.turn_from = Rotation(a[3], a[4], a[5], a[6]);
    const Rotation turn = motion.turn_from.inverse() * Rotation(b[3], b[4], b[5], b[6]);
    const Vec axis{turn.x, turn.y, turn.z};
    const Real sine = norm(axis);
    if (sine == 0) return {motion};
    const Real half = std::atan2(sine, std::abs(turn.w));
    motion.turn_by = ((turn.w < 0 ? -2 : 2) * half / sine) * axis;
    if (std::abs(turn.w) > 1e-12L) return {motion};
    Motion other = motion;
    const Real angle = norm(motion.turn_by);
    other.turn_by = ((angle - 2 * std::numbers::pi_v<Real>) / angle) * motion.turn_by;
    return {motion, other};
  }

  void place(const Motion& motion, Real t) const override {
    position_ = {motion.from[0] + t * motion.by[0], motion.from[1] + t * motion.by[1],
                 motion.from[2] + t * motion.by[2]};
    const Real angle = norm(motion.turn_by);
    Rotation turn = motion.turn_from;
    if (angle > 0) {
      const Vec axis = (std::sin(0.5L * t * angle) / angle) * motion.turn_by;
      turn = turn * Rotation(axis.x, axis.y, axis.z, std::cos(0.5L * t * angle));
    }
    for (std::size_t i = 0; i < parts_.size(); ++i) placed_[i] = moved(parts_[i], turn, position_);
  }

  [[nodiscard]] std::size_t pair_count() const override { return pairs_.size(); }

  [[nodiscard]] Gap gap(std::size_t pair, Real enough) const override {
    const auto& [part, other] = pairs_[pair];
    if (other != boundary) return distance(placed_[part], obstacles_[other], enough, contact);
    const auto& [lo, hi] = scene_.world.bounds();
    const Vec low = vec(lo), high = vec(hi);
    if (scene_.world.contain() == Contain::reference) {
      const Vec& p = position_;
      const Real margin = std::min({p.x - low.x, high.x - p.x, p.y - low.y, high.y - p.y, p.z - low.z, high.z - p.z});
      return {margin + 2 * slack, margin + 2 * slack, {}};
    }
    const Convex& shape = placed_[part];
    const Vec least{shape.support({-1, 0, 0}).x, shape.support({0, -1, 0}).y, shape.support({0, 0, -1}).z};
    const Vec most{shape.support({1, 0, 0}).x, shape.support({0, 1, 0}).y, shape.support({0, 0, 1}).z};
    const Real margin = std::min({least.x - low.x, least.y - low.y, least.z - low.z, high.x - most.x, high.y - most.y,
                                  high.z - most.z}) -
                        shape.radius + 2 * slack;
    return {margin, margin, {}};
  }

  [[nodiscard]] Rate rate(const Motion& motion, std::size_t pair) const override {
    const Convex& part = parts_[pairs_[pair].part];
    Real far = 0;
    for (const Vec& p : part.points) far = std::max(far, norm(p));
    return {{motion.by[0], motion.by[1], motion.by[2]}, norm(motion.turn_by) * (far + part.disc)};
  }

  [[nodiscard]] std::string describe(std::size_t pair) const override {
    const std::size_t other = pairs_[pair].other;
    return other == boundary ? "the boundary" : name(obstacle_of_[other]);
  }

  [[nodiscard]] std::string swallowed() const override {
    for (std::size_t k = 0; k < scene_.world.obstacles().size(); ++k) {
      const Mesh* mesh = solid_mesh(k);
      if (mesh == nullptr) continue;
      const Solid& solid = scene_.world.obstacles()[k].solid;
      for (const Convex& part : placed_) {
        const Vec p = Rotation(solid.pose.orientation).inverse()(part.points.front() - vec(solid.pose.position));
        if (inside(*mesh, Vec3{static_cast<double>(p.x), static_cast<double>(p.y), static_cast<double>(p.z)})) {
          return name(k);
        }
      }
    }
    return "";
  }

  void decide_point(View a, View b, Search& search) const override {
    const auto& [lo, hi] = scene_.world.bounds();
    if (scene_.world.contain() != Contain::none) {
      for (const View q : {a, b}) {
        const Vec p = vec(Vec3{q[0], q[1], q[2]}), low = p - vec(lo), high = vec(hi) - p;
        const Real out = -std::min({low.x, low.y, low.z, high.x, high.y, high.z});
        if (out > 2 * slack) {
          search.contact(0, "the boundary");
          return;
        }
        if (out > 0) search.leave_open(0, "the boundary");
      }
    }
    Convex segment;
    segment.points = {vec(Vec3{a[0], a[1], a[2]}), vec(Vec3{b[0], b[1], b[2]})};
    segment.bound();
    for (std::size_t i = 0; i < obstacles_.size(); ++i) {
      // A direction that separates by more than the slack is far beyond the rounding of long double.
      if (distance(segment, obstacles_[i], 2 * slack, -1).lower > 2 * slack) continue;
      const std::size_t k = obstacle_of_[i];
      if (touches_solid(scene_.world.obstacles()[k].solid, a, b, scene_.world.surface())) {
        search.contact(0, name(k));
        return;
      }
      search.leave_open(0, name(k));
    }
    for (std::size_t k = 0; k < scene_.world.obstacles().size(); ++k) {
      const Mesh* mesh = solid_mesh(k);
      if (mesh == nullptr) continue;
      // Poses of such meshes are translations by a short binary fraction, so that this difference is exact enough.
      const Solid& solid = scene_.world.obstacles()[k].solid;
      if (inside(*mesh, solid.pose.inverse()(Vec3{a[0], a[1], a[2]}))) {
        search.contact(0, name(k));
        return;
      }
    }
  }

 private:
  static constexpr std::size_t boundary = std::numeric_limits<std::size_t>::max();
  struct Pair {
    std::size_t part;
    std::size_t other;  ///< a piece of an obstacle, or `boundary`
  };

  [[nodiscard]] std::string name(std::size_t k) const {
    return scene_.world.obstacles()[k].name + " (" + std::to_string(k) + ")";
  }

  /// The mesh of an obstacle that is solid and whose pieces are its triangles.
  [[nodiscard]] const Mesh* solid_mesh(std::size_t k) const {
    const auto* mesh = std::get_if<std::shared_ptr<const Mesh>>(&scene_.world.obstacles()[k].solid.shape);
    if (mesh == nullptr || scene_.world.surface() || !(*mesh)->closed() || (*mesh)->convex()) return nullptr;
    return mesh->get();
  }

  /// In the solid's frame, where all lengths are larger by the square of its quaternion's norm.
  static bool touches_solid(const Solid& solid, View a, View b, bool surface) {
    const Quaternion& q = solid.pose.orientation;
    const Exact scale = dot(Exact3{q.x, q.y, q.z}, Exact3{q.x, q.y, q.z}) + Exact(q.w) * Exact(q.w);
    const Exact3 origin = exact(solid.pose.position);
    const Exact3 from = turned(q.inverse(), Exact3{a[0], a[1], a[2]} - origin);
    const Exact3 to = turned(q.inverse(), Exact3{b[0], b[1], b[2]} - origin);
    const Exact half = 0.5;
    const auto squared = [&scale](double r) { return scale * scale * Exact(r) * Exact(r); };
    if (const auto* sphere = std::get_if<Sphere>(&solid.shape)) {
      return within(Exact3{0.0, 0.0, 0.0}, from, to, squared(sphere->radius));
    }
    if (const auto* box = std::get_if<Cuboid>(&solid.shape)) {
      return touches_box(from, to, half * (scale * exact(box->size)));
    }
    if (const auto* cylinder = std::get_if<Cylinder>(&solid.shape)) {
      return touches_cylinder(from, to, scale * Exact(cylinder->radius), half * scale * Exact(cylinder->length));
    }
    if (const auto* capsule = std::get_if<Capsule>(&solid.shape)) {
      const Exact end = half * scale * Exact(capsule->length);
      return within(from, to, Exact3{0.0, 0.0, Exact(0.0) - end}, Exact3{0.0, 0.0, end}, squared(capsule->radius));
    }
    const Mesh& mesh = *std::get<std::shared_ptr<const Mesh>>(solid.shape);
    const bool meets = std::any_of(mesh.triangles().begin(), mesh.triangles().end(), [&](const Triangle& t) {
      const auto vertex = [&](std::size_t i) { return scale * exact(mesh.vertices()[t[i]]); };
      return touches_triangle(from, to, {vertex(0), vertex(1), vertex(2)});
    });
    return meets || (mesh.convex() && !surface && inside(mesh, solid.pose.inverse()(Vec3{a[0], a[1], a[2]})));
  }

  const SpatialScene& scene_;
  Space space_;
  std::vector<Convex> obstacles_;
  std::vector<std::size_t> obstacle_of_;  ///< of each piece
  std::vector<Convex> parts_;
  std::vector<Pair> pairs_;
  mutable std::vector<Convex> placed_;
  mutable Vec position_;
};

}  // namespace

PathJudge::PathJudge(std::shared_ptr<const Scene> scene, Space space, std::vector<std::vector<Shape>> bodies)
    : scene_(std::move(scene)) {
  if (const PlanarScene* planar = scene_->planar()) {
    work_ = std::make_unique<PlanarWork>(*planar, std::move(space), bodies);
  } else {
    work_ = std::make_unique<SpatialWork>(*scene_->spatial(), std::move(space));
  }
}

PathJudge::~PathJudge() = default;

Judgement PathJudge::motion(View a, View b) const {
  Search search;
  work_->judge(a, b, search);
  return search.judgement;
}

Judgement PathJudge::path(const Configurations& path) const {
  Judgement open;
  for (std::size_t i = 0; i + 1 < path.size(); ++i) {
    Judgement judgement = motion(path[i], path[i + 1]);
    judgement.leg = i;
    if (judgement.verdict == Verdict::hit) return judgement;
    if (judgement.verdict == Verdict::undecided && open.verdict == Verdict::free) open = judgement;
  }
  return open;
}

Judgement PathJudge::nearer(const Configurations& path, double clearance) const {
  // One percent less, so that a motion beside an edge needs few intervals, and the touching slack less, by which a
  // checker grows the boundary.
  const Real least = std::max(0.0L, 0.99L * clearance - 4 * work_->slack);
  for (std::size_t i = 0; i + 1 < path.size(); ++i) {
    Search search;
    work_->divide(path[i], path[i + 1], least, search);
    search.judgement.leg = i;
    if (search.hit()) return search.judgement;
  }
  return {};
}

bool PathJudge::clear(View q, double gap) const {
  const auto motion = work_->motions(q, q).front();
  work_->place(motion, 0.0L);
  if (!work_->swallowed().empty()) return false;
  for (std::size_t pair = 0; pair < work_->pair_count(); ++pair) {
    if (!(work_->gap(pair, gap).lower > gap)) return false;
  }
  return true;
}

}  // namespace trellis::test

namespace {

using namespace trellis;
using namespace trellis::test;

std::shared_ptr<const Scene> flat_scene(std::vector<Obstacle> obstacles, Robot robot) {
  return std::make_shared<const PlanarScene>(World({{0, 0}, {10, 10}}, std::move(obstacles)), std::move(robot));
}

std::shared_ptr<const Scene> deep_scene(std::vector<Obstacle3> obstacles, Robot3 robot) {
  return std::make_shared<const SpatialScene>(World3({{0, 0, 0}, {10, 10, 10}}, std::move(obstacles)),
                                              std::move(robot));
}

Verdict verdict(const std::shared_ptr<const Scene>& scene, const Configuration& a, const Configuration& b) {
  return PathJudge(scene, scene->default_space(1.0)).motion(a, b).verdict;
}

}  // namespace

TEST_CASE("the judge decides the segments of a point in the plane exactly", "[certified][judge]") {
  const Obstacle low{"", Box2{{1, 1}, {2, 2}}}, high{"", Box2{{2, 2}, {3, 3}}};
  const auto cells = flat_scene({low, high}, Robot::point());
  CHECK(verdict(cells, {1, 3}, {3, 1}) == Verdict::hit);  // through the common corner
  CHECK(verdict(cells, {0.5, 1}, {0.9, 1}) == Verdict::free);
  CHECK(verdict(cells, {0.5, 1}, {1, 1}) == Verdict::hit);  // up to the corner
  CHECK(verdict(cells, {0, 2}, {1.5, 2}) == Verdict::hit);  // along the edge
  CHECK(verdict(cells, {0, 2.001}, {1.5, 2.001}) == Verdict::free);
  CHECK(verdict(cells, {0, std::nextafter(2.0, 3.0)}, {1.5, std::nextafter(2.0, 3.0)}) == Verdict::undecided);
  CHECK(verdict(cells, {1.2, 1.2}, {1.3, 1.3}) == Verdict::hit);  // inside
  CHECK(verdict(cells, {5, 5}, {5, 10.5}) == Verdict::hit);       // beyond the boundary
  CHECK(verdict(cells, {5, 5}, {5, 10}) == Verdict::free);
  const auto sliver = flat_scene({{"", Polygon{{{1, 1}, {9, 1}, {9, 1 + 1e-9}}}}}, Robot::point());
  CHECK(verdict(sliver, {5, 0}, {5, 2}) == Verdict::hit);
  CHECK(verdict(sliver, {0.999, 0}, {0.999, 2}) == Verdict::free);
  const auto disc = flat_scene({{"", Disc{{5, 5}, 1}}}, Robot::point());
  CHECK(verdict(disc, {0, 6}, {10, 6}) == Verdict::hit);  // a tangent
  CHECK(verdict(disc, {0, 6.0001}, {10, 6.0001}) == Verdict::free);
}

TEST_CASE("the judge decides the segments of a point in space exactly", "[certified][judge]") {
  const double half = std::sqrt(0.5);
  const auto scene = [](const Solid& solid) { return deep_scene({{"", solid}}, Robot3::point()); };
  const auto box = scene({Cuboid{{2, 2, 2}}, {{5, 5, 5}, {}}});
  CHECK(verdict(box, {0, 6, 6}, {10, 6, 6}) == Verdict::hit);  // along an edge
  CHECK(verdict(box, {0, 6, 6.01}, {10, 6, 6.01}) == Verdict::free);
  CHECK(verdict(box, {4, 4, 3}, {4, 4, 5}) == Verdict::hit);
  const auto turned_box = scene({Cuboid{{2, 2, 2}}, {{5, 5, 5}, rotation_of({0, 0, std::numbers::pi / 4})}});
  CHECK(verdict(turned_box, {6.4, 0, 5}, {6.4, 10, 5}) == Verdict::hit);
  CHECK(verdict(turned_box, {6.42, 0, 5}, {6.42, 10, 5}) == Verdict::free);
  const auto lying = scene({Cylinder{1, 4}, {{5, 5, 5}, {half, 0, 0, half}}});  // its axis along y
  CHECK(verdict(lying, {0, 5, 6}, {10, 5, 6.0001}) == Verdict::free);
  CHECK(verdict(lying, {0, 6.9, 5.9}, {10, 6.9, 5.9}) == Verdict::hit);
  CHECK(verdict(lying, {0, 7.1, 5}, {10, 7.1, 5}) == Verdict::free);
  const auto standing = scene({Capsule{1, 2}, {{5, 5, 5}, {}}});
  CHECK(verdict(standing, {0, 5, 7}, {10, 5, 7}) == Verdict::hit);  // touches its end
  CHECK(verdict(standing, {0, 5, 7.001}, {10, 5, 7.001}) == Verdict::free);
  CHECK(verdict(standing, {0, 6, 5.5}, {10, 6, 5.5}) == Verdict::hit);  // touches its side
  const auto ball = scene({Sphere{1}, {{5, 5, 5}, {}}});
  CHECK(verdict(ball, {0, 6, 5}, {10, 6, 5}) == Verdict::hit);
  const auto tetrahedron = scene(
      {std::make_shared<const Mesh>(Mesh::hull({{1, 1, 1}, {3, 1, 1}, {1, 3, 1}, {1, 1, 3}}, "tetrahedron")), {}});
  CHECK(verdict(tetrahedron, {0, 2, 1}, {5, 2, 1}) == Verdict::hit);  // in a face's plane, touches a corner of it
  CHECK(verdict(tetrahedron, {1.2, 1.2, 1.2}, {1.3, 1.3, 1.3}) == Verdict::hit);
  CHECK(verdict(tetrahedron, {0, 0, 3}, {3, 3, 3}) == Verdict::hit);
  CHECK(verdict(tetrahedron, {0, 0, 3.01}, {3, 3, 3.01}) == Verdict::free);
}

TEST_CASE("the judge follows turns, chains of links and half turns", "[certified][judge]") {
  const Robot bar = Robot::rigid({Box2{{0, -0.05}, {1, 0.05}}});
  const auto above = flat_scene({{"", Disc{{5, 5.9}, 0.2}}}, bar);
  CHECK(verdict(above, {5, 5, 0}, {5, 5, 2}) == Verdict::hit);
  CHECK(verdict(above, {5, 5, 0}, {5, 5, -2}) == Verdict::free);
  CHECK(verdict(above, {5, 5, 3}, {5, 5, -3}) == Verdict::free);
  CHECK(verdict(above, {5, 5, 0}, {5, 5, -std::numbers::pi}) == Verdict::hit);
  // The farthest corner of the bar passes at hypot(1, 0.05) m.
  const double reach = std::hypot(1.0, 0.05);
  CHECK(verdict(flat_scene({{"", Box2{{4, 5 + reach + 1e-6}, {6, 7}}}}, bar), {5, 5, 0}, {5, 5, 3}) == Verdict::free);
  CHECK(verdict(flat_scene({{"", Box2{{4, 5 + reach - 1e-6}, {6, 7}}}}, bar), {5, 5, 0}, {5, 5, 3}) == Verdict::hit);
  Arm arm;
  arm.links = {1, 1, 1};
  arm.widths = {0.1, 0.1, 0.1};
  arm.base = {5, 5};
  const auto folding = flat_scene({}, Robot::arm(arm));
  CHECK(verdict(folding, {0, 0, 0}, {0, 2, 2}) == Verdict::free);
  CHECK(verdict(folding, {0, 0, 0}, {0, 2.5, 2.5}) == Verdict::hit);  // the last link meets the first
}

TEST_CASE("the judge follows bodies in space", "[certified][judge]") {
  const Robot3 bar("bar", {{Cuboid{{2, 0.1, 0.1}}, {}}});
  const auto scene = deep_scene({{"plate", {Cuboid{{0.001, 4, 4}}, {{5, 5, 5}, {}}}}}, bar);
  const double half = std::sqrt(0.5);
  const Configuration beside = {3, 5, 5, 0, 0, half, half}, beyond = {7, 5, 5, 0, 0, half, half};
  CHECK(verdict(scene, beside, beyond) == Verdict::hit);
  CHECK(verdict(scene, beside, {3, 8, 5, 0, 0, half, half}) == Verdict::free);
  const Configuration along = {4.2, 5, 5, 0, 0, 0, 1};
  CHECK(verdict(scene, {4.2, 5, 5, 0, 0, half, half}, along) == Verdict::hit);
  // It passes the plate's edge by 1e-9 m, or touches it.
  const double past = 7.0 + 0.05;
  CHECK(verdict(scene, {3, past + 1e-9, 5, 0, 0, 0, 1}, {7, past + 1e-9, 5, 0, 0, 0, 1}) == Verdict::free);
  CHECK(verdict(scene, {3, past - 1e-9, 5, 0, 0, 0, 1}, {7, past - 1e-9, 5, 0, 0, 0, 1}) == Verdict::hit);
  const auto torus =
      deep_scene({{"torus", {std::make_shared<const Mesh>(spatial_tests::torus(3, 1, 12, 8).mesh()), {{5, 5, 5}, {}}}}},
                 Robot3("cube", {{Cuboid{{0.2, 0.2, 0.2}}, {}}}));
  CHECK(verdict(torus, {5, 5, 2, 0, 0, 0, 1}, {5, 5, 8, half, 0, 0, half}) == Verdict::free);  // through the hole
  CHECK(verdict(torus, {8, 5, 5, 0, 0, 0, 1}, {8, 5.1, 5, 0, 0, 0, 1}) == Verdict::hit);       // inside the solid
}

TEST_CASE("the judge finds where a path comes nearer than a clearance", "[certified][judge]") {
  const auto nearer = [](const std::shared_ptr<const Scene>& scene, const std::vector<Configuration>& points,
                         double clearance) {
    Configurations path(points.front().size());
    for (const Configuration& q : points) path.push(q);
    return PathJudge(scene, scene->default_space(1.0)).nearer(path, clearance).verdict == Verdict::hit;
  };
  const auto point = flat_scene({{"", Box2{{4, 0}, {6, 4}}}}, Robot::point());
  CHECK_FALSE(nearer(point, {{1, 5}, {9, 5}}, 1.0));
  CHECK(nearer(point, {{1, 5}, {9, 5}}, 1.02));
  CHECK(nearer(point, {{1, 9.5}, {9, 9.5}}, 0.52));  // to the boundary
  // The bar's end passes the obstacle in the middle of its turn.
  const auto bar = flat_scene({{"", Box2{{4, 6.5}, {6, 7}}}}, Robot::rigid({Box2{{0, -0.05}, {1, 0.05}}}));
  const double gap = 1.5 - std::hypot(1.0, 0.05);
  CHECK_FALSE(nearer(bar, {{5, 5, 0}, {5, 5, 3}}, gap));
  CHECK(nearer(bar, {{5, 5, 0}, {5, 5, 3}}, 1.02 * gap));
  const auto ball =
      deep_scene({{"", {Cylinder{1, 4}, {{5, 5, 5}, {}}}}}, Robot3("ball", {Solid{Sphere{0.5}, {}}}, false));
  CHECK_FALSE(nearer(ball, {{1, 7, 5}, {9, 7, 5}}, 0.5));
  CHECK(nearer(ball, {{1, 7, 5}, {9, 7, 5}}, 0.51));
}
