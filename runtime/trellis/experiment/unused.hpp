// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include <trellis/experiment/experiment.hpp>

namespace trellis {

/// Returns a sentence, with the position in the script, for each unused part of an experiment: guides whose proposals
/// never entered a tree in any run, and guides that never proposed although their strategy never found a path. Omits
/// guides that proposed a few times only, because a path was found without them.
std::vector<std::string> unused_guides(const Experiment& experiment, const ExperimentResult& result);

}  // namespace trellis
