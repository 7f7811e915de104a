// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>

#include <trellis/guide/team.hpp>
#include <trellis/strategy/level.hpp>

namespace trellis {

/// Makes the planner of a level that divides its instance by the robots of a team. Each part is a level below it.
/// \param planner  of every part
/// \param guide    of every part that is one robot; nullptr: none
std::unique_ptr<Planner> make_team_search(Run& run, Level& level, const PlannerSpec& planner, const GuideSpec* guide,
                                          const TeamDivision& division, PlannerContext context);

}  // namespace trellis
