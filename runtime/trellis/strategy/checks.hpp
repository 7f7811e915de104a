// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <string>

#include <trellis/instance/instance.hpp>
#include <trellis/planner/planner.hpp>
#include <trellis/strategy/spec.hpp>

namespace trellis {

/// \throws Error for a hierarchy that is too deep
void check_depth(const StrategySpec& strategy);
/// The instance of a problem; its start and goals are normalised to the space.
/// \throws Error if the strategy cannot search the instance
std::unique_ptr<Instance> root_instance(const StrategySpec& strategy, const Problem& problem);
/// \throws Error if the planner ignores the instance's motion model, or requires one that the instance lacks
void check_planner(const PlannerKind& kind, const Instance& instance);
/// "script.lua:3: "; "" for a spec built in C++.
std::string where(const Origin& origin);

}  // namespace trellis
