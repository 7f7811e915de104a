// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <utility>

#include <trellis/base/slice_monitor.hpp>
#include <trellis/strategy/root_search.hpp>

namespace trellis {

/// The planner of a guided strategy without its guides and sub-goals, on the stream that it has when it runs alone: its
/// proposals and checks are those of the unguided strategy. It runs beside the guided search.
class Companion {
 public:
  Companion(const StrategySpec& strategy, const Problem& problem, Run& beside)
      : search_(begun(run_, beside), StrategySpec(undivided(strategy.planner())), problem) {}

  /// Takes steps until both parts of its cost reach those of `cost`, or until it ends.
  /// \param clock  of the guided search, which stops meanwhile
  void keep_up(const RunCost& cost, Clock& clock) {
    if (search_.ended() || has_reached(cost)) return;
    const MonitorScope unmonitored(nullptr);
    double* guided = clock.switch_to(nullptr);
    if (account_ != nullptr) run_.clock.switch_to(account_);
    while (!search_.ended() && !has_reached(cost)) search_.step();
    account_ = run_.clock.switch_to(nullptr);
    clock.switch_to(guided);
  }
  [[nodiscard]] RunCost cost() const { return run_.ledger.cost(); }
  [[nodiscard]] RootSearch& search() { return search_; }
  [[nodiscard]] Run& run() { return run_; }

 private:
  [[nodiscard]] bool has_reached(const RunCost& cost) const {
    const RunCost own = run_.ledger.cost();
    return own.checks >= cost.checks && own.work >= cost.work;
  }
  static PlannerSpec undivided(const PlannerSpec& planner) {
    return planner.dividing() != nullptr ? undivided(planner.undivided()) : planner;
  }
  static Run& begun(Run& run, Run& beside) {
    run.problem = beside.problem;
    run.seed = beside.seed;
    run.seeded = true;
    run.densities = beside.densities;
    run.helpers = beside.helpers;
    run.companion = true;
    run.ledger.begin_beside(beside.ledger);
    run.watch = beside.watch;
    run.cpu_begin = beside.cpu_begin;
    return run;
  }

  Run run_;
  RootSearch search_;
  double* account_ = nullptr;  ///< of its clock, while the guided search runs
};

}  // namespace trellis
