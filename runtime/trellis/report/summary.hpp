// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <limits>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <trellis/experiment/experiment.hpp>
#include <trellis/measure/statistics.hpp>

namespace trellis {

/// One efficiency figure over the runs of a group. A run that was not scored leaves no trace in the intervals; `scored`
/// says how many were.
struct Figure {
  Interval value;                                          ///< SE, defended, nats
  Interval gain;                                           ///< uniform - SE
  Interval uniform;                                        ///< the divergence of uniform sampling
  Interval coverage;                                       ///< share of the target within delta of a sample
  Interval uniform_coverage;                               ///< what as many uniform samples reach
  std::size_t scored = 0;                                  ///< runs that have a value
  std::vector<std::string> estimators;                     ///< of those runs, each once
  std::vector<std::pair<std::string, std::size_t>> flags;  ///< each flag raised, and in how many runs
};

/// Tree and expansion of a level, in one space.
struct FigurePair {
  Figure tree;
  Figure expansion;
};

/// One level of a hierarchy over the runs of a group. Medians are over all the runs that reached the level.
struct LevelSummary {
  std::string key;
  std::string name;
  int parent = -1;    ///< index into RunsSummary::levels
  std::string space;  ///< "" where it differs between the runs
  std::size_t dimension = 0;
  std::string planner;
  std::size_t runs = 0;    ///< that reached the level
  std::size_t solved = 0;  ///< whose level found a path of its own
  double resolves = std::numeric_limits<double>::quiet_NaN();
  double proposals = std::numeric_limits<double>::quiet_NaN();
  double nodes = std::numeric_limits<double>::quiet_NaN();
  double validity_checks = std::numeric_limits<double>::quiet_NaN();
  double motion_checks = std::numeric_limits<double>::quiet_NaN();
  double seconds = std::numeric_limits<double>::quiet_NaN();
  FigurePair own;
  FigurePair root;
};

/// The runs of one strategy on one problem, or on all problems taken together.
struct RunsSummary {
  std::size_t runs = 0;
  Interval success;  ///< Wilson
  std::size_t solved = 0;
  double validity_checks = std::numeric_limits<double>::quiet_NaN();  ///< medians over all runs, all levels together
  double motion_checks = std::numeric_limits<double>::quiet_NaN();
  double seconds = std::numeric_limits<double>::quiet_NaN();
  Interval length;                   ///< mean over the solved runs, metres of the metric
  std::vector<LevelSummary> levels;  ///< depth first, the root first
};

RunsSummary summarise(std::span<const RunResult* const> runs);

/// The runs of a strategy on a problem, in the order of the result; an empty `problem`: on all of them.
std::vector<const RunResult*> select_runs(const ExperimentResult& result, const std::string& problem,
                                          const std::string& strategy);

}  // namespace trellis
