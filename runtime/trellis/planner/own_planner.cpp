// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/planner/own_planner.hpp>

#include <cmath>
#include <utility>
#include <vector>

namespace trellis {

std::uint32_t add_node(PlannerContext& context, View q, std::uint32_t parent) {
  const std::uint32_t row = context.search.nodes.push(q);
  context.search.parents.push_back(parent == no_node ? row : parent);
  return row;
}

NodeExtension::NodeExtension(PlannerContext& context, double step)
    : context_(context),
      step_(step),
      target_(context.instance.space.dimension()),
      blocked_(context.instance.space.dimension()) {}

Outcome NodeExtension::extend(std::uint32_t from, View proposal) {
  const Space& space = context_.instance.space;
  const auto near = [&] { return std::as_const(context_.search.nodes)[from]; };
  Outcome outcome;
  outcome.proposal = proposal;
  outcome.near_row = from;
  const double distance = std::sqrt(space.squared_distance(near(), proposal));
  if (distance > 0.0) {
    const bool reaches = steer(space, near(), proposal, distance, step_, target_);
    const MotionReport motion = context_.instance.motion(near(), target_);
    if (motion.valid) {
      outcome.added_row = add_node(context_, target_, from);
      outcome.fate = reaches ? Fate::reached : Fate::advanced;
      outcome.added = target_;
    } else {
      space.interpolate(near(), target_, motion.invalid_at, blocked_);
      outcome.blocked_at = blocked_;
    }
  }
  // A view of a node is invalid after the next one is added.
  outcome.near = near();
  return outcome;
}

Configurations branch_to(const Search& search, std::uint32_t row) {
  std::vector<std::uint32_t> rows = {row};
  for (; search.parents[row] != row; row = search.parents[row]) rows.push_back(search.parents[row]);
  Configurations path(search.nodes.dimension());
  for (auto it = rows.rbegin(); it != rows.rend(); ++it) path.push(search.nodes[*it]);
  return path;
}

}  // namespace trellis
