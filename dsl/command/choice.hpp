// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include <trellis/experiment/experiment.hpp>

namespace trellis::command {

// What --problem and --strategy leave of an experiment: the one of that name, or all where it is "". Throw Error that
// names the nearest right name.

void choose_problem(Experiment& experiment, const std::string& name);
void choose_strategy(Experiment& experiment, const std::string& name);

}  // namespace trellis::command
