// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <optional>

#include <trellis/instance/instance.hpp>

namespace trellis {

/// Searches when to move along given paths: for a path from the start to the goal of an instance whose coordinates are
/// metres along paths (TeamSpace), on a grid of `cells` steps of each, by greedy best-first search. A step moves all
/// groups that have not arrived, or one, forwards or back. The instance counts the checks.
/// \param most  expansions, at most
/// \return none where the grid has no such path, or it was not found in as many expansions
std::optional<Configurations> schedule(Instance& paths, std::size_t cells, std::size_t most);

}  // namespace trellis
