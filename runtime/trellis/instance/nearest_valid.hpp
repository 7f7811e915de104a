// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <optional>
#include <string>

#include <trellis/base/configurations.hpp>
#include <trellis/space/space.hpp>

namespace trellis {

/// A valid configuration as somebody would type it.
struct TypedConfiguration {
  std::string text;       ///< "(6.12, 5, 0)"
  Configuration q;        ///< what that text says, to the bit
  double distance = 0.0;  ///< in the metric, from where it was looked for
};

/// The nearest valid configuration with few decimals that a bounded search finds: rings of quasi-random configurations
/// that grow around `q` in the metric, the best one pulled back towards `q` as far as it stays valid. `q` may lie out
/// of bounds. The same each time. None where nothing valid was found.
std::optional<TypedConfiguration> nearest_valid(const Space& space, View q, const std::function<bool(View)>& valid);

}  // namespace trellis
