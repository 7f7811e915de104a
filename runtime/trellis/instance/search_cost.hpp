// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

/// The work of searches, in units of 0.07 us: from the CPU times of `scripts/bench-work --law` (docs/performance.md).
/// What checks cost, CheckCost says.
namespace trellis::search_cost {
inline constexpr double proposal = 4.0;              ///< with its nearest neighbour
inline constexpr double guided_proposal = 2.0;       ///< more in a level that guides, or is guided
inline constexpr double neighbours = 2.5;            ///< a query of k nearest neighbours, and
inline constexpr double neighbours_compared = 0.25;  ///< a group of nodes that are compared in it
inline constexpr double edge = 1.0;                  ///< an edge of a graph that a search considers
inline constexpr double label = 0.375;               ///< an edge or vertex whose label the beginning of a search clears
inline constexpr double roadmap_edge = 0.1;          ///< an edge of a roadmap that a search considers
inline constexpr double node = 6.0;                  ///< a node that a roadmap connects to its neighbours, and
inline constexpr double node_compared = 3.0;         ///< a group of nodes that it is compared with then
inline constexpr double rewired_node = 40.0;         ///< a node of a tree whose neighbours take it as their parent
inline constexpr double coordinate = 0.25;           ///< a coordinate that a sampler draws, beside those of proposals
inline constexpr double path_point = 3.0;            ///< a point of a path that a guide validates, without its checks
inline constexpr double slice = 1.0;                 ///< of a motion, whose place is looked up among known ranges
inline constexpr double node_rated = 4.0;            ///< a node, or cell, that a guide rates
/// A step of inverse kinematics of a manipulator: 0.9 to 1.1 us for Baxter, Fetch, UR5 and Panda.
inline constexpr double kinematics = 14.0;
}  // namespace trellis::search_cost
