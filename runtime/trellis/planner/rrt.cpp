// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <limits>

#include <trellis/planner/kinds.hpp>
#include <trellis/planner/loop.hpp>

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
          .number("step", &RrtSettings::step, "m in the metric", Range::positive(), "longest extension of the tree")
          .boolean("connect_goal", &RrtSettings::connect_goal,
                   "try the motion to the goal from every new node within one step of it"));
  return settings;
}

class Rrt final : public Planner {
 public:
  Rrt(const RrtSettings& settings, Task task)
      : settings_(settings),
        task_(std::move(task)),
        target_(dimension()),
        sample_(dimension()),
        blocked_(dimension()) {}

  Solution solve(const Budget& budget) override {
    auto& instance = task_.instance;
    Meter meter(task_, budget);
    if (!ends_checked_) {
      if (auto nothing = invalid_ends(instance)) return std::move(*nothing);
      ends_checked_ = true;
    }
    // A tree that has reached the goal is grown anew when another path is asked for; one that has not, goes on.
    if (!tree_ || solved_ || epoch_ != instance.validity->epoch()) plant();
    while (!solved_) {
      if (const auto reason = meter.spent()) return finish(*reason);
      iterate();
    }
    return finish(Status::solved);
  }

 private:
  [[nodiscard]] std::size_t dimension() const { return task_.instance.space.dimension(); }

  void plant() {
    tree_.emplace(task_);
    solved_ = false;
    epoch_ = task_.instance.validity->epoch();
    best_ = tree_->add(task_.instance.start, 0);
    best_distance_ = task_.instance.to_goal(task_.instance.start);
    if (best_distance_ <= task_.instance.goal_tolerance) solved_ = true;
  }

  void iterate() {
    auto& instance = task_.instance;
    const auto& space = instance.space;
    propose(task_, sample_);
    const auto near = tree_->nearest(sample_);
    const double distance = std::sqrt(near.squared_distance);
    Outcome outcome;
    outcome.proposal = sample_;
    outcome.near = (*tree_)[near.id];
    if (distance == 0.0) {
      settle(task_, outcome, tree_->row(near.id));
      return;
    }
    const bool reaches = steer(space, outcome.near, sample_, distance, settings_.step, target_);
    const MotionReport report = instance.motion(outcome.near, target_);
    if (!report.valid) {
      space.interpolate(outcome.near, target_, report.invalid_at, blocked_);
      outcome.blocked_at = blocked_;
      settle(task_, outcome, tree_->row(near.id));
      return;
    }
    const std::uint32_t id = tree_->add(target_, near.id);
    note(id);
    outcome.fate = reaches ? Fate::reached : Fate::advanced;
    outcome.near = (*tree_)[near.id];
    outcome.added = target_;
    if (!solved_ && settings_.connect_goal && last_distance_ <= settings_.step) {
      const View goal = instance.goal_at(instance.nearest_goal(target_).goal);
      if (instance.motion(target_, goal).valid) note(tree_->add(goal, id));
    }
    settle(task_, outcome, tree_->row(near.id), tree_->row(id));
  }

  /// Remembers how near the new node is to the goal.
  void note(std::uint32_t id) {
    last_distance_ = task_.instance.to_goal((*tree_)[id]);
    if (last_distance_ < best_distance_) {
      best_distance_ = last_distance_;
      best_ = id;
    }
    if (last_distance_ <= task_.instance.goal_tolerance) solved_ = true;
  }

  [[nodiscard]] Solution finish(Status status) const { return {status, tree_->branch(best_)}; }

  RrtSettings settings_;
  Task task_;
  std::optional<Tree> tree_;
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
  return {&rrt_settings().component(), [](const Options& o) { return rrt_settings().read(o).common(); },
          [](const Options& o, Planner::Task task) -> std::unique_ptr<Planner> {
            return std::make_unique<Rrt>(rrt_settings().read(o), std::move(task));
          },
          false};
}

}  // namespace trellis
