// SPDX-License-Identifier: GPL-3.0-or-later
// The planners, in the order of the reference: one line each. The source of a planner defines PlannerKind NAME_kind().
// Only planner.cpp includes this header.
#pragma once

// clang-format off
#define TRELLIS_PLANNERS(planner) \
  planner(rrt)                    \
  planner(rrt_connect)            \
  planner(prm)                    \
  planner(lazy_prm)               \
  planner(rrt_star)               \
  planner(prm_star)               \
  planner(lazy_prm_star)          \
  planner(lazy_rrg_star)          \
  planner(kinodynamic_rrt)        \
  planner(graph_search)           \
  planner(best_first)             \
  planner(drrt)
// clang-format on
