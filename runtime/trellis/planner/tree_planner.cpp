// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/planner/tree_planner.hpp>

#include <algorithm>
#include <cmath>

namespace trellis {

std::optional<Status> TreePlanner::begin(const Budget& budget) {
  static_cast<void>(budget);
  auto& instance = context_.instance;
  if (!ends_checked_ || epoch_ != instance.epoch()) {
    if (const auto invalid = remove_invalid_goals(instance)) return invalid;
    ends_checked_ = true;
    epoch_ = instance.epoch();
    if (planted()) begin_repair();
  }
  if (repairing()) return path_still_valid() ? std::optional(Status::solved) : end_repair_if_checked();
  if (!planted() || done()) {
    // Trees that reached the goal are replaced by new ones, to find another path. Other trees continue to grow.
    plant();
    valid_since_ = epoch_;
  }
  return ended();
}

std::optional<Status> TreePlanner::work() {
  check_branch();
  return end_repair_if_checked();
}

std::optional<Status> TreePlanner::end_repair_if_checked() {
  if (unchecked()) return std::nullopt;
  return end_repair() || done() ? std::optional(Status::solved) : std::nullopt;
}

TreePlanner::Extension TreePlanner::extend_from(View from, View q, double distance, double step) {
  if (distance == 0.0) return {.there = true};
  const auto& space = context_.instance.space;
  const bool reaches = steer(space, from, q, distance, step, target_);
  const MotionReport report = motion(from, target_);
  if (report.valid) return {.fate = reaches ? Fate::reached : Fate::advanced};
  space.interpolate(from, target_, report.invalid_at, blocked_);
  return {.blocked = true};
}

std::optional<NearestIndex::Neighbour> TreePlanner::extend_ahead(const Space& space, const Tree& tree, View q,
                                                                 double step, StepAhead& ahead, Validity& validity) {
  const NearestIndex::Neighbour near = tree.nearest(q);
  ahead.add_nearest(&tree, q, near);
  if (near.squared_distance == 0.0) return std::nullopt;
  const View from = tree[near.id];
  steer(space, from, q, std::sqrt(near.squared_distance), step, ahead.target);
  const MotionReport report = validity.motion(from, ahead.target);
  ahead.add_motion(from, ahead.target, report);
  return report.valid ? std::optional(near) : std::nullopt;
}

void StartTreePlanner::plant() {
  tree_.emplace(context_);
  repair_.reset();
  context_.guidance.restart();
  tree_->add(context_.instance.start, 0);
  note_all();
}

void StartTreePlanner::begin_repair() {
  if (!std::equal(context_.instance.start.begin(), context_.instance.start.end(), (*tree_)[0].begin())) {
    tree_.reset();
    repair_.reset();
    return;
  }
  repair_.emplace(*tree_, valid_since());
  note_all();
}

bool StartTreePlanner::path_still_valid() {
  if (solved_ && branch_still_valid(best_)) {
    repair_.reset();
    return true;
  }
  solved_ = false;
  return false;
}

bool StartTreePlanner::end_repair() {
  remove_invalid();
  note_all();
  return false;
}

void StartTreePlanner::remove_invalid() {
  const std::vector<std::uint32_t> ids = repair_->prune(*tree_);
  repair_.reset();
  repaired();
  context_.guidance.restart();
  report_nodes(context_, *tree_, false);
  pruned(ids);
}

bool StartTreePlanner::edge_still_valid(std::uint32_t id) {
  return motion_still_valid(context_, (*tree_)[tree_->parent(id)], (*tree_)[id], repair_->since());
}

void StartTreePlanner::look_ahead(std::size_t step, StepAhead& ahead, Validity& validity) const {
  static_cast<void>(step);
  const auto& instance = context_.instance;
  if (!extend_ahead(instance.space, *tree_, ahead.proposal, step_, ahead, validity)) return;
  if (const auto goal = goal_to_connect(ahead.target)) {
    ahead.add_motion(ahead.target, instance.goals[*goal], validity.motion(ahead.target, instance.goals[*goal]));
  }
}

Outcome StartTreePlanner::extend(View proposal) {
  const auto near = to_extend(*tree_, proposal);
  const Extension extension = extend_from((*tree_)[near.id], proposal, std::sqrt(near.squared_distance), step_);
  const bool adds = extension.fate != Fate::rejected;
  added_ = adds ? insert(target_, near.id) : no_node;
  Outcome outcome;
  outcome.fate = extension.fate;
  outcome.proposal = proposal;
  outcome.near = (*tree_)[near.id];
  outcome.near_row = tree_->row(near.id);
  if (adds) {
    outcome.added = target_;
    outcome.added_row = tree_->row(added_);
  }
  if (extension.blocked) outcome.blocked_at = blocked_;
  return outcome;
}

std::optional<Status> StartTreePlanner::follow() {
  if (added_ != no_node) {
    blocked_motions_.report(context_);
    if (const auto goal = goal_to_connect(target_)) connect(added_, *goal);
  }
  return ended();
}

void StartTreePlanner::connect(std::uint32_t id, std::size_t goal) {
  auto& instance = context_.instance;
  const View q = instance.goals[goal];
  if (!context_.guidance.worth_connecting(target_, q)) return;
  const MotionReport report = motion(target_, q);
  Outcome outcome;
  outcome.proposal = q;
  outcome.near = target_;
  if (report.valid) {
    outcome.added_row = tree_->row(insert(q, id));
    outcome.fate = Fate::reached;
    outcome.added = q;
  } else {
    instance.space.interpolate(target_, q, report.invalid_at, blocked_);
    outcome.blocked_at = blocked_;
  }
  context_.guidance.observe(outcome, false);
  blocked_motions_.report(context_);
}

std::uint32_t StartTreePlanner::insert(View q, std::uint32_t from) {
  const std::uint32_t id = tree_->add(q, from);
  note(id);
  return id;
}

void StartTreePlanner::note(std::uint32_t id) {
  const double distance = context_.instance.to_goal((*tree_)[id]);
  note_nearest(id, distance);
  if (distance <= context_.instance.goal_tolerance) solved_ = true;
}

void StartTreePlanner::note_all() {
  solved_ = false;
  best_distance_ = std::numeric_limits<double>::infinity();
  for (std::uint32_t id = 0; id < tree_->size(); ++id) note(id);
}

}  // namespace trellis
