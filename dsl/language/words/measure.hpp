// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <dsl/language/core/construct.hpp>
#include <dsl/lua/state.hpp>
#include <trellis/experiment/experiment.hpp>

namespace trellis::dsl {

/// A function of a script, with a record of its calls.
struct Callback {
  std::string where;  ///< "script.lua:3: "
  std::string what;   ///< "'sample' of this target"
  std::function<bool()> called;
  bool guides = false;  ///< of a guide; else of a target
};

/// Registers the targets and the estimators: a constructor of each, and `target`.
/// \param each   limits of one call of a target's functions
/// \param given  receives each user-defined target
void open_measure(lua::Stack& stack, const lua::Limits& each, const std::shared_ptr<std::vector<Callback>>& given);

/// Returns the targets and the estimators that are components. (A user's own target is a construct.)
std::vector<const Component*> target_components();
std::vector<const Component*> estimator_components();

/// target { sample = function, log_density = function }.
const Construct& target_construct();

/// Targets and estimators, and the arguments of the functions of a user's target.
struct ObjectType;
std::vector<ObjectType> measure_types();

/// Implements a call of a target's or an estimator's constructor.
int make_target(const Component& component, lua::Stack& call);
int make_estimator(const Component& component, lua::Stack& call);

/// Returns the target in the syntax of a script: "tube { delta = 0.25 }", with the options that differ from their
/// defaults.
std::string text_of(const TargetSpec& target);
/// "exact, knn { k = 5 }".
std::string text_of(const std::vector<EstimatorSpec>& estimators);

}  // namespace trellis::dsl
