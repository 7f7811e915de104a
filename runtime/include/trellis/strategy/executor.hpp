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
#include <trellis/scene/team_times.hpp>
#include <trellis/strategy/run_facts.hpp>
#include <trellis/strategy/spec.hpp>

namespace trellis {

/// The record of one level of a hierarchy in one run. Level 0 is the root: the configuration space of the actual robot.
struct LevelRecord {
  int level = 0;        ///< position in the run's list, depth first
  int parent = -1;      ///< the level that this one guides; -1 at the root
  int depth = 0;        ///< 0 at the root
  std::string key;      ///< path in the hierarchy, the key of random streams: "0", "0.0", "0.1.0"
  std::string name;     ///< "root" or the guide as written: "shrink(0.5)"
  Space space;          ///< S
  Configuration start;  ///< of its instance
  Configuration goal;
  std::vector<std::size_t> position_axes;  ///< axes of the reference point's position; empty if none
  std::shared_ptr<const Scene> scene;      ///< world and robot of its instance
  /// Whether the first coordinates are those of the scene's robot, where the space has as many: not where they say how
  /// far other robots are.
  bool places_robot = true;
  bool presumed = false;     ///< its validity was presumed instead of checked
  std::string planner;       ///< name of the planner in scripts
  std::uint64_t solves = 0;  ///< number of solves, including further ones
  Resolves resolves;         ///< number of further solves, by reason
  int solved_as = -1;        ///< number of levels whose first solve ended before that of this one; -1: never solved
  /// Whether a guide, or a path from another guide, drew proposals for it.
  bool guided = false;
  /// Validity checks by the accounts of bounded loss: those of guided proposals and of the validation of guiding paths;
  /// those of other proposals; and those of all levels below that its guide searches.
  std::uint64_t guided_checks = 0;
  std::uint64_t unguided_checks = 0;
  std::uint64_t checks_below = 0;
  /// The same for proposals. The other proposals of `search` are unguided.
  std::uint64_t guided_proposals = 0;
  std::uint64_t proposals_below = 0;
  Search search;      ///< proposals, nodes, fates, checks and time over all solves
  Solution solution;  ///< the last solution found
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

/// What searches cost, counted twice.
struct RunCost {
  double checks = 0.0;  ///< of configurations
  double work = 0.0;    ///< CPU time by a model, in units of search_cost: checks, proposals, searches of graphs, set-up

  friend RunCost operator+(const RunCost& a, const RunCost& b) { return {a.checks + b.checks, a.work + b.work}; }
  friend RunCost operator-(const RunCost& a, const RunCost& b) { return {a.checks - b.checks, a.work - b.work}; }
};

/// The constants of bounded loss.
inline constexpr RunCost companion_constant = {800.0, 1200.0};

/// The shares of a guided run in its cost. Bounded loss, of checks as of work: guided + unguided <=
/// bound * U + constant + largest_step, where U is the cost of the same planner without guides on this seed, which is
/// at least `unguided`.
struct BoundedLoss {
  double bound = 0.0;  ///< 0: the guided search ran alone
  RunCost constant;
  RunCost largest_step;  ///< of the guided search: between two places where it can wait, or up to its end
  RunCost guided;        ///< of all levels
  RunCost unguided;      ///< of the planner that ran beside them without guides
  double set_up = 0.0;   ///< work of the guides' set-up: part of `guided`, or an estimate where they were not set up
  bool guides_set_up = false;            ///< false: the unguided planner ended before it had done as much work as that
  bool unguided_won = false;             ///< it found the path
  std::uint64_t unguided_proposals = 0;  ///< the last proposals of level 0
};

struct RunRecord {
  Status status = Status::untried;
  bool solved = false;
  double seconds = 0.0;      ///< wall-clock time to set up and plan, all levels, without completion of the record
  double cpu_seconds = 0.0;  ///< CPU time for the same, of the thread and of its helpers (ExecuteOptions::threads)
  /// Part of `cpu_seconds`: functions in Lua and what they call, and loading their script. Calls are timed by the wall
  /// clock, so this is their share of `seconds`, times `cpu_seconds`. 0 where no such function was called.
  double lua_seconds = 0.0;
  Configurations path;                  ///< from start to goal; empty if unsolved
  double length = 0.0;                  ///< of `path`, in metres in the metric
  std::optional<TeamTimes> times = {};  ///< of `path`, where the robot is a team
  Trajectory trajectory;                ///< controls of the path if the problem has a motion model
  std::uint64_t validity_checks = 0;    ///< over all levels
  std::uint64_t motion_checks = 0;
  /// Part of `validity_checks`: those of an anytime planner after its first path, spent on shorter ones.
  std::uint64_t improvement_checks = 0;
  double work = 0.0;  ///< of all levels: see RunCost
  /// The work to set up the guides for this run alone; 0 where they were not set up. `work` counts
  /// one part in `queries` of what depends on the world alone, as its medial axis.
  double set_up = 0.0;
  double set_up_seconds = 0.0;        ///< part of `seconds`: the time to set up the guides
  std::uint64_t shortcut_checks = 0;  ///< validity checks of shortcutting; the sums above exclude them
  /// Whether `path` is certified: everywhere on it the robot is free of contact (PathCertificate). Every path that is
  /// reported is.
  bool certified = false;
  double clearance = 0.0;  ///< of a certified path, in metres: a lower bound on the robot's distance from contact
  std::uint64_t refuted_paths = 0;  ///< paths found before `path` that could not be certified
  std::uint64_t path_checks = 0;    ///< configurations checked for certificates; the sums and times above exclude them
  double path_seconds = 0.0;        ///< CPU time of the thread for certificates; not in the times above
  BoundedLoss bounded;
  /// The root's paths before shortcutting: the first one and each shorter one, without those that could not be
  /// certified.
  std::vector<Improvement> improvements;
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
};

/// Checks a problem: coordinates finite, of the right number and inside the space; start and goal valid.
/// \throws Error that names the obstacle in collision with start or goal
void check(const Problem& problem);

/// Makes the levels of a strategy for a problem without a search.
/// \throws Error if a guide cannot make its space, as `execute` does when it sets up the guides
void check(const StrategySpec& strategy, const Problem& problem);
/// The same after a run whose guides were not set up, because its planner solved the problem before: what a guide
/// cannot do is an error all the same. Does nothing where the set-up would take more than about 0.2 s.
/// \param run  of this strategy and problem
void check_unused_guides(const StrategySpec& strategy, const Problem& problem, const RunRecord& run);

/// The guides of a strategy that can never draw a proposal, for any problem: the planner above leaves them no share, or
/// its budget ends before their turn.
/// \return one sentence per guide, with its location in the script
std::vector<std::string> unreachable_guides(const StrategySpec& strategy);

/// Runs a strategy on a problem, in the thread that calls. Deterministic in (strategy, problem, seed), except for
/// times; several threads may run strategies at the same time. That no path was found is no error: RunRecord::status
/// says why. \param seed  of all random streams of the run \throws Error for a problem that fails `check`, or if a
/// guide that it sets up cannot make its space
RunRecord execute(const StrategySpec& strategy, const Problem& problem, std::uint64_t seed,
                  const ExecuteOptions& options = {});

/// A run that stops between two steps of its planners and continues where it stopped: it makes the proposals, and the
/// record, that `execute` makes. The run has a thread of its own, which waits while the run is stopped. The functions
/// are called by one thread at a time; the functions of `ExecuteOptions` are called by the thread of the run.
class Execution {
 public:
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
  [[nodiscard]] const LevelRecord& level(std::size_t number) const;
  /// The samples of the unguided planner that runs beside a guided search; nullptr: there is none. Its level is -1.
  [[nodiscard]] const LevelRecord* companion() const;

 private:
  class Thread;
  std::unique_ptr<Thread> thread_;
};

}  // namespace trellis
