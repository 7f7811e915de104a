// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/scene/spatial/linked_robot.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <variant>

#include <trellis/base/error.hpp>

namespace trellis {

namespace {

/// Returns a robot whose joints with coordinates all move.
SphereModel model_of(KinematicTree tree, SphereModel::Pairs may_touch) {
  std::vector<std::size_t> moving;
  for (std::size_t j = 0; j < tree.joints().size(); ++j) {
    if (tree.joints()[j].width() > 0) moving.push_back(j);
  }
  return SphereModel(Manipulator(std::move(tree), std::move(moving)), std::move(may_touch));
}

SphereModel linked_body(const Robot3& body) {
  if (body.is_point()) throw Error("robots: a point is in no team with robots of links: nothing can touch it");
  const KinematicTree alone(body.name(), {{"body", body.solids()}}, {});
  return model_of(alone.on_ground(body.rotates() ? Joint::Kind::floating : Joint::Kind::translation_3), {});
}

/// Returns the prism of a shape between the heights 0 and `height`.
Solid prism(const ConvexShape& shape, double height) {
  const double middle = 0.5 * height;
  if (const auto* disc = std::get_if<Disc>(&shape)) {
    return {Cylinder{disc->radius, height}, {{disc->centre.x, disc->centre.y, middle}, {}}};
  }
  const std::vector<Vec2>& corners = std::get<Polygon>(shape).vertices;
  const Box2 box = bounding_box(shape);
  const auto of_box = rectangle_vertices(box);
  if (corners.size() == of_box.size() && std::is_permutation(of_box.begin(), of_box.end(), corners.begin())) {
    const Vec2 size = box.hi - box.lo;
    const Vec2 centre = 0.5 * (box.lo + box.hi);
    return {Cuboid{{size.x, size.y, height}}, {{centre.x, centre.y, middle}, {}}};
  }
  const auto count = static_cast<std::uint32_t>(corners.size());
  std::vector<Vec3> vertices;
  for (const double z : {0.0, height}) {
    for (const Vec2 corner : corners) vertices.push_back({corner.x, corner.y, z});
  }
  std::vector<Triangle> triangles;
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::uint32_t next = (i + 1) % count;
    triangles.push_back({i, next, count + next});
    triangles.push_back({i, count + next, count + i});
    if (i < 2) continue;
    triangles.push_back({0, i, i - 1});
    triangles.push_back({count, count + i - 1, count + i});
  }
  return {std::make_shared<const Mesh>(std::move(vertices), std::move(triangles), "a prism"), {}};
}

SphereModel upright_robot(const Robot& robot, double height) {
  const auto fail = [&](const std::string& fault) -> void {
    throw Error(fmt::format("robot '{}' cannot stand in space: {}", robot.name(), fault));
  };
  if (robot.is_point()) fail("a point has no height");
  const std::size_t first_angle = robot.translates() ? 2 : 0;
  std::vector<Link> links = {{"ground", {}}};
  std::vector<Joint> joints;
  std::size_t carrier = 0;  // the link that carries the bodies without a parent
  std::size_t next_axis = first_angle;
  const bool alone = robot.translates() && robot.bodies().size() == 1 && robot.bodies().front().angle_axis >= 0 &&
                     robot.bodies().front().joint == Vec2{};
  if (robot.translates() && !alone) {
    links.push_back({"reference point", {}});
    joints.push_back(
        {.name = "base", .kind = Joint::Kind::translation_2, .parent = 0, .child = 1, .axis = {0.0, 0.0, 1.0}});
    carrier = 1;
  }
  const std::size_t first_body = links.size();
  std::vector<std::size_t> joint_of_axis(robot.dimension(), 0);
  for (std::size_t i = 0; i < robot.bodies().size(); ++i) {
    const Body& body = robot.bodies()[i];
    if (body.absolute && body.parent >= 0) fail(fmt::format("the angle of body {} is that of the world", i + 1));
    Link link{body.name.empty() ? fmt::format("body {}", i + 1) : body.name, {}};
    for (const ConvexShape& part : body.parts) link.solids.push_back(prism(part, height));
    links.push_back(std::move(link));
    Joint joint{.name = alone ? "base" : fmt::format("joint {}", i + 1),
                .parent = body.parent < 0 ? carrier : first_body + static_cast<std::size_t>(body.parent),
                .child = first_body + i,
                .origin = {{body.joint.x, body.joint.y, 0.0}, {}},
                .axis = {0.0, 0.0, 1.0}};
    if (body.angle_axis >= 0) {
      const auto axis = static_cast<std::size_t>(body.angle_axis);
      const auto& limits = robot.limits();
      const auto limit = axis - first_angle < limits.size() ? limits[axis - first_angle] : std::nullopt;
      joint.kind = alone ? Joint::Kind::planar : limit ? Joint::Kind::revolute : Joint::Kind::continuous;
      if (limit) std::tie(joint.lo, joint.hi) = *limit;
      if (axis > next_axis) fail(fmt::format("body {} turns before one whose coordinate comes earlier", i + 1));
      if (axis < next_axis) {
        joint.mimic = Joint::Mimic{joint_of_axis[axis]};
      } else {
        joint_of_axis[axis] = joints.size();
        ++next_axis;
      }
    }
    joints.push_back(std::move(joint));
  }
  SphereModel::Pairs may_touch;
  for (std::size_t a = 0; a < robot.bodies().size(); ++a) {
    for (std::size_t b = a + 1; b < robot.bodies().size(); ++b) {
      const bool apart = std::binary_search(robot.pairs().begin(), robot.pairs().end(), std::pair(a, b));
      if (!apart) may_touch.emplace_back(first_body + a, first_body + b);
    }
  }
  // Breadth first is the order of the coordinates where each body has one parent before it.
  KinematicTree tree(robot.name(), std::move(links), joints);
  for (std::size_t j = 0; j < joints.size(); ++j) {
    if (joints[j].width() > 0 && tree.joints()[j].name != joints[j].name) fail("its angles do not follow its branches");
  }
  SphereModel model = model_of(std::move(tree), std::move(may_touch));
  return robot.translates() ? model : model.based_at({{robot.base().x, robot.base().y, 0.0}, {}});
}

}  // namespace

std::vector<SphereModel> linked(const Robot3& robot) {
  if (robot.members().empty()) return {linked_body(robot)};
  std::vector<SphereModel> all;
  for (const Robot3::Member& member : robot.members()) all.push_back(linked_body(*member.robot));
  return all;
}

std::vector<SphereModel> upright(const Robot& robot, double height) {
  if (!(height > 0.0) || !std::isfinite(height)) {
    throw Error(fmt::format("robots: the height of robots of the plane must be a number > 0, got {:g}", height));
  }
  if (robot.members().empty()) return {upright_robot(robot, height)};
  std::vector<SphereModel> all;
  for (const Robot::Member& member : robot.members()) all.push_back(upright_robot(*member.robot, height));
  return all;
}

}  // namespace trellis
