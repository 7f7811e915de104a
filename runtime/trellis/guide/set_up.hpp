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

/// Estimates the work before it is done: from the kind of the guide, the number of obstacles, and, of guides that
/// retrieve stored paths, the number of these.
/// \param guide  the name of a guide of the catalogue
/// \param options  of the guide
/// \throws Fault for a guide without an entry
SetUp set_up_of(std::string_view guide, const Options& options, const Scene& scene);
/// The same for a guide that is not in the catalogue. What its functions do is not known.
SetUp set_up_of_custom();

}  // namespace trellis
