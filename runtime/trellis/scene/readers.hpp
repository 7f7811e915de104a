// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include <trellis/scene/scene.hpp>

namespace trellis {

struct ReadOptions {
  double weight = 0.0;               ///< metres per radian of angular axes; 0: the default, 1/pi
  double resolution = 0.05;          ///< see Problem
  std::string collision = "planar";  ///< see Problem
  bool motion = true;            ///< problems have the motion models that the files name, where there is such a model
  double goal_tolerance = 0.25;  ///< of problems with a motion model: their files do not give one
};

/// Reads a scene file of another project and returns its problems, at least one. The file's content selects the reader:
///  - the circle world of ompl_tests (two header lines, then "index x y r"). Its queries are in the file of the same
///    folder in whose name "queries" replaces "obstacles".
///  - a planar arm of SBPL on a grid. Its goal is a cell for the end of the last link: `reach` is set and `goal` is
///    empty, see resolve_goal.
///  - dynobench YAML (boxes). The models are in ../shared/models beside the scene's folder.
///  - PNG: pixels of 0.05 m, dark pixels are obstacles. The robot is a point that moves from the lower left corner to
///    the upper right one.
/// \throws Error with file and line for malformed or missing content.
std::vector<Problem> read_problems(const std::string& path, const ReadOptions& options);

}  // namespace trellis
