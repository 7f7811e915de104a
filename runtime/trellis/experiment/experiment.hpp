// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <trellis/measure/efficiency.hpp>
#include <trellis/measure/statistics.hpp>
#include <trellis/measure/target.hpp>
#include <trellis/scene/scene.hpp>
#include <trellis/strategy/executor.hpp>
#include <trellis/strategy/spec.hpp>

namespace trellis {

/// Problems x strategies x seeds, and how to score them.
struct Experiment {
  std::vector<Problem> problems;                                 ///< names are unique
  std::vector<std::pair<std::string, StrategySpec>> strategies;  ///< in the order of the report; names are unique
  std::vector<std::uint64_t> seeds;
  std::optional<TubeSettings> measure = TubeSettings{};  ///< none: no efficiency is computed
  std::int64_t shortcut = 0;  ///< rounds of shortcutting on each found path before it is reported; 0: none
};

/// One level's samples scored against one path, tree and expansion.
struct Scores {
  Efficiency tree;
  Efficiency expansion;
};

struct LevelResult {
  LevelRecord record;
  /// In the level's own space against the level's own path (the root's: the run's reported path). None without a path
  /// of its own. A role without samples, and a target without any valid configuration, score NaN.
  std::optional<Scores> own;
  /// Lifted to the root space by the chain of h's, against the root's path. None when the root found no path.
  std::optional<Scores> root;
};

/// One cell: a problem, a strategy, a seed.
struct RunResult {
  std::string problem;
  std::string strategy;
  std::uint64_t seed = 0;
  RunRecord run;                    ///< its `levels` have moved into the ones below
  std::vector<LevelResult> levels;  ///< the validity closures are released once the run is scored
};

struct ExperimentResult {
  std::vector<RunResult> runs;  ///< by problem, strategy, seed, whatever the number of threads
};

struct ExperimentOptions {
  unsigned jobs = 1;  ///< cells run at the same time
  /// Called after each cell, from one thread at a time: cells done, cells in all.
  std::function<void(std::size_t, std::size_t)> progress;
  /// Asked between cells and, through the executor, between proposals; true ends the experiment early (Interrupted).
  /// Called from the threads of all jobs at once.
  std::function<bool()> interrupted;
};

/// Thrown when ExperimentOptions::interrupted said so.
class Interrupted : public std::runtime_error {
 public:
  Interrupted() : std::runtime_error("interrupted") {}
};

/// Checks every problem and strategy without planning: names and seeds that repeat, coordinates, bounds, start and goal
/// in collision (naming the obstacle), settings of the measure. Throws Error. (That planners fit their spaces is
/// checked where specs are made.)
void check(const Experiment& experiment);

/// Checks, runs every cell and scores it in the same thread; scoring changes no run and is not in the run's time. The
/// result does not depend on `jobs`, times apart. An exception in a cell stops the others and is rethrown here.
ExperimentResult run(const Experiment& experiment, const ExperimentOptions& options = {});

}  // namespace trellis
