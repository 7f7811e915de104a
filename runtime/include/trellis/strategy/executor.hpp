// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include <trellis/guide/guide.hpp>
#include <trellis/planner/planner.hpp>
#include <trellis/scene/scene.hpp>
#include <trellis/strategy/run_facts.hpp>
#include <trellis/strategy/spec.hpp>

namespace trellis {

/// The record of one level of a hierarchy in one run. Level 0 is the root: the configuration space of the actual robot.
struct LevelRecord : LevelAccounts {
  Space space;          ///< S
  Configuration start;  ///< of its instance
  Configuration goal;
  std::vector<std::size_t> position_axes;  ///< axes of the reference point's position; empty if none
  std::shared_ptr<const Scene> scene;      ///< world and robot of its instance
  /// Whether the first coordinates are those of the scene's robot, where the space has as many: not where they say how
  /// far other robots are.
  bool places_robot = true;
  bool presumed = false;  ///< its validity was presumed instead of checked
  int solved_as = -1;     ///< number of levels whose first solve ended before that of this one; -1: never solved
  Search search;          ///< proposals, nodes, fates, checks and time over all solves
  Solution solution;      ///< the last solution found
  /// Validity in S at the end of the run: of a configuration, and of the straight motion from a valid configuration.
  /// For scoring; no record counts these checks. Not thread-safe: all levels of a run may share a checker.
  std::function<bool(View)> valid;
  std::function<bool(View, View)> valid_motion;
  /// The mean density from which the level's proposals were drawn, with respect to volume in metric coordinates,
  /// absolutely continuous part only. Empty without proposals, or if a part of h has no closed form.
  std::function<double(View)> proposal_density;
  /// The same for the proposals lifted to the root's space.
  std::function<double(View)> root_proposal_density;
  /// The share of proposals drawn from atoms, in both spaces: 1 minus the integral of the densities. NaN if the
  /// densities are empty.
  double proposal_atoms = std::numeric_limits<double>::quiet_NaN();
  /// Nodes and proposals lifted to the root's space through all levels between; empty for level 0, and where
  /// ExecuteOptions::lift is false.
  Configurations lifted_nodes;
  Configurations lifted_proposals;

  /// Nodes and proposals in the root's space; for level 0 those of `search`, not a copy of them.
  [[nodiscard]] const Configurations& root_nodes() const { return parent < 0 ? search.nodes : lifted_nodes; }
  [[nodiscard]] const Configurations& root_proposals() const {
    return parent < 0 ? search.proposals : lifted_proposals;
  }

  /// Releases the functions above and the memory that they own.
  void release() {
    valid = nullptr;
    valid_motion = nullptr;
    proposal_density = nullptr;
    root_proposal_density = nullptr;
  }
};

/// A level and the levels that it guides, up to the root: "skeleton() >> lazy() >> rrt, level 2".
/// \param level  the first of the path
/// \param at  returns the level with a number, of the same run
std::string level_path(const LevelRecord& level, const std::function<const LevelRecord&(int)>& at);

/// Levels take turns: a level that needs the solution of a level below waits for it. The work of a turn is the
/// difference between the counts at its end and those at the end of the level's previous turn.
struct Turn {
  int level = 0;
  std::uint32_t proposals = 0;  ///< number of the level's proposals at the end of the turn
  std::uint32_t nodes = 0;
  bool solve_ended = false;  ///< false: it waits for a level below
  Configurations path;       ///< path of the solve that ended; empty if none ended or no path was found
};

struct RunRecord : RunTotals {
  std::vector<LevelRecord> levels;
  std::vector<Turn> turns;  ///< in chronological order
};

struct ExecuteOptions {
  std::int64_t shortcut = 0;               ///< rounds of shortcutting of the path; ignored for kinodynamic planning
  std::function<bool()> interrupted = {};  ///< polled between proposals; if true, the run ends with Status::interrupted
  /// Called after each proposal and before its outcome, with the level and its current guidance. The level of the
  /// planner that runs beside a guided search has the number -1.
  std::function<void(const LevelRecord& level, const Guidance& h)> watch = {};
  /// Whether records get what the measure needs besides the samples: the nodes and proposals of lower levels in the
  /// root's space, and the densities of proposals.
  bool measured = true;
  /// Threads of the run: they check motions and find neighbours ahead of searches without a guide, as of a planner
  /// alone, of the lowest level of a hierarchy, and of the unguided planner beside it. The record is the same but for
  /// times.
  unsigned threads = 1;
  /// False: no unguided planner runs beside a guided search, whatever `bound` says, and guides are set up at once.
  bool companion = true;
  /// Work of all levels at which the run ends with Status::interrupted; 0: no limit.
  double work_limit = 0.0;
  /// The same for the validity checks of all levels; 0: no limit.
  std::uint64_t check_limit = 0;
};

/// Checks a problem: coordinates finite, of the right number and inside the space; start and goal valid.
/// \param problem  `reach` is not read: the goals were chosen from it before
/// \throws Error that names the obstacle in collision with start or goal
void check(const Problem& problem);

/// Makes the levels of a strategy for a problem without a search.
/// \param strategy  its options are valid already
/// \param problem  valid (check)
/// \throws Error if a guide cannot make its space, as `execute` does when it sets up the guides
void check(const StrategySpec& strategy, const Problem& problem);
/// The same after a run whose guides were not set up, because its planner solved the problem before: what a guide
/// cannot do is an error all the same. Does nothing where the set-up would take more than about 0.2 s.
/// \param strategy  with or without a guide
/// \param problem  valid (check)
/// \param run  of this strategy and problem
void check_unused_guides(const StrategySpec& strategy, const Problem& problem, const RunRecord& run);

/// The guides of a strategy that can never draw a proposal, for any problem: the planner above leaves them no share, or
/// its budget ends before their turn.
/// \param strategy  with or without a guide
/// \return one sentence per guide, with its location in the script
std::vector<std::string> unreachable_guides(const StrategySpec& strategy);

/// Runs a strategy on a problem, in the thread that calls. Deterministic in (strategy, problem, seed), except for
/// times; several threads may run strategies at the same time. That no path was found is no error: RunRecord::status
/// says why.
/// \param strategy  with or without a guide
/// \param problem  the record shares its scene
/// \param seed  of all random streams of the run
/// \param options  its functions are called during the call only
/// \throws Error for a problem that fails `check`, or if a guide that it sets up cannot make its space
RunRecord execute(const StrategySpec& strategy, const Problem& problem, std::uint64_t seed,
                  const ExecuteOptions& options = {});

/// A run that stops between two steps of its planners and continues where it stopped: it makes the proposals, and the
/// record, that `execute` makes. The run has a thread of its own, which waits while the run is stopped. The functions
/// are called by one thread at a time; the functions of `ExecuteOptions` are called by the thread of the run.
class Execution {
 public:
  /// \param strategy  with or without a guide
  /// \param problem  the record shares its scene
  /// \param seed  of all random streams of the run
  /// \param options  copied; what its functions refer to outlives the execution
  /// \throws Error for a problem that fails `check`
  Execution(StrategySpec strategy, Problem problem, std::uint64_t seed, ExecuteOptions options = {});
  Execution(const Execution&) = delete;
  Execution& operator=(const Execution&) = delete;
  /// Abandons a run that has not ended.
  ~Execution();

  /// Continues the run until `stop` returns true, or to its end.
  /// \param stop  called before each step, by the thread of the run
  /// \return whether the run has ended
  /// \throws what the run throws
  bool advance(std::function<bool()> stop);
  /// The record so far; of a run that has not ended with Status::interrupted. After the end, callable once.
  RunRecord record();
  /// The samples of a level while the run is stopped, without a copy: its fields that `record` completes are missing.
  /// \param number  LevelAccounts::level, 0 for the root
  /// \return valid until the next `advance`
  /// \throws std::out_of_range for a number of no level
  [[nodiscard]] const LevelRecord& level(std::size_t number) const;
  /// The samples of the unguided planner that runs beside a guided search; nullptr: there is none. Its level is -1.
  [[nodiscard]] const LevelRecord* companion() const;

 private:
  class Thread;
  std::unique_ptr<Thread> thread_;
};

}  // namespace trellis
