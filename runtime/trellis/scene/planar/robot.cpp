// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/scene/planar/robot.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <numbers>
#include <optional>
#include <utility>

#include <trellis/base/error.hpp>
#include <trellis/scene/limits.hpp>
#include <trellis/scene/planar/polygon.hpp>
#include <trellis/scene/planar/reduced_robot.hpp>
#include <trellis/scene/planar/valid_shapes.hpp>
#include <trellis/scene/team_members.hpp>

namespace trellis {

namespace {

double distance_to_segment(Vec2 p, Vec2 a, Vec2 b) {
  const Vec2 along = b - a;
  const double t = std::clamp(dot(p - a, along) / dot(along, along), 0.0, 1.0);
  return norm(p - (a + t * along));
}

// Returns the radius of the largest disc about `p` inside a convex shape, 0 where p lies outside.
double inscribed_in(const ConvexShape& shape, Vec2 p) {
  if (const auto* disc = std::get_if<Disc>(&shape)) return std::max(0.0, disc->radius - norm(p - disc->centre));
  const auto& vertices = std::get<Polygon>(shape).vertices;
  double radius = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    const Vec2 a = vertices[i];
    const Vec2 along = vertices[(i + 1) % vertices.size()] - a;
    radius = std::min(radius, cross(along, p - a) / norm(along));
  }
  return std::max(0.0, radius);
}

// Returns the radius of the largest disc about `p` inside the union of polygons, where p lies inside one of them or on
// a common edge.
double inscribed_in_union(const std::vector<Polygon>& polygons, Vec2 p) {
  const bool touched = std::any_of(polygons.begin(), polygons.end(), [&](const Polygon& polygon) {
    const auto& v = polygon.vertices;
    for (std::size_t i = 0; i < v.size(); ++i) {
      if (cross(v[(i + 1) % v.size()] - v[i], p - v[i]) < 0.0) return false;
    }
    return true;
  });
  if (!touched) return 0.0;
  double radius = std::numeric_limits<double>::infinity();
  const auto visit = [&](const Polygon& loop) {
    const auto& v = loop.vertices;
    for (std::size_t i = 0; i < v.size(); ++i) {
      radius = std::min(radius, distance_to_segment(p, v[i], v[(i + 1) % v.size()]));
    }
  };
  for (const auto& piece : polygon_union(polygons)) {
    visit(piece.outer);
    std::for_each(piece.holes.begin(), piece.holes.end(), visit);
  }
  return radius;
}

double inscribed_in_body(const Body& body, Vec2 p) {
  double radius = 0.0;
  std::vector<Polygon> polygons;
  for (const auto& part : body.parts) {
    radius = std::max(radius, inscribed_in(part, p));
    if (const auto* polygon = std::get_if<Polygon>(&part)) polygons.push_back(*polygon);
  }
  // Parts of a split polygon share edges that are not on the body's boundary.
  if (polygons.size() > 1) radius = std::max(radius, inscribed_in_union(polygons, p));
  return radius;
}

/// The two coordinates that move a body of a team which no other carries, of a configuration or a difference.
Vec2 position_in(View q, const Body& body) {
  const auto axis = static_cast<std::size_t>(body.position_axis);
  return {q[axis], q[axis + 1]};
}

Body body_of(std::vector<ConvexShape> parts) {
  Body body;
  body.parts = std::move(parts);
  return body;
}

double farthest_from(const Body& body, Vec2 p) {
  double radius = 0.0;
  for (const auto& part : body.parts) {
    if (const auto* disc = std::get_if<Disc>(&part)) {
      radius = std::max(radius, norm(disc->centre - p) + disc->radius);
    } else {
      for (const Vec2 v : std::get<Polygon>(part).vertices) radius = std::max(radius, norm(v - p));
    }
  }
  return radius;
}

// The direction of a body's axis, of length 1.
Vec2 axis_of(const std::vector<Body>& bodies, std::size_t i) {
  Vec2 axis;
  for (const auto& child : bodies) {
    if (child.parent == static_cast<int>(i) && norm(child.joint) > norm(axis)) axis = child.joint;
  }
  if (axis == Vec2{}) {
    const auto& parts = bodies[i].parts;
    for (const auto& part : parts) {
      const Box2 box = bounding_box(part);
      axis = axis + 0.5 * (box.lo + box.hi);
    }
  }
  const double length = norm(axis);
  return length > 0.0 ? 1.0 / length * axis : Vec2{1.0, 0.0};
}

// Scales a convex polygon across an axis. The chord between the polygon's two ends along the axis stays fixed. The
// chord lies in the polygon, so the scaled polygon does too.
void thin(Polygon& polygon, Vec2 along, double factor) {
  const Vec2 across{-along.y, along.x};
  auto& vertices = polygon.vertices;
  struct End {
    double at;
    double lo;  // across the axis, of the vertices at this end
    double hi;
  };
  constexpr double infinity = std::numeric_limits<double>::infinity();
  double least = infinity, greatest = -infinity;
  for (const Vec2 v : vertices) {
    least = std::min(least, dot(along, v));
    greatest = std::max(greatest, dot(along, v));
  }
  // Rounding moves the vertices of one end unless the axis is a coordinate axis.
  const double same = 1e-9 * (greatest - least);
  End from{least, infinity, -infinity}, to{greatest, infinity, -infinity};
  for (const Vec2 v : vertices) {
    const double b = dot(across, v);
    for (End* end : {&from, &to}) {
      if (std::abs(dot(along, v) - end->at) > same) continue;
      end->lo = std::min(end->lo, b);
      end->hi = std::max(end->hi, b);
    }
  }
  const double from_middle = 0.5 * (from.lo + from.hi), to_middle = 0.5 * (to.lo + to.hi);
  for (Vec2& v : vertices) {
    const double a = dot(along, v);
    const double chord = from_middle + (a - from.at) / (to.at - from.at) * (to_middle - from_middle);
    v = a * along + (chord + factor * (dot(across, v) - chord)) * across;
  }
}

}  // namespace

Robot::Robot(std::string name, std::vector<Body> bodies, bool translates, Vec2 base)
    : name_(std::move(name)), bodies_(std::move(bodies)), translates_(translates), base_(base) {
  const auto fail = [&](const std::string& fault) -> void { throw Error(fmt::format("robot '{}': {}", name_, fault)); };
  const int first_angle = translates_ ? 2 : 0;
  const auto check_place = [&](Vec2 at, const std::string& what) {
    if (in_range(at)) return;
    fail(fmt::format("{} must lie within {:g} m of 0 in x and in y, got ({}, {})", what, most_distant, at.x, at.y));
  };
  check_place(base_, "the base");

  bool any_part = false;
  int axes = first_angle;
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    auto& body = bodies_[i];
    const std::string what = fmt::format("body {}", i + 1);
    if (body.parent < -1 || body.parent >= static_cast<int>(i)) {
      fail(fmt::format("the parent of {} must be an earlier body or none, got body {}", what, body.parent + 1));
    }
    check_place(body.joint, "the joint of " + what);
    if (body.angle_axis != -1 && body.angle_axis < first_angle) {
      fail(fmt::format("{} must be turned by axis {} or a later one (counted from 0), got {}", what, first_angle,
                       body.angle_axis));
    }
    axes = std::max(axes, body.angle_axis + 1);
    for (std::size_t k = 0; k < body.parts.size(); ++k) {
      any_part = true;
      const std::string part = fmt::format("robot '{}': part {} of {}", name_, k + 1, what);
      if (const auto* disc = std::get_if<Disc>(&body.parts[k])) {
        check_disc(*disc, part, true);
        continue;
      }
      auto& polygon = std::get<Polygon>(body.parts[k]);
      auto convex = convex_parts(validated_polygon(std::move(polygon), part));
      if (convex.size() != 1) throw Error(fmt::format("{}: the polygon must be convex", part));
      polygon = std::move(convex.front());
    }
  }
  if (!any_part) fail("it needs at least one body with a shape");

  dimension_ = static_cast<std::size_t>(axes);
  if (dimension_ == 0) fail("nothing moves it: it neither translates nor turns");
  for (int axis = first_angle; axis < axes; ++axis) {
    if (std::none_of(bodies_.begin(), bodies_.end(), [&](const Body& b) { return b.angle_axis == axis; })) {
      fail(fmt::format("axis {} (counted from 0) turns no body", axis));
    }
  }

  // The position of a body on a chain without turns is fixed relative to the reference point, so its radii are exact.
  // Behind a turn only the length of the chain is fixed.
  struct Chain {
    double length = 0.0;         // the sum of |joint|
    std::optional<Vec2> offset;  // the origin's position, as long as no earlier body turns
    bool turns = false;          // whether the body itself turns, by its own axis or its parent's
  };
  std::vector<Chain> chains;
  for (const auto& body : bodies_) {
    const Chain parent = body.parent < 0 ? Chain{0.0, Vec2{}, false} : chains[static_cast<std::size_t>(body.parent)];
    Chain chain;
    chain.length = parent.length + norm(body.joint);
    if (parent.offset && !parent.turns) chain.offset = *parent.offset + body.joint;
    chain.turns = parent.turns || body.angle_axis >= 0;
    chains.push_back(chain);

    const double radius = farthest_from(body, {});
    body_radius_.push_back(radius);
    if (chain.offset) {
      const Vec2 reference = -1.0 * *chain.offset;
      const double carried = norm(reference);
      if (chain.turns) {
        bounding_radius_ = std::max(bounding_radius_, carried + radius);
        inscribed_radius_ = std::max(inscribed_radius_, inscribed_in_body(body, {}) - carried);
      } else {
        bounding_radius_ = std::max(bounding_radius_, farthest_from(body, reference));
        inscribed_radius_ = std::max(inscribed_radius_, inscribed_in_body(body, reference));
      }
    } else {
      bounding_radius_ = std::max(bounding_radius_, chain.length + radius);
      inscribed_radius_ = std::max(inscribed_radius_, inscribed_in_body(body, {}) - chain.length);
    }
  }
}

Robot Robot::point() { return {"point", {body_of({Disc{}})}}; }

Robot Robot::disc(double radius) {
  check_disc({{}, radius}, "robot 'disc'", false);
  return {"disc", {body_of({Disc{{}, radius}})}};
}

Robot Robot::rigid(const std::vector<Shape>& shapes, bool rotates) {
  if (shapes.size() > most_shapes) {
    throw Error(fmt::format("robot 'rigid': at most {} shapes, got {}", most_shapes, shapes.size()));
  }
  Body body;
  body.angle_axis = rotates ? 2 : -1;
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    Shape shape = shapes[i];
    validate(shape, fmt::format("robot 'rigid': shape {}", i + 1), true, body.parts);
  }
  return {"rigid", {std::move(body)}};
}

Robot Robot::arm(const Arm& arm) {
  const std::size_t count = arm.links.size();
  const auto fail = [](const std::string& fault) -> void { throw Error(fmt::format("robot 'arm': {}", fault)); };
  if (count == 0) fail("it needs at least one link");
  if (count > most_links) fail(fmt::format("at most {} links, got {}", most_links, count));
  if (arm.widths.size() != count) fail(fmt::format("it has {} links and {} widths", count, arm.widths.size()));
  if (arm.limits.size() > count) fail(fmt::format("it has {} links and limits of {}", count, arm.limits.size()));
  std::vector<Body> bodies;
  bodies.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    for (const auto& [what, size] : {std::pair("length", arm.links[i]), std::pair("width", arm.widths[i])}) {
      if (std::isfinite(size) && size > 0.0) continue;
      fail(fmt::format("the {} of link {} must be a number greater than 0, got {}", what, i + 1, size));
    }
    const double half = 0.5 * arm.widths[i];
    Body link;
    link.parts = {Polygon{rectangle_vertices({{0.0, -half}, {arm.links[i], half}})}};
    link.parent = static_cast<int>(i) - 1;
    if (i > 0) link.joint = {arm.links[i - 1], 0.0};
    link.angle_axis = static_cast<int>(i);
    link.name = fmt::format("link {}", i + 1);
    bodies.push_back(std::move(link));
  }
  Robot robot("arm", std::move(bodies), false, arm.base);
  if (arm.self_collision) {
    std::vector<std::pair<std::size_t, std::size_t>> pairs;
    for (std::size_t i = 0; i < count; ++i) {
      for (std::size_t k = i + 2; k < count; ++k) pairs.emplace_back(i, k);
    }
    robot = robot.apart(std::move(pairs));
  }
  return robot.limited(arm.limits);
}

Robot Robot::team(const std::vector<Robot>& robots) {
  std::vector<Member> members;
  join_members(robots, "disc", [&](const Robot& one, std::size_t axis, std::size_t number) {
    members.push_back({std::make_shared<const Robot>(one), axis, 0, number});
  });
  return team_of(std::move(members));
}

Robot Robot::team_of(std::vector<Member> members) {
  if (members.size() == 1 && members.front().axis == 0) return *members.front().robot;
  Robot team;
  std::vector<std::string> names;
  for (Member& member : members) {
    const Robot& robot = *member.robot;
    member.body = team.bodies_.size();
    for (std::size_t i = 0; i < robot.bodies_.size(); ++i) {
      Body body = robot.bodies_[i];
      if (body.parent >= 0) {
        body.parent += static_cast<int>(member.body);
      } else if (robot.translates_) {
        body.position_axis = static_cast<int>(member.axis);
      } else {
        body.joint = body.joint + robot.base_;
      }
      if (body.angle_axis >= 0) body.angle_axis += static_cast<int>(member.axis);
      team.bodies_.push_back(std::move(body));
      team.body_radius_.push_back(robot.body_radius_[i]);
    }
    for (const auto& [first, second] : robot.pairs_) {
      team.pairs_.emplace_back(member.body + first, member.body + second);
    }
    for (std::size_t i = 0; i < member.body; ++i) {
      for (std::size_t k = member.body; k < team.bodies_.size(); ++k) {
        if (!team.bodies_[i].parts.empty() && !team.bodies_[k].parts.empty()) team.pairs_.emplace_back(i, k);
      }
    }
    team.dimension_ = std::max(team.dimension_, member.axis + robot.dimension_);
    team.bounding_radius_ = std::max(team.bounding_radius_, robot.bounding_radius_);
    if (std::find(names.begin(), names.end(), robot.name_) == names.end()) names.push_back(robot.name_);
  }
  std::sort(team.pairs_.begin(), team.pairs_.end());
  team.name_ = fmt::format("{} robots ({})", members.size(), fmt::join(names, ", "));
  team.translates_ = false;
  team.members_ = std::move(members);
  return team;
}

std::size_t Robot::member_of(std::size_t body) const {
  std::size_t member = members_.size();
  while (members_.at(member - 1).body > body) --member;
  return member - 1;
}

Robot Robot::shrunken(double factor) const {
  if (members_.empty()) return translates_ ? scaled(factor) : thinned(factor);
  std::vector<Member> smaller = members_;
  for (Member& member : smaller) member.robot = std::make_shared<const Robot>(member.robot->shrunken(factor));
  return uncoupled_as(*this, team_of(std::move(smaller)));
}

Robot Robot::apart(std::vector<std::pair<std::size_t, std::size_t>> pairs) const {
  Robot result = *this;
  for (auto& [first, second] : pairs) {
    if (first > second) std::swap(first, second);
    if (first == second || second >= bodies_.size()) {
      throw Error(fmt::format("robot '{}': bodies {} and {} cannot be a self-collision pair, it has {}", name_,
                              first + 1, second + 1, bodies_.size()));
    }
  }
  std::sort(pairs.begin(), pairs.end());
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  result.pairs_ = std::move(pairs);
  return result;
}

Robot Robot::limited(std::vector<std::optional<std::pair<double, double>>> limits) const {
  const std::size_t angles = dimension_ - (translates_ ? 2 : 0);
  if (limits.size() > angles) {
    throw Error(fmt::format("robot '{}': it turns about {} axes, got limits of {}", name_, angles, limits.size()));
  }
  for (std::size_t i = 0; i < limits.size(); ++i) {
    if (!limits[i]) continue;
    const auto& [lo, hi] = *limits[i];
    constexpr double farthest = 2.0 * std::numbers::pi * most_turns;
    if (std::isfinite(lo) && std::isfinite(hi) && lo < hi && -lo <= farthest && hi <= farthest) continue;
    throw Error(
        fmt::format("robot '{}': the limits of joint {} must be two angles lo < hi in radians, within {:g} turns "
                    "({:.4g} rad) of 0, got {} and {}; of degrees, write math.rad(...)",
                    name_, i + 1, most_turns, farthest, lo, hi));
  }
  Robot result = *this;
  result.limits_ = std::move(limits);
  return result;
}

std::string Robot::body_name(std::size_t body) const {
  if (!members_.empty()) {
    const Member& member = members_[member_of(body)];
    const std::string robot = fmt::format("robot {}", member.number);
    return member.robot->bodies_.size() == 1
               ? robot
               : fmt::format("{} of {}", member.robot->body_name(body - member.body), robot);
  }
  const std::string& name = bodies_.at(body).name;
  return name.empty() ? fmt::format("body {}", body + 1) : name;
}

bool Robot::is_point() const {
  return bodies_.size() == 1 && bodies_[0].parts.size() == 1 && bodies_[0].parts[0] == ConvexShape(Disc{}) &&
         bodies_[0].joint == Vec2{};
}

Robot Robot::scaled(double factor) const {
  if (!std::isfinite(factor) || factor <= 0.0) {
    throw Error(
        fmt::format("robot '{}': the scale factor must be a finite number greater than 0, got {}", name_, factor));
  }
  Robot result = *this;
  for (auto& body : result.bodies_) {
    body.joint = factor * body.joint;
    for (auto& part : body.parts) {
      if (auto* disc = std::get_if<Disc>(&part)) {
        *disc = {factor * disc->centre, factor * disc->radius};
      } else {
        for (Vec2& v : std::get<Polygon>(part).vertices) v = factor * v;
      }
    }
  }
  result.bounding_radius_ *= factor;
  result.inscribed_radius_ *= factor;
  for (double& radius : result.body_radius_) radius *= factor;
  return result;
}

Robot Robot::thinned(double factor) const {
  if (!std::isfinite(factor) || factor <= 0.0) {
    throw Error(
        fmt::format("robot '{}': the scale factor must be a finite number greater than 0, got {}", name_, factor));
  }
  Robot result = *this;
  if (factor == 1.0) return result;
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    const Vec2 along = axis_of(bodies_, i);
    for (auto& part : result.bodies_[i].parts) {
      if (auto* disc = std::get_if<Disc>(&part)) {
        disc->radius *= factor;
      } else {
        thin(std::get<Polygon>(part), along, factor);
      }
    }
  }
  result.inscribed_radius_ = 0.0;
  return result;
}

void Robot::place(View q, std::span<Pose2> out) const {
  const Vec2 reference = translates_ ? Vec2{q[0], q[1]} : base_;
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    const auto& body = bodies_[i];
    const Vec2 root = body.position_axis < 0 ? reference : position_in(q, body);
    const Pose2 parent = body.parent < 0 ? Pose2{root.x, root.y, 1.0, 0.0} : out[static_cast<std::size_t>(body.parent)];
    const Vec2 origin = parent(body.joint);
    Pose2 pose{origin.x, origin.y, parent.c, parent.s};
    if (body.angle_axis >= 0) {
      const double angle = q[static_cast<std::size_t>(body.angle_axis)];
      const double c = std::cos(angle), s = std::sin(angle);
      if (body.absolute || body.parent < 0) {
        pose.c = c;
        pose.s = s;
      } else {
        pose.c = parent.c * c - parent.s * s;
        pose.s = parent.s * c + parent.c * s;
      }
    }
    out[i] = pose;
  }
}

double Robot::displacement_bound(const Space& space, View a, View b) const {
  // Runs for each motion check: usual sizes fit on the stack.
  constexpr std::size_t few_bodies = 16, few_axes = 2 * few_bodies;
  const std::size_t axes = space.dimension(), count = bodies_.size();
  std::array<double, few_axes> axis_buffer;
  std::array<std::pair<double, double>, few_bodies> body_buffer;
  std::vector<double> many_axes;
  std::vector<std::pair<double, double>> many_bodies;
  if (axes > few_axes) many_axes.resize(axes);
  if (count > few_bodies) many_bodies.resize(count);
  const MutableView difference = axes > few_axes ? MutableView(many_axes) : MutableView(axis_buffer).first(axes);
  // Per body: the distance that its origin moves, and its turn in the world.
  const auto motion = count > few_bodies ? std::span(many_bodies) : std::span(body_buffer).first(count);

  space.difference(a, b, difference);
  const double translation = translates_ ? norm(Vec2{difference[0], difference[1]}) : 0.0;
  double bound = 0.0;
  for (std::size_t i = 0; i < count; ++i) {
    const auto& body = bodies_[i];
    const auto [parent_distance, parent_turn] = body.parent >= 0 ? motion[static_cast<std::size_t>(body.parent)]
                                                : body.position_axis >= 0
                                                    ? std::pair(norm(position_in(difference, body)), 0.0)
                                                    : std::pair(translation, 0.0);
    double turn = parent_turn;
    if (body.angle_axis >= 0) {
      const double own = std::abs(difference[static_cast<std::size_t>(body.angle_axis)]);
      turn = body.absolute ? own : parent_turn + own;
    }
    const double distance = parent_distance + (parent_turn > 0.0 ? norm(body.joint) * parent_turn : 0.0);
    motion[i] = {distance, turn};
    bound = std::max(bound, distance + body_radius_[i] * turn);
  }
  return bound;
}

double Robot::displacement_of(std::size_t body, int ancestor, View difference) const {
  struct Moved {
    double distance = 0.0;  ///< of a body's origin
    double turn = 0.0;
  };
  const auto moved = [&](const auto& of, int at) -> Moved {
    if (at < 0 || at == ancestor) return {};
    const Body& carried = bodies_[static_cast<std::size_t>(at)];
    auto [distance, turn] = of(of, carried.parent);
    if (carried.position_axis >= 0) distance += norm(position_in(difference, carried));
    if (turn > 0.0) distance += norm(carried.joint) * turn;
    if (carried.angle_axis < 0) return {distance, turn};
    const double own = std::abs(difference[static_cast<std::size_t>(carried.angle_axis)]);
    return {distance, carried.absolute ? own : turn + own};
  };
  const auto [distance, turn] = moved(moved, static_cast<int>(body));
  return distance + body_radius_[body] * turn;
}

}  // namespace trellis
