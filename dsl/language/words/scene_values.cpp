// SPDX-License-Identifier: GPL-3.0-or-later
#include <dsl/language/words/scene_values.hpp>

#include <fmt/format.h>

#include <utility>

#include <dsl/language/core/types.hpp>
#include <trellis/base/error.hpp>
#include <trellis/scene/visit.hpp>

namespace trellis::dsl {

std::optional<AnyWorld> world_in(lua::Value value) {
  if (const auto* world = value.get<World>()) return *world;
  if (const auto* world = value.get<World3>()) return *world;
  return std::nullopt;
}

std::optional<AnyRobot> robot_in(lua::Value value) {
  if (const auto* robot = value.get<Robot>()) return *robot;
  if (const auto* robot = value.get<Robot3>()) return *robot;
  if (const auto* robot = value.get<SphereModel>()) return *robot;
  return std::nullopt;
}

AnyWorld world_of(const Scene& scene) {
  return visit(scene, [](const auto& kind) -> AnyWorld { return kind.world; });
}

AnyRobot robot_of(const Scene& scene) {
  return visit(scene, [](const auto& kind) -> AnyRobot { return kind.robot; });
}

void push_world(lua::Stack& stack, const Scene& scene) {
  visit(scene, [&](const auto& kind) { stack.push_object(kind.world); });
}

void push_robot(lua::Stack& stack, const Scene& scene) {
  visit(scene, [&](const auto& kind) { stack.push_object(kind.robot); });
}

std::shared_ptr<const Scene> make_scene(AnyWorld world, AnyRobot robot) {
  const bool spatial_world = std::holds_alternative<World3>(world);
  if (spatial_world == std::holds_alternative<Robot>(robot)) {
    throw Error(fmt::format(
        "the world is {} and the robot is {}; a robot of {}, as {}, fits this world",
        spatial_world ? "of space" : "planar", spatial_world ? "planar" : "of space",
        spatial_world ? "space" : "the plane",
        spatial_world ? "robot.rigid { box {-0.3, -0.1, -0.1, 0.3, 0.1, 0.1} }" : "robot.rectangle(0.6, 0.2)"));
  }
  if (auto* manipulator = std::get_if<SphereModel>(&robot)) {
    World3 around = std::get<World3>(std::move(world));
    if (manipulator->robot().has_fixed_base()) around = around.for_fixed_base();
    return std::make_shared<const ManipulatorScene>(std::move(around), std::move(*manipulator));
  }
  if (spatial_world) {
    return std::make_shared<const SpatialScene>(std::get<World3>(std::move(world)), std::get<Robot3>(std::move(robot)));
  }
  return std::make_shared<const PlanarScene>(std::get<World>(std::move(world)), std::get<Robot>(std::move(robot)));
}

}  // namespace trellis::dsl
