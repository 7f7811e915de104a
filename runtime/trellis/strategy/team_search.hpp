// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>

#include <trellis/guide/team.hpp>
#include <trellis/strategy/level.hpp>

namespace trellis {

/// Whether a guide guides the searches of so many robots together: one that needs a position, or is written in Lua,
/// those of one robot, one that needs a team those of several, any other both; a combination where all its guides do.
bool guides_searches_of(const GuideSpec& guide, std::size_t robots);

/// The context of a planner that divides the instance of a team by its robots.
struct TeamSearchContext {
  Run& run;
  Level& level;            ///< of the team; each part is a level below it
  PlannerSpec planner;     ///< of every part
  const GuideSpec* guide;  ///< of every part that it guides (guides_searches_of); nullptr: none
  TeamDivision division;
  PlannerContext context;
};

/// Makes the planner of a level that divides its instance by the robots of a team, without motion models.
std::unique_ptr<Planner> make_team_search(TeamSearchContext context);

/// Makes the search that divides the instance of a team that is driven by motion models. Its parts are those of
/// `make_team_search`, but robots that follow a motion found before continue along it or wait, and never go back.
/// Requires robots that can wait, and no division about conflicts (TeamPath checks both).
std::unique_ptr<Planner> make_driven_team_search(TeamSearchContext context);

/// Makes the planner of a level that couples the robots of a team only where their paths conflict
/// (Coordination::windows). Each search is a level below it.
std::unique_ptr<Planner> make_conflict_search(TeamSearchContext context);

}  // namespace trellis
