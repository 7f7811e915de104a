// SPDX-License-Identifier: GPL-3.0-or-later
#include <array>
#include <cmath>
#include <limits>

#include <trellis/planner/kinds.hpp>
#include <trellis/planner/loop.hpp>

namespace trellis {

namespace {

struct RrtConnectSettings : CommonSettings {
  RrtConnectSettings() { goal_bias = 0.0; }
  double step = 0.5;
};

const Settings<RrtConnectSettings>& rrt_connect_settings() {
  static const Settings<RrtConnectSettings> settings = with_common(
      Settings<RrtConnectSettings>(Component::Kind::planner, "rrt_connect",
                                   "two trees from start and goal, grown towards proposals and greedily to each other",
                                   "Kuffner and LaValle 2000, RRT-Connect")
          .number("step", &RrtConnectSettings::step, "m in the metric", Range::positive(),
                  "longest extension of a tree"));
  return settings;
}

class RrtConnect final : public Planner {
 public:
  RrtConnect(const RrtConnectSettings& settings, Task task)
      : settings_(settings),
        task_(std::move(task)),
        sample_(dimension()),
        target_(dimension()),
        blocked_(dimension()) {}

  Solution solve(const Budget& budget) override {
    auto& instance = task_.instance;
    Meter meter(task_, budget);
    if (!ends_checked_) {
      if (auto nothing = invalid_ends(instance)) return std::move(*nothing);
      ends_checked_ = true;
    }
    if (!trees_[0] || bridge_ || epoch_ != instance.validity->epoch()) plant();
    while (!bridge_) {
      if (const auto reason = meter.spent()) return finish(*reason);
      iterate();
    }
    return finish(Status::solved);
  }

 private:
  struct Bridge {
    std::uint32_t start_side = 0;
    std::uint32_t goal_side = 0;
  };

  [[nodiscard]] std::size_t dimension() const { return task_.instance.space.dimension(); }

  void plant() {
    auto& instance = task_.instance;
    trees_[0].emplace(task_);
    trees_[1].emplace(task_);
    trees_[0]->add(instance.start, 0);
    for (std::uint32_t i = 0; i < instance.goals(); ++i) trees_[1]->add(instance.goal_at(i), i);
    bridge_.reset();
    active_ = 0;
    best_ = 0;
    const auto nearest = instance.nearest_goal(instance.start);
    best_distance_ = nearest.distance;
    epoch_ = instance.validity->epoch();
    if (best_distance_ <= instance.goal_tolerance) bridge_ = Bridge{0, static_cast<std::uint32_t>(nearest.goal)};
  }

  /// One step of `tree` from its node nearest to q. Fills near, added or blocked_at and fate.
  struct Step {
    Fate fate = Fate::rejected;
    std::uint32_t near = 0;
    std::uint32_t added = 0;
    bool blocked = false;
    bool there = false;  ///< q itself is a node of the tree already
  };
  Step extend(std::size_t side, View q) {
    auto& instance = task_.instance;
    Tree& tree = *trees_[side];
    const auto near = tree.nearest(q);
    const double distance = std::sqrt(near.squared_distance);
    Step step;
    step.near = near.id;
    if (distance == 0.0) {
      step.there = true;
      step.added = near.id;
      return step;
    }
    const bool reaches = steer(instance.space, tree[near.id], q, distance, settings_.step, target_);
    const MotionReport report = instance.motion(tree[near.id], target_);
    if (!report.valid) {
      instance.space.interpolate(tree[near.id], target_, report.invalid_at, blocked_);
      step.blocked = true;
      return step;
    }
    step.added = tree.add(target_, near.id);
    step.fate = reaches ? Fate::reached : Fate::advanced;
    if (side == 0) {
      const double to_goal = instance.to_goal(target_);
      if (to_goal < best_distance_) {
        best_distance_ = to_goal;
        best_ = step.added;
      }
    }
    return step;
  }

  void iterate() {
    propose(task_, sample_);
    const std::size_t side = active_;
    active_ = 1 - active_;
    const Step step = extend(side, sample_);
    Configuration added;
    if (step.fate != Fate::rejected || step.there) {
      const View q = (*trees_[side])[step.added];
      added.assign(q.begin(), q.end());
      connect(side, step.added, added);
    }
    Outcome outcome;
    outcome.fate = step.fate;
    outcome.proposal = sample_;
    outcome.near = (*trees_[side])[step.near];
    if (step.fate != Fate::rejected) outcome.added = added;
    if (step.blocked) outcome.blocked_at = blocked_;
    outcome.from_goal = side == 1;
    settle(task_, outcome, trees_[side]->row(step.near),
           step.fate != Fate::rejected ? trees_[side]->row(step.added) : no_node);
  }

  /// Grows the other tree towards q until it is there or blocked.
  void connect(std::size_t side, std::uint32_t from, const Configuration& q) {
    // The first report of what blocked belongs to the proposal; connecting must not overwrite it.
    const Configuration kept = blocked_;
    for (;;) {
      const Step step = extend(1 - side, q);
      if (step.fate == Fate::reached || step.there) {
        bridge_ = side == 0 ? Bridge{from, step.added} : Bridge{step.added, from};
        break;
      }
      if (step.fate == Fate::rejected) break;
    }
    blocked_ = kept;
  }

  [[nodiscard]] Solution finish(Status status) const {
    if (!bridge_) return {status, trees_[0]->branch(best_)};
    Configurations path = trees_[0]->branch(bridge_->start_side);
    const Configurations back = trees_[1]->branch(bridge_->goal_side);
    // Both branches hold the configuration where the trees met, unless start and goal are the same from the outset.
    for (std::size_t i = back.size() - 1; i-- > 0;) path.push(back[i]);
    return {status, std::move(path)};
  }

  RrtConnectSettings settings_;
  Task task_;
  std::array<std::optional<Tree>, 2> trees_;
  std::optional<Bridge> bridge_;
  std::size_t active_ = 0;
  Configuration sample_;
  Configuration target_;
  Configuration blocked_;
  std::uint32_t best_ = 0;
  double best_distance_ = std::numeric_limits<double>::infinity();
  std::uint64_t epoch_ = 0;
  bool ends_checked_ = false;
};

}  // namespace

PlannerKind rrt_connect_kind() {
  return {&rrt_connect_settings().component(), [](const Options& o) { return rrt_connect_settings().read(o).common(); },
          [](const Options& o, Planner::Task task) -> std::unique_ptr<Planner> {
            return std::make_unique<RrtConnect>(rrt_connect_settings().read(o), std::move(task));
          },
          false};
}

}  // namespace trellis
