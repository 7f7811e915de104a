// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/collision/planar/separation.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace trellis {

namespace {

/// A corner, and how far it lies along a direction.
struct Extreme {
  double along = std::numeric_limits<double>::infinity();
  std::size_t corner = 0;
};

Extreme least(const std::vector<Vec2>& corners, Vec2 n) {
  Extreme found;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    if (const double along = dot(n, corners[i]); along < found.along) found = {along, i};
  }
  return found;
}

/// The edge whose normal separates two sets of corners most.
struct Separator {
  double gap = -std::numeric_limits<double>::infinity();
  Vec2 normal;           ///< of the edge
  bool nearest = false;  ///< the other shape's nearest corner lies before the edge, so that the gap is the distance
};

/// Replaces `best` where an edge of `corners` separates more.
/// \param apart  from the origin of `corners` to that of `others`
void separate(const std::vector<Vec2>& corners, const std::vector<Vec2>& normals, const std::vector<Vec2>& others,
              Vec2 apart, Separator& best) {
  for (std::size_t i = 0; i < normals.size(); ++i) {
    const Vec2 n = normals[i];
    const Extreme other = least(others, n);
    const double gap = other.along + dot(n, apart) - dot(n, corners[i]);
    if (gap <= best.gap) continue;
    const Vec2 along{-n.y, n.x};
    const double at = dot(along, others[other.corner] + apart);
    best = {gap, n, dot(along, corners[i]) <= at && at <= dot(along, corners[(i + 1) % corners.size()])};
  }
}

}  // namespace

void write_convex(const ConvexShape& shape, Convex& out) {
  if (const auto* disc = std::get_if<Disc>(&shape)) {
    out.corners.assign(1, disc->centre);
    out.normals.clear();
    out.radius = disc->radius;
    return;
  }
  const auto& v = std::get<Polygon>(shape).vertices;
  out.corners.assign(v.begin(), v.end());
  out.radius = 0.0;
  out.normals.resize(v.size());
  for (std::size_t i = 0; i < v.size(); ++i) {
    const Vec2 along = v[i + 1 < v.size() ? i + 1 : 0] - v[i];
    out.normals[i] = 1.0 / norm(along) * Vec2{along.y, -along.x};
  }
}

void write_convex(const Box2& box, Convex& out) {
  out.corners = {box.lo, {box.hi.x, box.lo.y}, box.hi, {box.lo.x, box.hi.y}};
  out.normals = {{0, -1}, {1, 0}, {0, 1}, {-1, 0}};
  out.radius = 0.0;
}

void MovingConvex::set(const Convex& shape, const Pose2& middle, Vec2 translation, double turn) {
  origin_ = {middle.x, middle.y};
  translation_ = translation;
  turn_ = turn;
  radius_ = shape.radius;
  const auto turned = [&](Vec2 p) { return Vec2{middle.c * p.x - middle.s * p.y, middle.s * p.x + middle.c * p.y}; };
  arms_.resize(shape.corners.size());
  std::transform(shape.corners.begin(), shape.corners.end(), arms_.begin(), turned);
  normals_.resize(shape.normals.size());
  std::transform(shape.normals.begin(), shape.normals.end(), normals_.begin(), turned);
}

// At a share s in [-1, 1] an arm p lies at u cos(s turn) + z sin(s turn) along n, where u = n.p and z is that of p
// turned by a right angle. The sine differs from its angle by at most a sixth of its cube, and the cosine from 1 by
// half its square; translation and turn together are linear in s.
double MovingConvex::loss(double translation, double u, double z) const {
  const double turn = std::abs(turn_);
  return std::abs(translation + z * turn_) + turn * turn * (0.5 * std::max(u, 0.0) + std::abs(z) * turn / 6.0);
}

double MovingConvex::least_along(Vec2 n) const {
  const double translation = dot(n, translation_);
  double arm = std::numeric_limits<double>::infinity();
  for (const Vec2 p : arms_) {
    const double u = dot(n, p);
    arm = std::min(arm, u - loss(translation, u, cross(p, n)));
  }
  return dot(n, origin_) + arm;
}

Box2 MovingConvex::box() const {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  Box2 box{{infinity, infinity}, {-infinity, -infinity}};
  for (const Vec2 p : arms_) {
    box.lo.x = std::min(box.lo.x, p.x - loss(translation_.x, p.x, -p.y));
    box.hi.x = std::max(box.hi.x, p.x + loss(translation_.x, -p.x, -p.y));
    box.lo.y = std::min(box.lo.y, p.y - loss(translation_.y, p.y, p.x));
    box.hi.y = std::max(box.hi.y, p.y + loss(translation_.y, -p.y, p.x));
  }
  const Vec2 outwards{radius_, radius_};
  return {origin_ + box.lo - outwards, origin_ + box.hi + outwards};
}

Box2 MovingConvex::middle_box() const {
  const Box2 box = bounding_box(arms_);
  const Vec2 outwards{radius_, radius_};
  return {origin_ + box.lo - outwards, origin_ + box.hi + outwards};
}

// The distance of two disjoint convex polygons is their largest gap along a direction. Where their nearest points are a
// corner and a point of an edge it is the edge's normal; else these points are corners.
MovingConvex::Gap MovingConvex::gap(const Convex& obstacle) const {
  Separator best;
  separate(obstacle.corners, obstacle.normals, arms_, origin_, best);
  const double of_obstacle = best.gap;
  separate(arms_, normals_, obstacle.corners, -1.0 * origin_, best);
  Vec2 towards = best.gap > of_obstacle ? -1.0 * best.normal : best.normal;  // from the obstacle
  double middle = best.gap;
  const bool discs = obstacle.normals.empty() && normals_.empty();
  if (middle <= 0.0 && !discs) return {};
  if (!best.nearest) {
    Vec2 nearest;
    double squared = std::numeric_limits<double>::infinity();
    for (const Vec2 p : arms_) {
      for (const Vec2 q : obstacle.corners) {
        const Vec2 apart = p + origin_ - q;
        if (const double d = dot(apart, apart); d < squared) {
          squared = d;
          nearest = apart;
        }
      }
    }
    if (squared <= 0.0) return {};
    nearest = 1.0 / std::sqrt(squared) * nearest;
    // Of two edges with one gap, the other may have the nearest point: then these corners are not the nearest.
    const double gap =
        least(arms_, nearest).along + dot(nearest, origin_) + least(obstacle.corners, -1.0 * nearest).along;
    if (gap > middle) {
      middle = gap;
      towards = nearest;
    }
  }
  const double radii = radius_ + obstacle.radius;
  if (middle <= radii) return {};
  const double end = -least(obstacle.corners, -1.0 * towards).along;
  return {middle - radii, least_along(towards) - end - radii};
}

}  // namespace trellis
