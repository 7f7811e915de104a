// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/guide/kept_tree.hpp>

#include <algorithm>

namespace trellis {

KeptTree::KeptTree(Space space, Configuration start)
    : space_(std::move(space)), places_(space_.dimension()), index_(space_) {
  places_.push(start);
  index_.add(start);
  nodes_.push_back({.in_c = true, .tried = true});
}

void KeptTree::update(const Search& search) {
  const Configurations& rows = search.nodes;
  for (std::size_t row = node_of_row_.size(); row < rows.size(); ++row) {
    node_of_row_.push_back(no_node);
    const std::uint32_t parent = search.parents[row];
    const bool root = parent == row;
    if (root) {
      if (space_.squared_distance(rows[row], std::as_const(places_)[0]) == 0.0) node_of_row_[row] = 0;
      continue;
    }
    // Nodes of a roadmap have no parent. A parent has a smaller row, unless the node was rewired.
    if (parent == no_node || parent > row || node_of_row_[parent] == no_node) continue;
    const std::uint32_t id = places_.push(rows[row]);
    node_of_row_[row] = id;
    index_.add(rows[row]);
    Node& above = nodes_[node_of_row_[parent]];
    const Node node = {.parent = node_of_row_[parent], .sibling = std::exchange(above.child, id)};
    if (above.in_c) ready_.push(id);
    nodes_.push_back(node);
  }
}

void KeptTree::reach(std::uint32_t id) {
  nodes_[id].in_c = true;
  for (std::uint32_t child = nodes_[id].child; child != no_node; child = nodes_[child].sibling) ready_.push(child);
}

void KeptTree::add(View q, std::uint32_t row) {
  const auto near = index_.nearest(q);
  if (near.squared_distance > 0.0) return;
  nodes_[near.id].row = row;
  if (!nodes_[near.id].in_c) reach(near.id);
}

void KeptTree::clear() {
  for (Node& node : nodes_) {
    node.row = no_node;
    node.in_c = false;
  }
  ready_ = {};
  reach(0);
}

bool KeptTree::any() {
  while (!ready_.empty() && (nodes_[ready_.top()].in_c || nodes_[ready_.top()].tried)) ready_.pop();
  return !ready_.empty();
}

std::optional<KeptTree::Branch> KeptTree::next() {
  if (!any()) return std::nullopt;
  const std::uint32_t id = ready_.top();
  ready_.pop();
  nodes_[id].tried = true;
  return Branch{std::as_const(places_)[id], nodes_[nodes_[id].parent].row};
}

TreeAndPath::TreeAndPath(std::shared_ptr<KeptTree> tree, std::unique_ptr<PathFollower> path)
    : Wrapping(std::move(path)), tree_(std::move(tree)) {
  if (part()->stale()) refute();
  look();
}

void TreeAndPath::select_tree(TreeSide side) {
  Wrapping::select_tree(side);
  look();
}

Guidance::Source TreeAndPath::sample(Stream& stream, MutableView out) {
  branch_.reset();
  if (open_ && stream.uniform() < share_of_tree) branch_ = tree_->next();
  if (!branch_) return part()->sample(stream, out);
  std::copy(branch_->node.begin(), branch_->node.end(), out.begin());
  return 0;
}

void TreeAndPath::record(DensityRecord& record, double of) const {
  record.add_atoms(of * share());
  part()->record(record, of * (1.0 - share()));
}

void TreeAndPath::observe(const Outcome& outcome, bool mine) {
  Wrapping::observe(outcome, mine);
  if (mine && outcome.fate == Fate::rejected && !outcome.blocked_at.empty()) blocked_ = true;
  if (mine) branch_.reset();
  if (part()->progress() > progress_) blocked_ = false;
  progress_ = part()->progress();
  if (part()->stale()) refute();
  look();
}

void TreeAndPath::look() {
  // The nodes in S belong to the tree from the start.
  const bool open = blocked_ && side() == TreeSide::start && tree_->any();
  if (open != open_) ++changes_;
  open_ = open;
}

}  // namespace trellis
