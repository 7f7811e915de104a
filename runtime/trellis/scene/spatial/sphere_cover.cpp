// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/scene/spatial/sphere_cover.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <queue>
#include <utility>
#include <variant>

#include <trellis/scene/spatial/obstacle_distance.hpp>
#include <trellis/scene/spatial/ranges.hpp>

namespace trellis {

namespace {

using Polygon3 = std::vector<Vec3>;

double Vec3::*longest_axis(const Box3& box) {
  const Vec3 extent = box.hi - box.lo;
  double Vec3::*axis = &Vec3::x;
  if (extent.y > extent.*axis) axis = &Vec3::y;
  if (extent.z > extent.*axis) axis = &Vec3::z;
  return axis;
}

/// Appends the part of a convex polygon below (sign 1) or above (sign -1) the plane where the coordinate is `at`.
void clip(const Polygon3& polygon, double Vec3::*axis, double at, double sign, std::vector<Polygon3>& out) {
  Polygon3 part;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vec3& a = polygon[i];
    const Vec3& b = polygon[(i + 1) % polygon.size()];
    const double da = sign * (at - a.*axis), db = sign * (at - b.*axis);
    if (da >= 0.0) part.push_back(a);
    if ((da > 0.0 && db < 0.0) || (da < 0.0 && db > 0.0)) {
      Vec3 between = a + da / (da - db) * (b - a);
      between.*axis = at;
      part.push_back(between);
    }
  }
  if (!part.empty()) out.push_back(std::move(part));
}

/// A part of the solid: what of it lies in a cell.
struct Part {
  Box3 cell;
  std::vector<Polygon3> surface;  ///< of a mesh: its triangles' parts
  SphereCover::Node node;
};

class Builder {
 public:
  Builder(const Solid& solid, bool surface, double finest)
      : shape_(solid.shape), finest_(finest), distance_({{solid.shape, {}}}, surface) {
    if (const auto* shared = std::get_if<std::shared_ptr<const Mesh>>(&shape_)) {
      mesh_ = shared->get();
      if (!surface && mesh_->closed()) inside_.emplace(*shared);
    }
  }

  /// The nodes in the shape's frame.
  std::vector<SphereCover::Node> build() {
    Part root{bounding_box({shape_, {}}), {}, {}};
    if (mesh_ != nullptr) {
      const auto& v = mesh_->vertices();
      for (const auto& [a, b, c] : mesh_->triangles()) root.surface.push_back({v[a], v[b], v[c]});
    }
    enclose(root);
    parts_.push_back(std::move(root));
    // The largest ball is divided first.
    const auto smaller = [&](std::size_t a, std::size_t b) {
      const double left = parts_[a].node.outer, right = parts_[b].node.outer;
      return left != right ? left < right : a > b;
    };
    std::priority_queue<std::size_t, std::vector<std::size_t>, decltype(smaller)> waiting(smaller);
    waiting.push(0);
    while (!waiting.empty() && parts_.size() + 2 <= SphereCover::most_nodes) {
      const std::size_t at = waiting.top();
      waiting.pop();
      if (parts_[at].node.outer <= finest_ || !divides()) continue;
      const std::size_t first = parts_.size();
      divide(at);
      parts_[at].node.first = static_cast<std::uint32_t>(first);
      parts_[at].node.count = static_cast<std::uint32_t>(parts_.size() - first);
      for (std::size_t child = first; child < parts_.size(); ++child) waiting.push(child);
      parts_[at].surface = {};
    }
    std::vector<SphereCover::Node> nodes;
    nodes.reserve(parts_.size());
    for (const Part& part : parts_) nodes.push_back(part.node);
    return nodes;
  }

 private:
  [[nodiscard]] bool divides() const {
    return !std::holds_alternative<Sphere>(shape_) &&
           (mesh_ == nullptr || mesh_->triangles().size() <= SphereCover::most_divided_triangles);
  }

  void divide(std::size_t at) {
    const Box3 cell = parts_[at].cell;
    double Vec3::*axis = std::holds_alternative<Capsule>(shape_) ? &Vec3::z : longest_axis(cell);
    const double middle = 0.5 * (cell.lo.*axis + cell.hi.*axis);
    for (const double sign : {1.0, -1.0}) {
      Part half{cell, {}, {}};
      Vec3& cut = sign > 0.0 ? half.cell.hi : half.cell.lo;
      cut.*axis = middle;
      for (const Polygon3& polygon : parts_[at].surface) clip(polygon, axis, middle, sign, half.surface);
      if (enclose(half)) parts_.push_back(std::move(half));
    }
  }

  /// Makes the part's ball, and its cell no larger than the part. Returns false where the part is empty.
  bool enclose(Part& part) const {
    // What rounding may add.
    constexpr double margin = 1e-9;
    SphereCover::Node& node = part.node;
    if (mesh_ != nullptr) {
      std::vector<Vec3> points;
      for (const Polygon3& polygon : part.surface) points.insert(points.end(), polygon.begin(), polygon.end());
      // The part lies in the hull of its surface and of the cell's corners in it.
      if (inside_) {
        for (const Vec3& corner : corners_of(part.cell)) {
          if (inside_->contains(corner)) points.push_back(corner);
        }
      }
      if (points.empty()) return false;
      part.cell = bounds_of(points);
      node.centre = 0.5 * (part.cell.lo + part.cell.hi);
      for (const Vec3& p : points) node.outer = std::max(node.outer, norm(p - node.centre));
    } else if (const auto* sphere = std::get_if<Sphere>(&shape_)) {
      node.outer = sphere->radius;
    } else if (const auto* capsule = std::get_if<Capsule>(&shape_)) {
      // Of its segment, half of the balls about it.
      const double half = 0.5 * capsule->length;
      const double share = capsule->length / (capsule->length + 2.0 * capsule->radius);
      const double low = std::clamp(share * part.cell.lo.z, -half, half);
      const double high = std::clamp(share * part.cell.hi.z, -half, half);
      node.centre = {0.0, 0.0, 0.5 * (low + high)};
      node.outer = 0.5 * (high - low) + capsule->radius;
    } else {
      node.centre = 0.5 * (part.cell.lo + part.cell.hi);
      if (const auto* cylinder = std::get_if<Cylinder>(&shape_)) {
        const double x = std::clamp(0.0, part.cell.lo.x, part.cell.hi.x);
        const double y = std::clamp(0.0, part.cell.lo.y, part.cell.hi.y);
        if (std::hypot(x, y) > (1.0 + margin) * cylinder->radius) return false;
      }
      node.outer = 0.5 * norm(part.cell.hi - part.cell.lo);
    }
    node.outer *= 1.0 + margin;
    node.inner = -distance_(node.centre) * (1.0 - margin);
    return true;
  }

  const Shape3& shape_;
  double finest_;
  const Mesh* mesh_ = nullptr;
  std::optional<MeshDistance> inside_;  ///< of a mesh that has one
  ObstacleDistance distance_;
  std::vector<Part> parts_;
};

}  // namespace

SphereCover::SphereCover(const Solid& solid, bool surface, double finest)
    : nodes_(Builder(solid, surface, finest).build()) {
  for (Node& node : nodes_) node.centre = solid.pose(node.centre);
}

}  // namespace trellis
