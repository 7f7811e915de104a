// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>

#include <trellis/guide/team.hpp>
#include <trellis/strategy/level.hpp>

namespace trellis {

/// Makes the planner of a level that couples the robots of a team only where their paths conflict
/// (Coordination::windows). Each search is a level below it.
/// \param planner  of every search
/// \param guide    of every search that it guides (guides_searches_of); nullptr: none
std::unique_ptr<Planner> make_conflict_search(Run& run, Level& level, const PlannerSpec& planner,
                                              const GuideSpec* guide, const TeamDivision& division,
                                              PlannerContext context);

}  // namespace trellis
