// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/guide/handles.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <utility>

#include <trellis/planner/nearest.hpp>

namespace trellis {

namespace {

/// Share of angles that are uniform, so that none is left out.
constexpr double uniform_share = 0.1;
/// Distances from the medial axis count by this share of a body's length.
constexpr double scale_of_length = 0.125;

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

/// The ends of a body in the direction in which its vertices spread most, and none where they spread alike in all.
std::optional<std::array<Vec2, 2>> ends_of(const Body& body) {
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
  return std::array{Vec2{mean.x + least * along.x, mean.y + least * along.y},
                    Vec2{mean.x + most * along.x, mean.y + most * along.y}};
}

Space plane(const Box2& box) {
  return {"R^2", {{.name = "x", .lo = box.lo.x, .hi = box.hi.x}, {.name = "y", .lo = box.lo.y, .hi = box.hi.y}}};
}

}  // namespace

/// Distances from the medial axis, looked up in a grid over the world.
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

  /// Of the nearest point of the grid.
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

HandleLift::~HandleLift() = default;

HandleLift::HandleLift(std::shared_ptr<const PositionProjection> position, const Instance& parent)
    : position_(std::move(position)), scene_(parent.scene), field_(std::make_shared<Field>(parent.scene->world)) {
  // In a space of other axes than the robot's nothing is known of what turns.
  if (parent.validity_of) return;
  const auto& bodies = scene_->robot.bodies();
  std::vector<char> turned(parent.space.dimension(), 0);
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    if (bodies[b].angle_axis < 0) continue;
    const auto axis = static_cast<std::size_t>(bodies[b].angle_axis);
    if (axis >= turned.size() || turned[axis] != 0) continue;
    const auto ends = ends_of(bodies[b]);
    if (!ends) continue;
    turned[axis] = 1;
    const Axis& of = parent.space.axes()[axis];
    const double length = std::hypot((*ends)[0].x - (*ends)[1].x, (*ends)[0].y - (*ends)[1].y);
    turns_.push_back({b, axis, of.lo, (of.hi - of.lo) / static_cast<double>(bins), scale_of_length * length, *ends});
  }
}

void HandleLift::chances(const Turn& turn, MutableView q, Chances& out) const {
  thread_local std::vector<Pose2> poses;
  poses.resize(scene_->robot.bodies().size());
  double sum = 0.0;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < bins; ++k) {
    q[turn.axis] = turn.lo + (static_cast<double>(k) + 0.5) * turn.width;
    scene_->robot.place(q, poses);
    const Pose2& pose = poses[turn.body];
    double squares = 0.0;
    for (const Vec2 h : turn.handles) {
      squares += field_->squared_distance({pose.x + pose.c * h.x - pose.s * h.y, pose.y + pose.s * h.x + pose.c * h.y});
    }
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

void HandleLift::settle(MutableView q) const {
  Chances chance;
  for (const Turn& turn : turns_) {
    chances(turn, q, chance);
    const auto k = static_cast<std::size_t>(std::max_element(chance.begin(), chance.end()) - chance.begin());
    q[turn.axis] = turn.lo + (static_cast<double>(k) + 0.5) * turn.width;
  }
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
