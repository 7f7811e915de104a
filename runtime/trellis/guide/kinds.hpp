// SPDX-License-Identifier: GPL-3.0-or-later
// The guides, in the order of the reference: one line each. The source of a guide defines GuideKind NAME_kind(). Only
// guide.cpp includes this header.
#pragma once

// clang-format off
#define TRELLIS_GUIDES(guide) \
  guide(uniform)              \
  guide(goal_bias)            \
  guide(gaussian)             \
  guide(bridge_test)          \
  guide(obstacle_based)       \
  guide(medial_axis)          \
  guide(halton)               \
  guide(informed)             \
  guide(information_gain)     \
  guide(state_cells)          \
  guide(identity)             \
  guide(workspace)            \
  guide(skeleton)             \
  guide(shrink)               \
  guide(joints)               \
  guide(pca)                  \
  guide(widen)                \
  guide(lazy)                 \
  guide(drop)                 \
  guide(aggregate)            \
  guide(holonomic)            \
  guide(blossom)              \
  guide(decomposition)        \
  guide(experience)           \
  guide(path_database)        \
  guide(learned)              \
  guide(team)                 \
  guide(decouple)             \
  guide(prioritise)           \
  guide(couple)
// clang-format on
