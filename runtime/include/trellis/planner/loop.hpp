// SPDX-License-Identifier: GPL-3.0-or-later
// The planning loop, and what planners share: budgets, the record of a proposal, and the options of every planner.
#pragma once

#include <chrono>
#include <functional>
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
template <class S>
PlannerCommon common_of(const S& settings) {
  PlannerCommon common = settings.common();
  if constexpr (requires { settings.step; }) common.step = settings.step;
  return common;
}

/// Adds the options of every planner to those of one: goal_bias, uniform, bound, queries and the budgets.
/// \tparam S  derives from CommonSettings
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

/// Compares a budget with what a level has spent, during one solve.
class BudgetMonitor {
 public:
  /// \param stopped  the seconds that the run has waited so far, which do not count; nullptr: none
  BudgetMonitor(const Instance& instance, const Search& search, const Budget& budget, const double* stopped = nullptr)
      : instance_(instance),
        search_(search),
        budget_(budget),
        stopped_(stopped),
        begin_(std::chrono::steady_clock::now()),
        stopped_before_(stopped != nullptr ? *stopped : 0.0) {}

  /// Whether the budget is spent. Its cost permits a call before every step.
  /// \param draws  whether the limit of proposals applies
  [[nodiscard]] bool reached(bool draws) {
    if (draws && static_cast<double>(search_.proposals.size()) >= budget_.proposals) return true;
    if (static_cast<double>(instance_.checks.validity) >= budget_.checks) return true;
    // Reading the clock costs more.
    if ((asked_++ & 63U) != 0 || budget_.seconds == Budget::unlimited) return false;
    const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - begin_;
    const double waited = stopped_ != nullptr ? *stopped_ - stopped_before_ : 0.0;
    return search_.seconds + elapsed.count() - waited >= budget_.seconds;
  }

 private:
  const Instance& instance_;
  const Search& search_;
  Budget budget_;
  const double* stopped_;
  std::chrono::steady_clock::time_point begin_;
  double stopped_before_;
  unsigned asked_ = 0;
};

/// What an executor does in the loop of a planner.
struct StepHooks {
  std::function<bool()> interrupted = {};  ///< polled before every step; true ends the loop with Status::interrupted
  /// Called before every step: prepares h, which may search other levels. Returns a status that ends the loop, as
  /// Status::paused, or none.
  std::function<std::optional<Status>()> prepare = {};
  const double* stopped = nullptr;  ///< see BudgetMonitor
};

/// Returns the path that contains only the start: the solution of a search whose goal is invalid.
inline Configurations path_of_start(const Instance& instance) {
  Configurations path(instance.space.dimension());
  path.push(instance.start);
  return path;
}

/// The planning loop, one step at a time: lets a planner take steps until it ends or a limit is reached.
class StepLoop {
 public:
  /// Begins a solve. The referenced objects outlive the loop.
  /// \param instance  of the planner
  /// \param search  of the planner
  StepLoop(Planner& planner, const Instance& instance, const Search& search, const Budget& budget, StepHooks hooks = {})
      : planner_(planner),
        instance_(instance),
        hooks_(std::move(hooks)),
        monitor_(instance, search, budget, hooks_.stopped),
        ended_(planner.begin(budget)) {}

  /// Whether the solve has ended: then there is no further step.
  [[nodiscard]] bool ended() const { return ended_.has_value(); }
  /// Compares the limits, then lets the planner take a step.
  void step() {
    const std::optional<Status> reached = limit();
    ended_ = reached ? planner_.stopped(*reached) : planner_.step();
  }
  /// The solution of a solve that has ended.
  /// \param keeps_path  whether an interrupted search of an anytime planner is solved by the path that it has
  [[nodiscard]] Solution solution(bool keeps_path = false) {
    if (*ended_ == Status::invalid_start) return {*ended_, Configurations(instance_.space.dimension())};
    if (*ended_ == Status::invalid_goal) return {*ended_, path_of_start(instance_)};
    if (keeps_path && *ended_ == Status::interrupted) {
      Solution best = planner_.solution(Status::budget_spent);
      if (!best.solved()) best.status = Status::interrupted;
      return best;
    }
    return planner_.solution(*ended_);
  }

 private:
  std::optional<Status> limit() {
    if (monitor_.reached(planner_.draws())) return Status::budget_spent;
    if (hooks_.interrupted && hooks_.interrupted()) return Status::interrupted;
    return hooks_.prepare ? hooks_.prepare() : std::nullopt;
  }

  Planner& planner_;
  const Instance& instance_;
  StepHooks hooks_;
  BudgetMonitor monitor_;
  std::optional<Status> ended_;
};

/// Runs the planning loop to its end, in the thread that calls.
/// \param instance  of the planner
/// \param search  of the planner
/// \throws Error and what the instance's validity, the guidance and `hooks` throw
inline Solution run_steps(Planner& planner, const Instance& instance, const Search& search, const Budget& budget,
                          const StepHooks& hooks = {}) {
  StepLoop loop(planner, instance, search, budget, hooks);
  while (!loop.ended()) loop.step();
  return loop.solution();
}

/// Draws a proposal into `q` and records it together with the current distribution. Its result is recorded after the
/// extension, by the function below.
inline void propose(PlannerContext& context, MutableView q) {
  Instance::announce_proposal();
  const Guidance::Source source = context.guidance.sample(context.proposals, q);
  context.search.density.served(context.guidance);
  context.search.proposals.push(q);
  context.search.proposal_sources.push_back(source);
}

/// Records the result of the last proposal and reports it to the guidance.
/// \param near  row of the node that was extended
/// \param added  row of the node that was added
inline void record_outcome(PlannerContext& context, Outcome outcome, std::uint32_t near = no_node,
                           std::uint32_t added = no_node) {
  context.search.fates.push_back(outcome.fate);
  context.search.near.push_back(near);
  context.search.added.push_back(added);
  outcome.added_row = added;
  outcome.near_row = near;
  context.guidance.observe(outcome, true);
}

/// Motions found invalid while the planner inserted a node. The guidance receives them after the result of the proposal
/// itself.
class BlockedMotions {
 public:
  explicit BlockedMotions(std::size_t dimension) : from_(dimension), to_(dimension), at_(dimension) {}

  /// Adds a motion.
  /// \param t  position of the first invalid configuration on the motion, in [0, 1]
  void add(const Space& space, View from, View to, double t) {
    Configuration at(from.size());
    space.interpolate(from, to, t, at);
    from_.push(from);
    to_.push(to);
    at_.push(at);
  }
  /// Reports all motions to the guidance as outcomes without a proposal, then clears the list.
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
