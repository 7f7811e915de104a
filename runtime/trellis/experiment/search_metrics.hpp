// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <string_view>
#include <vector>

#include <trellis/planner/planner.hpp>
#include <trellis/results/facts.hpp>
#include <trellis/space/space.hpp>

namespace trellis {

struct SearchMetricsSettings {
  std::size_t neighbours = 10;       ///< nearest earlier nodes, and nearest witnesses, that a node tries to connect to
  std::size_t witnesses = 256;       ///< in each of the two sets
  std::size_t model_neighbours = 5;  ///< nearest labelled samples that predict a configuration's validity
};

/// Does not count its checks. Deterministic.
/// \param valid         of configurations of the space
/// \param valid_motion  of the straight motion from a valid configuration to another
SearchMetrics search_metrics(const Space& space, const Search& search, const std::function<bool(View)>& valid,
                             const std::function<bool(View, View)>& valid_motion,
                             const SearchMetricsSettings& settings = {}, std::uint64_t seed = 0);

/// Returns the first set of witnesses: at most `count` valid configurations; fewer where validity is rare.
Configurations valid_witnesses(const Space& space, const std::function<bool(View)>& valid, std::size_t count,
                               std::uint64_t seed);

}  // namespace trellis
