// SPDX-License-Identifier: GPL-3.0-or-later
// The nodes of the planner in C, for guides that ask what it has reached.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include <trellis/base/configurations.hpp>
#include <trellis/space/nearest.hpp>
#include <trellis/space/space.hpp>

namespace trellis {

/// The nodes of one tree, with nearest neighbours. A guide receives every node and asks seldom, so nodes enter the
/// index at the next question. A planner whose tree lost branches reports the remaining nodes again, in their order:
/// these stay in the index. Use by one thread at a time.
class ReachedIndex {
 public:
  /// \param space  of the nodes
  /// \param root  the first node, which stays
  ReachedIndex(Space space, View root)
      : ReachedIndex(std::move(space), std::vector<Configuration>(1, Configuration(root.begin(), root.end()))) {}
  /// \param roots  the first nodes, at least one, which stay
  ReachedIndex(Space space, std::vector<Configuration> roots)
      : space_(std::move(space)), roots_(std::move(roots)), indexed_(space_.dimension()), waiting_(space_.dimension()) {
    for (const Configuration& root : roots_) add(root);
  }

  void add(View q) {
    ++size_;
    for (; waiting_.empty() && next_ < indexed_.size(); ++next_) {
      if (!std::ranges::equal(std::as_const(indexed_)[next_], q)) continue;
      keep_[next_++] = 1;
      return;
    }
    waiting_.push(q);
  }
  /// Removes all nodes except the roots.
  void clear() {
    keep_.assign(indexed_.size(), 0);
    next_ = 0;
    waiting_.clear();
    size_ = 0;
    for (const Configuration& root : roots_) add(root);
  }
  /// The number of nodes, at least 1.
  [[nodiscard]] std::size_t size() const { return size_; }
  /// Whether there are nodes besides the roots.
  [[nodiscard]] bool grown() const { return size_ > roots_.size(); }
  /// The squared distance to the nearest node, in square metres in the metric.
  [[nodiscard]] double squared_distance(View q) const {
    update();
    return index_->nearest(q).squared_distance;
  }

 private:
  void update() const {
    if (!index_) index_.emplace(space_);
    if (!keep_.empty()) {
      index_->retain(keep_);
      Configurations kept(space_.dimension());
      for (std::size_t i = 0; i < keep_.size(); ++i) {
        if (keep_[i] != 0) kept.push(std::as_const(indexed_)[i]);
      }
      indexed_ = std::move(kept);
      keep_.clear();
    }
    for (std::size_t i = 0; i < waiting_.size(); ++i) {
      index_->add(std::as_const(waiting_)[i]);
      indexed_.push(std::as_const(waiting_)[i]);
    }
    waiting_.clear();
    next_ = indexed_.size();
  }

  Space space_;
  std::vector<Configuration> roots_;
  std::size_t size_ = 0;
  mutable std::optional<NearestIndex> index_;
  mutable Configurations indexed_;          ///< the points of the index, in order
  mutable Configurations waiting_;          ///< nodes that the index lacks, in order
  mutable std::vector<std::uint8_t> keep_;  ///< since `clear`: for each point of the index, whether it was added again
  mutable std::size_t next_ = 0;            ///< since `clear`: the points before this one were compared
};

/// The nodes of a planner's trees, or of its roadmap.
class ReachedNodes {
 public:
  /// \param space  of the nodes
  /// \param goals  at least one
  void begin(const Space& space, View start, const std::vector<Configuration>& goals) {
    trees_.clear();
    trees_.emplace_back(space, start);
    trees_.emplace_back(space, goals);
  }
  /// Adds a node that is connected to its tree's root.
  void add(View q, bool from_goal) {
    if (!trees_.empty()) trees_[from_goal ? 1 : 0].add(q);
  }
  /// Removes all nodes except the roots.
  void clear() {
    for (ReachedIndex& tree : trees_) tree.clear();
  }
  [[nodiscard]] bool begun() const { return !trees_.empty(); }
  [[nodiscard]] const ReachedIndex& from_start() const { return trees_[0]; }
  [[nodiscard]] std::array<const ReachedIndex*, 2> both() const { return {&trees_.front(), &trees_.back()}; }

 private:
  std::vector<ReachedIndex> trees_;  ///< from the start, and from the goals
};

}  // namespace trellis
