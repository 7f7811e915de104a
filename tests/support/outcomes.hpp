// SPDX-License-Identifier: GPL-3.0-or-later
// Outcomes of proposals, as planners report them.
#pragma once

#include <cstdint>

#include <trellis/planner/guidance.hpp>

namespace trellis::test {

/// The planner added the proposal q as a node. The outcome refers to q and does not copy it.
inline Outcome reached(View q, std::uint32_t row = no_node, bool from_goal = false) {
  Outcome outcome;
  outcome.fate = Fate::reached;
  outcome.proposal = q;
  outcome.near = q;
  outcome.added = q;
  outcome.added_row = row;
  outcome.from_goal = from_goal;
  return outcome;
}

/// The motion towards q was invalid at q. The outcome refers to q and does not copy it.
inline Outcome blocked(View q) {
  Outcome outcome;
  outcome.proposal = q;
  outcome.near = q;
  outcome.blocked_at = q;
  return outcome;
}

}  // namespace trellis::test
