// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <optional>
#include <string>

#include <trellis/base/configurations.hpp>
#include <trellis/space/space.hpp>

namespace trellis {

/// A valid configuration with few decimals, as a user would type it.
struct TypedConfiguration {
  std::string text;       ///< "(6.12, 5, 0)"
  Configuration q;        ///< the configuration that the text denotes, to the bit
  double distance = 0.0;  ///< in the metric, from the query
};

/// Finds a valid configuration with few decimals near `q`. A bounded search samples quasi-random configurations on
/// rings of growing radius around `q` in the metric, then moves the best one towards `q` as long as it stays valid. `q`
/// may lie out of bounds. Deterministic. \return none where the search finds no valid configuration
std::optional<TypedConfiguration> nearest_valid(const Space& space, View q, const std::function<bool(View)>& valid);

}  // namespace trellis
