// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <limits>

#include <trellis/planner/kinds.hpp>
#include <trellis/planner/tree.hpp>

namespace trellis {

namespace {

struct RrtSettings : CommonSettings {
  double step = 0.5;
  bool connect_goal = true;
};

const Settings<RrtSettings>& rrt_settings() {
  static const Settings<RrtSettings> settings = with_common(
      Settings<RrtSettings>(Component::Kind::planner, "rrt",
                            "rapidly-exploring random tree: grows from the start towards proposals",
                            "LaValle and Kuffner 2001, Randomized kinodynamic planning")
          .number("step", &RrtSettings::step, "m in the metric", Range::at_least(1e-6), "longest extension of the tree")
          .boolean("connect_goal", &RrtSettings::connect_goal,
                   "try the motion to the goal from every new node within one step of it"));
  return settings;
}

class Rrt final : public Planner {
 public:
  Rrt(const RrtSettings& settings, PlannerContext context)
      : settings_(settings),
        context_(std::move(context)),
        target_(dimension()),
        sample_(dimension()),
        blocked_(dimension()) {}

  Solution solve(const Budget& budget) override {
    auto& instance = context_.instance;
    BudgetMonitor monitor(context_, budget);
    if (!ends_checked_ || epoch_ != instance.epoch()) {
      if (auto nothing = invalid_ends(instance)) return std::move(*nothing);
      ends_checked_ = true;
      epoch_ = instance.epoch();
      if (tree_) begin_repair();
    }
    if (tree_ && repair_ && !solved_) {
      if (const auto reason = repair(monitor)) return {*reason, path_of_start(instance)};
    } else if (!tree_ || solved_) {
      // A tree that reached the goal is replaced by a new one, to find another path. Another tree continues to grow.
      plant();
    }
    while (!solved_) {
      if (const auto reason = monitor.spent()) return finish(*reason);
      iterate();
    }
    return finish(Status::solved);
  }

 private:
  [[nodiscard]] std::size_t dimension() const { return context_.instance.space.dimension(); }

  /// Called when the instance changed, so that validity of the tree is unknown. If the goal may still be reachable,
  /// checks the branch to it first; the search ends if that branch is valid.
  void begin_repair() {
    if (!std::equal(context_.instance.start.begin(), context_.instance.start.end(), (*tree_)[0].begin())) {
      tree_.reset();
      return;
    }
    repair_.emplace(*tree_);
    find_best();
  }

  /// Solves the instance if the branch to the goal is still valid; else removes all invalid branches. Returns the
  /// reason if it stops early, else none.
  std::optional<Status> repair(BudgetMonitor& monitor) {
    const auto edge_valid = [&](std::uint32_t id) { return edge_still_valid(id); };
    if (best_distance_ <= context_.instance.goal_tolerance && repair_->branch_valid(*tree_, best_, edge_valid)) {
      solved_ = true;
      return std::nullopt;
    }
    if (const auto reason = repair_->check_all(*tree_, monitor, edge_valid)) return reason;
    repair_->prune(*tree_);
    repair_.reset();
    context_.guidance.restart();
    report_nodes(context_, *tree_, false);
    find_best();
    solved_ = best_distance_ <= context_.instance.goal_tolerance;
    return std::nullopt;
  }

  bool edge_still_valid(std::uint32_t id) {
    return motion_still_valid(context_, (*tree_)[tree_->parent(id)], (*tree_)[id]);
  }

  /// Finds the node nearest to the goal.
  void find_best() {
    solved_ = false;
    best_ = 0;
    best_distance_ = context_.instance.to_goal((*tree_)[0]);
    for (std::uint32_t id = 1; id < tree_->size(); ++id) {
      const double distance = context_.instance.to_goal((*tree_)[id]);
      if (distance >= best_distance_) continue;
      best_distance_ = distance;
      best_ = id;
    }
  }

  void plant() {
    tree_.emplace(context_);
    repair_.reset();
    context_.guidance.restart();
    solved_ = false;
    best_ = tree_->add(context_.instance.start, 0);
    best_distance_ = context_.instance.to_goal(context_.instance.start);
    if (best_distance_ <= context_.instance.goal_tolerance) solved_ = true;
  }

  void iterate() {
    auto& instance = context_.instance;
    const auto& space = instance.space;
    propose(context_, sample_);
    const auto near = tree_->to_extend(sample_);
    const double distance = std::sqrt(near.squared_distance);
    Outcome outcome;
    outcome.proposal = sample_;
    outcome.near = (*tree_)[near.id];
    if (distance == 0.0) {
      settle(context_, outcome, tree_->row(near.id));
      return;
    }
    const bool reaches = steer(space, outcome.near, sample_, distance, settings_.step, target_);
    const MotionReport report = instance.motion(outcome.near, target_);
    if (!report.valid) {
      space.interpolate(outcome.near, target_, report.invalid_at, blocked_);
      outcome.blocked_at = blocked_;
      settle(context_, outcome, tree_->row(near.id));
      return;
    }
    const std::uint32_t id = tree_->add(target_, near.id);
    note(id);
    outcome.fate = reaches ? Fate::reached : Fate::advanced;
    outcome.near = (*tree_)[near.id];
    outcome.added = target_;
    settle(context_, outcome, tree_->row(near.id), tree_->row(id));
    if (!solved_ && settings_.connect_goal && last_distance_ <= settings_.step) connect_goal(id);
  }

  /// Tries the motion from the node at target_ to the goal.
  void connect_goal(std::uint32_t id) {
    auto& instance = context_.instance;
    const View goal = instance.goal_at(instance.nearest_goal(target_).goal);
    if (!context_.guidance.worth_connecting(target_, goal)) return;
    const MotionReport report = instance.motion(target_, goal);
    Outcome outcome;
    outcome.proposal = goal;
    outcome.near = target_;
    if (report.valid) {
      const std::uint32_t end = tree_->add(goal, id);
      note(end);
      outcome.fate = Fate::reached;
      outcome.added = goal;
      outcome.added_row = tree_->row(end);
    } else {
      instance.space.interpolate(target_, goal, report.invalid_at, blocked_);
      outcome.blocked_at = blocked_;
    }
    context_.guidance.observe(outcome, false);
  }

  /// Updates the node nearest to the goal.
  void note(std::uint32_t id) {
    last_distance_ = context_.instance.to_goal((*tree_)[id]);
    if (last_distance_ < best_distance_) {
      best_distance_ = last_distance_;
      best_ = id;
    }
    if (last_distance_ <= context_.instance.goal_tolerance) solved_ = true;
  }

  [[nodiscard]] Solution finish(Status status) const { return {status, tree_->branch(best_)}; }

  RrtSettings settings_;
  PlannerContext context_;
  std::optional<Tree> tree_;
  std::optional<TreeRepair> repair_;  ///< active after a change of the instance
  Configuration target_;
  Configuration sample_;
  Configuration blocked_;
  std::uint32_t best_ = 0;
  double best_distance_ = std::numeric_limits<double>::infinity();
  double last_distance_ = std::numeric_limits<double>::infinity();
  std::uint64_t epoch_ = 0;
  bool solved_ = false;
  bool ends_checked_ = false;
};

}  // namespace

PlannerKind rrt_kind() {
  return {&rrt_settings().component(), [](const Options& o) { return common_of(rrt_settings().read(o)); },
          [](const Options& o, PlannerContext context) -> std::unique_ptr<Planner> {
            return std::make_unique<Rrt>(rrt_settings().read(o), std::move(context));
          },
          false};
}

}  // namespace trellis
