// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <vector>

#include <dsl/language/core/construct.hpp>
#include <dsl/lua/stack.hpp>
#include <trellis/motion/motion_model.hpp>

namespace trellis::dsl {

/// A motion model as a Lua value.
using Motion = std::shared_ptr<const MotionModel>;

/// Registers the motion models, in the table `motion`.
void open_motion(lua::Stack& stack);

/// One for each motion model: motion.unicycle1, ...
std::vector<const Construct*> motion_constructs();

}  // namespace trellis::dsl

namespace trellis::lua {

template <>
struct TypeName<dsl::Motion> {
  static constexpr const char* value = "motion model";
};

}  // namespace trellis::lua
