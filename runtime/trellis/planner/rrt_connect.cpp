// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include <trellis/planner/kinds.hpp>
#include <trellis/planner/tree.hpp>

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
          .number("step", &RrtConnectSettings::step, "m in the metric", Range::at_least(1e-6),
                  "longest extension of a tree"));
  return settings;
}

class RrtConnect final : public Planner {
 public:
  RrtConnect(const RrtConnectSettings& settings, PlannerContext context)
      : settings_(settings),
        context_(std::move(context)),
        sample_(dimension()),
        target_(dimension()),
        blocked_(dimension()) {}

  Solution solve(const Budget& budget) override {
    auto& instance = context_.instance;
    BudgetMonitor monitor(context_, budget);
    if (!ends_checked_ || epoch_ != instance.epoch()) {
      if (auto nothing = invalid_ends(instance)) return std::move(*nothing);
      ends_checked_ = true;
      epoch_ = instance.epoch();
      if (trees_[0]) begin_repair();
    }
    if (trees_[0] && repairing_) {
      if (const auto reason = repair(monitor)) return {*reason, path_of_start(instance)};
    } else if (!trees_[0] || bridge_) {
      plant();
    }
    while (!bridge_) {
      if (const auto reason = monitor.spent()) return finish(*reason);
      iterate();
    }
    return finish(Status::solved);
  }

 private:
  struct Bridge {
    std::uint32_t start_side = 0;
    std::uint32_t goal_side = 0;
  };

  [[nodiscard]] std::size_t dimension() const { return context_.instance.space.dimension(); }

  void plant() {
    auto& instance = context_.instance;
    trees_[0].emplace(context_);
    trees_[1].emplace(context_);
    context_.guidance.restart();
    trees_[0]->add(instance.start, 0);
    for (std::uint32_t i = 0; i < instance.goals(); ++i) trees_[1]->add(instance.goal_at(i), i);
    bridge_.reset();
    active_ = 0;
    best_ = 0;
    const auto nearest = instance.nearest_goal(instance.start);
    best_distance_ = nearest.distance;
    if (best_distance_ <= instance.goal_tolerance) bridge_ = Bridge{0, static_cast<std::uint32_t>(nearest.goal)};
  }

  [[nodiscard]] static bool same(View a, View b) { return std::equal(a.begin(), a.end(), b.begin()); }

  /// Called when the instance changed, so that validity of the trees is unknown. Replaces a tree whose root is no
  /// longer the start, removes roots that are no longer goals, and adds new goals as roots.
  void begin_repair() {
    auto& instance = context_.instance;
    if (!same((*trees_[0])[0], instance.start)) {
      trees_[0].emplace(context_);
      trees_[0]->add(instance.start, 0);
      bridge_.reset();
    }
    Tree& goals = *trees_[1];
    std::vector<std::uint32_t> roots;
    for (std::uint32_t id = 0; id < goals.size(); ++id) {
      if (goals.parent(id) == id) roots.push_back(id);
    }
    for (std::size_t i = 0; i < instance.goals(); ++i) {
      const View goal = instance.goal_at(i);
      if (std::any_of(roots.begin(), roots.end(), [&](std::uint32_t id) { return same(goals[id], goal); })) continue;
      goals.add(goal, static_cast<std::uint32_t>(goals.size()));
    }
    repairs_[0].emplace(*trees_[0]);
    repairs_[1].emplace(goals);
    for (const std::uint32_t id : roots) {
      bool still = false;
      for (std::size_t i = 0; i < instance.goals(); ++i) still = still || same(goals[id], instance.goal_at(i));
      if (!still) repairs_[1]->refute(id);
    }
    repairing_ = true;
  }

  /// Solves the instance if the path is still valid; else removes all invalid branches. Returns the reason if it stops
  /// early, else none.
  std::optional<Status> repair(BudgetMonitor& monitor) {
    const auto edge_valid = [&](const Tree& tree) {
      return [&](std::uint32_t id) { return motion_still_valid(context_, tree[tree.parent(id)], tree[id]); };
    };
    const auto branch_valid = [&](std::size_t side, std::uint32_t id) {
      return repairs_[side]->branch_valid(*trees_[side], id, edge_valid(*trees_[side]));
    };
    if (bridge_ && branch_valid(0, bridge_->start_side) && branch_valid(1, bridge_->goal_side)) {
      // The next solve grows new trees or repairs them again before it draws a proposal.
      repairing_ = false;
      return std::nullopt;
    }
    bridge_.reset();
    for (std::size_t side = 0; side < 2; ++side) {
      if (const auto reason = repairs_[side]->check_all(*trees_[side], monitor, edge_valid(*trees_[side])))
        return reason;
    }
    for (std::size_t side = 0; side < 2; ++side) repairs_[side]->prune(*trees_[side]);
    repairing_ = false;
    context_.guidance.restart();
    for (std::size_t side = 0; side < 2; ++side) report_nodes(context_, *trees_[side], side == 1);
    find_best();
    return std::nullopt;
  }

  /// Finds the node nearest to the goal.
  void find_best() {
    auto& instance = context_.instance;
    const Tree& tree = *trees_[0];
    best_ = 0;
    best_distance_ = instance.to_goal(tree[0]);
    if (best_distance_ <= instance.goal_tolerance) bridge_ = Bridge{0, trees_[1]->nearest(tree[0]).id};
    for (std::uint32_t id = 1; id < tree.size(); ++id) {
      const double distance = instance.to_goal(tree[id]);
      if (distance >= best_distance_) continue;
      best_distance_ = distance;
      best_ = id;
    }
  }

  /// One step of a tree from one of its nodes towards q.
  struct Step {
    Fate fate = Fate::rejected;
    std::uint32_t near = 0;
    std::uint32_t added = 0;
    bool blocked = false;  ///< its motion is invalid at blocked_
    bool there = false;    ///< the tree already contains q
  };
  Step extend(std::size_t side, NearestIndex::Neighbour near, View q) {
    auto& instance = context_.instance;
    Tree& tree = *trees_[side];
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

  /// The outcome of a step towards q. Its views are valid until the next step.
  [[nodiscard]] Outcome outcome_of(const Step& step, std::size_t side, View q) const {
    const Tree& tree = *trees_[side];
    Outcome outcome;
    outcome.fate = step.fate;
    outcome.proposal = q;
    outcome.near = tree[step.near];
    if (step.fate != Fate::rejected) {
      outcome.added = tree[step.added];
      outcome.added_row = tree.row(step.added);
    }
    if (step.blocked) outcome.blocked_at = blocked_;
    outcome.from_goal = side == 1;
    return outcome;
  }

  void iterate() {
    const std::size_t side = active_;
    active_ = 1 - active_;
    context_.guidance.select_tree(side == 0 ? TreeSide::start : TreeSide::goal);
    propose(context_, sample_);
    const Step step = extend(side, trees_[side]->to_extend(sample_), sample_);
    const Outcome outcome = outcome_of(step, side, sample_);
    settle(context_, outcome, trees_[side]->row(step.near), outcome.added_row);
    if (step.fate == Fate::rejected && !step.there) return;
    const View q = (*trees_[side])[step.added];
    connect(side, step.added, Configuration(q.begin(), q.end()));
  }

  /// Grows the other tree towards q until it reaches q, is blocked, or the guidance rejects the motion.
  void connect(std::size_t side, std::uint32_t from, const Configuration& q) {
    const std::size_t other = 1 - side;
    for (;;) {
      const auto near = trees_[other]->nearest(q);
      if (near.squared_distance > 0.0 && !context_.guidance.worth_connecting((*trees_[other])[near.id], q)) return;
      const Step step = extend(other, near, q);
      if (!step.there) context_.guidance.observe(outcome_of(step, other, q), false);
      if (step.fate == Fate::reached || step.there) {
        bridge_ = side == 0 ? Bridge{from, step.added} : Bridge{step.added, from};
        return;
      }
      if (step.fate == Fate::rejected) return;
    }
  }

  [[nodiscard]] Solution finish(Status status) const {
    if (!bridge_) return {status, trees_[0]->branch(best_)};
    Configurations path = trees_[0]->branch(bridge_->start_side);
    const Configurations back = trees_[1]->branch(bridge_->goal_side);
    // Both branches contain the configuration where the trees met, unless start and goal coincide initially.
    for (std::size_t i = back.size() - 1; i-- > 0;) path.push(back[i]);
    return {status, std::move(path)};
  }

  RrtConnectSettings settings_;
  PlannerContext context_;
  std::array<std::optional<Tree>, 2> trees_;
  std::array<std::optional<TreeRepair>, 2> repairs_;
  bool repairing_ = false;  ///< active after a change of the instance
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
  return {&rrt_connect_settings().component(),
          [](const Options& o) { return common_of(rrt_connect_settings().read(o)); },
          [](const Options& o, PlannerContext context) -> std::unique_ptr<Planner> {
            return std::make_unique<RrtConnect>(rrt_connect_settings().read(o), std::move(context));
          },
          false};
}

}  // namespace trellis
