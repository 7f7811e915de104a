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

/// Thrown through a search that may not continue. Only the executor catches it, so it is no std::exception.
struct SearchEnded {};

/// Adds up what a search announces, and asks before the sum exceeds a slice.
class SliceMonitor {
 public:
  /// Whether the search may continue.
  /// \param announced  since the last call of `begin`, without `next`
  /// \param next  announced now
  /// \return false: the question cannot be answered now, because a function of a script is running
  /// \throws SearchEnded if the search may not continue
  using Ask = std::function<bool(const Spending& announced, const Spending& next)>;

  /// \param motion_check, check_alone  the work of a validity check
  SliceMonitor(double motion_check, double check_alone, Ask ask)
      : motion_check_(motion_check), check_alone_(check_alone), ask_(std::move(ask)) {}

  /// Begins a slice: the caller has compared all that was spent so far.
  void begin() {
    announced_ = {};
    limit_ = largest_slice;
  }
  /// From now on every announcement asks: the search ends.
  void end() { limit_ = {-1.0, -1.0}; }
  /// Announces checks and work. The search has spent all that it announced before.
  void announce(const Spending& next);
  [[nodiscard]] Spending checks(double count, bool on_motion) const {
    return {count, count * (on_motion ? motion_check_ : check_alone_)};
  }
  /// Announces work that is no checks.
  void announce_other(double work) {
    announce({0.0, work});
    other_ += work;
  }
  /// All such work that was announced so far.
  [[nodiscard]] double other() const { return other_; }
  /// Takes back announced checks that were not needed.
  void withdraw(const Spending& unspent) {
    announced_.checks -= unspent.checks;
    announced_.work -= unspent.work;
  }

 private:
  double motion_check_;
  double check_alone_;
  Ask ask_;
  Spending announced_;
  double other_ = 0.0;
  Spending limit_ = largest_slice;  ///< value of `announced_` beyond which it asks
};

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

/// Announces that this thread makes so many checks at most next, of a motion or of single configurations.
/// \throws SearchEnded if the search may not continue
void announce_motion_checks(std::uint32_t most);
void announce_checks(std::uint32_t most);
/// Takes back those that a motion did not need.
void withdraw_motion_checks(std::uint32_t unspent);
/// Announces work that is neither checks nor proposals, in units of search_cost.
/// \throws SearchEnded if the search may not continue
void announce_work(double work);

}  // namespace trellis
