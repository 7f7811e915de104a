// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include <trellis/experiment/experiment.hpp>

namespace trellis {

/// Separates the shifts of the measure from the run's seed. They depend on the seed only, not on problem or strategy,
/// so that two runs with the same path are scored at the same points.
inline constexpr std::uint64_t measure_seed = 0x7472656c6c697300;

/// A target, or the reason why there is none.
struct MadeTarget {
  std::shared_ptr<const Target> target;
  std::string reason;
};

/// Makes a tube about a path in a level's space; none for a path without length in the target's metric.
MadeTarget make_tube(const LevelRecord& level, const Configurations& path, const TubeSettings& settings,
                     std::uint64_t seed);

/// Returns why a space has no target of near-optimal paths; "" where it has one.
std::string unfit_near_optimal(const Space& space);

/// Makes the target of near-optimal configurations of a level's instance; equal for all its runs. None from five
/// degrees of freedom on.
MadeTarget make_near_optimal(const LevelRecord& level, const NearOptimalSettings& settings);

/// A search's motions ranked by their progress towards the goal, and the target of those ranks.
struct Ranks {
  MadeTarget target;
  Configurations samples;
};
/// \param tree   the motions that created nodes, from each one's parent; else the proposed motions
/// \param model  the motion model: a motion is ranked among those that the planner could have chosen for it, by the
///     record of its controls; nullptr: among straight motions in all directions
/// \return no ranks for planners without a tree
Ranks rank_motions(const LevelRecord& level, bool tree, const ProgressSettings& settings, std::uint64_t seed,
                   const MotionModel* model = nullptr);

}  // namespace trellis
