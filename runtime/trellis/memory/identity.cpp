// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/memory/identity.hpp>

#include <string>
#include <type_traits>
#include <variant>

#include <trellis/base/random.hpp>
#include <trellis/memory/bytes.hpp>

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

}  // namespace

std::uint64_t identity(const Space& space) {
  std::string bytes;
  for (const Axis& axis : space.axes()) {
    bytes += axis.name;
    bytes += axis.periodic ? '\1' : '\0';
    put_number(bytes, axis.lo);
    put_number(bytes, axis.hi);
    put_number(bytes, axis.weight);
  }
  return stable_hash(bytes);
}

std::uint64_t identity(const Robot& robot) {
  std::string bytes;
  bytes += robot.translates() ? '\1' : '\0';
  put(bytes, robot.base());
  for (const Body& body : robot.bodies()) {
    put_integer(bytes, static_cast<std::uint64_t>(std::int64_t{body.parent} + 1));
    put_integer(bytes, static_cast<std::uint64_t>(std::int64_t{body.angle_axis} + 1));
    bytes += body.absolute ? '\1' : '\0';
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

std::uint64_t identity(const World& world) {
  std::string bytes;
  put(bytes, world.bounds());
  for (const Obstacle& obstacle : world.obstacles()) put(bytes, obstacle.shape);
  return stable_hash(bytes);
}

}  // namespace trellis
