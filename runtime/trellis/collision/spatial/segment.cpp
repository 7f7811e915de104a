// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/collision/spatial/segment.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <utility>
#include <variant>

#include <trellis/base/error.hpp>
#include <trellis/scene/spatial/point_cloud.hpp>
#include <trellis/scene/spatial/ranges.hpp>

namespace trellis {

namespace {

/// The parameters between which a segment is in contact; none where lo > hi.
struct Clip {
  double lo = 0.0;
  double hi = 1.0;

  /// Keeps the parameters t with |at + t * change| <= limit.
  void within(double at, double change, double limit) {
    if (change == 0.0) {
      if (std::abs(at) > limit) hi = -1.0;
      return;
    }
    const auto [first, second] = std::minmax({(-limit - at) / change, (limit - at) / change});
    lo = std::max(lo, first);
    hi = std::min(hi, second);
  }
  [[nodiscard]] double middle() const { return std::clamp(0.5 * (lo + hi), 0.0, 1.0); }
};

double nearest_parameter(const Segment3& segment, const Vec3& p) {
  const double squared = dot(segment.along, segment.along);
  return squared > 0.0 ? std::clamp(dot(p - segment.from, segment.along) / squared, 0.0, 1.0) : 0.0;
}

/// Returns the parameters of the nearest points of two segments, on the first and on the second.
std::pair<double, double> nearest_parameters(const Segment3& a, const Segment3& b) {
  const Vec3 between = a.from - b.from;
  const double aa = dot(a.along, a.along);
  const double bb = dot(b.along, b.along);
  const double ab = dot(a.along, b.along);
  const double a_between = dot(a.along, between);
  const double b_between = dot(b.along, between);
  double best = std::numeric_limits<double>::infinity();
  std::pair<double, double> found{0.0, 0.0};
  const auto offer = [&](double s, double t) {
    const Vec3 gap = a.at(s) - b.at(t);
    const double squared = dot(gap, gap);
    if (squared < best) {
      best = squared;
      found = {s, t};
    }
  };
  // Inside both segments, or at an end of one of them.
  const double determinant = aa * bb - ab * ab;
  if (determinant > 0.0) {
    const double s = (ab * b_between - bb * a_between) / determinant;
    const double t = (aa * b_between - ab * a_between) / determinant;
    if (s >= 0.0 && s <= 1.0 && t >= 0.0 && t <= 1.0) offer(s, t);
  }
  for (const double end : {0.0, 1.0}) {
    offer(end, nearest_parameter(b, a.at(end)));
    offer(nearest_parameter(a, b.at(end)), end);
  }
  return found;
}

struct ShapeContact {
  const Segment3& segment;
  double reach;

  std::optional<double> operator()(const Sphere& sphere) const {
    const double t = nearest_parameter(segment, {});
    if (norm(segment.at(t)) > sphere.radius + reach) return {};
    return t;
  }

  std::optional<double> operator()(const Cuboid& cuboid) const {
    const Vec3 half = 0.5 * cuboid.size;
    const Vec3& p = segment.from;
    const Vec3& d = segment.along;
    // The axes that separate a segment and a box are those of the box and their cross products with the segment.
    const auto apart = [&](double middle, double extent, double length) {
      return std::abs(middle) > extent + reach * length;
    };
    const Vec3 middle = segment.at(0.5);
    const Vec3 reach_of{std::abs(0.5 * d.x), std::abs(0.5 * d.y), std::abs(0.5 * d.z)};
    if (apart(middle.x, half.x + reach_of.x, 1.0) || apart(middle.y, half.y + reach_of.y, 1.0) ||
        apart(middle.z, half.z + reach_of.z, 1.0) ||
        apart(p.y * d.z - p.z * d.y, half.y * std::abs(d.z) + half.z * std::abs(d.y), std::hypot(d.y, d.z)) ||
        apart(p.z * d.x - p.x * d.z, half.z * std::abs(d.x) + half.x * std::abs(d.z), std::hypot(d.z, d.x)) ||
        apart(p.x * d.y - p.y * d.x, half.x * std::abs(d.y) + half.y * std::abs(d.x), std::hypot(d.x, d.y))) {
      return {};
    }
    Clip clip;
    clip.within(p.x, d.x, half.x + reach);
    clip.within(p.y, d.y, half.y + reach);
    clip.within(p.z, d.z, half.z + reach);
    return clip.middle();
  }

  std::optional<double> operator()(const Capsule& capsule) const {
    const Segment3 axis{{0.0, 0.0, -0.5 * capsule.length}, {0.0, 0.0, capsule.length}};
    const auto [s, t] = nearest_parameters(segment, axis);
    if (norm(segment.at(s) - axis.at(t)) > capsule.radius + reach) return {};
    return s;
  }

  std::optional<double> operator()(const Cylinder& cylinder) const {
    // The part between the planes of the ends, and its nearest point to the axis.
    Clip clip;
    clip.within(segment.from.z, segment.along.z, 0.5 * cylinder.length + reach);
    if (clip.lo > clip.hi) return {};
    const Segment3 flat{{segment.from.x, segment.from.y, 0.0}, {segment.along.x, segment.along.y, 0.0}};
    const double t = std::clamp(nearest_parameter(flat, {}), clip.lo, clip.hi);
    if (norm(flat.at(t)) > cylinder.radius + reach) return {};
    return t;
  }

  std::optional<double> operator()(const std::shared_ptr<const Mesh>&) const {
    throw Fault("a mesh as a convex shape");
  }
  std::optional<double> operator()(const std::shared_ptr<const PointCloud>&) const {
    throw Fault("a cloud of points as a convex shape");
  }
};

}  // namespace

Segment3 seen_from(const Pose3& inverse, const Segment3& segment) {
  return {inverse(segment.from), inverse.orientation(segment.along)};
}

std::optional<double> contact(const Segment3& segment, const Shape3& shape, double reach) {
  return std::visit(ShapeContact{segment, reach}, shape);
}

std::optional<double> contact(const Segment3& segment, const PointCloud& cloud, double reach) {
  const Vec3 to = segment.at(1.0);
  const double within = cloud.radius() + reach;
  const Vec3 margin{within, within, within};
  std::optional<double> found;
  cloud.each_near({least_of(segment.from, to) - margin, greatest_of(segment.from, to) + margin}, [&](std::size_t i) {
    const Vec3& p = cloud.points()[i];
    const double t = nearest_parameter(segment, p);
    if (norm(segment.at(t) - p) <= within) found = t;
    return !found;
  });
  return found;
}

std::optional<double> contact(const Segment3& segment, const std::array<Vec3, 3>& corners, double reach) {
  const auto& [a, b, c] = corners;
  const Vec3 normal = cross(b - a, c - a);
  const double area = norm(normal);
  const double from = dot(normal, segment.from - a);
  const double to = dot(normal, segment.at(1.0) - a);
  // The normal of a sliver is a difference of nearly equal numbers.
  constexpr double epsilon = 8e-16;
  const double extent = norm(segment.from - a) + norm(segment.along);
  const double off_plane = reach * area + epsilon * norm(b - a) * norm(c - a) * extent;
  if (std::min(from, to) > off_plane || std::max(from, to) < -off_plane) return {};
  // Through the inside of the triangle, on the same side of its three edges.
  if (from != to && std::min(from, to) <= 0.0 && std::max(from, to) >= 0.0) {
    const double t = std::clamp(from / (from - to), 0.0, 1.0);
    const Vec3 p = segment.at(t);
    const auto inside = [&](const Vec3& first, const Vec3& second) {
      return dot(normal, cross(second - first, p - first)) >= 0.0;
    };
    if (inside(a, b) && inside(b, c) && inside(c, a)) return t;
  }
  // Else the nearest points are on an edge, or at an end of the segment.
  double best = reach;
  std::optional<double> found;
  for (const auto& [first, second] : {std::pair(a, b), std::pair(b, c), std::pair(c, a)}) {
    const Segment3 edge{first, second - first};
    const auto [s, t] = nearest_parameters(segment, edge);
    const double gap = norm(segment.at(s) - edge.at(t));
    if (gap > best) continue;
    best = gap;
    found = s;
  }
  for (const double end : {0.0, 1.0}) {
    const Vec3 p = segment.at(end);
    const double height = area > 0.0 ? std::abs(dot(normal, p - a)) / area : std::numeric_limits<double>::infinity();
    const auto above = [&](const Vec3& first, const Vec3& second) {
      return dot(normal, cross(second - first, p - first)) >= 0.0;
    };
    if (height > best || !above(a, b) || !above(b, c) || !above(c, a)) continue;
    best = height;
    found = end;
  }
  return found;
}

std::optional<double> contact(const Segment3& segment, const MeshDistance& mesh, double reach) {
  const Vec3 to = segment.at(1.0);
  const Vec3 margin{reach, reach, reach};
  const Box3 box{least_of(segment.from, to) - margin, greatest_of(segment.from, to) + margin};
  const Vec3 middle = segment.at(0.5);
  const Vec3 direction{std::abs(segment.along.x), std::abs(segment.along.y), std::abs(segment.along.z)};
  const double length = norm(segment.along);
  const auto meets = [&](const Box3& other) {
    if (other.lo.x > box.hi.x || other.hi.x < box.lo.x || other.lo.y > box.hi.y || other.hi.y < box.lo.y ||
        other.lo.z > box.hi.z || other.hi.z < box.lo.z) {
      return false;
    }
    // A long segment crosses the box of a mesh: the cross products with its direction separate most boxes.
    const Vec3 half = 0.5 * (other.hi - other.lo) + margin;
    const Vec3 p = middle - 0.5 * (other.lo + other.hi);
    const Vec3& d = segment.along;
    const double rounding = 1e-12 * length * (norm(p) + length);
    return std::abs(p.y * d.z - p.z * d.y) <= half.y * direction.z + half.z * direction.y + rounding &&
           std::abs(p.z * d.x - p.x * d.z) <= half.z * direction.x + half.x * direction.z + rounding &&
           std::abs(p.x * d.y - p.y * d.x) <= half.x * direction.y + half.y * direction.x + rounding;
  };
  // BoxTree::each visits items by their original number; the corners are in the tree's order.
  std::optional<double> found;
  const auto& triangles = mesh.mesh().triangles();
  const auto& vertices = mesh.mesh().vertices();
  mesh.tree().each([&](const Box3& other) { return !found && meets(other); },
                   [&](std::uint32_t i) {
                     if (found) return;
                     const auto& [a, b, c] = triangles[i];
                     found = contact(segment, {vertices[a], vertices[b], vertices[c]}, reach);
                   });
  return found;
}

}  // namespace trellis
