// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/guide/goal_choice.hpp>

#include <limits>
#include <tuple>
#include <utility>

namespace trellis {

const Configuration& GoalChoice::choose(const Instance& parent, const F& f, const Space& s,
                                        const Configurations& path) {
  const Configuration* best = &parent.goal();
  Configuration place;
  if (parent.goals.size() > 1) {
    Configuration projected(s.dimension());
    std::tuple<double, std::uint64_t, double> least{std::numeric_limits<double>::infinity(), 0, 0.0};
    for (const Configuration& goal : parent.goals) {
      f(goal, projected);
      const auto refuted = refuted_.find(goal);
      const std::tuple here{path.empty() ? 0.0 : s.distance(projected, path.back()),
                            refuted == refuted_.end() ? 0 : refuted->second, parent.space.distance(parent.start, goal)};
      if (here < least || (here == least && goal < *best)) {
        least = here;
        best = &goal;
        place = projected;
      }
    }
  }
  replaced_ = !last_.empty() && last_ != *best && place_ == place;
  last_ = *best;
  place_ = std::move(place);
  return *best;
}

Configuration goal_at_end(const Instance& parent, View end) {
  const Instance::NearGoal nearest = parent.nearest_goal(end);
  if (parent.goals.size() == 1 || nearest.distance <= parent.goal_tolerance) return parent.goals[nearest.goal];
  return {end.begin(), end.end()};
}

}  // namespace trellis
