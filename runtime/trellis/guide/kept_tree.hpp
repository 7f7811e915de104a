// SPDX-License-Identifier: GPL-3.0-or-later
// What a search in C keeps of the tree that was grown in S.
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

/// The tree of S that grew from its start, and which of its nodes C has. S has the coordinates of C.
class KeptTree {
 public:
  KeptTree(Space space, Configuration start);

  /// Takes in the nodes that the search of S has added.
  void update(const Search& search);
  /// A node of C's tree from the start. \param row  of Search::nodes
  void add(View q, std::uint32_t row);
  /// C has no nodes but its start; those that are left are added again.
  void clear();

  struct Branch {
    View node;                     ///< of S
    std::uint32_t from = no_node;  ///< the node of C where its parent is; no_node: the start
  };
  /// The next node of S, in the order in which they came, that C has not, but has its parent. Each is given once; none
  /// where there is no more.
  std::optional<Branch> next();
  /// Whether `next` would give a node.
  [[nodiscard]] bool any();

 private:
  struct Node {
    std::uint32_t parent = no_node;  ///< of the tree; the start has none
    std::uint32_t child = no_node;   ///< the last one
    std::uint32_t sibling = no_node;
    std::uint32_t row = no_node;  ///< in C
    bool in_c = false;
    bool tried = false;
  };

  /// C has the node: its children are next.
  void reach(std::uint32_t id);

  Space space_;
  Configurations places_;
  std::vector<Node> nodes_;
  NearestIndex index_;
  std::vector<std::uint32_t> node_of_row_;  ///< of S's rows; no_node: not of the tree from the start
  std::priority_queue<std::uint32_t, std::vector<std::uint32_t>, std::greater<>> ready_;  ///< C has their parents
};

/// h of a path. Where a proposal of its was blocked, until the path is advanced along, half of them are nodes of the
/// tree in S, as long as there are such that C has the parent of: extended from there, they bring the branches into C's
/// tree that are valid there.
class TreeAndPath final : public PathFollower {
 public:
  TreeAndPath(std::shared_ptr<KeptTree> tree, std::unique_ptr<PathFollower> path);

  void select_tree(TreeSide side) override;
  Source sample(Stream& stream, MutableView out) override;
  [[nodiscard]] std::uint32_t vertex() const override { return branch_ ? branch_->from : path_->vertex(); }
  [[nodiscard]] bool worth_connecting(View from, View to) const override {
    return branch_ || path_->worth_connecting(from, to);
  }
  [[nodiscard]] double progress() const override { return path_->progress(); }
  [[nodiscard]] double connected() const override { return path_->connected(); }
  [[nodiscard]] double edge_factor(View a, View b) const override { return path_->edge_factor(a, b); }
  [[nodiscard]] double density(View q) const override { return (1.0 - share()) * path_->density(q); }
  [[nodiscard]] double atom_mass() const override { return share() + (1.0 - share()) * path_->atom_mass(); }
  [[nodiscard]] std::uint64_t epoch() const override { return epoch_ + path_->epoch(); }
  void record(DensityRecord& record, double of) const override;
  void observe(const Outcome& outcome, bool mine) override;
  void restart() override { path_->restart(); }
  void found(double length) override { path_->found(length); }
  [[nodiscard]] std::vector<std::string> sources() const override { return path_->sources(); }
  [[nodiscard]] Configurations lifted_path() const override { return path_->lifted_path(); }
  [[nodiscard]] std::optional<Configuration> refuted_place() const override { return path_->refuted_place(); }
  [[nodiscard]] double radius() const override { return path_->radius(); }

 private:
  static constexpr double share_of_tree = 0.5;
  [[nodiscard]] double share() const { return open_ ? share_of_tree : 0.0; }
  /// Notices where the tree's share has come or gone.
  void look();

  std::shared_ptr<KeptTree> tree_;
  std::unique_ptr<PathFollower> path_;
  std::optional<KeptTree::Branch> branch_;  ///< that was proposed last
  TreeSide side_ = TreeSide::start;
  bool blocked_ = false;  ///< since the last progress
  double progress_ = 0.0;
  bool open_ = false;  ///< the tree has a share
  std::uint64_t epoch_ = 0;
};

}  // namespace trellis
