// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include <trellis/experiment/experiment.hpp>

namespace trellis::command {

// Apply --problem and --strategy to an experiment: return the one of that name, or all for "". They throw Error that
// names the nearest valid name.

void choose_problem(Experiment& experiment, const std::string& name);
void choose_strategy(Experiment& experiment, const std::string& name);

}  // namespace trellis::command
