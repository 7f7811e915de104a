// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include <trellis/experiment/experiment.hpp>

namespace trellis {

/// What an experiment was given and made no use of, a sentence each, with where it was written: guides whose proposals
/// never entered a tree in any run, and guides that never drew although their strategy never found a path. Guides that
/// drew a few times only, because a path was found without them, are as they should be.
std::vector<std::string> unused_guides(const Experiment& experiment, const ExperimentResult& result);

}  // namespace trellis
