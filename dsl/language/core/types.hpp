// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <variant>

#include <dsl/language/core/program.hpp>
#include <dsl/lua/value.hpp>
#include <trellis/base/component.hpp>
#include <trellis/experiment/experiment.hpp>
#include <trellis/measure/estimator.hpp>
#include <trellis/scene/planar/scene.hpp>
#include <trellis/scene/spatial/manipulator_scene.hpp>
#include <trellis/scene/spatial/point_cloud.hpp>
#include <trellis/scene/spatial/scene.hpp>
#include <trellis/strategy/spec.hpp>

// The types of Lua values, and their names in messages.

namespace trellis::dsl {

/// A component without options: the value of the global `rrt`.
struct Constructor {
  const Component* component;
};

/// An obstacle or a robot's part.
struct NamedShape {
  std::string name;                  ///< the script's name for it, "" for none
  std::string text;                  ///< "box 4 0 6 4.75"
  std::variant<Shape, Solid> shape;  ///< of the plane, or of space
};

}  // namespace trellis::dsl

namespace trellis::lua {

template <>
struct Weight<dsl::NamedShape> {
  static std::size_t of(const dsl::NamedShape& shape) {
    return sizeof shape + shape.name.size() + shape.text.size() +
           std::visit([](const auto& kind) { return of(kind); }, shape.shape);
  }
  static std::size_t of(const Solid& solid) {
    if (const auto* cloud = std::get_if<std::shared_ptr<const PointCloud>>(&solid.shape)) {
      return sizeof solid + (*cloud)->points().size() * sizeof(Vec3);
    }
    const auto* mesh = std::get_if<std::shared_ptr<const Mesh>>(&solid.shape);
    if (mesh == nullptr) return sizeof solid;
    return sizeof solid + (*mesh)->vertices().size() * sizeof(Vec3) + (*mesh)->triangles().size() * sizeof(Triangle);
  }
  static std::size_t of(const Shape& shape) {
    const auto* polygon = std::get_if<Polygon>(&shape);
    return sizeof shape + (polygon != nullptr ? polygon->vertices.size() * sizeof(Vec2) : 0);
  }
};
template <>
struct Weight<World> {
  static std::size_t of(const World& world) {
    std::size_t sum = sizeof world;
    for (const auto& obstacle : world.obstacles()) {
      sum += sizeof obstacle + obstacle.name.size() + Weight<dsl::NamedShape>::of(obstacle.shape);
    }
    return sum + world.parts().size() * parts;
  }
  static constexpr std::size_t parts = sizeof(World::Part) + 4 * sizeof(Vec2);
};
template <>
struct Weight<Robot> {
  static std::size_t of(const Robot& robot) {
    std::size_t sum = sizeof robot;
    for (const auto& body : robot.bodies()) sum += sizeof body + body.parts.size() * Weight<World>::parts;
    return sum;
  }
};
template <>
struct Weight<World3> {
  static std::size_t of(const World3& world) {
    std::size_t sum = sizeof world;
    for (const auto& obstacle : world.obstacles())
      sum += obstacle.name.size() + Weight<dsl::NamedShape>::of(obstacle.solid);
    return sum;
  }
};
template <>
struct Weight<Robot3> {
  static std::size_t of(const Robot3& robot) {
    std::size_t sum = sizeof robot;
    for (const auto& solid : robot.solids()) sum += Weight<dsl::NamedShape>::of(solid);
    return sum;
  }
};
template <>
struct Weight<SphereModel> {
  static std::size_t of(const SphereModel& robot) {
    constexpr std::size_t link = 512;
    std::size_t sum = sizeof robot + link * robot.robot().tree().links().size();
    for (const auto& body : robot.bodies()) sum += body.size() * sizeof(BodySphere);
    for (const Link& one : robot.robot().tree().links()) {
      for (const Solid& solid : one.solids) sum += Weight<dsl::NamedShape>::of(solid);
    }
    return sum + sizeof(std::size_t) * 2 * (robot.pairs().size() + robot.may_touch().size());
  }
};
template <>
struct Weight<Problem> {
  static std::size_t of(const Problem& problem) {
    constexpr std::size_t axis = 128;
    return sizeof problem + sizeof(PlanarScene) + problem.name.size() + axis * problem.space.dimension();
  }
};
template <>
struct Weight<dsl::Program> {
  static std::size_t of(const dsl::Program& program) {
    constexpr std::size_t strategy = 1024;
    std::size_t sum = sizeof program + program.experiment.seeds.size() * sizeof(std::uint64_t) +
                      program.experiment.strategies.size() * strategy;
    for (const auto& problem : program.experiment.problems) sum += Weight<Problem>::of(problem);
    return sum;
  }
};

template <>
struct TypeName<dsl::Constructor> {
  static constexpr const char* value = "constructor";
};
template <>
struct TypeName<PlannerSpec> {
  static constexpr const char* value = "planner";
};
template <>
struct TypeName<GuideSpec> {
  static constexpr const char* value = "guide";
};
template <>
struct TypeName<StrategySpec> {
  static constexpr const char* value = "strategy";
};
template <>
struct TypeName<dsl::NamedShape> {
  static constexpr const char* value = "shape";
};
template <>
struct TypeName<World> {
  static constexpr const char* value = "world";
};
template <>
struct TypeName<Robot> {
  static constexpr const char* value = "robot";
};
template <>
struct TypeName<Pose3> {
  static constexpr const char* value = "pose";
};
template <>
struct TypeName<World3> {
  static constexpr const char* value = "world of space";
};
template <>
struct TypeName<Robot3> {
  static constexpr const char* value = "robot of space";
};
template <>
struct TypeName<SphereModel> {
  static constexpr const char* value = "manipulator";
};
template <>
struct TypeName<Problem> {
  static constexpr const char* value = "problem";
};
template <>
struct TypeName<TargetSpec> {
  static constexpr const char* value = "target";
};
template <>
struct TypeName<EstimatorSpec> {
  static constexpr const char* value = "estimator";
};
template <>
struct TypeName<dsl::Program> {
  static constexpr const char* value = "experiment";
};

}  // namespace trellis::lua
