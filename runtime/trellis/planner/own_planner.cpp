// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/planner/own_planner.hpp>

#include <cmath>
#include <vector>

namespace trellis {

namespace {

// A view of a row is invalid after the next row is added.
Configuration row_of(const Configurations& rows, std::uint32_t row) {
  const View q = rows[row];
  return {q.begin(), q.end()};
}

}  // namespace

std::uint32_t add_node(PlannerContext& context, View q, std::uint32_t parent) {
  const std::uint32_t row = context.search.nodes.push(q);
  context.search.parents.push_back(parent == no_node ? row : parent);
  return row;
}

std::uint32_t extend_node(PlannerContext& context, std::uint32_t from, double step) {
  const Space& space = context.instance.space;
  const Configuration near = row_of(context.search.nodes, from);
  const Configuration proposal =
      row_of(context.search.proposals, static_cast<std::uint32_t>(context.search.proposals.size() - 1));
  Configuration target(space.dimension());
  Configuration blocked(space.dimension());
  Outcome outcome;
  outcome.proposal = proposal;
  outcome.near = near;
  std::uint32_t added = no_node;
  const double distance = std::sqrt(space.squared_distance(near, proposal));
  if (distance > 0.0) {
    const bool reaches = steer(space, near, proposal, distance, step, target);
    const MotionReport motion = context.instance.motion(near, target);
    if (motion.valid) {
      added = add_node(context, target, from);
      outcome.fate = reaches ? Fate::reached : Fate::advanced;
      outcome.added = target;
    } else {
      space.interpolate(near, target, motion.invalid_at, blocked);
      outcome.blocked_at = blocked;
    }
  }
  record_outcome(context, outcome, from, added);
  return added;
}

Configurations branch_to(const Search& search, std::uint32_t row) {
  std::vector<std::uint32_t> rows = {row};
  for (; search.parents[row] != row; row = search.parents[row]) rows.push_back(search.parents[row]);
  Configurations path(search.nodes.dimension());
  for (auto it = rows.rbegin(); it != rows.rend(); ++it) path.push(search.nodes[*it]);
  return path;
}

}  // namespace trellis
