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

  /// Work in units of search_cost.
  struct Rates {
    double motion_check = 1.0;
    double check_alone = 1.0;
    double proposal = 1.0;
  };

  SliceMonitor(const Rates& rates, Ask ask) : rates_(rates), ask_(std::move(ask)) {}

  /// Begins a slice: the caller has compared all that was spent so far.
  void begin() {
    announced_ = {};
    limit_ = largest_slice;
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
    return {count, count * (on_motion ? rates_.motion_check : rates_.check_alone)};
  }
  void announce_proposal() { announce({0.0, rates_.proposal}); }
  /// Announces work that is no checks.
  void announce_other(double work) {
    announce({0.0, work});
    other_ += work;
  }
  /// All that was announced since the last call of `begin`.
  [[nodiscard]] const Spending& announced() const { return announced_; }
  /// All such work that was announced so far.
  [[nodiscard]] double other() const { return other_; }
  /// Takes back announced checks that were not needed.
  void withdraw(const Spending& unspent) {
    announced_.checks -= unspent.checks;
    announced_.work -= unspent.work;
  }

 private:
  void ask(const Spending& next);

  Rates rates_;
  Ask ask_;
  Spending announced_;
  double other_ = 0.0;
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
/// The number of checks that this thread's monitor has received; negative if it has none.
[[nodiscard]] inline double announced_checks() { return is_monitored() ? thread_monitor->announced().checks : -1.0; }
/// Announces those of counted checks that were not announced, as that of a configuration beyond the limits of a space.
/// \param before  value of announced_checks() before these checks; without effect if negative
/// \throws SearchEnded if the search may not continue
inline void announce_rest(double before, double counted) {
  if (before < 0.0 || !is_monitored()) return;
  const double rest = counted - (thread_monitor->announced().checks - before);
  if (rest > 0.0) thread_monitor->announce(thread_monitor->checks(rest, false));
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
