// SPDX-License-Identifier: GPL-3.0-or-later
// What planners share: the options of every planner, and parts of their steps.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <trellis/planner/planner.hpp>

namespace trellis {

/// The options of every planner. `with_common` describes each field.
struct CommonSettings {
  double goal_bias = 0.05;
  double uniform = 0.05;
  double bound = PlannerCommon().bound;
  double queries = PlannerCommon().queries;
  double proposals = 50000;
  double checks = Budget::unlimited;
  double seconds = Budget::unlimited;

  /// The options that the planner's level reads.
  [[nodiscard]] PlannerCommon common() const {
    PlannerCommon result;
    result.budget.proposals = proposals;
    result.budget.checks = checks;
    result.budget.seconds = seconds;
    result.uniform = uniform;
    result.goal_bias = goal_bias;
    result.bound = bound;
    result.queries = queries;
    return result;
  }
};

/// The options of every planner, and `step` if the planner has one.
/// \param settings  validated options, read by Settings::read
template <class S>
PlannerCommon common_of(const S& settings) {
  PlannerCommon common = settings.common();
  if constexpr (requires { settings.step; }) common.step = settings.step;
  return common;
}

/// Adds the options of every planner to those of one: goal_bias, uniform, bound, queries and the budgets.
/// \tparam S  derives from CommonSettings
/// \param settings  without these options
/// \return the settings, to which the planner's own options may be added
template <class S>
Settings<S> with_common(Settings<S> settings) {
  settings.number("goal_bias", &S::goal_bias, "share of proposals", Range::share(),
                  "share of proposals that are the goal itself");
  settings.number("uniform", &S::uniform, "share of proposals", Range::share(),
                  "share of uniform proposals kept (of those that are not the goal) when the level is guided; with 0 "
                  "completeness rests on the guide alone");
  settings.number("bound", &S::bound, "factor", Range::zero_or_above(1.0),
                  "of a guided planner at the root: a run costs at most so many times what this planner costs without "
                  "guides on the same seed, plus 864 validity checks (of work 1400 units). The planner "
                  "runs beside its guided search, and the first path ends the run. Below the root it limits guided "
                  "work: that of guided proposals and of the levels below is at most 0.8 (bound - 1) times that of "
                  "unguided proposals, beyond a grant for what a straight path costs to check and for progress along "
                  "a guiding path. 0: no limit");
  settings.number(
      "queries", &S::queries, "runs", Range::at_least(1),
      "of a guided planner at the root with a bound: runs in this world that share what is set up for the "
      "world alone, as its medial axis, by assumption; a run counts one part of that work. 1 for a single query: "
      "each run computes all of it anew");
  // Nodes have 32-bit numbers.
  settings.number("proposals", &S::proposals, "proposals", Range{.lo = 1, .hi = 1e9},
                  "budget: proposals of this level, over all its solves");
  settings.number("checks", &S::checks, "validity checks", Range::at_least(1),
                  "budget: validity checks of this level, over all its solves");
  settings.number("seconds", &S::seconds, "s", Range::positive(),
                  "budget: wall-clock time of this level, over all its solves; at the root, of the run: set-up, the "
                  "levels below and the planner beside them included. It is read between steps. A run that it ends "
                  "does not repeat");
  return settings;
}

/// Returns the path that contains only the start: the solution of a search whose goal is invalid.
/// \param instance  whose start is valid
inline Configurations path_of_start(const Instance& instance) {
  Configurations path(instance.space.dimension());
  path.push(instance.start);
  return path;
}

/// Motions found invalid while the planner inserted a node. The guidance receives them after the result of the proposal
/// itself.
class BlockedMotions {
 public:
  /// \param dimension  of the instance's space
  explicit BlockedMotions(std::size_t dimension) : from_(dimension), to_(dimension), at_(dimension) {}

  /// Adds a motion.
  /// \param space  of the instance
  /// \param from  valid end of the motion, copied
  /// \param to  other end of the motion, copied
  /// \param t  position of the first invalid configuration on the motion, in [0, 1]
  void add(const Space& space, View from, View to, double t) {
    Configuration at(from.size());
    space.interpolate(from, to, t, at);
    from_.push(from);
    to_.push(to);
    at_.push(at);
  }
  /// Reports all motions to the guidance as outcomes without a proposal, then clears the list.
  /// \param context  of the planner
  void report(PlannerContext& context) {
    for (std::size_t i = 0; i < at_.size(); ++i) {
      Outcome outcome;
      outcome.proposal = std::as_const(to_)[i];
      outcome.near = std::as_const(from_)[i];
      outcome.blocked_at = std::as_const(at_)[i];
      context.guidance.observe(outcome, false);
    }
    from_.clear();
    to_.clear();
    at_.clear();
  }

 private:
  Configurations from_;
  Configurations to_;
  Configurations at_;
};

/// Computes the end of an extension from `from` towards q.
/// \param space  of the instance
/// \param from  a node; it must not be a view of `target`
/// \param q  the proposal; it must not be a view of `target`
/// \param distance  from `from` to q, in metres in the metric
/// \param step  longest extension, in metres in the metric
/// \param target  receives the end
/// \return whether the end is q
inline bool steer(const Space& space, View from, View q, double distance, double step, Configuration& target) {
  // A configuration constructed at distance `step` counts as within `step` despite rounding.
  constexpr double rounding = 1e-6;
  if (distance <= (1.0 + rounding) * step) {
    target.assign(q.begin(), q.end());
    return true;
  }
  space.interpolate(from, q, step / distance, target);
  return false;
}

/// Checks the start, and removes the goals that are invalid; where all are, it keeps them.
/// \param instance  its goals are changed; each checked configuration is counted
/// \return none if the search can begin; else the reason
inline std::optional<Status> remove_invalid_goals(Instance& instance) {
  if (!instance.space.contains(instance.start) || !instance.valid(instance.start)) return Status::invalid_start;
  std::vector<Configuration> valid;
  for (const Configuration& q : instance.goals) {
    if (instance.space.contains(q) && instance.valid(q)) valid.push_back(q);
  }
  if (valid.empty()) return Status::invalid_goal;
  instance.goals = std::move(valid);
  return std::nullopt;
}

}  // namespace trellis
