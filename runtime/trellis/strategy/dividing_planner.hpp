// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>

#include <trellis/planner/planner.hpp>
#include <trellis/strategy/searched_guidance.hpp>

namespace trellis {

class Level;

/// A planner that divides its instance into parts, as halves, or robots of a team. The search of each is a level below
/// its own. Where a step needs one, the level of the planner advances it before the step ends.
class DividingPlanner : public Planner {
 public:
  using Planner::Planner;

  /// A search that the present step continues.
  struct Part {
    Level* level = nullptr;  ///< none: the step has ended
    Grant grant = {};        ///< of that search
  };
  /// The next part to search in the present step.
  [[nodiscard]] virtual Part part() = 0;
  /// Takes what that search has come to.
  /// \return the status if the solve ends; none if it continues
  virtual std::optional<Status> take(Advance advance) = 0;
  /// Called when SearchEnded has left that search.
  virtual void leave() {}
};

}  // namespace trellis
