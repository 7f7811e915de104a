// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>

#include <trellis/base/slice_monitor.hpp>
#include <trellis/scene/scene.hpp>
#include <trellis/strategy/executor.hpp>
#include <trellis/strategy/spec.hpp>

namespace trellis {

class Companion;
struct Run;

/// CPU time of the calling thread, seconds.
double thread_seconds();

/// Whether a time has passed. Reads the clock at one of eight calls where those follow each other within microseconds:
/// reading it takes 3 % of the time of an arm's steps.
class Deadline {
 public:
  explicit Deadline(double seconds) : seconds_(seconds) {}
  /// \param elapsed  returns the seconds so far
  template <class Elapsed>
  bool passed(const Elapsed& elapsed) {
    if (skipped_ > 0) {
      --skipped_;
      return false;
    }
    constexpr int every = 8;
    constexpr double short_time = 1e-4;
    const double now = elapsed();
    if (now >= seconds_) return true;
    if (now - last_ < short_time) skipped_ = every - 1;
    last_ = now;
    return false;
  }

 private:
  double seconds_;
  double last_ = -1.0;
  int skipped_ = 0;
};

/// What a run has spent, and what ends it: the caller, limits, its time, and bounded loss. By that the planner without
/// guides, the companion, runs beside the guided search, which continues only as far as the companion keeps up.
class RunLedger {
 public:
  /// \param run  that it is a part of
  explicit RunLedger(Run& run) : run_(run) {}
  RunLedger(const RunLedger&) = delete;
  RunLedger& operator=(const RunLedger&) = delete;

  /// Begins the time of the run.
  /// \param options  outlive this object
  void begin(const ExecuteOptions& options);
  /// Begins the run of a companion, which ends when the guided one does.
  void begin_beside(RunLedger& guided);
  /// Ends the run after so many seconds.
  void limit_time(double seconds) { deadline_.emplace(seconds); }
  /// Bounds the loss.
  /// \param bound  above 1
  /// \param set_up  estimated work of setting up the guides
  void rely_on(Companion& companion, double bound, double set_up);
  /// Runs that share what is set up for the world.
  void share_set_up(double queries) { queries_ = queries; }

  /// Whether the caller, or a limit of checks or work, ends the run.
  [[nodiscard]] bool interrupted() const { return guided_ != nullptr ? guided_->interrupted() : limits_reached(); }
  /// Whether the time of the run is over.
  [[nodiscard]] bool out_of_time();
  /// Called before each step of each level. Lets the companion keep up, and returns whether it ends the run.
  [[nodiscard]] bool companion_ends_run();
  /// Whether it has ended the run.
  [[nodiscard]] bool ending() const { return ending_; }

  /// Seconds since the beginning of the run, without those in which it waited.
  [[nodiscard]] double elapsed() const;
  /// Adds seconds in which the run waited between two steps.
  void wait(double seconds) { waited_ += seconds; }
  [[nodiscard]] const double& waited() const { return waited_; }

  /// Called when the search of a level below another one begins or continues.
  void begin_search() { ++searches_; }
  [[nodiscard]] std::uint64_t searches() const { return searches_; }

  /// Counts the set-up of a guide's space. What depends on the world alone counts once in a run, with one part in
  /// `queries`.
  void count_set_up(const GuideSpec& guide, const Scene& scene);
  /// The same where f is applied again. What depends on a world that changed during this run counts with all of it: no
  /// other run asks it. Returns false, and counts nothing, where the run ends before.
  bool count_further_set_up(const GuideSpec& guide, const Scene& scene);
  /// Sets up the guides, while their estimated work is allowed.
  /// \return whether the set-up ended
  template <class SetUp>
  bool set_up(const SetUp& make);
  /// Lets the companion do as much work as the set-up costs.
  /// \return whether the guides may be set up: not if the companion or the run has ended before
  [[nodiscard]] bool companion_goes_first();
  [[nodiscard]] bool guides_set_up() const { return is_set_up_; }
  /// Work of setting up guides, where they were set up; else as estimated.
  [[nodiscard]] double set_up_work() const { return is_set_up_ ? set_up_ : estimated_; }
  [[nodiscard]] double queries() const { return queries_; }
  /// Seconds of the set-up.
  [[nodiscard]] double set_up_seconds() const { return set_up_seconds_; }

  /// Of all levels.
  [[nodiscard]] RunCost cost() const;
  /// Of all levels and those of the companion.
  [[nodiscard]] RunCost total() const;
  /// Called when the guided search has ended: counts what it had spent when it was ended within a step.
  void end_search();
  /// The monitor of the guided search; nullptr without a companion.
  [[nodiscard]] SliceMonitor* monitor() { return monitor_ ? &*monitor_ : nullptr; }
  [[nodiscard]] const RunCost& largest_step() const { return largest_step_; }

 private:
  [[nodiscard]] bool limits_reached() const;
  /// Counts set-up work, and announces it as far as the estimate has not announced it.
  void count_set_up(double work);
  void begin_set_up();
  /// The cost that the companion must have had before the guided search, which has cost so much, continues.
  [[nodiscard]] RunCost wanted(const RunCost& guided) const;
  /// Whether the companion has ended, and with a path or before the guided search may continue.
  [[nodiscard]] bool companion_decides(const RunCost& guided) const;
  /// Lets the companion catch up with the guided search, as if that had spent `more` already. Returns whether the run
  /// ends.
  /// \param guided  cost of the guided search
  bool companion_ends_run_before(const RunCost& more, const RunCost& guided);
  /// Called within a step, before the guided search spends more than a slice (SliceMonitor::Ask).
  bool ask(const Spending& next);
  /// What the guided search has announced and not counted: a guide may count its checks after several of them.
  /// \param guided  its cost so far
  [[nodiscard]] RunCost announced_only(const RunCost& guided) const;
  /// Notes what the guided search has spent beyond what the companion allows.
  void note_step(const RunCost& guided);

  Run& run_;
  const ExecuteOptions* options_ = nullptr;
  RunLedger* guided_ = nullptr;  ///< of the run that this one, a companion's, is beside
  std::chrono::steady_clock::time_point begin_;
  std::optional<Deadline> deadline_;
  double waited_ = 0.0;
  std::uint64_t searches_ = 0;
  // Set-up:
  double queries_ = 1.0;
  double set_up_ = 0.0;       ///< counted so far
  double estimated_ = 0.0;    ///< of all guides
  double announced_ = 0.0;    ///< the estimate has announced `set_up_` up to this value
  double unannounced_ = 0.0;  ///< part of `set_up_` that was not announced when it was counted
  bool is_set_up_ = false;
  double set_up_seconds_ = 0.0;
  std::set<std::pair<std::string, std::shared_ptr<const void>>> prepared_;  ///< guides and their worlds
  // Beside a companion:
  Companion* companion_ = nullptr;
  double bound_ = 0.0;
  bool ending_ = false;
  std::optional<SliceMonitor> monitor_;
  RunCost guided_before_;              ///< of the guided search when it was noted last
  RunCost allowed_;                    ///< cost of the guided search that the companion has kept up with
  RunCost slice_begun_;                ///< cost of the guided search when the monitor began a slice
  double unannounced_at_slice_ = 0.0;  ///< `unannounced_` then
  RunCost uncounted_;                  ///< of the guided search when it was ended within a step
  RunCost largest_step_;
};

template <class SetUp>
bool RunLedger::set_up(const SetUp& make) {
  const double before = elapsed();
  begin_set_up();
  {
    const MonitorScope monitored(monitor());
    is_set_up_ = make();
  }
  announced_ = 0.0;
  set_up_seconds_ = elapsed() - before;
  return is_set_up_;
}

}  // namespace trellis
