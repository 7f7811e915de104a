// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>

#include <trellis/collision/checker.hpp>
#include <trellis/collision/planar/kernel.hpp>

namespace trellis {

/// As make_planar_checker, with the kernels of one instruction set; for tests and benchmarks.
std::unique_ptr<Checker> make_planar_checker(std::shared_ptr<const Scene> scene, const Space& space, double resolution,
                                             const kernel::Table& kernels);

}  // namespace trellis
