// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <queue>
#include <string>
#include <tuple>
#include <unordered_map>
#include <vector>

#include <trellis/instance/instance.hpp>

namespace trellis {

/// The search of when to move along given paths: for a path from the start to the goal of an instance whose coordinates
/// are metres along paths (TeamSpace), on a grid of `cells` steps of each, by greedy best-first search. A step moves
/// all groups that have not arrived, or one, forwards or back. The instance counts the checks.
class ScheduleSearch {
 public:
  /// \param paths  outlives the search
  /// \param cells  at most 127
  ScheduleSearch(Instance& paths, std::size_t cells);

  /// Whether every place that can be reached was expanded: the grid has no path, unless one was found.
  [[nodiscard]] bool exhausted() const { return open_.empty(); }
  [[nodiscard]] std::size_t expanded() const { return expanded_; }
  /// Expands one place. Requires that it is not exhausted.
  /// \return the path, if this finds it
  std::optional<Configurations> expand();

 private:
  /// How many cells each group has moved.
  using Place = std::string;
  /// The cells that are left, the number of the entry from the end, and the place.
  using Entry = std::tuple<std::size_t, std::size_t, Place>;

  [[nodiscard]] Configuration at(const Place& place) const;
  void reach(const Place& from, const Configuration& at_from, const Place& next);

  Instance& paths_;
  std::size_t cells_;
  Place start_;
  Place goal_;
  std::unordered_map<Place, Place> reached_from_;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> open_;
  std::size_t added_ = 0;
  std::size_t expanded_ = 0;
};

}  // namespace trellis
