// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include <trellis/base/component.hpp>
#include <trellis/instance/instance.hpp>
#include <trellis/strategy/spec.hpp>

namespace trellis {

/// The rule of scale, by which the work that an option demands stays finite. The extent of a problem is the diameter of
/// its space in the metric. An option that is a length, and the distance that a speed covers in one step of the motion
/// model (a millisecond at least), divide the extent into at most this many parts; a share of a path's length divides 1
/// into at most as many; a number of attempts for one proposal is at most this number; and a turn is at most this many
/// times the resolution, where it is longer than the extent of the positions. Defaults, and 0, are exempt.
inline constexpr double most_parts = 1e6;

/// Checks options of a component against the rule of scale.
/// \param given  names and values; names that the component does not have are ignored
/// \throws Error that names the component, the option, its value, the problem, and the least or greatest value
void check_scale(const Component& component, const std::vector<Options::Entry>& given, const Problem& problem);

/// The same for all planners and guides of a strategy.
void check_scale(const StrategySpec& strategy, const Problem& problem);

/// The same for the weight and the motion model of a problem.
void check_scale(const Problem& problem);

}  // namespace trellis
