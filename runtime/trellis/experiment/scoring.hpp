// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <functional>

#include <trellis/experiment/experiment.hpp>
#include <trellis/experiment/store.hpp>

namespace trellis {

/// Scores all runs of an experiment: on their own targets, on those of other seeds, and for the other options of the
/// measure.
/// \param progress     called after each run
/// \param interrupted  called often; true stops the scoring with Interrupted
/// \param scope        the scores to compute
/// \param store        receives the scores and restores those that it has; nullptr: none
void score(const Experiment& experiment, ExperimentResult& result, unsigned jobs, const std::function<void()>& progress,
           const std::function<bool()>& interrupted, ScoreScope scope = ScoreScope::all, RunStore* store = nullptr);

}  // namespace trellis
