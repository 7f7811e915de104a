// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include <trellis/instance/instance.hpp>
#include <trellis/planner/step.hpp>
#include <trellis/strategy/executor.hpp>
#include <trellis/strategy/searched_guidance.hpp>

namespace trellis {

class LevelHeuristic;
struct Run;

/// What a level has spent, and what it may spend: the budget of its planner, the slice that the level above grants, the
/// end of the run, and the share of guided proposals and of the levels below.
///
/// Work is the number of validity checks and proposals, and what searches of graphs do besides. The work of guided
/// proposals and of all levels below is at most `guided_share` times the work of unguided proposals, beyond a grant and
/// beyond the work earned by progress along guiding paths. Of the work below, what progress there has earned is
/// deducted as far as guides have spent it, and the first search of a graph does not count. If this limit is reached,
/// or if the guide's space is still being searched, the planner draws unguided proposals.
///
/// Beside a companion (at the root, with a bound of more than 1) the planner waits for the levels below. Their work
/// does not count, nor does the validation of their paths: the companion bounds it. The planner of a tree without a
/// path draws unguided proposals beyond the same limit, so that the tree leaves a place where its guide is stuck.
class Ledger {
 public:
  /// Work of one kind of proposals.
  struct Spent {
    double checks = 0.0;
    double proposals = 0.0;
    double other = 0.0;
    [[nodiscard]] double work() const { return checks + proposals + other; }
  };
  struct BothSpent {
    Spent guided;  ///< includes the validation of guiding paths
    Spent unguided;
  };
  /// While it exists, h is asked for the next proposal: what it checks in C then validates its paths.
  class Asking {
   public:
    explicit Asking(Ledger& ledger) : ledger_(ledger) {}
    ~Asking() { ledger_.count_asking(); }
    Asking(const Asking&) = delete;
    Asking& operator=(const Asking&) = delete;

   private:
    Ledger& ledger_;
  };

  /// \param h  of the level; it and the others outlive this object
  /// \param graph  the planner searches graphs that f makes, below the root
  Ledger(Run& run, const Instance& instance, const Search& search, const PlannerCommon& common, const LevelHeuristic& h,
         bool graph);

  /// Begins a slice of a solve.
  /// \return the budget of the planner
  Budget begin(const Grant& grant);
  /// Whether that slice has ended before the solve.
  /// \param paused  the planner was stopped by a pause
  [[nodiscard]] bool sliced(bool paused) const;
  /// Called when a solve has ended, which may be the first search of a graph.
  void end_solve();
  /// Called before the instance is replaced by another projection.
  void replace_instance();
  /// Sets the value of `work()` at which the search pauses, and returns the one before.
  double limit_work(double limit);

  /// Whether a limit ends the solve before the next step.
  /// \param draws  whether the limit of proposals applies
  [[nodiscard]] std::optional<Status> stop(bool draws);
  /// The same again after h was asked, where levels below have worked; and whether the slice is spent.
  [[nodiscard]] std::optional<Status> stop_after_search();

  /// Once for each proposal: accounts for the work of the last one, and decides whether the guide may draw the next. If
  /// so, h is asked.
  [[nodiscard]] bool asks_guide();
  /// `asks_guide` asks h once more before the next proposal.
  void ask_again() { asked_ = false; }
  /// What the levels below may spend before they pause.
  [[nodiscard]] Slice slice() const;
  /// Whether h continues to search though a search below has not ended: beside a companion, which draws the planner's
  /// own proposals. This ends with the run: each search that is begun then ends at its first step.
  [[nodiscard]] bool goes_on(Advance ready) const;
  /// Decides whether the guide draws this proposal.
  /// \param ready  what h answered
  void close(Advance ready);

  /// Whether the guide may draw.
  [[nodiscard]] bool open() const { return open_; }
  /// Number of changes of that.
  [[nodiscard]] std::uint64_t changes() const { return changes_; }
  /// Called with each proposal.
  void drew(bool guided) {
    asked_ = false;
    guided_ = guided;
  }
  /// Adds checks of the present proposal that validate guiding paths.
  void count_validation(double checks);
  /// The planner has found a path, or its path is not valid.
  void found(bool path) { has_path_ = path; }

  /// Work of this level.
  [[nodiscard]] double own_work() const;
  /// Work of this level and all below it, as the level above counts it: less what is deducted for progress, and without
  /// `first_searches`.
  [[nodiscard]] double work() const;
  /// What this level costs, without proposals that its search has from other levels.
  [[nodiscard]] RunCost cost() const;
  /// Of all proposals so far.
  [[nodiscard]] BothSpent spent() const;
  /// Work that the guide may spend initially.
  [[nodiscard]] double grant() const;

  /// A companion bounds the work of the levels below.
  void rely_on_companion() { has_companion_ = true; }
  /// Called with the work of the searches that the instance is divided into.
  void count_parts(double work) { parts_ = work; }
  /// Called when the search has received the proposals of another level.
  void note_absorbed(std::size_t proposals) { absorbed_ += static_cast<double>(proposals); }

 private:
  [[nodiscard]] Spent own() const;
  /// Charges the work since `counted_` to the kind of the last proposal.
  void charge(BothSpent& both) const;
  void count_asking();
  void set_open(bool open);
  /// Whether the unguided proposals of a tree, too, have a share while it has no path: they leave the place where its
  /// guide is stuck. Samples of a roadmap serve wherever they are, and the companion draws uniform ones.
  [[nodiscard]] bool leaves_stuck_guide() const;
  /// Whether guided and unguided proposals share the work.
  [[nodiscard]] bool divides() const { return common_.bound > 0.0 && !has_companion_; }
  /// Work of guided proposals and of the levels below, per work of unguided proposals.
  [[nodiscard]] double guided_share() const;
  /// Checks of as many metres as connected nodes have advanced along guiding paths.
  [[nodiscard]] double progress_checks() const;
  /// Work that progress along guiding paths has earned.
  [[nodiscard]] double earned() const;
  /// Work of this level that the level above does not count, because its search made progress: half of the checks of
  /// this progress; or what the guide has spent of its earnings, if that is more. The level above would end its guide's
  /// search in favour of unguided proposals though that search advances.
  [[nodiscard]] double deducted() const;
  /// Work of the levels of the guide.
  [[nodiscard]] double below() const;
  /// Own work of the first search of each graph that f made below the root, also in a changed world. The level above
  /// waits for these as for the set-up of a guide: without the path it would draw unguided proposals meanwhile. They
  /// end: each considers an edge at most once, and draws few proposals.
  [[nodiscard]] double first_searches() const;

  Run& run_;
  const Instance& instance_;
  const Search& search_;
  const PlannerCommon& common_;
  const LevelHeuristic& h_;
  bool graph_;
  std::optional<BudgetMonitor> budget_;
  double direct_;                      ///< from start to goal, metres in the metric
  std::optional<double> solve_begun_;  ///< number of proposals when the unfinished solve began
  double whole_ = 0.0;                 ///< limit of proposals of all slices of this solve
  double sliced_ = 0.0;                ///< limit of proposals of this slice
  double work_limit_ = Budget::unlimited;
  std::uint64_t searches_ = 0;  ///< of the run, before h was asked
  double worked_ = 0.0;         ///< own work then
  BothSpent spent_;
  Spent counted_;            ///< the level's work that `spent_` includes
  double validation_ = 0.0;  ///< part of the guided work: the checks by which guides validate their paths
  double left_ = 0.0;        ///< work that the guide may still spend
  bool open_ = false;
  bool was_open_ = false;  ///< before h was asked
  bool asked_ = false;     ///< for the next proposal
  bool guided_ = false;    ///< the last proposal was
  bool has_companion_ = false;
  bool has_path_ = false;
  std::uint64_t changes_ = 0;
  bool searched_ = false;        ///< a solve of the instance of the present world has ended
  double first_begun_ = 0.0;     ///< own work before that instance
  double first_searches_ = 0.0;  ///< of those that have ended
  double parts_ = 0.0;
  double absorbed_ = 0.0;  ///< proposals that the search has from other levels
};

}  // namespace trellis
