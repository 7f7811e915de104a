// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include <trellis/experiment/experiment.hpp>
#include <trellis/pictures/trajectory.hpp>
#include <trellis/scene/scene.hpp>

namespace trellis {

/// A file of glTF 2.0, which viewers and Blender open: JSON with the numbers in it, or the binary form.
enum class GltfForm { text, binary };

/// Returns the form that a name asks for: binary for ".glb".
/// \throws Error for a name that ends neither with .gltf nor with .glb
GltfForm gltf_form(const std::string& path);

/// Returns a world of space, with the robot at start and goal, as glTF 2.0. Metres; the file's root turns z up into y
/// up, as the format has it. Meshes are not simplified; curved solids have 24 sides to a turn. \param problem  in
/// space; start and goal may be missing
std::string gltf(const Problem& problem, GltfForm form);

/// Returns the same with the levels of a run, deepest first: a node for each level that has positions in space, with
/// the curve of its path and its robot. The robot moves along the path in an animation of the level: its keys are the
/// path's points, at times in proportion to the length of the path in the level's metric, of 10 s in all. A robot of a
/// URDF file moves at the limits of its joints, and stops where its path bends (TimedPath).
std::string gltf(const Problem& problem, const RunResult& run, GltfForm form, const TrajectorySettings& settings = {});

/// Writes DIR/<problem>/<strategy>.glb for every strategy on every problem of space: the first run that found a path
/// or, without one, the first run. \return a sentence about each omitted problem \throws Error where it cannot write a
/// file.
std::vector<std::string> write_gltf(const Experiment& experiment, const ExperimentResult& result,
                                    const std::string& directory, const TrajectorySettings& settings = {});

}  // namespace trellis
