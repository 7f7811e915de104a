// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>

#include <trellis/measure/efficiency.hpp>
#include <trellis/report/summary.hpp>

namespace trellis {

/// One quantity of the measure: how reports name it, where a run has it, and where a summary has its interval. Writers
/// and readers of the JSON of runs and of summaries, and the means over runs use this one list.
struct MeasureQuantity {
  const char* group;  ///< of JSON: the object that has it, nullptr: the measure itself
  const char* name;   ///< in JSON
  double (*of_run)(const Efficiency&);
  double& (*field)(Efficiency&);  ///< where a run stores it; nullptr: computed from others
  Interval Figure::*over_runs;    ///< nullptr: summaries do not have it
  bool infinite;                  ///< whether runs print an infinite value; else it counts as missing
};

/// Returns all quantities, in the order of reports; those of a group follow one another.
std::span<const MeasureQuantity> measure_quantities();

}  // namespace trellis
