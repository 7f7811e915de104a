// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <functional>
#include <map>

#include <trellis/instance/instance.hpp>

namespace trellis {

/// Chooses the goal of C to which the lift of a path in S leads. The choice does not depend on the order of the goals.
class GoalChoice {
 public:
  /// f of a configuration.
  using F = std::function<void(View q, MutableView s)>;

  /// Returns the goal of C whose f is nearest to the end of a path in S. Of several, the one chosen for the fewest
  /// refuted paths; of these the nearest to the start, then the first by coordinates.
  /// \param s  the guiding space
  /// \param path  in S; empty: ends everywhere
  [[nodiscard]] const Configuration& choose(const Instance& parent, const F& f, const Space& s,
                                            const Configurations& path);
  /// Whether the goal chosen last replaces another one that f maps to the same place.
  [[nodiscard]] bool replaced() const { return replaced_; }
  /// Counts a refuted path to the goal chosen last.
  void refute() { ++refuted_[last_]; }

 private:
  std::map<Configuration, std::uint64_t> refuted_;  ///< number of refuted paths to a goal
  Configuration last_;
  Configuration place_;  ///< f of the goal chosen last
  bool replaced_ = false;
};

/// Returns the goal of C where a path in S ends that has the coordinates of C; the path's end itself if no goal is
/// within the goal tolerance of it.
Configuration goal_at_end(const Instance& parent, View end);

}  // namespace trellis
