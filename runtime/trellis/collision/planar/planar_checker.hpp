// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>

#include <trellis/collision/checker.hpp>
#include <trellis/collision/narrow_phase.hpp>
#include <trellis/collision/planar/kernel.hpp>
#include <trellis/scene/planar/scene.hpp>

namespace trellis {

/// Returns the narrow phase of make_planar_checker.
/// \param scene  not nullptr; the narrow phase shares its ownership
/// \param space  copied; fits the scene (check_fits)
/// \param kernels  of one instruction set
std::unique_ptr<NarrowPhase> make_planar_phase(std::shared_ptr<const PlanarScene> scene, const Space& space,
                                               const kernel::Table& kernels = kernel::best());

/// As make_planar_checker, with the kernels of one instruction set; for tests and benchmarks.
std::unique_ptr<Checker> make_planar_checker(std::shared_ptr<const Scene> scene, const Space& space, double resolution,
                                             const kernel::Table& kernels);

}  // namespace trellis
