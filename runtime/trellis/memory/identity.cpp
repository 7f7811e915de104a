// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/memory/identity.hpp>

#include <memory>
#include <string>
#include <type_traits>
#include <variant>

#include <trellis/base/random.hpp>
#include <trellis/memory/bytes.hpp>
#include <trellis/scene/spatial/point_cloud.hpp>
#include <trellis/scene/visit.hpp>

namespace trellis {

namespace {

void put(std::string& bytes, Vec2 p) {
  put_number(bytes, p.x);
  put_number(bytes, p.y);
}

void put(std::string& bytes, const Disc& disc) {
  bytes += 'd';
  put(bytes, disc.centre);
  put_number(bytes, disc.radius);
}

void put(std::string& bytes, const Polygon& polygon) {
  bytes += 'p';
  put_integer(bytes, polygon.vertices.size());
  for (const Vec2 v : polygon.vertices) put(bytes, v);
}

void put(std::string& bytes, const Box2& box) {
  bytes += 'b';
  put(bytes, box.lo);
  put(bytes, box.hi);
}

template <class... Shapes>
void put(std::string& bytes, const std::variant<Shapes...>& shape) {
  std::visit([&](const auto& one) { put(bytes, one); }, shape);
}

std::uint64_t hash_of(const Robot& robot) {
  std::string bytes;
  bytes += robot.translates() ? '\1' : '\0';
  put(bytes, robot.base());
  for (const Body& body : robot.bodies()) {
    put_integer(bytes, static_cast<std::uint64_t>(std::int64_t{body.parent} + 1));
    put_integer(bytes, static_cast<std::uint64_t>(std::int64_t{body.angle_axis} + 1));
    bytes += body.absolute ? '\1' : '\0';
    if (body.position_axis >= 0) put_integer(bytes, static_cast<std::uint64_t>(body.position_axis) + 1);
    put(bytes, body.joint);
    put_integer(bytes, body.parts.size());
    for (const auto& part : body.parts) put(bytes, part);
  }
  for (const auto& [first, second] : robot.pairs()) {
    put_integer(bytes, first);
    put_integer(bytes, second);
  }
  return stable_hash(bytes);
}

std::uint64_t hash_of(const World& world) {
  std::string bytes;
  put(bytes, world.bounds());
  for (const Obstacle& obstacle : world.obstacles()) put(bytes, obstacle.shape);
  return stable_hash(bytes);
}

void put(std::string& bytes, const Vec3& p) {
  put_number(bytes, p.x);
  put_number(bytes, p.y);
  put_number(bytes, p.z);
}

void put(std::string& bytes, const Sphere& sphere) {
  bytes += 's';
  put_number(bytes, sphere.radius);
}

void put(std::string& bytes, const Cuboid& cuboid) {
  bytes += 'q';
  put(bytes, cuboid.size);
}

void put(std::string& bytes, const Cylinder& cylinder) {
  bytes += 'y';
  put_number(bytes, cylinder.radius);
  put_number(bytes, cylinder.length);
}

void put(std::string& bytes, const Capsule& capsule) {
  bytes += 'c';
  put_number(bytes, capsule.radius);
  put_number(bytes, capsule.length);
}

void put(std::string& bytes, const std::shared_ptr<const Mesh>& mesh) {
  bytes += 'm';
  put_integer(bytes, mesh->hash());
}

void put(std::string& bytes, const std::shared_ptr<const PointCloud>& cloud) {
  bytes += 'p';
  put_integer(bytes, cloud->hash());
}

void put(std::string& bytes, const Solid& solid) {
  std::visit([&](const auto& shape) { put(bytes, shape); }, solid.shape);
  put(bytes, solid.pose.position);
  const Quaternion& turn = solid.pose.orientation;
  for (const double x : {turn.x, turn.y, turn.z, turn.w}) put_number(bytes, x);
}

std::uint64_t hash_of(const Robot3& robot) {
  std::string bytes = "3";
  bytes += robot.rotates() ? '\1' : '\0';
  for (const Robot3::Member& member : robot.members()) {
    put_integer(bytes, member.column);
    put_integer(bytes, hash_of(*member.robot));
  }
  if (robot.members().empty()) {
    for (const Solid& solid : robot.solids()) put(bytes, solid);
  }
  return stable_hash(bytes);
}

std::uint64_t hash_of(const SphereModel& model) {
  std::string bytes = "m";
  const auto put_pose = [&](const Pose3& pose) {
    put(bytes, pose.position);
    const Quaternion& turn = pose.orientation;
    for (const double x : {turn.x, turn.y, turn.z, turn.w}) put_number(bytes, x);
  };
  put_pose(model.base());
  for (std::size_t b = 0; b < model.bodies().size(); ++b) {
    const Manipulator::Body& body = model.robot().bodies()[b];
    put_integer(bytes, body.parent);
    put_integer(bytes, static_cast<std::uint64_t>(body.kind));
    put_integer(bytes, body.column);
    put_pose(body.origin);
    put(bytes, body.axis);
    put_number(bytes, body.multiplier);
    put_number(bytes, body.offset);
    put_integer(bytes, model.bodies()[b].size());
    for (const BodySphere& ball : model.bodies()[b]) {
      put(bytes, ball.centre);
      put_number(bytes, ball.radius);
    }
  }
  for (const SphereModel::Part& part : model.parts()) {
    put_integer(bytes, part.body);
    put_integer(bytes, part.count());
  }
  for (const auto& [first, second] : model.pairs()) {
    put_integer(bytes, first);
    put_integer(bytes, second);
  }
  if (const auto standing = model.standing()) put_number(bytes, standing->gap);
  return stable_hash(bytes);
}

std::uint64_t hash_of(const World3& world) {
  std::string bytes = "3";
  put(bytes, world.bounds().lo);
  put(bytes, world.bounds().hi);
  bytes += static_cast<char>(world.contain());
  bytes += world.surface() ? '\1' : '\0';
  for (const Obstacle3& obstacle : world.obstacles()) put(bytes, obstacle.solid);
  return stable_hash(bytes);
}

}  // namespace

std::uint64_t identity(const Space& space) {
  std::string bytes;
  for (const Axis& axis : space.coordinates()) {
    bytes += axis.name;
    bytes += axis.periodic ? '\1' : '\0';
    put_number(bytes, axis.lo);
    put_number(bytes, axis.hi);
    put_number(bytes, axis.weight);
  }
  return stable_hash(bytes);
}

std::uint64_t robot_hash(const Scene& scene) {
  return visit(scene, [](const auto& kind) { return hash_of(kind.robot); });
}

std::uint64_t world_hash(const Scene& scene) {
  return visit(scene, [](const auto& kind) { return hash_of(kind.world); });
}

}  // namespace trellis
