// SPDX-License-Identifier: GPL-3.0-or-later
// The guides. Each is defined in the source file of its name. Only guide.cpp includes this header.
#pragma once

#include <trellis/guide/guide.hpp>

namespace trellis {

GuideKind uniform_kind();
GuideKind goal_bias_kind();
GuideKind gaussian_kind();
GuideKind bridge_test_kind();
GuideKind obstacle_based_kind();
GuideKind medial_axis_kind();
GuideKind halton_kind();
GuideKind informed_kind();
GuideKind information_gain_kind();
GuideKind state_cells_kind();
GuideKind identity_kind();
GuideKind workspace_kind();
GuideKind skeleton_kind();
GuideKind shrink_kind();
GuideKind joints_kind();
GuideKind pca_kind();
GuideKind widen_kind();
GuideKind lazy_kind();
GuideKind drop_kind();
GuideKind aggregate_kind();
GuideKind holonomic_kind();
GuideKind blossom_kind();
GuideKind decomposition_kind();
GuideKind experience_kind();
GuideKind learned_kind();
GuideKind path_database_kind();
GuideKind team_kind();
GuideKind decouple_kind();
GuideKind prioritise_kind();
GuideKind couple_kind();

}  // namespace trellis
