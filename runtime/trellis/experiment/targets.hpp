// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include <trellis/experiment/experiment.hpp>

namespace trellis {

/// Keeps the shifts of the measure apart from the run's own seed. They depend on the seed alone, not on problem or
/// strategy, so that two runs that found the same path are scored at the same points.
inline constexpr std::uint64_t measure_seed = 0x7472656c6c697300;

/// A target, or why there is none.
struct MadeTarget {
  std::shared_ptr<const Target> target;
  std::string reason;
};

/// A tube about a path in a level's space. A path without length in the target's sense makes none.
MadeTarget make_tube(const LevelRecord& level, const Configurations& path, const TubeSettings& settings,
                     std::uint64_t seed);

/// The configurations near the optimum of a level's instance; the same for every run of it.
MadeTarget make_near_optimal(const LevelRecord& level, const NearOptimalSettings& settings);

/// A search's motions ranked by how much closer they come to the goal, and the target of those ranks.
struct Ranks {
  MadeTarget target;
  Configurations samples;
};
/// \param tree  the motions that made nodes, from each one's parent; else those that were proposed
/// \param model  what drives the robot: motions are ranked among those that its controls make; nullptr: among straight
///               ones in all directions
/// Planners without a tree make none.
Ranks rank_motions(const LevelRecord& level, bool tree, const ProgressSettings& settings, std::uint64_t seed,
                   const MotionModel* model = nullptr);

}  // namespace trellis
