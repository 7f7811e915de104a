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
  double goal_tolerance = 0.25;  ///< of problems with a motion model: their files give none
};

/// Reads a scene file made by others and returns its problems, at least one. Which reader is meant is told from the
/// content: the circle world of ompl_tests (two header lines, then "index x y r"; queries come from the file next to it
/// in which "obstacles" of the name is replaced by "queries"), a planar arm of SBPL's on a grid (its goal is a cell for
/// the end of the last link: `reach` is set and `goal` is empty, see settle_goal), dynobench YAML (boxes; models are
/// looked up in ../shared/models beside the scene's folder) or a PNG: pixels of 0.05 m, the dark ones obstacles, for a
/// point that goes from the lower left corner to the upper right one. Throws Error with file and line for anything
/// malformed or missing.
std::vector<Problem> read_problems(const std::string& path, const ReadOptions& options);

}  // namespace trellis
