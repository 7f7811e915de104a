// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include <trellis/planner/tree_planner.hpp>
#include <trellis/scene/scene.hpp>

namespace trellis {

namespace {

/// Which tree a proposal extends.
enum class Grow : std::uint8_t { automatic, in_turn, smaller };

struct RrtConnectSettings : CommonSettings {
  RrtConnectSettings() { goal_bias = 0.0; }
  double step = 0.5;
  Grow grow = Grow::automatic;
};

const Settings<RrtConnectSettings>& rrt_connect_settings() {
  static const Settings<RrtConnectSettings> settings = with_common(
      Settings<RrtConnectSettings>(Component::Kind::planner, "rrt_connect",
                                   "two trees from start and goal, grown towards proposals and greedily to each other",
                                   "Kuffner and LaValle 2000, RRT-Connect; LaValle 2006, Planning Algorithms, 5.5.3 "
                                   "(balanced trees)")
          .number("step", &RrtConnectSettings::step, "m in the metric", Range::at_least(1e-6),
                  "longest extension of a tree")
          .choice("grow", &RrtConnectSettings::grow,
                  {{"auto", Grow::automatic}, {"in_turn", Grow::in_turn}, {"smaller", Grow::smaller}},
                  "the tree that a proposal extends: \"in_turn\", each in turn; \"smaller\", the one with fewer "
                  "nodes, so that the proposals go where a tree grows with difficulty, as from a goal in a shelf; "
                  "\"auto\", \"smaller\" for an arm (a robot of robot.urdf), else \"in_turn\""));
  return settings;
}

class RrtConnect final : public TreePlanner {
 public:
  RrtConnect(const RrtConnectSettings& settings, PlannerContext context)
      : TreePlanner(std::move(context)), step_(settings.step), balanced_(balances(settings.grow, context_.instance)) {}

  Plan plan() override {
    return {.proposal = !repairing_, .tree = next_side() == 0 ? TreeSide::start : TreeSide::goal};
  }
  Outcome extend(View proposal) override {
    last_ = next_side();
    extended_ = step_towards(last_, to_extend(*trees_[last_], proposal), proposal);
    Outcome outcome = outcome_of(extended_, last_, proposal);
    outcome.near_row = trees_[last_]->row(extended_.near);
    return outcome;
  }
  std::optional<Status> follow() override {
    if (extended_.fate != Fate::rejected || extended_.there) {
      const View q = (*trees_[last_])[extended_.added];
      met_.assign(q.begin(), q.end());
      connect(last_, extended_.added, met_);
    }
    return ended();
  }

 protected:
  [[nodiscard]] bool planted() const override { return trees_[0].has_value(); }
  [[nodiscard]] bool repairing() const override { return repairing_; }
  [[nodiscard]] bool done() const override { return bridge_.has_value(); }
  void plant() override {
    auto& instance = context_.instance;
    trees_[0].emplace(context_);
    trees_[1].emplace(context_);
    context_.guidance.restart();
    trees_[0]->add(instance.start, 0);
    for (std::uint32_t i = 0; i < instance.goals.size(); ++i) trees_[1]->add(instance.goals[i], i);
    bridge_.reset();
    last_ = 1;
    best_ = 0;
    const auto nearest = instance.nearest_goal(instance.start);
    best_distance_ = nearest.distance;
    if (best_distance_ <= instance.goal_tolerance) bridge_ = Bridge{0, static_cast<std::uint32_t>(nearest.goal)};
  }

  /// Replaces a tree whose root is no longer the start, removes roots that are no longer goals, and adds new goals as
  /// roots.
  void begin_repair() override {
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
    for (const auto& goal : instance.goals) {
      if (std::any_of(roots.begin(), roots.end(), [&](std::uint32_t id) { return same(goals[id], goal); })) continue;
      goals.add(goal, static_cast<std::uint32_t>(goals.size()));
    }
    repairs_[0].emplace(*trees_[0], valid_since());
    repairs_[1].emplace(goals, valid_since());
    for (const std::uint32_t id : roots) {
      const auto is_root = [&](const auto& goal) { return same(goals[id], goal); };
      if (std::ranges::none_of(instance.goals, is_root)) repairs_[1]->refute(id);
    }
    repairing_ = true;
  }

  bool path_still_valid() override {
    const auto branch_valid = [&](std::size_t side, std::uint32_t id) {
      return repairs_[side]->branch_valid(*trees_[side], id,
                                          [&](std::uint32_t at) { return edge_still_valid(side, at); });
    };
    if (bridge_ && branch_valid(0, bridge_->start_side) && branch_valid(1, bridge_->goal_side)) {
      // The next solve grows new trees or repairs them again before it draws a proposal.
      repairing_ = false;
      return true;
    }
    bridge_.reset();
    return false;
  }

  bool unchecked() override { return repairs_[0]->pending() || repairs_[1]->pending(); }

  void check_branch() override {
    const std::size_t side = repairs_[0]->pending() ? 0 : 1;
    repairs_[side]->check_next(*trees_[side], [&](std::uint32_t id) { return edge_still_valid(side, id); });
  }

  bool end_repair() override {
    for (std::size_t side = 0; side < 2; ++side) repairs_[side]->prune(*trees_[side]);
    repairing_ = false;
    repaired();
    context_.guidance.restart();
    for (std::size_t side = 0; side < 2; ++side) report_nodes(context_, *trees_[side], side == 1);
    find_best();
    return false;
  }

  [[nodiscard]] Solution finish(Status status) const override {
    if (!bridge_) return {status, trees_[0]->branch(best_)};
    Configurations path = trees_[0]->branch(bridge_->start_side);
    const Configurations back = trees_[1]->branch(bridge_->goal_side);
    // Both branches contain the configuration where the trees met, unless start and goal coincide initially.
    for (std::size_t i = back.size() - 1; i-- > 0;) path.push(back[i]);
    return {status, std::move(path)};
  }

 private:
  struct Bridge {
    std::uint32_t start_side = 0;
    std::uint32_t goal_side = 0;
  };

  [[nodiscard]] static bool balances(Grow grow, const Instance& instance) {
    const bool arm = instance.scene != nullptr && instance.scene->manipulator() != nullptr;
    return grow == Grow::smaller || (grow == Grow::automatic && arm);
  }
  /// The tree that the next proposal extends. Trees of one size take turns.
  [[nodiscard]] std::size_t next_side() const {
    const std::size_t other = 1 - last_;
    return !balanced_ || trees_[other]->size() <= trees_[last_]->size() ? other : last_;
  }

  /// The tree that a coming step is likely to extend.
  [[nodiscard]] std::size_t side_ahead(std::size_t step) const {
    const std::size_t turn = (1 - last_ + step) % 2;
    if (!balanced_ || trees_[0]->size() == trees_[1]->size()) return turn;
    return trees_[0]->size() < trees_[1]->size() ? 0 : 1;
  }

  [[nodiscard]] static bool same(View a, View b) { return std::equal(a.begin(), a.end(), b.begin()); }

  /// Whether the motion to a node of a tree from its parent is still valid.
  bool edge_still_valid(std::size_t side, std::uint32_t id) {
    const Tree& tree = *trees_[side];
    return motion_still_valid(context_, tree[tree.parent(id)], tree[id], valid_since());
  }

  /// Finds the node nearest to the goal.
  void find_best() {
    auto& instance = context_.instance;
    const Tree& tree = *trees_[0];
    if (instance.to_goal(tree[0]) <= instance.goal_tolerance) bridge_ = Bridge{0, trees_[1]->nearest(tree[0]).id};
    best_distance_ = std::numeric_limits<double>::infinity();
    for (std::uint32_t id = 0; id < tree.size(); ++id) note_nearest(id, instance.to_goal(tree[id]));
  }

  /// One extension of a tree.
  struct Step : Extension {
    std::uint32_t near = 0;
    std::uint32_t added = 0;  ///< the new node; `near` if it is there already
  };
  Step step_towards(std::size_t side, NearestIndex::Neighbour near, View q) {
    Tree& tree = *trees_[side];
    Step step{extend_from(tree[near.id], q, std::sqrt(near.squared_distance), step_), near.id, near.id};
    if (step.fate == Fate::rejected) return step;
    step.added = tree.add(target_, near.id);
    if (side == 0) note_nearest(step.added, context_.instance.to_goal(target_));
    return step;
  }

  [[nodiscard]] std::size_t nodes() const override { return trees_[0]->size() + trees_[1]->size(); }
  void mark_new_nodes(bool begins) override {
    for (auto& tree : trees_) tree->mark_new_nodes(begins);
  }
  /// Computes the extension of a tree, and that of the other one towards the new node.
  void look_ahead(std::size_t step, StepAhead& ahead, Validity& validity) const override {
    const std::size_t side = side_ahead(step);
    // The other tree reaches farther seldom.
    constexpr int most_steps = 16;
    const auto& space = context_.instance.space;
    if (!extend_ahead(space, *trees_[side], ahead.proposal, step_, ahead, validity)) return;
    const Configuration q = ahead.target;
    const Tree& other = *trees_[1 - side];
    auto near = extend_ahead(space, other, q, step_, ahead, validity);
    for (int i = 1; near && i < most_steps; ++i) {
      // The new node is the nearest to q.
      const Configuration from = ahead.target;
      const double distance = space.distance(from, q);
      if (distance == 0.0) return;
      steer(space, from, q, distance, step_, ahead.target);
      const MotionReport report = validity.motion(from, ahead.target);
      ahead.add_motion(from, ahead.target, report);
      if (!report.valid) return;
    }
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

  /// Grows the other tree towards q until it reaches q, is blocked, or the guidance rejects the motion.
  void connect(std::size_t side, std::uint32_t from, const Configuration& q) {
    const std::size_t other = 1 - side;
    auto near = nearest(*trees_[other], q);
    for (;;) {
      if (near.squared_distance > 0.0 && !context_.guidance.worth_connecting((*trees_[other])[near.id], q)) return;
      const Step step = step_towards(other, near, q);
      if (!step.there) context_.guidance.observe(outcome_of(step, other, q), false);
      if (step.fate == Fate::reached || step.there) {
        bridge_ = side == 0 ? Bridge{from, step.added} : Bridge{step.added, from};
        return;
      }
      if (step.fate == Fate::rejected) return;
      // The node that was the nearest has a child that is nearer.
      const double squared_distance = trees_[other]->squared_distance(step.added, q);
      near = squared_distance < near.squared_distance ? NearestIndex::Neighbour{step.added, squared_distance}
                                                      : nearest(*trees_[other], q);
    }
  }

  double step_;
  bool balanced_;  ///< whether the smaller tree grows
  std::array<std::optional<Tree>, 2> trees_;
  std::array<std::optional<TreeRepair>, 2> repairs_;
  bool repairing_ = false;  ///< active after a change of the instance
  std::optional<Bridge> bridge_;
  std::size_t last_ = 1;  ///< tree that the last proposal extended
  Step extended_;         ///< of the last proposal
  Configuration met_;     ///< where the other tree is to meet it
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
