// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include <trellis/guide/custom.hpp>
#include <trellis/strategy/executor.hpp>
#include <trellis/strategy/run_ledger.hpp>

namespace trellis {

class Level;

/// Charges wall-clock time to the running level. While it waits for a level below, only that level is charged.
class Clock {
 public:
  /// Switches to `account` and returns the previous account, to switch back to.
  double* switch_to(double* account) {
    const auto now = std::chrono::steady_clock::now();
    if (account_ != nullptr) *account_ += std::chrono::duration<double>(now - since_).count();
    since_ = now;
    return std::exchange(account_, account);
  }

 private:
  double* account_ = nullptr;
  std::chrono::steady_clock::time_point since_;
};

/// State that all levels of one run share.
struct Run {
  std::string problem;  ///< name of the problem
  std::uint64_t seed = 0;
  bool seeded = false;               ///< false if the strategy is only checked, not run
  bool densities = true;             ///< whether levels record the densities of their proposals
  HelperThreads* helpers = nullptr;  ///< of the searches; nullptr: none
  /// Called with each proposal (ExecuteOptions); nullptr: nothing is.
  const std::function<void(const LevelRecord&, const Guidance&)>* watch = nullptr;
  Clock clock;
  std::vector<Level*> levels;  ///< in order of their numbers
  std::vector<Turn> turns;
  Level* active_level = nullptr;
  int first_solves = 0;                   ///< number of levels whose first solve has ended
  double cpu_begin = 0.0;                 ///< CPU time of the thread at the beginning of the run, seconds
  double lua_begin = 0.0;                 ///< lua_seconds() of the thread at the beginning of the run
  unsigned lua_depth = 0;                 ///< lua_depth() of the thread at the beginning of the run
  std::vector<Improvement> improvements;  ///< of the root's path
  std::vector<TeamConflict> conflicts;
  bool refuted = false;  ///< its last path was refuted, and no other one is known yet
  RunShared shared;
  bool companion = false;        ///< it runs beside another run: its levels have the number -1
  bool abandons_levels = false;  ///< a level that ends now was not completed
  RunLedger ledger{*this};

  Run() = default;
  Run(const Run&) = delete;
  Run& operator=(const Run&) = delete;

  /// Ends the searches of all levels, after SearchEnded was thrown through them.
  void leave_searches();
  /// Removes a level that was not completed. The root counts its checks from now on.
  void abandon(Level& level);
};

}  // namespace trellis
