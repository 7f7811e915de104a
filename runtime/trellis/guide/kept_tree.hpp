// SPDX-License-Identifier: GPL-3.0-or-later
// Reuse of the tree grown in S by the search in C.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <queue>
#include <string>
#include <utility>
#include <vector>

#include <trellis/guide/path_guide.hpp>
#include <trellis/planner/planner.hpp>

namespace trellis {

/// The tree in S from the start, with a mark at each node that C's tree contains. S has the coordinates of C.
class KeptTree {
 public:
  KeptTree(Space space, Configuration start);

  /// Adds the nodes that the search of S has added.
  void update(const Search& search);
  /// Marks the node of S that a node of C's tree from the start corresponds to.
  /// \param row  of the node in Search::nodes
  void add(View q, std::uint32_t row);
  /// Removes all marks except that of the start. The caller then adds the remaining nodes again.
  void clear();

  struct Branch {
    View node;                     ///< node of S
    std::uint32_t from = no_node;  ///< node of C at its parent; no_node: the start
  };
  /// The next node of S, in order of insertion, that C lacks but whose parent C contains. Returns each node once; none
  /// if there is no more.
  std::optional<Branch> next();
  /// Whether `next` would return a node.
  [[nodiscard]] bool any();

 private:
  struct Node {
    std::uint32_t parent = no_node;  ///< in the tree of S; none for the start
    std::uint32_t child = no_node;   ///< the last child
    std::uint32_t sibling = no_node;
    std::uint32_t row = no_node;  ///< node in C
    bool in_c = false;
    bool tried = false;
  };

  /// Marks a node as contained in C; its children become candidates.
  void reach(std::uint32_t id);

  Space space_;
  Configurations places_;
  std::vector<Node> nodes_;
  NearestIndex index_;
  std::vector<std::uint32_t> node_of_row_;  ///< for each row of S; no_node: not in the tree from the start
  std::priority_queue<std::uint32_t, std::vector<std::uint32_t>, std::greater<>>
      ready_;  ///< nodes whose parents C contains
};

/// h of a path, combined with the tree in S. After one of its proposals was blocked, and until the next progress along
/// the path, half of the proposals are nodes of the tree in S whose parents C contains. Extended from these parents,
/// they add the branches that are valid in C to its tree.
class TreeAndPath final : public Wrapping<PathFollower, PathFollower> {
 public:
  TreeAndPath(std::shared_ptr<KeptTree> tree, std::unique_ptr<PathFollower> path);

  void select_tree(TreeSide side) override;
  Source sample(Stream& stream, MutableView out) override;
  [[nodiscard]] std::uint32_t vertex() const override { return branch_ ? branch_->from : Wrapping::vertex(); }
  [[nodiscard]] std::uint64_t epoch() const override { return changes_ + Wrapping::epoch(); }
  void record(DensityRecord& record, double of) const override;
  void observe(const Outcome& outcome, bool mine) override;
  [[nodiscard]] Configurations lifted_path() const override { return part()->lifted_path(); }
  [[nodiscard]] std::optional<Configuration> refuted_place() const override { return part()->refuted_place(); }
  [[nodiscard]] double radius() const override { return part()->radius(); }

 private:
  [[nodiscard]] Guidance* drew_last() const override { return branch_ ? nullptr : part(); }
  static constexpr double share_of_tree = 0.5;
  [[nodiscard]] double share() const { return open_ ? share_of_tree : 0.0; }
  /// Updates whether the tree has a share of the proposals.
  void look();

  std::shared_ptr<KeptTree> tree_;
  std::optional<KeptTree::Branch> branch_;  ///< the last proposal, if from the tree
  bool blocked_ = false;                    ///< a proposal was blocked since the last progress
  double progress_ = 0.0;
  bool open_ = false;          ///< the tree has a share
  std::uint64_t changes_ = 0;  ///< number of changes of the share
};

}  // namespace trellis
