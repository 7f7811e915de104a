// SPDX-License-Identifier: GPL-3.0-or-later
// The trees of planners, and their repair after a change of the instance.
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include <trellis/planner/common.hpp>
#include <trellis/space/nearest.hpp>

namespace trellis {

/// A tree of configurations: rows of the level's nodes, their parents, and an index of nearest neighbours.
class Tree {
 public:
  explicit Tree(PlannerContext& context) : context_(context), index_(context.instance.space) {}

  std::uint32_t add(View q, std::uint32_t parent) {
    rows_.push_back(context_.search.nodes.push(q));
    context_.search.parents.push_back(rows_[parent]);
    parents_.push_back(parent);
    if (new_nodes_) new_nodes_->add(q);
    return index_.add(q);
  }
  /// Rewires a node to another parent. The parent is no descendant of the node; its id may be larger than the node's.
  void rewire(std::uint32_t id, std::uint32_t parent) {
    context_.search.parents[rows_[id]] = rows_[parent];
    parents_[id] = parent;
  }
  [[nodiscard]] std::uint32_t parent(std::uint32_t id) const { return parents_[id]; }
  [[nodiscard]] const NearestIndex& index() const { return index_; }
  /// The node's row in Search::nodes.
  [[nodiscard]] std::uint32_t row(std::uint32_t id) const { return rows_[id]; }
  [[nodiscard]] View operator[](std::uint32_t id) const { return std::as_const(context_.search.nodes)[rows_[id]]; }
  [[nodiscard]] NearestIndex::Neighbour nearest(View q) const { return index_.nearest(q); }
  /// The squared distance of a node from q, as `nearest` has it.
  [[nodiscard]] double squared_distance(std::uint32_t id, View q) const {
    return index_.squared_distance((*this)[id], q);
  }
  /// Nodes that are added from now on are new, or, where `begins` is false, no node is.
  void mark_new_nodes(bool begins) {
    new_nodes_.reset();
    if (!begins) return;
    new_nodes_.emplace(context_.instance.space);
    old_nodes_ = static_cast<std::uint32_t>(size());
  }
  /// The nearest node.
  /// \param old  the nearest of the nodes that are not new
  [[nodiscard]] NearestIndex::Neighbour nearest(View q, NearestIndex::Neighbour old) const {
    if (new_nodes_->size() == 0) return old;
    NearestIndex::Neighbour node = new_nodes_->nearest(q);
    node.id += old_nodes_;
    return node.squared_distance < old.squared_distance ? node : old;
  }
  /// The node to extend towards the last proposal q: the node that the guidance selects if this tree contains it, else
  /// the nearest node.
  [[nodiscard]] NearestIndex::Neighbour to_extend(View q) const {
    const std::uint32_t row = context_.guidance.vertex();
    if (row != no_node) {
      // Rows are in ascending order.
      const auto it = std::lower_bound(rows_.begin(), rows_.end(), row);
      if (it != rows_.end() && *it == row) {
        const auto id = static_cast<std::uint32_t>(it - rows_.begin());
        return {id, context_.instance.space.squared_distance((*this)[id], q)};
      }
    }
    return nearest(q);
  }
  [[nodiscard]] std::size_t size() const { return rows_.size(); }

  /// Removes nodes and their descendants. Search keeps its rows.
  /// \param keep  for each node, whether it stays; except for roots, its parent must stay too
  /// \return for each node its new id, or no_node
  std::vector<std::uint32_t> prune(const std::vector<std::uint8_t>& keep) {
    std::vector<std::uint32_t> ids(size(), no_node);
    std::uint32_t kept = 0;
    for (std::uint32_t id = 0; id < size(); ++id) {
      if (keep[id] == 0) continue;
      rows_[kept] = rows_[id];
      parents_[kept] = parents_[id];
      ids[id] = kept++;
    }
    rows_.resize(kept);
    parents_.resize(kept);
    // A rewired node may have a parent that comes after it.
    for (std::uint32_t& parent : parents_) parent = ids[parent];
    index_.retain(keep);
    new_nodes_.reset();
    return ids;
  }

  /// The path from the root to `id`, both included.
  [[nodiscard]] Configurations branch(std::uint32_t id) const {
    std::vector<std::uint32_t> ids;
    for (std::uint32_t at = id;; at = parents_[at]) {
      ids.push_back(at);
      if (at == parents_[at]) break;
    }
    Configurations path(context_.instance.space.dimension());
    for (auto it = ids.rbegin(); it != ids.rend(); ++it) path.push((*this)[*it]);
    return path;
  }

 private:
  PlannerContext& context_;
  NearestIndex index_;
  std::optional<NearestIndex> new_nodes_;  ///< of steps that are computed ahead (Lookahead)
  std::uint32_t old_nodes_ = 0;            ///< the number of nodes that are not new
  std::vector<std::uint32_t> rows_;
  std::vector<std::uint32_t> parents_;  ///< a root is its own parent
};

/// Whether a motion that was valid at an earlier epoch is still valid. Reports an invalid one to the guidance.
/// \param since  an epoch at which the motion was valid; 0: not known
inline bool motion_still_valid(PlannerContext& context, View from, View to, std::uint64_t since) {
  const MotionReport report = context.instance.recheck_motion(from, to, since);
  if (report.valid) return true;
  Configuration blocked(from.size());
  context.instance.space.interpolate(from, to, report.invalid_at, blocked);
  Outcome outcome;
  outcome.proposal = to;
  outcome.near = from;
  outcome.blocked_at = blocked;
  context.guidance.observe(outcome, false);
  return false;
}

/// Finds the valid branches of a tree after a change of the instance. Checks each motion at most once, and one
/// branch at a time.
class TreeRepair {
 public:
  /// \param since  an epoch at which every motion of the tree was valid
  TreeRepair(const Tree& tree, std::uint64_t since) : branches_(tree.size(), Branch::unknown), since_(since) {
    for (std::uint32_t id = 0; id < tree.size(); ++id) {
      if (tree.parent(id) == id) branches_[id] = Branch::valid;
    }
  }

  [[nodiscard]] std::uint64_t since() const { return since_; }
  /// Marks a root, or an invalid node, for removal.
  void refute(std::uint32_t id) { branches_[id] = Branch::invalid; }
  /// Whether the branch to the node is known to be valid, or invalid.
  [[nodiscard]] bool known_valid(std::uint32_t id) const { return branches_[id] == Branch::valid; }
  [[nodiscard]] bool known_invalid(std::uint32_t id) const { return branches_[id] == Branch::invalid; }
  /// Notes that a node was rewired to a parent with a valid branch, by a valid motion. Its descendants need a new
  /// check.
  /// \param descendants  of the node
  void reconnected(std::uint32_t id, const std::vector<std::uint32_t>& descendants) {
    branches_[id] = Branch::valid;
    for (const std::uint32_t at : descendants) branches_[at] = Branch::unknown;
    next_ = 0;
  }
  /// Whether all motions from the root to the node are valid.
  /// \param edge_valid  returns for a node whether the motion from its parent is valid
  template <class EdgeValid>
  bool branch_valid(const Tree& tree, std::uint32_t id, const EdgeValid& edge_valid) {
    branch_.clear();
    for (; branches_[id] == Branch::unknown; id = tree.parent(id)) branch_.push_back(id);
    Branch so_far = branches_[id];
    for (auto it = branch_.rbegin(); it != branch_.rend(); ++it) {
      if (so_far == Branch::valid && !edge_valid(*it)) so_far = Branch::invalid;
      branches_[*it] = so_far;
    }
    return so_far == Branch::valid;
  }
  /// Whether there is a node whose branch is not known to be valid or invalid.
  [[nodiscard]] bool pending() {
    while (next_ < branches_.size() && branches_[next_] != Branch::unknown) ++next_;
    return next_ < branches_.size();
  }
  /// Checks the branch of the first such node, in order of insertion.
  template <class EdgeValid>
  void check_next(const Tree& tree, const EdgeValid& edge_valid) {
    branch_valid(tree, next_, edge_valid);
  }
  /// Removes the invalid branches after all checks, as Tree::prune does.
  std::vector<std::uint32_t> prune(Tree& tree) const {
    std::vector<std::uint8_t> keep(branches_.size(), 0);
    for (std::size_t id = 0; id < keep.size(); ++id) keep[id] = branches_[id] == Branch::valid ? 1 : 0;
    return tree.prune(keep);
  }

 private:
  enum class Branch : std::uint8_t { unknown, valid, invalid };

  std::vector<Branch> branches_;
  std::uint64_t since_;
  std::vector<std::uint32_t> branch_;
  std::uint32_t next_ = 0;
};

/// Reports the nodes of a tree that lost some of them, after Guidance::restart.
inline void report_nodes(PlannerContext& context, const Tree& tree, bool from_goal) {
  Outcome outcome;
  outcome.fate = Fate::reached;
  outcome.from_goal = from_goal;
  for (std::uint32_t id = 0; id < tree.size(); ++id) {
    outcome.proposal = tree[id];
    outcome.near = tree[tree.parent(id)];
    outcome.near_row = tree.row(tree.parent(id));
    outcome.added = tree[id];
    outcome.added_row = tree.row(id);
    context.guidance.observe(outcome, false);
  }
}

}  // namespace trellis
