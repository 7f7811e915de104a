// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

namespace trellis {

/// A path of a run that is shorter than all earlier ones.
struct Improvement {
  std::uint64_t validity_checks = 0;  ///< of all levels so far
  double cpu_seconds = 0.0;
  double length = 0.0;  ///< in metres in the metric
};

}  // namespace trellis
