// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <memory>
#include <utility>

#include <trellis/guide/path_guide.hpp>

namespace trellis {

/// A path that the search of another space found, mapped to a level's space. The level's search follows it until it is
/// refuted: a tree in steps, a roadmap or graph through proposals along the whole path.
class InformedPath {
 public:
  /// \param instance  of the level; outlives this object
  explicit InformedPath(const Instance& instance) : instance_(instance) {}

  /// Records the level's nodes from now on, so that a path can be followed from the current state of the search. Called
  /// before the search begins.
  void expect() {
    if (!nodes_.begun()) nodes_.begin(instance_.space, instance_.start, instance_.goals);
  }
  /// Replaces the path to follow; an empty path ends following.
  void follow(Configurations path);
  /// Whether there is a path to follow. If not, nothing may be drawn.
  [[nodiscard]] bool guides() const { return h_ != nullptr; }
  /// h along the path.
  [[nodiscard]] Guidance& h() const { return *h_; }

  void select_tree(TreeSide side) {
    side_ = side;
    if (h_) h_->select_tree(side);
  }
  /// \param mine  whether h drew the proposal
  void observe(const Outcome& outcome, bool mine);
  /// Called when the planner removed nodes. The remaining nodes are then observed again.
  void restart();
  [[nodiscard]] double progress() const { return progress_ + (h_ ? h_->progress() : 0.0); }
  [[nodiscard]] std::uint64_t epoch() const { return epoch_ + (h_ ? h_->epoch() : 0); }

 private:
  void make();
  void drop();

  const Instance& instance_;
  ReachedNodes nodes_;  ///< nodes of the level
  Configurations path_;
  std::unique_ptr<PathFollower> h_;
  TreeSide side_ = TreeSide::start;
  double progress_ = 0.0;    ///< along earlier paths
  std::uint64_t epoch_ = 0;  ///< without that of h
};

}  // namespace trellis
