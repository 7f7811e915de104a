// SPDX-License-Identifier: GPL-3.0-or-later
// Shared by the planners that grow trees: steps, extensions, the connection to the goal, and repair.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include <trellis/planner/lookahead.hpp>
#include <trellis/planner/tree.hpp>

namespace trellis {

/// A planner that grows trees by one proposal at a time. After a change of the instance it repairs its trees first.
class TreePlanner : public Planner, protected StepsAhead {
 public:
  std::optional<Status> begin(const Budget& budget) override;
  [[nodiscard]] bool draws() const override { return !repairing(); }
  Plan plan() override { return {.proposal = !repairing()}; }
  std::optional<Status> work() override;
  [[nodiscard]] StepsAhead* coming() override { return this; }
  [[nodiscard]] Solution solution(Status status) override {
    return repairing() && status != Status::solved ? unrepaired(status) : finish(status);
  }

 protected:
  explicit TreePlanner(PlannerContext context)
      : Planner(std::move(context)), target_(dimension()), blocked_(dimension()) {}

  /// Whether there are trees, whether they need repair, and whether the search ends.
  [[nodiscard]] virtual bool planted() const = 0;
  [[nodiscard]] virtual bool repairing() const = 0;
  [[nodiscard]] virtual bool done() const = 0;
  /// Replaces the trees by their roots.
  virtual void plant() = 0;
  /// Called when the instance changed, so that validity of the trees is unknown.
  virtual void begin_repair() = 0;
  /// Whether a path is still valid. If so, the solve ends without a check of the remaining trees.
  virtual bool path_still_valid() = 0;
  /// Whether branches remain to be checked.
  virtual bool unchecked() = 0;
  /// Checks one of these branches.
  virtual void check_branch() = 0;
  /// Removes the invalid branches, when all are checked. Returns whether that found a path with which the solve ends.
  virtual bool end_repair() = 0;
  [[nodiscard]] std::size_t nodes() const override { return 0; }
  void look_ahead(std::size_t step, StepAhead& ahead, Validity& validity) const override {
    static_cast<void>(step);
    static_cast<void>(ahead);
    static_cast<void>(validity);
  }
  void mark_new_nodes(bool begins) override { static_cast<void>(begins); }
  [[nodiscard]] virtual Solution finish(Status status) const = 0;
  /// The solution of a solve that ended during the repair.
  [[nodiscard]] virtual Solution unrepaired(Status status) const { return {status, path_of_start(context_.instance)}; }

  [[nodiscard]] std::size_t dimension() const { return context_.instance.space.dimension(); }

  /// A motion from a node towards a configuration.
  struct Extension {
    Fate fate = Fate::rejected;  ///< advanced or reached: the motion to target_ is valid
    bool there = false;          ///< the node is the configuration
    bool blocked = false;        ///< the motion is invalid at blocked_
  };
  /// Checks the motion from `from` towards q. Adds no node.
  /// \param distance  from `from` to q, in metres in the metric
  /// \param step  longest extension, in metres in the metric
  Extension extend_from(View from, View q, double distance, double step);
  /// Checks a motion, or takes the report that was computed ahead.
  [[nodiscard]] MotionReport motion(View from, View to) {
    const StepAhead* ahead = present();
    return context_.instance.motion(from, to, ahead != nullptr ? ahead->motion(from, to) : nullptr);
  }
  /// The nearest node of a tree.
  [[nodiscard]] NearestIndex::Neighbour nearest(const Tree& tree, View q) const {
    const StepAhead* ahead = present();
    const NearestIndex::Neighbour* old = ahead != nullptr ? ahead->nearest(&tree, q) : nullptr;
    return old != nullptr ? tree.nearest(q, *old) : tree.nearest(q);
  }
  /// The node to extend towards the last proposal q, see Tree.
  [[nodiscard]] NearestIndex::Neighbour to_extend(const Tree& tree, View q) const {
    // Steps are computed ahead only where no guide selects nodes.
    return present() != nullptr ? nearest(tree, q) : tree.to_extend(q);
  }
  /// Computes what `extend_from` asks towards q from the nearest node of a tree, in the thread of a helper.
  /// \return the node, if the motion is valid and `ahead.target` its end
  static std::optional<NearestIndex::Neighbour> extend_ahead(const Space& space, const Tree& tree, View q, double step,
                                                             StepAhead& ahead, Validity& validity);
  /// Updates the node nearest to a goal.
  void note_nearest(std::uint32_t id, double distance) {
    if (distance >= best_distance_) return;
    best_distance_ = distance;
    best_ = id;
  }

  /// An epoch of the instance at which every motion of the trees was valid.
  [[nodiscard]] std::uint64_t valid_since() const { return valid_since_; }
  /// Called at the end of a repair: every motion of the trees is valid.
  void repaired() { valid_since_ = epoch_; }
  /// The status if the solve ends here.
  [[nodiscard]] std::optional<Status> ended() const { return done() ? std::optional(Status::solved) : std::nullopt; }

  Configuration target_;
  Configuration blocked_;
  std::uint32_t best_ = 0;  ///< node nearest to a goal
  double best_distance_ = std::numeric_limits<double>::infinity();

 private:
  /// What was computed for the present step; nullptr: nothing.
  [[nodiscard]] const StepAhead* present() const {
    return context_.ahead != nullptr ? context_.ahead->present() : nullptr;
  }
  /// Ends the repair if no branch is left to check. Returns the status if the solve ends here.
  std::optional<Status> end_repair_if_checked();

  std::uint64_t epoch_ = 0;
  std::uint64_t valid_since_ = 0;
  bool ends_checked_ = false;
};

/// A planner with one tree, from the start.
class StartTreePlanner : public TreePlanner {
 public:
  Outcome extend(View proposal) override;
  std::optional<Status> follow() override;

 protected:
  /// \param step  longest extension, in metres in the metric, of a planner that extends by straight motions
  explicit StartTreePlanner(PlannerContext context, double step = 0.0)
      : TreePlanner(std::move(context)), blocked_motions_(dimension()), step_(step) {}

  [[nodiscard]] bool planted() const override { return tree_.has_value(); }
  [[nodiscard]] bool repairing() const override { return repair_.has_value(); }
  [[nodiscard]] bool done() const override { return solved_; }
  void plant() override;
  void begin_repair() override;
  bool path_still_valid() override;
  bool unchecked() override { return repair_->pending(); }
  void check_branch() override {
    repair_->check_next(*tree_, [&](std::uint32_t id) { return edge_still_valid(id); });
  }
  bool end_repair() override;
  [[nodiscard]] Solution finish(Status status) const override { return {status, tree_->branch(best_)}; }

  /// Whether the motion to a node from its parent is still valid.
  virtual bool edge_still_valid(std::uint32_t id);
  /// Called after the removal of nodes.
  /// \param ids  for each former node its new id, or no_node
  virtual void pruned(const std::vector<std::uint32_t>& ids) { static_cast<void>(ids); }
  /// Inserts a node at q, to which the motion from the node `from` is valid.
  virtual std::uint32_t insert(View q, std::uint32_t from);
  /// The goal to which a motion from a new node at `target` is tried, or none. Helpers call it too.
  [[nodiscard]] virtual std::optional<std::size_t> goal_to_connect(View target) const {
    static_cast<void>(target);
    return std::nullopt;
  }
  /// Updates the node nearest to a goal, and whether the search is solved.
  virtual void note(std::uint32_t id);
  /// Notes all nodes anew.
  virtual void note_all();

  [[nodiscard]] bool branch_still_valid(std::uint32_t id) {
    return repair_->branch_valid(*tree_, id, [&](std::uint32_t at) { return edge_still_valid(at); });
  }
  void look_ahead(std::size_t step, StepAhead& ahead, Validity& validity) const override;
  void mark_new_nodes(bool begins) override { tree_->mark_new_nodes(begins); }
  /// Removes the branches found invalid, and ends the repair.
  void remove_invalid();

  std::optional<Tree> tree_;
  std::optional<TreeRepair> repair_;  ///< active after a change of the instance
  BlockedMotions blocked_motions_;    ///< found during insertions
  bool solved_ = false;
  double step_;

 private:
  /// Tries the motion from the node at target_ to a goal.
  void connect(std::uint32_t id, std::size_t goal);

  std::uint32_t added_ = no_node;  ///< for the last proposal
};

}  // namespace trellis
