// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/draw/depth_order.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace trellis::draw {

namespace {

using Items = std::vector<SpatialItem>;

struct Plane {
  Point3 normal;
  double offset = 0.0;

  [[nodiscard]] double above(const Point3& p) const { return dot(normal, p) - offset; }
};

/// Returns the plane of a face, with its normal towards the camera.
Plane plane_of(const SpatialItem& face, const Point3& to_camera) {
  // Newell's sum is robust where corners are nearly in line.
  Point3 sum;
  for (std::size_t i = 0; i < face.points.size(); ++i) {
    sum = sum + cross(face.points[i] - face.points[0], face.points[(i + 1) % face.points.size()] - face.points[0]);
  }
  Point3 normal = unit(sum);
  if (dot(normal, to_camera) < 0.0) normal = -1.0 * normal;
  return {normal, dot(normal, face.points[0])};
}

enum class Side : std::uint8_t { in_plane, behind, before, both };

Side side_of(const SpatialItem& item, const Plane& plane, double tolerance) {
  bool behind = false;
  bool before = false;
  for (const Point3& p : item.points) {
    const double above = plane.above(p);
    behind = behind || above < -tolerance;
    before = before || above > tolerance;
  }
  if (behind && before) return Side::both;
  return behind ? Side::behind : before ? Side::before : Side::in_plane;
}

/// Returns the part of an item on one side of a plane that it crosses.
SpatialItem part_of(const SpatialItem& item, const Plane& plane, double sign) {
  SpatialItem part{.kind = item.kind, .style = item.style};
  const auto crossing = [](const Point3& p, const Point3& q, double a, double b) {
    return p + (a / (a - b)) * (q - p);
  };
  if (item.kind == SpatialItem::Kind::line) {
    const double a = sign * plane.above(item.points[0]);
    const double b = sign * plane.above(item.points[1]);
    const Point3 middle = crossing(item.points[0], item.points[1], a, b);
    part.points = a > 0.0 ? std::vector{item.points[0], middle} : std::vector{middle, item.points[1]};
    return part;
  }
  const std::size_t count = item.points.size();
  for (std::size_t i = 0; i < count; ++i) {
    const Point3& p = item.points[i];
    const Point3& q = item.points[(i + 1) % count];
    const double a = sign * plane.above(p);
    const double b = sign * plane.above(q);
    if (a >= 0.0) {
      part.points.push_back(p);
      // Where the edge ends in the plane already, the next one runs along the cut.
      part.edges.push_back(item.edges[i] && !(a == 0.0 && b < 0.0));
    }
    if ((a > 0.0 && b < 0.0) || (a < 0.0 && b > 0.0)) {
      part.points.push_back(crossing(p, q, a, b));
      part.edges.push_back(a < 0.0 && item.edges[i]);
    }
  }
  return part;
}

double depth_of(const SpatialItem& item, const Point3& to_camera) {
  double sum = 0.0;
  for (const Point3& p : item.points) sum += dot(p, to_camera);
  return sum / static_cast<double>(item.points.size());
}

void sort_by_depth(Items& items, const Point3& to_camera) {
  std::vector<std::pair<double, std::size_t>> order;
  order.reserve(items.size());
  for (std::size_t i = 0; i < items.size(); ++i) order.emplace_back(depth_of(items[i], to_camera), i);
  std::sort(order.begin(), order.end());
  Items sorted;
  sorted.reserve(items.size());
  for (const auto& [depth, i] : order) sorted.push_back(std::move(items[i]));
  items = std::move(sorted);
}

/// Returns the index of a face whose plane cuts few items and leaves about as many on either side, of a few that are
/// spread evenly; the number of items where there is no face.
std::size_t divider(const Items& items, const Point3& to_camera, double tolerance) {
  constexpr std::size_t tried = 6;
  constexpr std::size_t cost_of_cut = 8;
  std::vector<std::size_t> faces;
  for (std::size_t i = 0; i < items.size(); ++i) {
    if (items[i].kind == SpatialItem::Kind::face) faces.push_back(i);
  }
  std::size_t best = items.size();
  std::size_t least = std::numeric_limits<std::size_t>::max();
  const std::size_t count = std::min(tried, faces.size());
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t at = faces[k * faces.size() / count];
    const Plane plane = plane_of(items[at], to_camera);
    std::size_t cuts = 0;
    std::size_t behind = 0;
    std::size_t before = 0;
    for (const SpatialItem& item : items) {
      switch (side_of(item, plane, tolerance)) {
        case Side::both: ++cuts; break;
        case Side::behind: ++behind; break;
        case Side::before: ++before; break;
        case Side::in_plane: break;
      }
    }
    const std::size_t cost = cost_of_cut * cuts + std::max(behind, before) - std::min(behind, before);
    if (cost < least) {
      least = cost;
      best = at;
    }
  }
  return best;
}

}  // namespace

std::vector<SpatialItem> far_to_near(std::vector<SpatialItem> items, const Point3& to_camera, double tolerance,
                                     std::size_t most) {
  struct Group {
    Items items;
    bool ordered = false;
  };
  Items out;
  std::size_t total = items.size();
  std::vector<Group> stack;  // the farthest last
  stack.push_back({std::move(items)});
  while (!stack.empty()) {
    Group group = std::move(stack.back());
    stack.pop_back();
    const std::size_t by = group.ordered ? group.items.size() : divider(group.items, to_camera, tolerance);
    if (by == group.items.size() || total > most) {
      if (!group.ordered) sort_by_depth(group.items, to_camera);
      std::move(group.items.begin(), group.items.end(), std::back_inserter(out));
      continue;
    }
    const Plane plane = plane_of(group.items[by], to_camera);
    Items behind;
    Items before;
    Items faces;
    Items marks;  // lines and dots in the plane lie on its faces
    for (SpatialItem& item : group.items) {
      switch (side_of(item, plane, tolerance)) {
        case Side::behind: behind.push_back(std::move(item)); break;
        case Side::before: before.push_back(std::move(item)); break;
        case Side::in_plane: (item.kind == SpatialItem::Kind::face ? faces : marks).push_back(std::move(item)); break;
        case Side::both:
          behind.push_back(part_of(item, plane, -1.0));
          before.push_back(part_of(item, plane, 1.0));
          ++total;
          break;
      }
    }
    std::move(marks.begin(), marks.end(), std::back_inserter(faces));
    if (!before.empty()) stack.push_back({std::move(before)});
    stack.push_back({std::move(faces), true});
    if (!behind.empty()) stack.push_back({std::move(behind)});
  }
  return out;
}

}  // namespace trellis::draw
