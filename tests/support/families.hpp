// SPDX-License-Identifier: GPL-3.0-or-later
// Families of worlds for training a heuristic: walls across the direct route, with a gap each.
#pragma once

#include <fmt/format.h>

#include <string>
#include <utility>
#include <vector>

#include <trellis/base/random.hpp>
#include <trellis/scene/planar/scene.hpp>

#include "support/worlds.hpp"

namespace trellis::test {

/// Two walls across a square of 10 m, each with a gap of 0.6 m between heights `lo` and `hi`.
inline World gap_world(std::uint64_t seed, double lo, double hi) {
  Stream stream(seed, "", "gap world");
  constexpr double gap = 0.6;
  Rectangles walls;
  for (const double x : {3.2, 6.4}) {
    const double y = stream.uniform(lo, hi);
    walls.push_back({x, 0, x + 0.4, y});
    walls.push_back({x, y + gap, x + 0.4, 10});
  }
  return rectangle_world(walls);
}

/// A point from the middle of the left side to the middle of the right one.
inline Problem gap_problem(std::uint64_t seed, double lo, double hi) {
  return make_problem(fmt::format("gaps {}", seed), gap_world(seed, lo, hi), Robot::point(), {0.5, 5.0}, {9.5, 5.0});
}

/// Gaps in the upper half; and their mirror images, which mislead a model of the former.
inline Problem upper_gaps(std::uint64_t seed) { return gap_problem(seed, 6.0, 8.8); }
inline Problem lower_gaps(std::uint64_t seed) { return gap_problem(seed, 0.6, 3.4); }

}  // namespace trellis::test
