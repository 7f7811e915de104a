// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <string>

#include <trellis/experiment/experiment.hpp>

namespace trellis::command {

/// Adds the paths of the solved runs to a library, in the order of the runs, if they are new: farther than `novelty`
/// metres from all stored paths (none: the characteristic length). Prints on stderr how many it added.
void learn(const Experiment& experiment, const ExperimentResult& result, const std::string& file,
           std::optional<double> novelty, bool quiet);

}  // namespace trellis::command
