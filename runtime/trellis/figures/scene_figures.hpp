// SPDX-License-Identifier: GPL-3.0-or-later
// Pictures of samples and motions in the world.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <trellis/draw/planar.hpp>
#include <trellis/experiment/experiment.hpp>
#include <trellis/figures/charts/pictures.hpp>

namespace trellis {

struct SceneFigureOptions {
  draw::RoleColours colours = draw::RoleColours::safe;
  /// The side of the cells in which to count samples, metres. None: half a metre, doubled or halved until the world's
  /// longer side has about 12 to 48 cells; in space doubled until there are at most 4096.
  std::optional<double> cell = {};
  unsigned jobs = 1;  ///< pictures drawn concurrently
  FigureStyle style = {};
};

/// Draws the distribution of the samples in the world, as Figure 2 of Attali et al. 2022:
/// DIR/<problem>/<strategy>/samples.svg, .png and .pdf for every strategy, and levels.* where levels below the root
/// have a position in the plane or in space. Omits problems without one. \return a sentence about each omitted
/// problem
/// \throws Error for a cell out of range, and where it cannot write a file.
std::vector<std::string> write_scene_figures(const Experiment& experiment, const ExperimentResult& result,
                                             const std::string& directory, const SceneFigureOptions& options = {});

/// Draws motions in two-dimensional spaces, as Figure 1 of Attali et al. 2022: DIR/<problem>/<strategy>/motion.svg,
/// .png and .pdf for every strategy of a problem whose space has two axes and is more than the workspace. Each picture
/// shows the robot along its path, and beside it the space with the invalid configurations, the path, and the density
/// of the proposals. It has a row for each guide that searches the same space, the deepest first, and one for the root.
/// It shows the first run that found a path or, without one, the first run. Of a problem in space the picture has a
/// view of the world for each level with positions, with the level's robot along its path. \throws Error where it
/// cannot write a file.
void write_motion_figures(const Experiment& experiment, const ExperimentResult& result, const std::string& directory,
                          unsigned jobs = 1, const FigureStyle& style = {});

}  // namespace trellis
