// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <trellis/instance/instance.hpp>

namespace trellis {

/// A grid over a space of two axes with edges to the eight neighbours of each vertex, none of them evaluated. Edges
/// join start and goal to the vertices near them. \param cell  side of a cell at most, metres, > 0
Graph grid_graph(const Instance& instance, double cell);

}  // namespace trellis
