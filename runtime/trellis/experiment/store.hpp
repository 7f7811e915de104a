// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include <trellis/experiment/experiment.hpp>

namespace trellis {

/// Stores the finished parts of an experiment, and restores those that an earlier, interrupted process stored. An
/// exception stops the experiment.
class RunStore {
 public:
  RunStore() = default;
  virtual ~RunStore() = default;
  RunStore(const RunStore&) = delete;
  RunStore& operator=(const RunStore&) = delete;

  /// Called when a run has been planned, before its scoring. May replace the run's times. Thread-safe.
  virtual void planned(RunResult& run) = 0;
  /// Restores the scores of a run. Returns false where none are stored. Thread-safe.
  virtual bool restore_scores(RunResult& run) = 0;
  /// Called when a run has been scored. Thread-safe.
  virtual void scored(const RunResult& run) = 0;
  /// Appends the pooled scores of a problem. Returns false where none are stored.
  virtual bool restore_pooled(const std::string& problem, std::vector<PooledScores>& pooled) = 0;
  /// Called when all runs of a problem have been scored, with the problem's pooled scores.
  virtual void pooled(const std::string& problem, const std::vector<PooledScores>& pooled) = 0;
};

/// As run(experiment, options), with a store. Every run is planned, because its samples and densities are not stored.
/// Stored scores are not computed again, except with a UserTarget, whose functions may depend on earlier calls.
ExperimentResult run(const Experiment& experiment, const ExperimentOptions& options, RunStore& store);

}  // namespace trellis
