// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>

#include <trellis/experiment/experiment.hpp>

namespace trellis {

/// Scores all runs of an experiment: on their own targets, on those of other seeds, and what else the measure asks for.
/// \param progress     told after each run
/// \param interrupted  asked often; true ends it with Interrupted
void score(const Experiment& experiment, ExperimentResult& result, unsigned jobs, const std::function<void()>& progress,
           const std::function<bool()>& interrupted);

}  // namespace trellis
