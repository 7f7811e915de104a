// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <limits>

#include <trellis/planner/anytime.hpp>
#include <trellis/planner/kinds.hpp>
#include <trellis/planner/tree.hpp>

namespace trellis {

namespace {

struct RrtStarSettings : AnytimeSettings {
  double step = 0.5;
};

const Settings<RrtStarSettings>& rrt_star_settings() {
  static const Settings<RrtStarSettings> settings = with_anytime(
      Settings<RrtStarSettings>(
          Component::Kind::planner, "rrt_star",
          "RRT*: a random tree that connects each new node to the neighbour with the shortest path to it, and rewires "
          "nodes when a shorter path is found; continues after its first path",
          "Karaman and Frazzoli 2011, Sampling-based algorithms for optimal motion planning")
          .number("step", &RrtStarSettings::step, "m in the metric", Range::at_least(1e-6),
                  "longest extension of the tree, and longest motion tried to the goal from a new node"));
  return settings;
}

class RrtStar final : public Planner {
 public:
  RrtStar(const RrtStarSettings& settings, PlannerContext context)
      : settings_(settings),
        context_(std::move(context)),
        connection_(settings.connection(context_.instance.space)),
        best_(context_, settings.improve),
        sample_(dimension()),
        target_(dimension()),
        blocked_(dimension()),
        blocked_motions_(dimension()) {}

  Solution solve(const Budget& budget) override {
    auto& instance = context_.instance;
    BudgetMonitor monitor(context_, budget);
    best_.begin();
    if (!ends_checked_ || epoch_ != instance.epoch()) {
      if (auto nothing = invalid_ends(instance)) return std::move(*nothing);
      ends_checked_ = true;
      epoch_ = instance.epoch();
      if (tree_) begin_repair();
    }
    // The tree and its shortest path remain when a solve has to find another path.
    if (!tree_) plant();
    if (repair_) {
      const bool known = best_.known();
      if (const auto reason = repair(monitor)) return {*reason, path_of_start(instance)};
      if (!known && best_.known()) return finish(Status::solved);
    }
    bool another = best_.known();
    while (another || !best_.done()) {
      another = false;
      if (const auto reason = monitor.spent()) return finish(*reason);
      iterate();
    }
    return finish(Status::solved);
  }

 private:
  [[nodiscard]] std::size_t dimension() const { return context_.instance.space.dimension(); }
  [[nodiscard]] double to_goal(View q) const { return context_.instance.to_goal(q); }

  void plant() {
    tree_.emplace(context_);
    repair_.reset();
    context_.guidance.restart();
    best_.forget();
    best_cost_ = std::numeric_limits<double>::infinity();
    tree_->add(context_.instance.start, 0);
    costs_ = {0.0};
    lengths_ = {0.0};
    children_.assign(1, {});
    note_all();
    keep_best();
  }

  /// Called when the instance changed, so that validity of the tree is unknown.
  void begin_repair() {
    if (!std::equal(context_.instance.start.begin(), context_.instance.start.end(), (*tree_)[0].begin())) {
      tree_.reset();
      return;
    }
    repair_.emplace(*tree_);
    best_.forget();
    best_cost_ = std::numeric_limits<double>::infinity();
    note_all();
  }

  /// Stops if the shortest path is still valid, without a check of the remaining tree. Else, or if that holds already,
  /// removes all invalid branches. Returns the reason if it stops early, else none.
  std::optional<Status> repair(BudgetMonitor& monitor) {
    const auto edge_valid = [&](std::uint32_t id) {
      return motion_still_valid(context_, (*tree_)[tree_->parent(id)], (*tree_)[id]);
    };
    if (!best_.known()) {
      const auto end = shortest_end();
      if (end && repair_->branch_valid(*tree_, *end, edge_valid)) {
        keep_best();
        return std::nullopt;
      }
    }
    do {
      if (const auto reason = repair_->check_all(*tree_, monitor, edge_valid)) return reason;
    } while (reconnect_orphans());
    const std::vector<std::uint32_t> ids = repair_->prune(*tree_);
    repair_.reset();
    context_.guidance.restart();
    report_nodes(context_, *tree_, false);
    std::vector<double> lengths(tree_->size(), 0.0);
    for (std::uint32_t id = 0; id < ids.size(); ++id) {
      if (ids[id] != no_node) lengths[ids[id]] = lengths_[id];
    }
    lengths_ = std::move(lengths);
    children_.assign(tree_->size(), {});
    for (std::uint32_t id = 1; id < tree_->size(); ++id) children_[tree_->parent(id)].push_back(id);
    costs_.assign(tree_->size(), 0.0);
    update_costs(0);
    note_all();
    keep_best();
    return std::nullopt;
  }

  /// Rewires each node whose motion from a valid parent is invalid to one of its neighbours, by the rule for
  /// insertions. Returns whether there were such nodes.
  bool reconnect_orphans() {
    const auto& space = context_.instance.space;
    bool any = false;
    for (std::uint32_t id = 0; id < tree_->size(); ++id) {
      if (!repair_->known_invalid(id) || !repair_->known_valid(tree_->parent(id))) continue;
      const Configuration q((*tree_)[id].begin(), (*tree_)[id].end());
      connection_.find(tree_->index(), q, near_);
      joints_.clear();
      for (const auto& n : near_) {
        if (n.id != tree_->parent(id) && repair_->known_valid(n.id)) add_joint(n.id, std::sqrt(n.squared_distance));
      }
      sort_joints();
      const auto found = std::find_if(joints_.begin(), joints_.end(),
                                      [&](const Joint& joint) { return motion_valid((*tree_)[joint.node], q); });
      if (found == joints_.end()) continue;
      hang(id, found->node, space.distance((*tree_)[found->node], q));
      repair_->reconnected(id, descendants(id));
      any = true;
    }
    return any;
  }

  [[nodiscard]] std::vector<std::uint32_t> descendants(std::uint32_t id) const {
    std::vector<std::uint32_t> all = children_[id];
    for (std::size_t i = 0; i < all.size(); ++i) {
      const auto& children = children_[all[i]];
      all.insert(all.end(), children.begin(), children.end());
    }
    return all;
  }

  /// Finds the nodes at a goal, and the node nearest to a goal.
  void note_all() {
    ends_.clear();
    goals_.assign(context_.instance.goals(), no_node);
    nearest_distance_ = std::numeric_limits<double>::infinity();
    for (std::uint32_t id = 0; id < tree_->size(); ++id) note(id);
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
    const std::uint32_t id = insert(target_, near.id);
    outcome.fate = reaches ? Fate::reached : Fate::advanced;
    outcome.near = (*tree_)[near.id];
    outcome.added = target_;
    settle(context_, outcome, tree_->row(near.id), tree_->row(id));
    blocked_motions_.report(context_);
    const auto goal = instance.nearest_goal(target_);
    if (goals_[goal.goal] == no_node && goal.distance <= settings_.step) connect_goal(id, goal.goal);
    keep_best();
  }

  /// Tries the motion from the node at target_ to a goal.
  void connect_goal(std::uint32_t id, std::size_t index) {
    auto& instance = context_.instance;
    const View goal = instance.goal_at(index);
    if (!context_.guidance.worth_connecting(target_, goal)) return;
    const MotionReport report = instance.motion(target_, goal);
    Outcome outcome;
    outcome.proposal = goal;
    outcome.near = target_;
    if (report.valid) {
      outcome.added_row = tree_->row(insert(goal, id));
      outcome.fate = Fate::reached;
      outcome.added = goal;
    } else {
      instance.space.interpolate(target_, goal, report.invalid_at, blocked_);
      outcome.blocked_at = blocked_;
    }
    context_.guidance.observe(outcome, false);
    blocked_motions_.report(context_);
  }

  /// Inserts a node at q and rewires. The motion to q from `from` is valid. The node's parent gives it the shortest
  /// path from the start; the node becomes the parent of neighbours whose paths it shortens.
  std::uint32_t insert(View q, std::uint32_t from) {
    const auto& space = context_.instance.space;
    connection_.find(tree_->index(), q, near_);
    joints_.clear();
    for (const auto& n : near_) add_joint(n.id, std::sqrt(n.squared_distance));
    // A goal is a candidate for every node within one step, however many nodes are nearer.
    for (const std::uint32_t goal : goals_) {
      if (goal == no_node) continue;
      const double distance = space.distance((*tree_)[goal], q);
      if (distance <= settings_.step) add_joint(goal, distance);
    }
    Joint best{from, space.distance((*tree_)[from], q)};
    best.way = costs_[from] + best.length;
    sort_joints();
    std::size_t refused = 0;
    for (; refused < joints_.size() && joints_[refused].way < best.way; ++refused) {
      const Joint& joint = joints_[refused];
      if (!motion_valid((*tree_)[joint.node], q)) continue;
      best = joint;
      break;
    }
    const std::uint32_t id = tree_->add(q, best.node);
    costs_.push_back(best.way);
    lengths_.push_back(best.length);
    children_.emplace_back();
    children_[best.node].push_back(id);
    note(id);
    // The motions of the candidates before `refused` are blocked.
    for (std::size_t i = refused; i < joints_.size(); ++i) {
      const Joint& joint = joints_[i];
      if (best.way + joint.length >= costs_[joint.node]) continue;
      if (!motion_valid((*tree_)[id], (*tree_)[joint.node])) continue;
      hang(joint.node, id, joint.length);
    }
    return id;
  }

  bool motion_valid(View a, View b) {
    const MotionReport report = context_.instance.motion(a, b);
    if (!report.valid) blocked_motions_.add(context_.instance.space, a, b, report.invalid_at);
    return report.valid;
  }

  /// A neighbour of a new node.
  struct Joint {
    std::uint32_t node = 0;
    double length = 0.0;
    double way = 0.0;  ///< length of the path to the new node through this one
  };

  void add_joint(std::uint32_t node, double length) {
    if (std::any_of(joints_.begin(), joints_.end(), [&](const Joint& j) { return j.node == node; })) return;
    joints_.push_back({node, length, costs_[node] + length});
  }

  void sort_joints() {
    std::sort(joints_.begin(), joints_.end(),
              [](const Joint& a, const Joint& b) { return a.way < b.way || (a.way == b.way && a.node < b.node); });
  }

  void hang(std::uint32_t id, std::uint32_t parent, double length) {
    auto& siblings = children_[tree_->parent(id)];
    siblings.erase(std::find(siblings.begin(), siblings.end(), id));
    children_[parent].push_back(id);
    tree_->hang(id, parent);
    lengths_[id] = length;
    update_costs(id);
  }

  /// Updates the costs of a node and its descendants.
  void update_costs(std::uint32_t id) {
    std::vector<std::uint32_t> changed = {id};
    while (!changed.empty()) {
      const std::uint32_t at = changed.back();
      changed.pop_back();
      costs_[at] = costs_[tree_->parent(at)] + lengths_[at];
      changed.insert(changed.end(), children_[at].begin(), children_[at].end());
    }
  }

  /// Updates the node nearest to the goal and the nodes at a goal.
  void note(std::uint32_t id) {
    const auto [goal, distance] = context_.instance.nearest_goal((*tree_)[id]);
    if (distance <= context_.instance.goal_tolerance) ends_.push_back(id);
    if (distance == 0.0) goals_[goal] = id;
    if (distance < nearest_distance_) {
      nearest_distance_ = distance;
      nearest_ = id;
    }
  }

  [[nodiscard]] std::optional<std::uint32_t> shortest_end() const {
    const auto end = std::min_element(ends_.begin(), ends_.end(),
                                      [&](std::uint32_t a, std::uint32_t b) { return costs_[a] < costs_[b]; });
    return end == ends_.end() ? std::nullopt : std::optional(*end);
  }

  void keep_best() {
    const auto end = shortest_end();
    if (!end || costs_[*end] >= best_cost_) return;
    best_cost_ = costs_[*end];
    best_.keep(tree_->branch(*end));
  }

  [[nodiscard]] Solution finish(Status status) const {
    if (best_.known()) return best_.solution(status);
    return {status, tree_->branch(nearest_)};
  }

  RrtStarSettings settings_;
  PlannerContext context_;
  Connection connection_;
  BestPath best_;
  std::optional<Tree> tree_;
  std::optional<TreeRepair> repair_;  ///< active after a change of the instance
  std::vector<double> costs_;         ///< for each node, the length of its path from the start
  std::vector<double> lengths_;       ///< for each node, the length of the motion from its parent
  std::vector<std::vector<std::uint32_t>> children_;
  std::vector<NearestIndex::Neighbour> near_;
  std::vector<Joint> joints_;
  std::vector<std::uint32_t> ends_;   ///< nodes at a goal
  std::vector<std::uint32_t> goals_;  ///< for each goal, the node with exactly its configuration
  double best_cost_ = std::numeric_limits<double>::infinity();
  Configuration sample_;
  Configuration target_;
  Configuration blocked_;
  BlockedMotions blocked_motions_;
  std::uint32_t nearest_ = 0;  ///< node nearest to a goal
  double nearest_distance_ = std::numeric_limits<double>::infinity();
  std::uint64_t epoch_ = 0;
  bool ends_checked_ = false;
};

}  // namespace

PlannerKind rrt_star_kind() {
  return {&rrt_star_settings().component(), [](const Options& o) { return common_of(rrt_star_settings().read(o)); },
          [](const Options& o, PlannerContext context) -> std::unique_ptr<Planner> {
            return std::make_unique<RrtStar>(rrt_star_settings().read(o), std::move(context));
          },
          false};
}

}  // namespace trellis
