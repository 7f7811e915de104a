// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include <dsl/language/program.hpp>
#include <dsl/lua/value.hpp>
#include <trellis/base/component.hpp>
#include <trellis/experiment/experiment.hpp>
#include <trellis/measure/estimator.hpp>
#include <trellis/scene/scene.hpp>
#include <trellis/strategy/spec.hpp>

// The types that scripts hold, and how messages call them.

namespace trellis::dsl {

/// A component before its options: the value of the global `rrt`.
struct Constructor {
  const Component* component;
};

/// An obstacle or a robot's part.
struct NamedShape {
  std::string name;  ///< what the script called it, "" without
  std::string text;  ///< "box 4 0 6 4.75"
  Shape shape;
};

}  // namespace trellis::dsl

namespace trellis::lua {

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
struct TypeName<Publication> {
  static constexpr const char* value = "publication";
};
template <>
struct TypeName<Publication::Claim> {
  static constexpr const char* value = "claim";
};
template <>
struct TypeName<dsl::Program> {
  static constexpr const char* value = "experiment";
};

}  // namespace trellis::lua
