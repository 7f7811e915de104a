// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/scene/recentred.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <queue>
#include <utility>
#include <variant>
#include <vector>

#include <trellis/base/error.hpp>
#include <trellis/scene/planar/polygon.hpp>

namespace trellis {

namespace {

/// A cube, or a square in the plane, and the distance of its centre from the boundary.
struct SearchCell {
  Vec3 centre;
  double half = 0.0;
  double inside = 0.0;  ///< negative outside
  double most = 0.0;    ///< no point of the cell has more

  friend bool operator<(const SearchCell& a, const SearchCell& b) { return a.most < b.most; }
};

/// Searches the point of a box that is farthest inside by bisection of cells, best bound first. A later point replaces
/// an earlier one only where it is better by the precision, so that the middle of a rectangle is its centre.
/// \param dimension  2 or 3
/// \param inside     distance from the boundary; Lipschitz with 1
Vec3 farthest_inside(const Vec3& lo, const Vec3& hi, int dimension, const std::function<double(const Vec3&)>& inside) {
  constexpr double relative = 1e-4;
  constexpr std::size_t most_cells = 20'000;
  const std::array<double, 3> size = {hi.x - lo.x, hi.y - lo.y, hi.z - lo.z};
  const double longest = std::max({size[0], size[1], size[2]});
  const double precision = relative * longest;
  const double diagonal = std::sqrt(static_cast<double>(dimension));
  const auto cell_at = [&](Vec3 centre, double half) {
    const double value = inside(centre);
    return SearchCell{centre, half, value, value + half * diagonal};
  };
  const Vec3 middle = 0.5 * (lo + hi);
  SearchCell best = cell_at(middle, 0.0);
  std::priority_queue<SearchCell> open;
  open.push(cell_at(middle, 0.5 * longest));
  for (std::size_t cells = 0; !open.empty() && cells < most_cells; ++cells) {
    const SearchCell cell = open.top();
    open.pop();
    if (cell.most <= best.inside + precision) break;
    const double half = 0.5 * cell.half;
    const int corners = 1 << dimension;
    for (int corner = 0; corner < corners; ++corner) {
      const auto shift = [&](int axis) { return ((corner >> axis) & 1) != 0 ? half : -half; };
      const Vec3 at = {cell.centre.x + shift(0), cell.centre.y + shift(1),
                       dimension > 2 ? cell.centre.z + shift(2) : 0.0};
      const SearchCell part = cell_at(at, half);
      if (part.inside > best.inside + precision) best = part;
      if (part.most > best.inside + precision) open.push(part);
    }
  }
  return best.centre;
}

double edge_distance(Vec2 p, Vec2 a, Vec2 b) {
  const Vec2 along = b - a;
  const double t = std::clamp(dot(p - a, along) / dot(along, along), 0.0, 1.0);
  return norm(p - (a + t * along));
}

bool covers_point(const Polygon& convex, Vec2 p) {
  const auto& v = convex.vertices;
  for (std::size_t i = 0; i < v.size(); ++i) {
    if (cross(v[(i + 1) % v.size()] - v[i], p - v[i]) < 0.0) return false;
  }
  return true;
}

/// The distance of a point from the boundary of a body, negative outside.
class BodyInside {
 public:
  explicit BodyInside(const Body& body) : parts_(body.parts) {
    std::vector<Polygon> polygons;
    for (const ConvexShape& part : parts_) {
      if (const auto* polygon = std::get_if<Polygon>(&part)) polygons.push_back(*polygon);
    }
    // Parts of a split polygon share edges that are not on the body's boundary.
    for (const PolygonWithHoles& piece : polygon_union(polygons)) {
      loops_.push_back(piece.outer);
      loops_.insert(loops_.end(), piece.holes.begin(), piece.holes.end());
    }
  }

  double operator()(Vec2 p) const {
    double radius = -std::numeric_limits<double>::infinity();
    bool within = false;
    for (const ConvexShape& part : parts_) {
      if (const auto* disc = std::get_if<Disc>(&part)) {
        radius = std::max(radius, disc->radius - norm(p - disc->centre));
      } else {
        within = within || covers_point(std::get<Polygon>(part), p);
      }
    }
    double distance = std::numeric_limits<double>::infinity();
    for (const Polygon& loop : loops_) {
      const auto& v = loop.vertices;
      for (std::size_t i = 0; i < v.size(); ++i) {
        distance = std::min(distance, edge_distance(p, v[i], v[(i + 1) % v.size()]));
      }
    }
    return loops_.empty() ? radius : std::max(radius, within ? distance : -distance);
  }

 private:
  const std::vector<ConvexShape>& parts_;
  std::vector<Polygon> loops_;
};

void require_inside(const char* what, double radius) {
  if (radius > 0.0) return;
  throw Error(fmt::format("recentred: {} contains no disc or ball about any point", what));
}

}  // namespace

Recentred<Robot> recentred(const Robot& robot) {
  if (robot.bodies().size() != 1 || !robot.translates()) {
    throw Error(fmt::format(
        "recentred: the robot '{}' {}, so its reference point is where it is fixed; it takes one rigid body "
        "that moves freely",
        robot.name(), robot.translates() ? "has several bodies" : "is fixed to its base"));
  }
  Body body = robot.bodies().front();
  if (robot.is_point()) return {robot, {}};
  Box2 box = bounding_box(body.parts.front());
  for (const ConvexShape& part : body.parts) box = united(box, bounding_box(part));
  const BodyInside inside(body);
  const Vec3 found = farthest_inside({box.lo.x, box.lo.y, 0.0}, {box.hi.x, box.hi.y, 0.0}, 2, [&](const Vec3& p) {
    return inside({p.x, p.y});
  });
  const Vec2 centre = {found.x, found.y};
  require_inside("the robot", inside(centre));
  for (ConvexShape& part : body.parts) {
    if (auto* disc = std::get_if<Disc>(&part)) {
      disc->centre = disc->centre - centre;
    } else {
      for (Vec2& v : std::get<Polygon>(part).vertices) v = v - centre;
    }
  }
  // The joint of the body is its origin in the frame of the reference point, which does not turn.
  const Vec2 offset = centre + body.joint;
  body.joint = {};
  return {Robot(robot.name(), {std::move(body)}), {offset.x, offset.y, 0.0}};
}

Recentred<Robot3> recentred(const Robot3& robot) {
  if (!robot.members().empty()) {
    throw Error(
        fmt::format("recentred: '{}' is a team, whose robots have a reference point each; recentre each one before "
                    "robots {{ ... }}",
                    robot.name()));
  }
  if (robot.is_point()) return {robot, {}};
  // In space discs are balls inside one of the solids, as Robot3::inscribed_radius.
  double most = 0.0;
  Vec3 centre;
  const auto consider = [&](const Vec3& at) {
    std::vector<Solid> moved = robot.solids();
    for (Solid& solid : moved) solid.pose.position = solid.pose.position - at;
    const double radius = Robot3(robot.name(), std::move(moved), robot.rotates()).inscribed_radius();
    if (radius <= most) return;
    most = radius;
    centre = at;
  };
  for (const Solid& solid : robot.solids()) {
    const auto* mesh = std::get_if<std::shared_ptr<const Mesh>>(&solid.shape);
    if (mesh == nullptr) {
      consider(solid.pose.position);
      continue;
    }
    const Box3 box = bounding_box(Solid{solid.shape, {}});
    const Vec3 at = farthest_inside(box.lo, box.hi, 3, [&](const Vec3& p) {
      const double distance = distance_to_surface(**mesh, p);
      return contains(**mesh, p) ? distance : -distance;
    });
    consider(solid.pose(at));
  }
  require_inside("the robot", most);
  std::vector<Solid> solids = robot.solids();
  for (Solid& solid : solids) solid.pose.position = solid.pose.position - centre;
  return {Robot3(robot.name(), std::move(solids), robot.rotates()), centre};
}

Configuration recentred_configuration(const Robot& robot, Vec3 offset, View q) {
  Configuration moved(q.begin(), q.end());
  const Body& body = robot.bodies().front();
  // A body that turns does so about its origin, which stays at the joint.
  const double angle = body.angle_axis >= 0 ? q[static_cast<std::size_t>(body.angle_axis)] : 0.0;
  const Vec2 centre = Vec2{offset.x, offset.y} - body.joint;
  const Vec2 at = Pose2{body.joint.x, body.joint.y, std::cos(angle), std::sin(angle)}(centre);
  moved[0] += at.x;
  moved[1] += at.y;
  return moved;
}

Configuration recentred_configuration(const Robot3& robot, Vec3 offset, View q) {
  Configuration moved(q.begin(), q.end());
  const Vec3 at = robot.pose(q)(offset);
  moved[0] = at.x;
  moved[1] = at.y;
  moved[2] = at.z;
  return moved;
}

}  // namespace trellis
