// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include <trellis/strategy/spec.hpp>

namespace trellis {

/// Whether the value of an option is a length, in metres or in metres in the metric.
[[nodiscard]] bool is_length(const Option& option);

/// A planner that a guide takes by default, with the lengths of the levels above: each of its options that is a length
/// takes the value that the nearest planner above with this option gives, if that differs from the default.
/// \param above  the planners of the levels above, the root's first
PlannerSpec with_lengths_of(const std::vector<const PlannerSpec*>& above, const PlannerSpec& standard);

}  // namespace trellis
