// SPDX-License-Identifier: GPL-3.0-or-later
// Where the configurations of a level place each robot of a team.
#pragma once

#include <cstddef>
#include <vector>

#include <trellis/experiment/experiment.hpp>
#include <trellis/scene/spatial/manipulator_scene.hpp>

namespace trellis {

/// The position of one robot in the configurations of a level.
struct Trace {
  std::size_t robot = 0;          ///< its place in the root's team, from 0 on; 0 of a robot alone
  std::vector<std::size_t> axes;  ///< of its reference point; empty: its tip has the position
  PointOnBody tip{};              ///< of the level's robot
};

/// Returns the robots with a position in the plane or in space, in the order of their coordinates.
/// \param levels  of one run
std::vector<Trace> traces_of(const std::vector<LevelResult>& levels, std::size_t level);
/// The same for the configurations of a problem.
std::vector<Trace> traces_of(const Problem& problem);

/// Returns at which coordinate of a level those of its robot begin: how far other robots are along their paths comes
/// before them.
std::size_t first_coordinate(const std::vector<LevelResult>& levels, std::size_t level);

/// Returns configurations of a path at even times, with both ends.
Configurations moments_of(const Scene* scene, const Space& space, const Configurations& path, std::size_t count);

}  // namespace trellis
