// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include <trellis/experiment/experiment.hpp>

namespace trellis {

/// Returns a sentence for each input that is valid and probably a mistake: an angle of start or goal beyond a full turn
/// (degrees), a start and goal that no path of a point joins, a guide that does not change the problem's robot.
std::vector<std::string> input_warnings(const Experiment& experiment);

}  // namespace trellis
