// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/guide/handles.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <string_view>
#include <utility>

#include <trellis/base/error.hpp>
#include <trellis/instance/characteristic_length.hpp>
#include <trellis/scene/planar/scene.hpp>
#include <trellis/space/nearest.hpp>

namespace trellis {

namespace {

/// Share of angles drawn uniformly, so that the support is complete.
constexpr double uniform_share = 0.1;
/// Standard deviation of the likelihood in the distance from the medial axis, as a share of a body's length.
constexpr double scale_of_length = 0.125;
/// Maximum number of iterations of the closest-point iteration.
constexpr int most_iterations = 20;

void append_vertices(const ConvexShape& shape, std::vector<Vec2>& out) {
  if (const auto* disc = std::get_if<Disc>(&shape)) {
    const Box2 box = bounding_box(*disc);
    const auto corners = rectangle_vertices(box);
    out.insert(out.end(), corners.begin(), corners.end());
  } else {
    const auto& vertices = std::get<Polygon>(shape).vertices;
    out.insert(out.end(), vertices.begin(), vertices.end());
  }
}

/// The ends of a body along the direction in which its vertices spread most; none if they spread equally in all
/// directions.
std::vector<Vec2> ends_of(const Body& body) {
  std::vector<Vec2> vertices;
  for (const ConvexShape& part : body.parts) append_vertices(part, vertices);
  if (vertices.size() < 2) return {};
  const auto n = static_cast<double>(vertices.size());
  Vec2 mean;
  for (const Vec2 v : vertices) mean = {mean.x + v.x / n, mean.y + v.y / n};
  double xx = 0.0;
  double yy = 0.0;
  double xy = 0.0;
  for (const Vec2 v : vertices) {
    xx += (v.x - mean.x) * (v.x - mean.x);
    yy += (v.y - mean.y) * (v.y - mean.y);
    xy += (v.x - mean.x) * (v.y - mean.y);
  }
  if (std::hypot(xx - yy, 2.0 * xy) <= 1e-6 * (xx + yy)) return {};
  const double angle = 0.5 * std::atan2(2.0 * xy, xx - yy);
  const Vec2 along{std::cos(angle), std::sin(angle)};
  double least = 0.0;
  double most = 0.0;
  for (const Vec2 v : vertices) {
    const double t = (v.x - mean.x) * along.x + (v.y - mean.y) * along.y;
    least = std::min(least, t);
    most = std::max(most, t);
  }
  return {Vec2{mean.x + least * along.x, mean.y + least * along.y},
          Vec2{mean.x + most * along.x, mean.y + most * along.y}};
}

/// The largest distance between two of the points.
double extent_of(const std::vector<Vec2>& points) {
  double extent = 0.0;
  for (const Vec2 a : points) {
    for (const Vec2 b : points) extent = std::max(extent, norm(a - b));
  }
  return extent;
}

/// Removes a number and the spaces around it from the beginning of a text; none if the text does not begin with a
/// number.
template <class Number>
std::optional<Number> take_number(std::string_view& text) {
  const auto skip_spaces = [&] { text.remove_prefix(std::min(text.find_first_not_of(' '), text.size())); };
  skip_spaces();
  Number number{};
  const auto [end, fault] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (fault != std::errc()) return {};
  text.remove_prefix(static_cast<std::size_t>(end - text.data()));
  skip_spaces();
  return number;
}

bool take(std::string_view& text, char expected) {
  if (text.empty() || text.front() != expected) return false;
  text.remove_prefix(1);
  return true;
}

Space plane(const Box2& box) {
  return {"R^2", {{.name = "x", .lo = box.lo.x, .hi = box.hi.x}, {.name = "y", .lo = box.lo.y, .hi = box.hi.y}}};
}

}  // namespace

/// Distances from the medial axis, tabulated on a grid over the world.
class HandleLift::Field {
 public:
  explicit Field(const World& world)
      : bounds_(world.bounds()), axis_(cached_medial_axis(world)), index_(plane(bounds_)) {
    for (const auto& edge : axis_->edges) {
      for (const Vec2 p : edge.points) index_.add(std::array{p.x, p.y});
      points_.insert(points_.end(), edge.points.begin(), edge.points.end());
    }
    if (points_.empty()) {
      for (const Vec2 p : axis_->vertices) index_.add(std::array{p.x, p.y});
      points_ = axis_->vertices;
    }
    const double width = bounds_.hi.x - bounds_.lo.x;
    const double height = bounds_.hi.y - bounds_.lo.y;
    const double cell = std::max(width, height) / cells;
    columns_ = static_cast<std::size_t>(std::ceil(width / cell)) + 1;
    rows_ = static_cast<std::size_t>(std::ceil(height / cell)) + 1;
    per_metre_ = 1.0 / cell;
    squared_.reserve(columns_ * rows_);
    for (std::size_t y = 0; y < rows_; ++y) {
      for (std::size_t x = 0; x < columns_; ++x) {
        const std::array at{bounds_.lo.x + static_cast<double>(x) * cell, bounds_.lo.y + static_cast<double>(y) * cell};
        squared_.push_back(index_.nearest(at).squared_distance);
      }
    }
  }

  /// At the nearest grid point.
  [[nodiscard]] double squared_distance(Vec2 p) const {
    const auto cell = [this](double at, double lo, std::size_t count) {
      const double place = std::round((at - lo) * per_metre_);
      return static_cast<std::size_t>(std::clamp(place, 0.0, static_cast<double>(count - 1)));
    };
    return squared_[cell(p.y, bounds_.lo.y, rows_) * columns_ + cell(p.x, bounds_.lo.x, columns_)];
  }
  [[nodiscard]] double cell() const { return 1.0 / per_metre_; }
  [[nodiscard]] Vec2 nearest(View p) const { return points_[index_.nearest(p).id]; }

 private:
  static constexpr double cells = 100.0;  ///< along the longer side
  Box2 bounds_;
  std::shared_ptr<const Skeleton> axis_;
  NearestIndex index_;
  std::vector<Vec2> points_;
  std::size_t columns_ = 0;
  std::size_t rows_ = 0;
  double per_metre_ = 0.0;
  std::vector<double> squared_;
};

std::vector<Handle> parse_handles(const std::string& guide, const std::vector<std::string>& texts, const Robot& robot) {
  std::vector<Handle> handles;
  handles.reserve(texts.size());
  for (const std::string& given : texts) {
    std::string_view text = given;
    std::size_t body = 1;
    if (given.find(':') != std::string::npos) {
      const auto number = take_number<std::size_t>(text);
      body = number && take(text, ':') ? *number : 0;
    }
    const auto x = take_number<double>(text);
    const bool comma = take(text, ',');
    const auto y = take_number<double>(text);
    if (body == 0 || !x || !comma || !y || !text.empty()) {
      throw Error(
          fmt::format("{}: option 'handles' has '{}'; expected \"x, y\", a point of the robot's first body, or "
                      "\"n: x, y\", one of its n-th",
                      guide, given));
    }
    if (body > robot.bodies().size()) {
      throw Error(fmt::format("{}: option 'handles' has '{}', but the robot '{}' has bodies 1 to {}", guide, given,
                              robot.name(), robot.bodies().size()));
    }
    handles.push_back({body - 1, {*x, *y}});
  }
  return handles;
}

HandleLift::~HandleLift() = default;

HandleLift::HandleLift(std::shared_ptr<const PositionProjection> position, const Instance& parent,
                       const std::vector<Handle>& given)
    : position_(std::move(position)),
      scene_(parent.scene),
      field_(std::make_shared<Field>(planar(*parent.scene).world)),
      space_(parent.space),
      position_axes_(parent.position_axes),
      handles_(given) {
  // If the space has other axes than the robot, the axes that rotate bodies are unknown.
  if (parent.validity_of) return;
  const auto& bodies = planar(*scene_).robot.bodies();
  std::vector<char> turned(parent.space.dimension(), 0);
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    if (bodies[b].angle_axis < 0) continue;
    const auto axis = static_cast<std::size_t>(bodies[b].angle_axis);
    if (axis >= turned.size() || turned[axis] != 0) continue;
    std::vector<Vec2> points;
    for (const Handle& handle : given) {
      if (handle.body == b) points.push_back(handle.point);
    }
    if (points.empty()) {
      points = ends_of(bodies[b]);
      for (const Vec2 point : points) handles_.push_back({b, point});
    }
    if (points.empty()) continue;
    // For a single handle: its distance from the origin that it rotates about.
    const double length = points.size() > 1 ? extent_of(points) : norm(points.front());
    if (!(length > 0.0)) continue;
    turned[axis] = 1;
    const Axis& of = parent.space.axes()[axis];
    turns_.push_back(
        {b, axis, of.lo, (of.hi - of.lo) / static_cast<double>(bins), scale_of_length * length, std::move(points)});
  }
}

void HandleLift::chances(const Turn& turn, MutableView q, Chances& out) const {
  thread_local std::vector<Pose2> poses;
  poses.resize(scene_->body_count());
  double sum = 0.0;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < bins; ++k) {
    q[turn.axis] = turn.lo + (static_cast<double>(k) + 0.5) * turn.width;
    planar(*scene_).robot.place(q, poses);
    const Pose2& pose = poses[turn.body];
    double squares = 0.0;
    for (const Vec2 handle : turn.handles) squares += field_->squared_distance(pose(handle));
    out[k] = squares / (2.0 * turn.scale * turn.scale);
    least = std::min(least, out[k]);
  }
  for (double& chance : out) {
    chance = std::exp(least - chance);
    sum += chance;
  }
  for (double& chance : out) chance = (1.0 - uniform_share) * chance / sum + uniform_share / static_cast<double>(bins);
}

void HandleLift::lift(View s, Stream& stream, MutableView q) const {
  position_->lift(s, stream, q);
  Chances chance;
  for (const Turn& turn : turns_) {
    chances(turn, q, chance);
    double left = stream.uniform();
    std::size_t k = 0;
    while (k + 1 < bins && left >= chance[k]) left -= chance[k++];
    q[turn.axis] = turn.lo + (static_cast<double>(k) + stream.uniform()) * turn.width;
  }
}

double HandleLift::log_fibre_density(View q) const {
  double density = position_->log_fibre_density(q);
  thread_local Configuration other;
  other.assign(q.begin(), q.end());
  Chances chance;
  for (const Turn& turn : turns_) {
    chances(turn, other, chance);
    other[turn.axis] = q[turn.axis];
    const double place = std::floor((q[turn.axis] - turn.lo) / turn.width);
    const auto k = static_cast<std::size_t>(std::clamp(place, 0.0, static_cast<double>(bins - 1)));
    density += std::log(chance[k] * static_cast<double>(bins));
  }
  return density;
}

Configurations HandleLift::lifted(const Configurations& path, View start, View goal) const {
  Configurations result = position_->lifted(path, start, goal);
  for (std::size_t i = 1; i + 1 < result.size(); ++i) set_likely_angles(result[i]);
  return result;
}

void HandleLift::set_likely_angles(MutableView q) const {
  Chances chance;
  for (const Turn& turn : turns_) {
    chances(turn, q, chance);
    const auto k = static_cast<std::size_t>(std::max_element(chance.begin(), chance.end()) - chance.begin());
    q[turn.axis] = turn.lo + (static_cast<double>(k) + 0.5) * turn.width;
  }
}

double HandleLift::distance(View q) const {
  if (handles_.empty()) return 0.0;
  std::vector<Pose2> poses(scene_->body_count());
  planar(*scene_).robot.place(q, poses);
  double squares = 0.0;
  for (const Handle& handle : handles_) {
    const Vec2 p = poses[handle.body](handle.point);
    const Vec2 off = p - field_->nearest(std::array{p.x, p.y});
    squares += off.x * off.x + off.y * off.y;
  }
  return std::sqrt(squares / static_cast<double>(handles_.size()));
}

void HandleLift::draw_near(MutableView q) const {
  if (handles_.empty() || position_axes_.size() != 2) return;
  std::vector<Pose2> poses(scene_->body_count());
  Configuration best(q.begin(), q.end());
  double least = distance(q);
  for (int i = 0; i < most_iterations; ++i) {
    // For each joint: the angle that moves its handles nearest to their closest points on the axis, with the body's
    // origin fixed.
    for (const Turn& turn : turns_) {
      planar(*scene_).robot.place(q, poses);
      const Pose2& pose = poses[turn.body];
      double dot = 0.0;
      double cross = 0.0;
      Vec2 mean;
      Vec2 mean_target;
      const auto n = static_cast<double>(turn.handles.size());
      std::vector<std::pair<Vec2, Vec2>> pairs;
      for (const Vec2 handle : turn.handles) {
        const Vec2 p = pose(handle);
        const Vec2 target = field_->nearest(std::array{p.x, p.y});
        pairs.emplace_back(p, target);
        mean = mean + (1.0 / n) * p;
        mean_target = mean_target + (1.0 / n) * target;
      }
      // A free body rotates about the mean of its handles, another body about its joint.
      const bool free = planar(*scene_).robot.bodies()[turn.body].parent < 0 && pairs.size() > 1;
      const Vec2 origin{pose.x, pose.y};
      for (const auto& [p, target] : pairs) {
        const Vec2 a = p - (free ? mean : origin);
        const Vec2 b = target - (free ? mean_target : origin);
        dot += a.x * b.x + a.y * b.y;
        cross += a.x * b.y - a.y * b.x;
      }
      if (std::hypot(dot, cross) > 0.0) q[turn.axis] += std::atan2(cross, dot);
      space_.normalise(q);
    }
    // Then translates the whole robot by the mean of the remaining offsets.
    planar(*scene_).robot.place(q, poses);
    Vec2 move;
    for (const Handle& handle : handles_) {
      const Vec2 p = poses[handle.body](handle.point);
      move = move + (1.0 / static_cast<double>(handles_.size())) * (field_->nearest(std::array{p.x, p.y}) - p);
    }
    q[position_axes_[0]] += move.x;
    q[position_axes_[1]] += move.y;
    space_.reflect(q);
    const double now = distance(q);
    if (now >= least) break;
    const bool enough = least - now < 0.01 * field_->cell();
    least = now;
    best.assign(q.begin(), q.end());
    if (enough) break;
  }
  std::copy(best.begin(), best.end(), q.begin());
}

PointLift HandleLift::point_lift(const Instance& parent) const {
  const double wander = characteristic_length(parent);
  return [this, wander](int attempt, View s, View previous, View, Stream& stream, MutableView q) {
    constexpr int beside = 14;
    constexpr int most = 26;
    if (attempt >= most) return false;
    if (attempt > 1) {
      lift(s, stream, q);
    } else {
      std::copy(previous.begin(), previous.end(), q.begin());
      for (std::size_t k = 0; k < 2; ++k) q[position_axes_[k]] = s[k];
      if (attempt > 0) set_likely_angles(q);
    }
    if (attempt < beside) {
      draw_near(q);
      return true;
    }
    const double r = wander * static_cast<double>(attempt - beside + 1) / (most - beside);
    for (const std::size_t axis : position_axes_) q[axis] += r * stream.uniform(-1.0, 1.0);
    space_.reflect(q);
    return true;
  };
}

Configurations HandleLift::on_axis(const Configurations& path, Instance& point) const {
  Configurations moved(2);
  moved.push(path.front());
  std::array<double, 2> from{};
  for (std::size_t i = 1; i < path.size(); ++i) {
    const double length = point.space.distance(path[i - 1], path[i]);
    const auto pieces = static_cast<std::size_t>(std::max(1.0, std::ceil(length / (2.0 * field_->cell()))));
    for (std::size_t k = 1; k <= pieces; ++k) {
      if (i + 1 == path.size() && k == pieces) break;
      point.space.interpolate(path[i - 1], path[i], static_cast<double>(k) / static_cast<double>(pieces), from);
      const Vec2 nearest = field_->nearest(from);
      const std::array to{nearest.x, nearest.y};
      moved.push(point.motion(from, to).valid ? to : from);
    }
  }
  moved.push(path.back());
  return moved;
}

}  // namespace trellis
