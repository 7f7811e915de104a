// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/collision/spatial/near_filter.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <tuple>
#include <variant>

#include <trellis/collision/spatial/shared_cache.hpp>
#include <trellis/scene/spatial/point_cloud.hpp>
#include <trellis/scene/spatial/surface.hpp>

namespace trellis {

namespace {

/// Returns the cover of a solid, which checkers share where it is a mesh.
std::shared_ptr<const SphereCover> cover_of(const Solid& solid, bool surface, double finest) {
  const auto make = [&] { return SphereCover(solid, surface, finest); };
  const auto* mesh = std::get_if<std::shared_ptr<const Mesh>>(&solid.shape);
  if (mesh == nullptr) return std::make_shared<const SphereCover>(make());
  static SharedCache<std::tuple<std::uint64_t, std::array<double, 7>, bool, double>, SphereCover> cache;
  const auto& [p, q] = solid.pose;
  return cache.get({(*mesh)->hash(), {p.x, p.y, p.z, q.x, q.y, q.z, q.w}, surface, finest}, true, make);
}

/// The number of nodes near the roots whose balls inside the robot are worth a look in any case.
constexpr std::size_t largest_balls = 16;
/// The number of nodes, of each solid of the robot, after which a check by FCL costs less.
constexpr std::size_t most_visited_of_solid = 256;

/// What shows that a body does not fit into another one.
struct Extent {
  double length = 0.0;  ///< of the longest side of a triangle between points of the body
  double width = 0.0;   ///< its least altitude
};

Extent extent_of(const Vec3& a, const Vec3& b, const Vec3& c) {
  const double length = std::max({norm(b - a), norm(c - b), norm(a - c)});
  return {length, norm(cross(b - a, c - a)) / length};
}

struct ExtentOfShape {
  Extent operator()(const Sphere& s) const { return extent_of({s.radius, 0, 0}, {-s.radius, 0, 0}, {0, s.radius, 0}); }
  Extent operator()(const Cuboid& s) const {
    const Vec3 half = 0.5 * s.size;
    return extent_of({-half.x, -half.y, -half.z}, half, {-half.x, half.y, half.z});
  }
  Extent operator()(const Cylinder& s) const {
    return extent_of({s.radius, 0, -0.5 * s.length}, {s.radius, 0, 0.5 * s.length}, {-s.radius, 0, 0});
  }
  Extent operator()(const Capsule& s) const {
    return extent_of({0, 0, -0.5 * s.length - s.radius}, {0, 0, 0.5 * s.length + s.radius}, {s.radius, 0, 0});
  }
  Extent operator()(const std::shared_ptr<const Mesh>&) const { return {}; }
  /// Of one of the points.
  Extent operator()(const std::shared_ptr<const PointCloud>& cloud) const { return (*this)(Sphere{cloud->radius()}); }
};

/// Returns the extents of the connected parts of the world's obstacles.
std::vector<Extent> extents_of(const World3& world) {
  static SharedCache<std::uint64_t, std::vector<MeshComponent>> cache;
  std::vector<Extent> extents;
  for (const Obstacle3& obstacle : world.obstacles()) {
    const Shape3& shape = obstacle.solid.shape;
    if (const auto* mesh = std::get_if<std::shared_ptr<const Mesh>>(&shape)) {
      const auto components = cache.get((*mesh)->hash(), true, [&] { return components_of(**mesh); });
      for (const auto& [a, b, c] : *components) extents.push_back(extent_of(a, b, c));
    } else {
      extents.push_back(std::visit(ExtentOfShape(), shape));
    }
  }
  return extents;
}

/// Whether no body of these extents fits into the solid. No segment in a box is longer than its diagonal. No triangle
/// in it is wider than the diagonal of its smallest side: along the longest side, the box lies in a cylinder of that
/// diameter, which the triangle's plane meets in a strip or an ellipse of that width.
bool too_large(const std::vector<Extent>& extents, const Solid& solid) {
  const Box3 box = bounding_box({solid.shape, {}});
  const Vec3 sides = box.hi - box.lo;
  const double diagonal = norm(sides), longest = std::max({sides.x, sides.y, sides.z});
  const double across = std::sqrt(std::max(diagonal * diagonal - longest * longest, 0.0));
  constexpr double margin = 1.0 + 1e-9;
  return std::all_of(extents.begin(), extents.end(), [&](const Extent& extent) {
    return extent.length > margin * diagonal || extent.width > margin * across;
  });
}

}  // namespace

bool NearFilter::pays(const SpatialScene& scene) {
  const auto is_plain = [](const Solid& solid) {
    return std::holds_alternative<Sphere>(solid.shape) || std::holds_alternative<Cuboid>(solid.shape);
  };
  const auto& solids = scene.robot.solids();
  const auto& obstacles = scene.world.obstacles();
  return !obstacles.empty() && !(std::all_of(solids.begin(), solids.end(), is_plain) &&
                                 std::all_of(obstacles.begin(), obstacles.end(),
                                             [&](const Obstacle3& obstacle) { return is_plain(obstacle.solid); }));
}

NearFilter::NearFilter(const SpatialScene& scene, double slack) : fields_(scene.world.distances()) {
  // FCL's answers about touching bodies are exact up to rounding, and up to the tolerance of its iterations.
  constexpr double tolerance = 1e-6;
  margin_ = slack + tolerance * scene.robot.bounding_radius();
  const double finest = fields_->level(0).spacing();
  std::vector<Extent> extents;
  if (scene.world.surface()) extents = extents_of(scene.world);
  for (const Solid& solid : scene.robot.solids()) {
    // A mesh that is only a surface meets what reaches into it and is too large to lie inside.
    const bool surface = scene.world.surface() && !too_large(extents, solid);
    const auto cover = cover_of(solid, surface, finest);
    const auto offset = static_cast<std::uint32_t>(nodes_.size());
    roots_.push_back(offset);
    for (const SphereCover::Node& node : cover->nodes()) {
      nodes_.push_back({node.centre, node.outer, node.inner, &fields_->level(fields_->level_of(0.5 * node.outer)),
                        &fields_->level(fields_->level_of(2.0 * node.outer)), node.first + offset, node.count});
    }
  }
  waiting_.resize(nodes_.size());
}

NearFilter::Answer NearFilter::decide(const Turn& turn, double enough) const {
  const auto bounds_of = [&](const Node& node) { return node.field->bounds(turn(node.centre)); };
  if (const Node& node = nodes_[last_met_]; bounds_of(node).upper < node.inner - margin_) {
    return {Verdict::meets, 0.0};
  }
  std::size_t most_visited = most_visited_of_solid * roots_.size();
  if (const Node& node = nodes_[last_near_]; node.count == 0 && bounds_of(node).lower < node.outer + margin_) {
    // Not free for certain: only the largest balls inside the robot may still decide.
    most_visited = std::min(most_visited, largest_balls);
  }
  double clearance = std::numeric_limits<double>::infinity();
  std::size_t last = roots_.size();
  std::copy(roots_.begin(), roots_.end(), waiting_.begin());
  for (std::size_t next = 0; next < last; ++next) {
    if (next >= most_visited) return {};
    const std::uint32_t at = waiting_[next];
    const Node& node = nodes_[at];
    // Values of a coarse field are soon all known, and decide most balls.
    DistanceField::Bounds bounds = node.coarse->bounds(turn(node.centre));
    const double free_from = node.outer + margin_, meets_below = node.inner - margin_;
    const bool may_be_free = bounds.upper > free_from && bounds.lower <= free_from;
    const bool may_meet = bounds.upper >= meets_below && bounds.lower < meets_below;
    if (may_be_free || may_meet) bounds = bounds_of(node);
    if (bounds.upper < meets_below) {
      last_met_ = at;
      return {Verdict::meets, 0.0};
    }
    const double gap = bounds.lower - free_from;
    // Smaller balls may show a larger clearance, but not by more than this ball's radius, and cost time.
    if (gap > 0.0 && (gap >= enough || gap >= 0.2 * node.outer || node.count == 0)) {
      clearance = std::min(clearance, gap);
      continue;
    }
    if (node.count == 0) {
      last_near_ = at;
      return {};
    }
    for (std::uint32_t i = 0; i < node.count; ++i) waiting_[last++] = node.first + i;
  }
  return {Verdict::free, clearance};
}

}  // namespace trellis
