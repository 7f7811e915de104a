// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <dsl/language/core/word.hpp>
#include <dsl/lua/stack.hpp>
#include <dsl/lua/state.hpp>
#include <trellis/instance/instance.hpp>

// The planning instance that the functions of a guiding space receive, as a value of the language.

namespace trellis::dsl {

/// The instance behind a value of the language, which may outlive it.
struct InstanceAccess {
  Instance* instance = nullptr;  ///< nullptr: the call that the value was passed to has ended

  /// Invalidates it at the end of a scope.
  class Scope {
   public:
    explicit Scope(InstanceAccess& access) : access_(access) {}
    Scope(const Scope&) = delete;
    Scope& operator=(const Scope&) = delete;
    ~Scope() { access_.instance = nullptr; }

   private:
    InstanceAccess& access_;
  };
};

/// An instance as a value: its fields, and its queries as methods.
struct InstanceValue {
  std::shared_ptr<const lua::Reference> members;  ///< a table, which scripts cannot access
};

/// Pushes an instance. Its checks count in the instance.
void push_instance(lua::Stack& stack, const Instance& instance, const std::shared_ptr<InstanceAccess>& access);

/// Reads a control of a motion model: a list of one number for each control, each within its bounds. Messages call it
/// `what`. \throws Error
Configuration read_control(const lua::Value& value, const MotionModel& model, const std::string& what);
/// Reads a duration in seconds, as the nearest number of steps of a motion model, at least 1. \throws Error
std::uint32_t read_duration(const lua::Value& value, const MotionModel& model, const std::string& what);

/// Registers the type.
void open_instance(lua::Stack& stack);

/// trellis.Instance, and the results of its methods.
std::vector<ObjectType> instance_types();

}  // namespace trellis::dsl

namespace trellis::lua {

template <>
struct TypeName<dsl::InstanceValue> {
  static constexpr const char* value = "instance";
};

}  // namespace trellis::lua
