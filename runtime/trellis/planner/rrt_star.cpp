// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <limits>

#include <trellis/instance/search_cost.hpp>
#include <trellis/planner/anytime.hpp>
#include <trellis/planner/tree_planner.hpp>

namespace trellis {

namespace {

struct RrtStarSettings : AnytimeSettings {
  RrtStarSettings() { factor = 4.0; }
  double step = 0.5;
  double first_factor = 1.1;

  [[nodiscard]] Connection first_connection(const Space& space) const {
    AnytimeSettings first = *this;
    first.factor = first_factor;
    return first.connection(space);
  }
};

const Settings<RrtStarSettings>& rrt_star_settings() {
  static const Settings<RrtStarSettings> settings = with_anytime(
      Settings<RrtStarSettings>(
          Component::Kind::planner, "rrt_star",
          "RRT*: a random tree that connects each new node to the neighbour with the shortest path to it, and rewires "
          "nodes when a shorter path is found; continues after its first path",
          "Karaman and Frazzoli 2011, Sampling-based algorithms for optimal motion planning")
          .number("step", &RrtStarSettings::step, "m in the metric", Range::at_least(1e-6),
                  "longest extension of the tree, and longest motion tried to the goal from a new node")
          .number("first_factor", &RrtStarSettings::first_factor, "times", Range::positive(),
                  "`factor` until a path is known: fewer neighbours find the first path sooner, and later nodes rewire "
                  "the tree"));
  return settings;
}

class RrtStar final : public StartTreePlanner {
 public:
  RrtStar(const RrtStarSettings& settings, PlannerContext context)
      : StartTreePlanner(std::move(context), settings.step),
        connection_(settings.connection(context_.instance.space)),
        first_connection_(settings.first_connection(context_.instance.space)),
        best_path_(context_, settings.improve) {}

  std::optional<Status> begin(const Budget& budget) override {
    best_path_.begin();
    drew_ = false;
    proposals_ = budget.proposals;
    return TreePlanner::begin(budget);
  }
  Outcome extend(View proposal) override {
    drew_ = true;
    return StartTreePlanner::extend(proposal);
  }
  std::optional<Status> follow() override {
    static_cast<void>(StartTreePlanner::follow());
    keep_best();
    return ended();
  }

 protected:
  /// A solve that has to find another path keeps the tree and its shortest path, and draws a proposal at least.
  [[nodiscard]] bool done() const override { return drew_ && best_path_.done(); }

  void plant() override {
    forget_path();
    StartTreePlanner::plant();
    costs_ = {0.0};
    lengths_ = {0.0};
    children_.assign(1, {});
    keep_best();
  }

  void begin_repair() override {
    StartTreePlanner::begin_repair();
    if (tree_) forget_path();
  }

  /// The shortest path counts if it is not the known one, which the solve is to replace.
  bool path_still_valid() override {
    known_ = best_path_.known();
    const auto end = shortest_end();
    if (known_ || !end || !branch_still_valid(*end)) return false;
    keep_best();
    return true;
  }
  bool unchecked() override {
    while (!repair_->pending()) {
      if (!reconnect_orphans() && !recover_path()) return false;
    }
    return true;
  }
  bool end_repair() override {
    StartTreePlanner::end_repair();
    keep_best();
    return !known_ && best_path_.known();
  }

  void pruned(const std::vector<std::uint32_t>& ids) override {
    std::vector<double> lengths(tree_->size(), 0.0);
    for (std::uint32_t id = 0; id < ids.size(); ++id) {
      if (ids[id] != no_node) lengths[ids[id]] = lengths_[id];
    }
    lengths_ = std::move(lengths);
    children_.assign(tree_->size(), {});
    for (std::uint32_t id = 1; id < tree_->size(); ++id) children_[tree_->parent(id)].push_back(id);
    costs_.assign(tree_->size(), 0.0);
    update_costs(0);
  }

  [[nodiscard]] std::size_t nodes() const override { return tree_->size(); }
  [[nodiscard]] std::optional<std::size_t> goal_to_connect(View target) const override {
    const auto nearest = context_.instance.nearest_goal(target);
    return goals_[nearest.goal] == no_node && nearest.distance <= step_ ? std::optional(nearest.goal) : std::nullopt;
  }

  /// Inserts a node at q and rewires. The motion to q from `from` is valid. The node's parent gives it the shortest
  /// path from the start; the node becomes the parent of neighbours whose paths it shortens.
  std::uint32_t insert(View q, std::uint32_t from) override {
    const auto& space = context_.instance.space;
    context_.instance.spend(search_cost::rewired_node);
    connection().find(tree_->index(), q, near_);
    candidates_.clear();
    for (const auto& n : near_) add_candidate(n.id, std::sqrt(n.squared_distance));
    // A goal is a candidate for every node within one step, however many nodes are nearer.
    for (const std::uint32_t goal : goals_) {
      if (goal == no_node || is_candidate(goal)) continue;
      const double distance = space.distance((*tree_)[goal], q);
      if (distance <= step_) add_candidate(goal, distance);
    }
    Candidate best{from, space.distance((*tree_)[from], q)};
    best.cost = costs_[from] + best.length;
    // The candidates for the parent come first, ordered by cost; the others are only rewired.
    const auto shorter = std::partition(candidates_.begin(), candidates_.end(),
                                        [&](const Candidate& candidate) { return candidate.cost < best.cost; });
    std::sort(candidates_.begin(), shorter, cheaper);
    auto found = candidates_.begin();
    while (found != shorter && !motion_valid((*tree_)[found->node], q)) ++found;
    // The motions of the candidates before `found` are blocked.
    if (found != shorter) best = *found;
    const std::uint32_t id = tree_->add(q, best.node);
    costs_.push_back(best.cost);
    lengths_.push_back(best.length);
    children_.emplace_back();
    children_[best.node].push_back(id);
    note(id);
    for (; found != candidates_.end(); ++found) {
      const Candidate& candidate = *found;
      if (best.cost + candidate.length >= costs_[candidate.node]) continue;
      if (!motion_valid((*tree_)[id], (*tree_)[candidate.node])) continue;
      rewire(candidate.node, id, candidate.length);
    }
    return id;
  }

  /// Updates the nodes at a goal too.
  void note(std::uint32_t id) override {
    const auto [goal, distance] = context_.instance.nearest_goal((*tree_)[id]);
    if (distance <= context_.instance.goal_tolerance) ends_.push_back(id);
    if (distance == 0.0) goals_[goal] = id;
    note_nearest(id, distance);
  }
  void note_all() override {
    ends_.clear();
    goals_.assign(context_.instance.goals.size(), no_node);
    StartTreePlanner::note_all();
  }

  [[nodiscard]] Solution finish(Status status) const override {
    return best_path_.known() ? best_path_.solution(status) : StartTreePlanner::finish(status);
  }

 private:
  void forget_path() {
    best_path_.forget();
    best_cost_ = std::numeric_limits<double>::infinity();
  }

  /// Rewires each node whose motion from a valid parent is invalid to one of its neighbours, by the rule for
  /// insertions. Returns whether there were such nodes.
  bool reconnect_orphans() {
    bool any = false;
    for (std::uint32_t id = 0; id < tree_->size(); ++id) {
      if (repair_->known_invalid(id) && repair_->known_valid(tree_->parent(id))) any = reconnect(id) || any;
    }
    return any;
  }

  /// Rewires a node to one of its neighbours with a valid branch, by the rule for insertions. Returns whether it has
  /// such a neighbour.
  bool reconnect(std::uint32_t id) {
    const auto& space = context_.instance.space;
    const Configuration q((*tree_)[id].begin(), (*tree_)[id].end());
    connection().find(tree_->index(), q, near_);
    candidates_.clear();
    for (const auto& n : near_) {
      if (n.id != tree_->parent(id) && repair_->known_valid(n.id)) add_candidate(n.id, std::sqrt(n.squared_distance));
    }
    std::sort(candidates_.begin(), candidates_.end(), cheaper);
    const auto found = std::find_if(candidates_.begin(), candidates_.end(), [&](const Candidate& candidate) {
      return motion_valid((*tree_)[candidate.node], q);
    });
    if (found == candidates_.end()) return false;
    rewire(id, found->node, space.distance((*tree_)[found->node], q));
    repair_->reconnected(id, descendants(id));
    return true;
  }

  /// If no proposals are left and the tree lost its nodes at the goals, only its other nodes can give another path:
  /// reconnects as many nodes of invalid branches as possible, not only the first of each. Returns whether it
  /// reconnected any.
  bool recover_path() {
    const bool spent = static_cast<double>(context_.search.proposals.size()) >= proposals_;
    if (!spent || ends_.empty()) return false;
    if (std::any_of(ends_.begin(), ends_.end(), [&](std::uint32_t id) { return branch_still_valid(id); })) return false;
    bool any = false;
    for (std::uint32_t id = 0; id < tree_->size(); ++id) {
      if (!branch_still_valid(id)) any = reconnect(id) || any;
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

  bool motion_valid(View a, View b) {
    const MotionReport report = context_.instance.motion(a, b);
    if (!report.valid) blocked_motions_.add(context_.instance.space, a, b, report.invalid_at);
    return report.valid;
  }

  /// A neighbour of a new node.
  struct Candidate {
    std::uint32_t node = 0;
    double length = 0.0;
    double cost = 0.0;  ///< length of the path to the new node through this one
  };

  void add_candidate(std::uint32_t node, double length) {
    candidates_.push_back({node, length, costs_[node] + length});
  }
  [[nodiscard]] bool is_candidate(std::uint32_t node) const {
    return std::any_of(candidates_.begin(), candidates_.end(), [&](const Candidate& c) { return c.node == node; });
  }
  static bool cheaper(const Candidate& a, const Candidate& b) {
    return a.cost < b.cost || (a.cost == b.cost && a.node < b.node);
  }

  [[nodiscard]] const Connection& connection() const { return best_path_.known() ? connection_ : first_connection_; }

  void rewire(std::uint32_t id, std::uint32_t parent, double length) {
    auto& siblings = children_[tree_->parent(id)];
    siblings.erase(std::find(siblings.begin(), siblings.end(), id));
    children_[parent].push_back(id);
    tree_->rewire(id, parent);
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

  [[nodiscard]] std::optional<std::uint32_t> shortest_end() const {
    const auto end = std::min_element(ends_.begin(), ends_.end(),
                                      [&](std::uint32_t a, std::uint32_t b) { return costs_[a] < costs_[b]; });
    return end == ends_.end() ? std::nullopt : std::optional(*end);
  }

  void keep_best() {
    const auto end = shortest_end();
    if (!end || costs_[*end] >= best_cost_) return;
    best_cost_ = costs_[*end];
    best_path_.keep(tree_->branch(*end));
  }

  Connection connection_;
  Connection first_connection_;  ///< until a path is known
  BestPath best_path_;
  bool drew_ = false;            ///< this solve drew a proposal
  bool known_ = false;           ///< a path was known when this solve began
  double proposals_ = 0.0;       ///< limit of proposals of this solve
  std::vector<double> costs_;    ///< for each node, the length of its path from the start
  std::vector<double> lengths_;  ///< for each node, the length of the motion from its parent
  std::vector<std::vector<std::uint32_t>> children_;
  std::vector<NearestIndex::Neighbour> near_;
  std::vector<Candidate> candidates_;
  std::vector<std::uint32_t> ends_;   ///< nodes at a goal
  std::vector<std::uint32_t> goals_;  ///< for each goal, the node with exactly its configuration
  double best_cost_ = std::numeric_limits<double>::infinity();
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
