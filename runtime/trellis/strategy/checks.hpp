// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <string>

#include <trellis/instance/instance.hpp>
#include <trellis/planner/planner.hpp>
#include <trellis/strategy/spec.hpp>

namespace trellis {

/// Throws Error for a hierarchy that has no end in sight.
void check_depth(const StrategySpec& strategy);
/// The instance of a problem, with its ends as the space writes them; throws Error where the strategy cannot search it.
std::unique_ptr<Instance> root_instance(const StrategySpec& strategy, const Problem& problem);
/// Throws Error where a planner does not respect an instance's motion model, or has none to drive.
void check_planner(const PlannerKind& kind, const Instance& instance);
/// "script.lua:3: ", "" for what was built through C++.
std::string where(const Origin& origin);

}  // namespace trellis
