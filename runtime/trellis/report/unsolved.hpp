// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include <trellis/experiment/experiment.hpp>

namespace trellis {

/// Returns why runs of a strategy found no path, a clause for each reason with the number of runs: "2 unsolved: 50000
/// proposals spent at level 0; shrink(0.8) reached its limit of 10 re-solves". "" where all were solved.
std::string unsolved_text(const std::vector<const RunResult*>& runs, const StrategySpec& strategy);

}  // namespace trellis
