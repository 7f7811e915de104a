// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include <trellis/experiment/experiment.hpp>

namespace trellis {

/// Runs an experiment as `run` does, and keeps what is finished if it is interrupted: `experiment` is then reduced to
/// problems and seeds of which every strategy's run is finished, as many as there are, and these runs are scored
/// (uninterrupted). An interruption of the scoring itself keeps all runs, and `experiment` measures nothing.
/// \param finished  receives what is left of an interrupted experiment: "seeds 1 to 3 of 10"; "" of a complete one
/// \throws Interrupted if no seed is finished
ExperimentResult run_or_part(Experiment& experiment, const ExperimentOptions& options, std::string& finished);

}  // namespace trellis
