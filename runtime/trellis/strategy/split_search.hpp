// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>

#include <trellis/strategy/level.hpp>

namespace trellis {

/// Makes the planner of a level that divides its instance at sub-goals.
/// \param guide  of the level and of each half; nullptr: none
std::unique_ptr<DividingPlanner> make_split_search(Run& run, Level& level, const PlannerSpec& planner,
                                                   const GuideSpec* guide, PlannerContext context);

}  // namespace trellis
