// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <string>

#include <trellis/experiment/experiment.hpp>

namespace trellis::command {

/// Adds the paths of the runs that solved their problems to a library, in the order of the runs, each only where it is
/// new: farther than `novelty` metres from all that are there (none: default_novelty). Says on stderr how many were.
void learn(const Experiment& experiment, const ExperimentResult& result, const std::string& file,
           std::optional<double> novelty, bool quiet);

}  // namespace trellis::command
