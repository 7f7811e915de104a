// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/reader/moveit_objects.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include <trellis/scene/spatial/ranges.hpp>

namespace trellis {

namespace {

/// Returns a rotation that turns the z axis into a direction of norm 1.
Quaternion turn_to(const Vec3& direction) {
  const Vec3 z{0.0, 0.0, 1.0};
  const Vec3 axis = cross(z, direction);
  const double sine = norm(axis);
  if (sine == 0.0) return direction.z > 0.0 ? Quaternion{} : rotation_of({std::numbers::pi, 0.0, 0.0});
  return normalised(rotation_of((std::atan2(sine, direction.z) / sine) * axis));
}

/// Returns a plane of a frame as one of the world.
MoveitPlane placed(const MoveitPlane& plane, const Pose3& pose) {
  const Vec3 normal = pose.orientation((1.0 / norm(plane.normal)) * plane.normal);
  return {normal, plane.offset / norm(plane.normal) - dot(normal, pose.position)};
}

/// Returns the half-space behind a plane, as a box that contains all of it within a ball.
Solid half_space(const MoveitPlane& plane, const Vec3& middle, double radius) {
  const double height = dot(plane.normal, middle) + plane.offset;
  const double side = 4.0 * radius;
  const double depth = 2.0 * (radius + std::abs(height));
  const Vec3 foot = middle - height * plane.normal;
  return {Cuboid{{side, side, depth}}, {foot - (0.5 * depth) * plane.normal, turn_to(plane.normal)}};
}

/// Whether more of the robot is behind a plane than before it.
bool is_behind(const SphereModel& robot, const Configuration& start, const MoveitPlane& plane) {
  const Configuration q = start.empty() ? Configuration(robot.robot().dimension(), 0.0) : start;
  std::vector<Pose3> poses;
  robot.robot().poses(q, poses);
  double sum = dot(plane.normal, robot.base().position) + plane.offset;
  for (std::size_t b = 0; b < poses.size(); ++b) {
    if (robot.bodies()[b].empty()) continue;
    sum += dot(plane.normal, robot.base()(poses[b](robot.bodies()[b].front().centre))) + plane.offset;
  }
  return sum < 0.0;
}

/// Whether a link stays where it is at all configurations.
bool is_fixed(const Manipulator& robot, std::size_t link) { return robot.body_of(link) == 0; }

}  // namespace

void MoveitObject::adopt_frame_of_shape() {
  if (parts.size() != 1 || !(pose == Pose3{})) return;
  std::swap(pose, parts.front().pose);
}

MoveitObjects::MoveitObjects(const SphereModel* robot, Configuration start) : robot_(robot), start_(std::move(start)) {}

std::optional<Pose3> MoveitObjects::find_frame(const std::string& name, const MakeError& fault) const {
  if (name.starts_with('/')) return find_frame(name.substr(1), fault);
  if (name.empty()) return Pose3{};
  const auto of_link = [&](std::size_t link) {
    const Manipulator& arm = robot_->robot();
    if (start_.empty() && !is_fixed(arm, link)) {
      throw fault(
          fmt::format("the frame '{}' is a link that moves, and there is no start that places it: give start = "
                      "{{...}}",
                      name));
    }
    const Configuration q = start_.empty() ? Configuration(arm.dimension(), 0.0) : start_;
    return robot_->base() * arm.pose_of(link, q);
  };
  if (robot_ != nullptr) {
    if (const auto link = robot_->robot().tree().find_link(name)) return of_link(*link);
  }
  const auto in = [&](const MoveitObject& object, const Pose3& pose) -> std::optional<Pose3> {
    if (object.id == name) return pose;
    if (!name.starts_with(object.id + "/")) return std::nullopt;
    const auto frame = object.subframes.find(name.substr(object.id.size() + 1));
    return frame != object.subframes.end() ? std::optional(pose * frame->second) : std::nullopt;
  };
  for (const MoveitAttached& one : attached) {
    if (one.object.id != name && !name.starts_with(one.object.id + "/")) continue;
    const Pose3 link = robot_ != nullptr ? of_link(one.link) : Pose3{};
    if (const auto found = in(one.object, link * one.object.pose)) return found;
  }
  for (const MoveitObject& object : objects_) {
    if (const auto found = in(object, object.pose)) return found;
  }
  if (const auto found = placed_.find(name); found != placed_.end()) return found->second;
  if (world_frames_.contains(name)) return Pose3{};
  return std::nullopt;
}

Pose3 MoveitObjects::frame(const std::string& name, const MakeError& fault) const {
  if (const auto found = find_frame(name, fault)) return *found;
  if (robot_ == nullptr) {
    unknown_.insert(name);
    return {};
  }
  std::vector<std::string> known(world_frames_.begin(), world_frames_.end());
  for (const Link& link : robot_->robot().tree().links()) known.push_back(link.name);
  for (const auto& [frame, pose] : placed_) known.push_back(frame);
  for (const MoveitObject& object : objects_) known.push_back(object.id);
  throw fault(
      fmt::format("the frame '{}' is not known{}: expected a link of the robot, one of 'fixed_frame_transforms', "
                  "an object before it, or the scene's own",
                  name, did_you_mean(name, known)));
}

void MoveitObjects::add(MoveitObject object) {
  remove(object.id);
  objects_.push_back(std::move(object));
}

void MoveitObjects::append(const MoveitObject& object) {
  MoveitObject* const to = find(object.id);
  if (to == nullptr) return add(object);
  for (const MoveitObject::Part& part : object.parts) {
    to->parts.push_back({part.shape, to->pose.inverse() * object.pose * part.pose});
  }
  for (const auto& [name, pose] : object.subframes) to->subframes[name] = to->pose.inverse() * object.pose * pose;
}

bool MoveitObjects::remove(const std::string& id) {
  return std::erase_if(objects_, [&](const MoveitObject& object) { return object.id == id; }) > 0;
}

MoveitObject* MoveitObjects::find(const std::string& id) {
  const auto found =
      std::find_if(objects_.begin(), objects_.end(), [&](const auto& object) { return object.id == id; });
  return found == objects_.end() ? nullptr : &*found;
}

World3 MoveitObjects::world(const SphereModel* robot) const {
  Vec3 lo;
  Vec3 hi;
  bool any = false;
  if (robot != nullptr) {
    const double r = robot->bounding_radius();
    lo = robot->base().position - Vec3{r, r, r};
    hi = robot->base().position + Vec3{r, r, r};
    any = true;
  }
  std::vector<Obstacle3> obstacles;
  std::vector<std::pair<std::size_t, MoveitPlane>> planes;  // by the number of their obstacles
  for (const MoveitObject& object : objects_) {
    for (const MoveitObject::Part& part : object.parts) {
      const std::string name = fmt::format("obstacle {} ({})", obstacles.size() + 1, object.id);
      const Pose3 pose = object.pose * part.pose;
      if (const auto* plane = std::get_if<MoveitPlane>(&part.shape)) {
        planes.emplace_back(obstacles.size(), placed(*plane, pose));
        obstacles.push_back({name, {Cuboid{{1.0, 1.0, 1.0}}, {}}});
        continue;
      }
      const Solid solid{std::get<Shape3>(part.shape), {pose.position, normalised(pose.orientation)}};
      check_solid(solid, fmt::format("object '{}'", object.id));
      const Box3 box = bounding_box(solid);
      lo = any ? least_of(lo, box.lo) : box.lo;
      hi = any ? greatest_of(hi, box.hi) : box.hi;
      any = true;
      obstacles.push_back({name, solid});
    }
  }
  if (!any) {
    lo = {-0.5, -0.5, -0.5};
    hi = {0.5, 0.5, 0.5};
  }
  // A world of one flat mesh has a height, too.
  constexpr double least = 1e-3;
  if (hi.x - lo.x < least) hi.x = lo.x + least;
  if (hi.y - lo.y < least) hi.y = lo.y + least;
  if (hi.z - lo.z < least) hi.z = lo.z + least;
  const double radius = 0.5 * norm(hi - lo) + (robot != nullptr ? robot->bounding_radius() : 0.0);
  for (auto [number, plane] : planes) {
    if (robot != nullptr && is_behind(*robot, start_, plane)) plane = {-1.0 * plane.normal, -plane.offset};
    obstacles[number].solid = half_space(plane, 0.5 * (lo + hi), radius);
  }
  return World3({lo, hi}, std::move(obstacles), Contain::none);
}

}  // namespace trellis
