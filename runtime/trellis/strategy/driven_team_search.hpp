// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>

#include <trellis/guide/team.hpp>
#include <trellis/planner/planner.hpp>
#include <trellis/strategy/spec.hpp>

namespace trellis {

class Level;
struct Run;

/// Makes the search that divides the instance of a team that is driven by motion models. Its parts are those of
/// `make_team_search`, but robots that follow a motion found before continue along it or wait, and never go back.
/// Requires robots that can wait, and no division about conflicts (TeamPath checks both).
std::unique_ptr<Planner> make_driven_team_search(Run& run, Level& level, const PlannerSpec& planner,
                                                 const GuideSpec* guide, const TeamDivision& division,
                                                 PlannerContext context);

}  // namespace trellis
