// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <numeric>
#include <vector>

#include <trellis/scene/scene.hpp>

namespace trellis::test {

/// The problem with a copy of its world, of which nothing is known yet.
inline Problem renewed(Problem problem) {
  std::vector<std::size_t> all(problem.scene->obstacle_count());
  std::iota(all.begin(), all.end(), std::size_t{0});
  problem.scene = problem.scene->with_obstacles(all);
  return problem;
}

}  // namespace trellis::test
