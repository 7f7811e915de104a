// SPDX-License-Identifier: GPL-3.0-or-later
// The planners. Each is defined in the source file of its name. Only planner.cpp includes this header.
#pragma once

#include <trellis/planner/planner.hpp>

namespace trellis {

PlannerKind rrt_kind();
PlannerKind rrt_connect_kind();
PlannerKind prm_kind();
PlannerKind lazy_prm_kind();
PlannerKind rrt_star_kind();
PlannerKind prm_star_kind();
PlannerKind lazy_prm_star_kind();
PlannerKind lazy_rrg_star_kind();
PlannerKind graph_search_kind();
PlannerKind best_first_kind();
PlannerKind kinodynamic_rrt_kind();
PlannerKind drrt_kind();

}  // namespace trellis
