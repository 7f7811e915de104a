// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <memory>
#include <utility>

#include <trellis/guide/path_guide.hpp>

namespace trellis {

/// A path that the search of another space found, mapped into a level's space: the level's search goes along it until
/// it is refuted there. A tree follows it by steps; a roadmap and a graph have vertices along all of it.
class InformedPath {
 public:
  /// \param instance  of the level; outlives this
  explicit InformedPath(const Instance& instance) : instance_(instance) {}

  /// Keeps the level's nodes from now on, so that a path is followed from where the search stands. Called before its
  /// search begins.
  void expect() {
    if (!nodes_.begun()) nodes_.begin(instance_.space, instance_.start, instance_.goal);
  }
  /// Follows this path instead of the last one; none where it is empty.
  void follow(Configurations path);
  /// Whether there is a path to follow. Nothing is drawn where not.
  [[nodiscard]] bool guides() const { return h_ != nullptr; }
  /// h along the path.
  [[nodiscard]] Guidance& h() const { return *h_; }

  void select_tree(TreeSide side) {
    side_ = side;
    if (h_) h_->select_tree(side);
  }
  /// \param mine  h drew the proposal
  void observe(const Outcome& outcome, bool mine);
  /// The planner removed nodes: those that are left are observed again.
  void restart();
  [[nodiscard]] double progress() const { return progress_ + (h_ ? h_->progress() : 0.0); }
  [[nodiscard]] std::uint64_t epoch() const { return epoch_ + (h_ ? h_->epoch() : 0); }

 private:
  void make();
  void drop();

  const Instance& instance_;
  ReachedNodes nodes_;  ///< of the level
  Configurations path_;
  std::unique_ptr<PathFollower> h_;
  TreeSide side_ = TreeSide::start;
  double progress_ = 0.0;    ///< along the paths before this one
  std::uint64_t epoch_ = 0;  ///< beside h's own
};

}  // namespace trellis
