// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <trellis/instance/instance.hpp>

namespace trellis {

/// Builds a grid over a space of two or three axes. Edges connect each vertex with its 8 or 26 neighbours, and start
/// and goals with the vertices near them. Evaluates no edge. \param cell  longest side of a cell, metres, > 0
Graph grid_graph(const Instance& instance, double cell);

}  // namespace trellis
