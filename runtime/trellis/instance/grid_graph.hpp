// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <trellis/instance/instance.hpp>

namespace trellis {

/// A grid over a space of two axes. Edges lead to the eight neighbours of each vertex, and from start and goal to the
/// vertices near them. No edge is evaluated.
/// \param cell  longest side of a cell, metres, > 0
Graph grid_graph(const Instance& instance, double cell);

}  // namespace trellis
