// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string_view>

#include <trellis/base/component.hpp>
#include <trellis/scene/scene.hpp>

namespace trellis {

/// The work of making a guide's space before its first search, in units of search_cost.
struct SetUp {
  double world = 0.0;  ///< for what depends on the world alone and is kept: the medial axis, cells
  double run = 0.0;    ///< in each run
};

/// Estimates the work before it is done, by the rates of the guide's kind.
/// \param guide  the name of a guide of the catalogue
/// \param options  of the guide
/// \throws Error for options that would make too many cells
SetUp set_up_of(std::string_view guide, const Options& options, const Scene& scene);
/// The same for a guide that is not in the catalogue. What its functions do is not known.
SetUp set_up_of_custom();

/// Returns the size of the scene's world: in the plane the corners of its obstacles, a disc with eight; in space its
/// solids, and for meshes and clouds a part of their triangles and points.
double world_size(const Scene& scene);

/// Returns the number of stored paths that a guide with the options `db` and `candidates` retrieves at most.
double retrieved_paths(const Options& options, const Scene& scene);

}  // namespace trellis
