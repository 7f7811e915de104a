// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/planner/tree_planner.hpp>

#include <algorithm>
#include <cmath>

namespace trellis {

Solution TreePlanner::solve(const Budget& budget) {
  auto& instance = context_.instance;
  BudgetMonitor monitor(context_, budget);
  if (!ends_checked_ || epoch_ != instance.epoch()) {
    if (auto nothing = remove_invalid_goals(instance)) return std::move(*nothing);
    ends_checked_ = true;
    epoch_ = instance.epoch();
    if (planted()) begin_repair();
  }
  if (repairing()) {
    if (const auto reason = repair(monitor)) return *reason == Status::solved ? finish(*reason) : unrepaired(*reason);
  } else if (!planted() || done()) {
    // Trees that reached the goal are replaced by new ones, to find another path. Other trees continue to grow.
    plant();
    valid_since_ = epoch_;
  }
  while (!done()) {
    if (const auto reason = monitor.spent()) return finish(*reason);
    iterate();
  }
  return finish(Status::solved);
}

TreePlanner::Extension TreePlanner::extend(View from, View q, double distance, double step) {
  if (distance == 0.0) return {.there = true};
  const auto& space = context_.instance.space;
  const bool reaches = steer(space, from, q, distance, step, target_);
  const MotionReport report = context_.instance.motion(from, target_);
  if (report.valid) return {.fate = reaches ? Fate::reached : Fate::advanced};
  space.interpolate(from, target_, report.invalid_at, blocked_);
  return {.blocked = true};
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

std::optional<Status> StartTreePlanner::repair(BudgetMonitor& monitor) {
  if (solved_ && branch_still_valid(best_)) {
    repair_.reset();
    return Status::solved;
  }
  solved_ = false;
  if (const auto reason = check_branches(monitor)) return reason;
  remove_invalid();
  note_all();
  return std::nullopt;
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

void StartTreePlanner::iterate() {
  propose(context_, sample_);
  const auto near = tree_->to_extend(sample_);
  const Extension extension = extend((*tree_)[near.id], sample_, std::sqrt(near.squared_distance), step_);
  const bool adds = extension.fate != Fate::rejected;
  const std::uint32_t id = adds ? insert(target_, near.id) : no_node;
  Outcome outcome;
  outcome.fate = extension.fate;
  outcome.proposal = sample_;
  outcome.near = (*tree_)[near.id];
  if (adds) outcome.added = target_;
  if (extension.blocked) outcome.blocked_at = blocked_;
  record_outcome(context_, outcome, tree_->row(near.id), adds ? tree_->row(id) : no_node);
  if (!adds) return;
  blocked_motions_.report(context_);
  if (const auto goal = goal_to_connect()) connect(id, *goal);
}

void StartTreePlanner::connect(std::uint32_t id, std::size_t goal) {
  auto& instance = context_.instance;
  const View q = instance.goals[goal];
  if (!context_.guidance.worth_connecting(target_, q)) return;
  const MotionReport report = instance.motion(target_, q);
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
