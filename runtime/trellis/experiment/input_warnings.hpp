// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include <trellis/experiment/experiment.hpp>

namespace trellis {

/// Returns a sentence for each input that is valid and probably a mistake: an angle of start or goal beyond a full turn
/// or joint limits more than four turns apart (degrees), a start and goal that no path of a point joins, a resolution
/// coarser than an obstacle is thick, a mesh at least 30 times as large as its world (millimetres), a guide that does
/// not change the problem's robot or its planner's proposals, a skeleton for a robot whose reference point is not
/// inside it, and guided strategies with the baseline's planner and another step.
std::vector<std::string> input_warnings(const Experiment& experiment);

/// Returns a sentence about the largest mesh of a scene in space if it is at least 30 times as large as the world: then
/// its numbers may be inches, centimetres or millimetres. "" otherwise.
std::string unit_warning(const Problem& problem);

/// Whether closed obstacles certainly separate the start from all goals, so that no path exists for any robot that
/// covers its reference point. An exact triangulation of the free space decides, where the world has at most 1000
/// obstacles and no discs; else false. Takes a tenth of a second at most.
bool separated(const Problem& problem);

/// Returns a sentence about a planar robot that fits no gap between start and goal: its largest disc about the
/// reference point is wider than every route along the medial axis, which is sampled each 1/200 of the world's
/// diagonal. "" where a route may be wide enough, and where this is not known: of robots that are fixed to their base
/// or contain no disc about their reference point, and worlds of more than 200 obstacles. Takes a tenth of a second at
/// most.
std::string narrow_warning(const Problem& problem);

}  // namespace trellis
