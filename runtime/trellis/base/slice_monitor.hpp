// SPDX-License-Identifier: GPL-3.0-or-later
// Announcements of what a search spends next, so that the caller of the search can stop it between two slices.
#pragma once

#include <cstdint>
#include <functional>
#include <utility>

namespace trellis {

/// Validity checks, and work in units of search_cost.
struct Spending {
  double checks = 0.0;
  double work = 0.0;  ///< that of the checks included
};

/// What a search spends at most between two questions whether it may continue; a part that costs more is announced as a
/// whole before it begins.
inline constexpr Spending largest_slice{48.0, 128.0};

/// Thrown through a search that may not continue. It ends in the search of the root (strategy/root_search.hpp) or in
/// the executor; guides and planners let it pass, so it is no std::exception.
struct SearchEnded {};

/// Adds up what a search announces, and asks before the sum exceeds a slice.
class SliceMonitor {
 public:
  /// Whether the search may continue.
  /// \param next  announced now, and not yet part of `announced`
  /// \return false: the question cannot be answered now, because a function of a script is running
  /// \throws SearchEnded if the search may not continue
  using Ask = std::function<bool(const Spending& next)>;

  /// What checks cost, in units of search_cost.
  struct CheckRates {
    double on_motion = 1.0;
    double alone = 1.0;
  };

  /// \param rates  of checks that no instance counts
  /// \param proposal  what a proposal costs, in units of search_cost
  SliceMonitor(const CheckRates& rates, double proposal, Ask ask)
      : rates_(rates), proposal_(proposal), ask_(std::move(ask)) {}

  /// Sets what checks cost that are announced from now on; returns what they cost before.
  CheckRates set_rates(const CheckRates& rates) { return std::exchange(rates_, rates); }
  /// Begins a slice: the caller has compared all that was counted so far.
  /// \param uncounted  announced and not counted yet
  void begin(const Spending& uncounted) {
    announced_ = uncounted;
    counted_ = {};
    limit_ = {uncounted.checks + largest_slice.checks, uncounted.work + largest_slice.work};
  }
  /// From now on every announcement asks: the search ends.
  void end() { limit_ = {-1.0, -1.0}; }
  /// Announces checks and work. The search has spent all that it announced before.
  void announce(const Spending& next) {
    if (announced_.checks + next.checks > limit_.checks || announced_.work + next.work > limit_.work) ask(next);
    announced_.checks += next.checks;
    announced_.work += next.work;
  }
  [[nodiscard]] Spending checks(double count, bool on_motion) const {
    return {count, count * (on_motion ? rates_.on_motion : rates_.alone)};
  }
  /// Announces a proposal, which is counted next.
  void announce_proposal() { spend(proposal_); }
  /// Announces work that is no checks.
  void announce_other(double work) { announce({0.0, work}); }
  /// Announces such work, which is counted next.
  void spend(double work) {
    announce({0.0, work});
    counted_.work += work;
  }
  /// What was announced since the last call of `begin`, and what had not been counted then.
  [[nodiscard]] const Spending& announced() const { return announced_; }
  /// Takes back announced checks that were not needed.
  void withdraw(const Spending& unspent) {
    announced_.checks -= unspent.checks;
    announced_.work -= unspent.work;
  }
  /// What was announced less what `spend` and the function below have counted.
  [[nodiscard]] Spending uncounted() const {
    return {announced_.checks - counted_.checks, announced_.work - counted_.work};
  }
  /// Makes what was announced, and not counted, since a call of `uncounted` what is counted now. Asks nothing.
  /// \param before  the result of that call
  void settle(const Spending& before, const Spending& counted) {
    counted_.checks += counted.checks;
    counted_.work += counted.work;
    announced_ = {before.checks + counted_.checks, before.work + counted_.work};
  }

 private:
  void ask(const Spending& next);

  CheckRates rates_;
  double proposal_;
  Ask ask_;
  Spending announced_;
  Spending counted_;                ///< part of `announced_` that was counted one by one
  Spending limit_ = largest_slice;  ///< value of `announced_` beyond which it asks
};

/// Receives what this thread announces; nullptr: announcements have no effect.
extern constinit thread_local SliceMonitor* thread_monitor;

/// While one exists, announcements in this thread reach its monitor. Scopes nest; the innermost counts.
class MonitorScope {
 public:
  /// \param monitor  outlives the scope; nullptr: announcements have no effect
  explicit MonitorScope(SliceMonitor* monitor);
  ~MonitorScope();
  MonitorScope(const MonitorScope&) = delete;
  MonitorScope& operator=(const MonitorScope&) = delete;

 private:
  SliceMonitor* outer_;
};

/// Whether announcements in this thread reach a monitor.
[[nodiscard]] inline bool is_monitored() { return thread_monitor != nullptr; }

/// Announces that this thread makes so many checks at most next, of a motion or of single configurations.
/// \throws SearchEnded if the search may not continue
inline void announce_motion_checks(std::uint32_t most) {
  if (is_monitored()) thread_monitor->announce(thread_monitor->checks(most, true));
}
inline void announce_checks(std::uint32_t most) {
  if (is_monitored()) thread_monitor->announce(thread_monitor->checks(most, false));
}
/// Announces a proposal, which is counted next.
/// \throws SearchEnded if the search may not continue
inline void announce_proposal() {
  if (is_monitored()) thread_monitor->announce_proposal();
}
/// Takes back those that a motion did not need.
inline void withdraw_motion_checks(std::uint32_t unspent) {
  if (is_monitored()) thread_monitor->withdraw(thread_monitor->checks(unspent, true));
}
/// Announces work that is neither checks nor proposals, in units of search_cost.
/// \throws SearchEnded if the search may not continue
inline void announce_work(double work) {
  if (is_monitored()) thread_monitor->announce_other(work);
}

}  // namespace trellis
