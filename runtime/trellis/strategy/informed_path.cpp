// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/strategy/informed_path.hpp>

#include <algorithm>
#include <limits>

#include <trellis/guide/path_steps.hpp>
#include <trellis/instance/characteristic_length.hpp>
#include <trellis/planner/planner.hpp>

namespace trellis {

void InformedPath::follow(Configurations path) {
  expect();
  path_ = std::move(path);
  make();
}

void InformedPath::observe(const Outcome& outcome, bool mine) {
  if (nodes_.begun() && !outcome.added.empty() && outcome.connected) nodes_.add(outcome.added, outcome.from_goal);
  if (!h_) return;
  h_->observe(outcome, mine);
  if (!h_->stale()) return;
  drop();
  path_ = {};
}

void InformedPath::restart() {
  if (!nodes_.begun()) return;
  nodes_.clear();
  if (!h_) return;
  // The remaining nodes are reported to the new h.
  const double before = h_->connected();
  make();
  progress_ -= std::max(0.0, before - (h_ ? h_->connected() : 0.0));
}

void InformedPath::make() {
  drop();
  const Space& space = instance_.space;
  if (path_.size() < 2 || !(path_length(space, path_) > 0.0)) return;
  if (instance_.step > 0.0) {
    const StepHeuristic::Settings steps = {.radius = tube_radius({}, instance_), .step = instance_.step};
    h_ = std::make_unique<StepHeuristic>("informed path", space, path_, steps, nodes_.both());
  } else {
    // Without a tree, proposals cannot stay ahead of its nodes, so they cover the whole path.
    h_ = std::make_unique<PathHeuristic>("informed path", space, path_, characteristic_length(instance_),
                                         std::numeric_limits<double>::infinity(),
                                         std::numeric_limits<std::int64_t>::max(), nullptr);
  }
  h_->select_tree(side_);
}

void InformedPath::drop() {
  progress_ = progress();
  epoch_ = epoch() + 1;
  h_.reset();
}

}  // namespace trellis
