// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include <trellis/instance/instance.hpp>

namespace trellis {

/// Why a path does not solve a problem: it does not begin at the start, does not end at a goal, leaves the space, or is
/// invalid at a configuration or on a motion, by the problem's collision backend and resolution. The fault of an
/// invalid configuration names the configuration and what the robot touches there.
/// \param path  configurations, or states where the problem has a motion model
/// \return what is wrong, as the end of a sentence that begins with "the path"; "" if the path solves the problem
std::string path_fault(const Problem& problem, const Configurations& path);

/// Why a trajectory is not how a path is driven: a control is out of bounds, or the states that it leads through, step
/// by step, are not those of the path (distances above 1e-9 m in the metric).
/// \param problem  with a motion model
/// \return as path_fault
std::string trajectory_fault(const Problem& problem, const Configurations& path, const Trajectory& trajectory);

}  // namespace trellis
