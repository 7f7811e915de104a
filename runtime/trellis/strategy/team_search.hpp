// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>

#include <trellis/guide/team.hpp>
#include <trellis/strategy/level.hpp>

namespace trellis {

/// Whether a guide guides the searches of so many robots together: one that needs a position, or is written in Lua,
/// those of one robot, one that needs a team those of several, any other both; a combination where all its guides do.
bool guides_searches_of(const GuideSpec& guide, std::size_t robots);

/// Makes the planner of a level that divides its instance by the robots of a team. Each part is a level below it.
/// \param planner  of every part
/// \param guide    of every part that it guides (guides_searches_of); nullptr: none
std::unique_ptr<Planner> make_team_search(Run& run, Level& level, const PlannerSpec& planner, const GuideSpec* guide,
                                          const TeamDivision& division, PlannerContext context);

}  // namespace trellis
