// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <trellis/planner/planner.hpp>

namespace trellis {

/// Appends the nodes, proposals, edges and densities of a search to another one over the same space. Rows of the part
/// come after those of the whole.
void absorb(const Search& part, Search& whole);

}  // namespace trellis
