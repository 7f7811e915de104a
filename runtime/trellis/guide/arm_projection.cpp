// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/guide/arm_projection.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

#include <trellis/instance/inverse_kinematics.hpp>
#include <trellis/scene/planar/scene.hpp>
#include <trellis/scene/set_up_cache.hpp>

namespace trellis {

namespace {

using std::numbers::pi;

Vec2 direction_of(double angle) { return {std::cos(angle), std::sin(angle)}; }

double wrapped(double angle) { return std::remainder(angle, 2.0 * pi); }

/// A vertex of a part in its body's frame; for a disc, the centre and the radius.
struct Extent {
  Vec2 point;
  double radius = 0.0;
};

std::vector<Extent> extents_of(const Body& body) {
  std::vector<Extent> extents;
  for (const auto& part : body.parts) {
    if (const auto* disc = std::get_if<Disc>(&part)) {
      extents.push_back({disc->centre, disc->radius});
    } else {
      for (const Vec2 v : std::get<Polygon>(part).vertices) extents.push_back({v, 0.0});
    }
  }
  return extents;
}

/// The end of a body that is farthest from its joint, on the line from the joint through the centre of its parts'
/// bounding box. None if the centre is at the joint.
std::optional<Vec2> end_of(const std::vector<Extent>& extents) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  Vec2 lo{infinity, infinity};
  Vec2 hi{-infinity, -infinity};
  double size = 0.0;
  for (const auto& [p, r] : extents) {
    lo = {std::min(lo.x, p.x - r), std::min(lo.y, p.y - r)};
    hi = {std::max(hi.x, p.x + r), std::max(hi.y, p.y + r)};
    size = std::max(size, norm(p) + r);
  }
  const Vec2 middle = 0.5 * (lo + hi);
  const double distance = norm(middle);
  if (extents.empty() || !(distance > 1e-9 * size)) return {};
  const Vec2 along = 1.0 / distance * middle;
  double end = -infinity;
  for (const auto& [p, r] : extents) end = std::max(end, dot(along, p) + r);
  return end * along;
}

/// The part of the world that an arm reaches.
World reachable_world(const World& world, Vec2 base, double least, double most) {
  constexpr int wedges = 48;
  constexpr double about = 1.02;  // so that the reachable set and the bounds have no side in common
  const Box2& whole = world.bounds();
  const double wide = about * most;
  const Box2 box{{std::max(whole.lo.x, base.x - wide), std::max(whole.lo.y, base.y - wide)},
                 {std::min(whole.hi.x, base.x + wide), std::min(whole.hi.y, base.y + wide)}};
  if (!(box.lo.x < box.hi.x) || !(box.lo.y < box.hi.y)) return world;
  auto obstacles = world.obstacles();
  // The arm may reach the boundary of the reachable set, so the obstacles keep a distance from it that exceeds
  // rounding.
  if (least > 0.0) obstacles.push_back({"what is too near to the arm's base", Disc{base, (1.0 - 1e-9) * least}});
  const double step = 2.0 * pi / wedges;
  const double inner = most * (1.0 + 1e-9) / std::cos(0.5 * step);
  const double outer = 2.0 * std::max(inner, norm(box.hi - box.lo));
  for (int i = 0; i < wedges; ++i) {
    const Vec2 from = direction_of(step * (i - 0.5));
    const Vec2 to = direction_of(step * (i + 0.5));
    const Polygon wedge{{base + inner * from, base + outer * from, base + outer * to, base + inner * to}};
    const Box2 around = bounding_box(wedge);
    if (around.lo.x >= box.hi.x || around.hi.x <= box.lo.x || around.lo.y >= box.hi.y || around.hi.y <= box.lo.y) {
      continue;
    }
    obstacles.push_back({"what is beyond the arm's reach", wedge});
  }
  return {box, std::move(obstacles)};
}

/// Caches `reachable_world` for a world and its copies while one of them lives, so that data computed for the result
/// are reused.
World cached_reachable_world(const World& world, Vec2 base, double least, double most) {
  constexpr std::size_t most_arms = 16;
  static SetUpCache<World, std::array<double, 4>, most_arms> cache;
  return *cache.get(world, {base.x, base.y, least, most},
                    [&](const World& of) { return reachable_world(of, base, least, most); });
}

}  // namespace

std::variant<ArmChain, std::string> arm_chain(const Instance& instance) {
  if (instance.scene->planar() == nullptr) {
    return fmt::format("the axes of this space ({}) are not the robot's", instance.space.name());
  }
  const Robot& robot = planar(*instance.scene).robot;
  if (instance.validity_of || robot.dimension() > instance.space.dimension()) {
    return fmt::format("the axes of this space ({}) are not the robot's", instance.space.name());
  }
  if (robot.translates()) return fmt::format("this space ({}) has no position", instance.space.name());
  const auto& bodies = robot.bodies();
  // Bodies without a joint between them form one link.
  struct Group {
    int body = -1;  // body whose axis rotates the group; -1: the base
    Vec2 offset;    // of a body's origin in the frame of `body`
  };
  std::vector<Group> groups;
  groups.reserve(bodies.size());
  ArmChain chain;
  chain.base = robot.base();
  int last = -1;
  std::vector<Extent> extents;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const Body& body = bodies[i];
    const Group parent = body.parent < 0 ? Group{} : groups[static_cast<std::size_t>(body.parent)];
    const Vec2 origin = parent.offset + body.joint;
    if (body.angle_axis < 0) {
      groups.push_back({parent.body, origin});
    } else {
      if (parent.body != last) return fmt::format("the links of the robot '{}' are no single chain", robot.name());
      const auto axis = static_cast<std::size_t>(body.angle_axis);
      if (std::any_of(chain.links.begin(), chain.links.end(), [&](const auto& link) { return link.axis == axis; })) {
        return fmt::format("joints of the robot '{}' turn together", robot.name());
      }
      if (last < 0) {
        chain.base = chain.base + origin;
      } else {
        chain.links.back().length = norm(origin);
        chain.links.back().bearing = std::atan2(origin.y, origin.x);
      }
      chain.links.push_back({.axis = axis, .absolute = body.absolute || body.parent < 0});
      last = static_cast<int>(i);
      groups.push_back({last, {}});
      extents.clear();
    }
    if (groups.back().body != last) continue;  // part of the base, or of an earlier link
    for (const auto& [point, radius] : extents_of(body)) extents.push_back({groups.back().offset + point, radius});
  }
  if (chain.links.size() < 2) {
    return fmt::format("the robot '{}' has one joint, so that its tip stays on a circle", robot.name());
  }
  const auto end = end_of(extents);
  if (!end) return fmt::format("the last link of the robot '{}' has its middle at its joint, and no tip", robot.name());
  chain.body = static_cast<std::size_t>(last);
  chain.tip = *end;
  chain.links.back().length = norm(*end);
  chain.links.back().bearing = std::atan2(end->y, end->x);
  if (std::any_of(chain.links.begin(), chain.links.end(), [](const auto& link) { return !(link.length > 0.0); })) {
    return fmt::format("two joints of the robot '{}' are at one place", robot.name());
  }
  return chain;
}

ArmProjection::ArmProjection(const Instance& parent, ArmChain chain)
    : TipProjection(parent.space), scene_(parent.scene), chain_(std::move(chain)) {
  const auto& links = chain_.links;
  rest_.resize(links.size());
  double longest = 0.0;
  double sum = 0.0;
  for (std::size_t i = links.size(); i-- > 0;) {
    sum += links[i].length;
    longest = std::max(longest, links[i].length);
    rest_[i] = {std::max(0.0, 2.0 * longest - sum), sum};
  }
  tolerance_ = 1e-10 * sum;
  if (rest_[0].least <= tolerance_) rest_[0].least = 0.0;
  world_ = cached_reachable_world(planar(*parent.scene).world, chain_.base, rest_[0].least, rest_[0].most);
  const auto& [lo, hi] = world_.bounds();
  space_ = Space::euclidean({{lo.x, hi.x}, {lo.y, hi.y}});
  for (const double x : {lo.x, hi.x}) {
    for (const double y : {lo.y, hi.y}) farthest_ = std::max(farthest_, norm(Vec2{x, y} - chain_.base));
  }
  std::vector<char> joint(this->parent().dimension(), 0);
  for (const auto& link : links) joint[link.axis] = 1;
  for (std::size_t j = 0; j < joint.size(); ++j) {
    const Axis& axis = this->parent().axes()[j];
    log_others_ -= std::log(axis.weight);
    if (joint[j] == 0) {
      others_ = true;
      log_others_ -= std::log(axis.period());
    } else if (!axis.periodic) {
      limited_ = true;
    }
  }
}

void ArmProjection::project(View q, MutableView s) const {
  Vec2 p = chain_.base;
  double body = 0.0;
  for (const auto& link : chain_.links) {
    body = link.absolute ? q[link.axis] : body + q[link.axis];
    p = p + link.length * direction_of(body + link.bearing);
  }
  s[0] = p.x;
  s[1] = p.y;
}

bool ArmProjection::reaches(View s) const {
  const double r = norm(Vec2{s[0], s[1]} - chain_.base);
  return r >= rest_[0].least - tolerance_ && r <= rest_[0].most + tolerance_;
}

Vec2 ArmProjection::reflected(Vec2 s) const {
  const auto& [least, most] = rest_[0];
  const Vec2 from_base = s - chain_.base;
  const double r = norm(from_base);
  if (r >= least && r <= most) return s;
  const double width = most - least;
  const double beyond = std::abs(std::remainder(r - least, 2.0 * width));
  return chain_.base + (least + beyond) * (r > 0.0 ? 1.0 / r * from_base : Vec2{1.0, 0.0});
}

double ArmProjection::folded(View s, const std::function<double(View)>& density) const {
  const auto& [least, most] = rest_[0];
  const Vec2 from_base = Vec2{s[0], s[1]} - chain_.base;
  const double r = norm(from_base);
  const double direct = space_.contains(s) ? density(s) : 0.0;
  if (!(r > 0.0)) return direct;
  const double width = most - least;
  double sum = direct;
  std::array<double, 2> image{};
  const auto add = [&](double at) {
    if (!(at > 0.0) || at > farthest_ || std::abs(at - r) <= tolerance_) return;
    image = {chain_.base.x + at / r * from_base.x, chain_.base.y + at / r * from_base.y};
    if (space_.contains(image)) sum += at / r * density(image);
  };
  const double beyond = r - least;
  for (int k = 0; least + 2.0 * k * width - width <= farthest_; ++k) {
    const double turn = least + 2.0 * k * width;
    add(turn - beyond);
    if (k > 0) add(turn + beyond);
  }
  // Positions nearer to the base than the arm reaches may also have several reflections.
  for (int k = -1; least + 2.0 * k * width + width >= 0.0; --k) {
    const double turn = least + 2.0 * k * width;
    add(turn - beyond);
    add(turn + beyond);
  }
  return sum;
}

ArmProjection::Arc ArmProjection::arc(std::size_t link, double distance) const {
  const double length = chain_.links[link].length;
  const Reach rest = rest_[link + 1];
  const double scale = 2.0 * distance * length;
  if (!(scale > 0.0)) return {0.0, pi};
  const double squares = distance * distance + length * length;
  const double greatest = std::clamp((squares - rest.least * rest.least) / scale, -1.0, 1.0);
  const double least = std::clamp((squares - rest.most * rest.most) / scale, -1.0, 1.0);
  return {std::acos(greatest), std::acos(std::min(least, greatest))};
}

double ArmProjection::angle(std::size_t link, double direction, double before) const {
  const auto& l = chain_.links[link];
  return l.absolute ? direction - l.bearing : direction - l.bearing - before;
}

bool ArmProjection::turn(std::size_t link, double direction, double before, Stream& stream, MutableView q) const {
  const std::size_t j = chain_.links[link].axis;
  const Axis& axis = parent().axes()[j];
  double angle = this->angle(link, direction, before);
  const double turns = std::floor((angle - axis.lo) / (2.0 * pi));
  angle -= 2.0 * pi * turns;
  // Rounding must not exclude a limit itself.
  if (!axis.periodic && angle > axis.hi) {
    if (angle - axis.hi < 1e-12) {
      angle = axis.hi;
    } else if (axis.lo + 2.0 * pi - angle < 1e-12) {
      angle = axis.lo;
    } else {
      return false;
    }
  }
  // Limits more than a turn apart contain some directions several times.
  const bool several = !axis.periodic && axis.hi - axis.lo > 2.0 * pi;
  const double more = several ? std::floor((axis.hi - angle) / (2.0 * pi)) : 0.0;
  if (more >= 1.0) angle += 2.0 * pi * static_cast<double>(stream.below(static_cast<std::uint64_t>(more) + 1));
  q[j] = angle < axis.hi ? angle : (axis.periodic ? axis.lo : axis.hi);
  return true;
}

bool ArmProjection::draw_direction(std::size_t link, const Arc& arc, double towards, double before, Stream& stream,
                                   double& direction) const {
  const Axis& axis = parent().axes()[chain_.links[link].axis];
  const std::array<std::pair<double, double>, 2> sides = {std::pair(towards - arc.most, towards - arc.least),
                                                          std::pair(towards + arc.least, towards + arc.most)};
  if (axis.periodic) {
    const auto& [from, to] = sides[stream.below(2)];
    direction = stream.uniform(from, to);
    return true;
  }
  // Directions within the limits, those of several turns several times.
  const double zero = angle(link, 0.0, before);
  const double lo = axis.lo - zero;
  const double hi = axis.hi - zero;
  std::vector<std::pair<double, double>> pieces;
  double total = 0.0;
  for (const auto& [from, to] : sides) {
    const double first = std::ceil((from - hi) / (2.0 * pi));
    for (double k = first; lo + 2.0 * pi * k < to; k += 1.0) {
      const double a = std::max(from, lo + 2.0 * pi * k);
      const double b = std::min(to, hi + 2.0 * pi * k);
      if (!(a < b)) continue;
      pieces.emplace_back(a, b);
      total += b - a;
    }
  }
  if (pieces.empty()) return false;
  double left = stream.uniform() * total;
  std::size_t piece = 0;
  while (piece + 1 < pieces.size() && left >= pieces.at(piece).second - pieces.at(piece).first) {
    left -= pieces.at(piece).second - pieces.at(piece).first;
    ++piece;
  }
  direction = std::min(pieces.at(piece).first + left, pieces.at(piece).second);
  return true;
}

bool ArmProjection::draw(Vec2 s, Stream& stream, MutableView q) const {
  const std::size_t n = chain_.links.size();
  Vec2 p = chain_.base;
  double before = 0.0;
  for (std::size_t i = 0; i + 2 < n; ++i) {
    const Vec2 to = s - p;
    double direction = 0.0;
    if (!draw_direction(i, arc(i, norm(to)), std::atan2(to.y, to.x), before, stream, direction)) return false;
    if (!turn(i, direction, before, stream, q)) return false;
    before = wrapped(direction - chain_.links[i].bearing);
    p = p + chain_.links[i].length * direction_of(direction);
  }
  const Vec2 to = s - p;
  const Arc elbow = arc(n - 2, norm(to));
  // If the tip is at the joint of the second-last link, all directions of that link are equally likely.
  const double bend = norm(to) > 0.0 ? elbow.most : stream.uniform(0.0, pi);
  const double first = stream.below(2) == 0 ? 1.0 : -1.0;
  const std::array sides = {first, -first};
  return std::any_of(sides.begin(), sides.end(), [&](double side) {
    const double direction = std::atan2(to.y, to.x) + side * bend;
    if (!turn(n - 2, direction, before, stream, q)) return false;
    const Vec2 joint = p + chain_.links[n - 2].length * direction_of(direction);
    const Vec2 rest = s - joint;
    return turn(n - 1, std::atan2(rest.y, rest.x), wrapped(direction - chain_.links[n - 2].bearing), stream, q);
  });
}

void ArmProjection::lift(View s, Stream& stream, MutableView q) const {
  const Vec2 target = reflected({s[0], s[1]});
  if (others_) parent().sample_uniform(stream, q);
  constexpr int draws = 64;
  constexpr int searches = 8;
  for (int i = 0; i < (limited_ ? draws : 1); ++i) {
    if (draw(target, stream, q)) return;
  }
  for (int i = 0; i < searches; ++i) {
    parent().sample_uniform(stream, q);
    if (bring(std::array{target.x, target.y}, q, tolerance_)) return;
  }
  parent().sample_uniform(stream, q);
}

double ArmProjection::log_fibre_density(View q) const {
  if (!parent().contains(q)) return -std::numeric_limits<double>::infinity();
  if (limited_) return std::numeric_limits<double>::quiet_NaN();
  std::array<double, 2> at{};
  project(q, at);
  const Vec2 s{at[0], at[1]};
  const std::size_t n = chain_.links.size();
  double density = log_others_ - std::numbers::ln2;
  Vec2 p = chain_.base;
  double body = 0.0;
  double direction = 0.0;
  double last = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    const auto& link = chain_.links[i];
    body = link.absolute ? q[link.axis] : body + q[link.axis];
    last = std::exchange(direction, body + link.bearing);
    if (i + 2 < n) {
      const Arc arc = this->arc(i, norm(s - p));
      density -= std::log(2.0 * (arc.most - arc.least));
    }
    p = p + link.length * direction_of(direction);
  }
  // The Jacobian determinant of the tip's position with respect to the last two angles.
  const double jacobian =
      chain_.links[n - 2].length * chain_.links[n - 1].length * std::abs(std::sin(direction - last));
  return density + std::log(jacobian);
}

bool ArmProjection::bring(View s, MutableView q, double near) const {
  InverseKinematics kinematics(planar(*scene_).robot, parent(), chain_.body, chain_.tip);
  return kinematics.bring(q, {s[0], s[1]}, near);
}

std::shared_ptr<const Scene> ArmProjection::point_scene() const {
  return std::make_shared<PlanarScene>(world_, Robot::point());
}

}  // namespace trellis
