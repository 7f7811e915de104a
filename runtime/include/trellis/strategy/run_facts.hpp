// SPDX-License-Identifier: GPL-3.0-or-later
// What a run records beside its samples: its paths, costs and accounts.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include <trellis/base/configurations.hpp>
#include <trellis/motion/motion_model.hpp>
#include <trellis/planner/status.hpp>
#include <trellis/scene/team_times.hpp>

namespace trellis {

/// How often a level's instance was solved again, by reason. The first solve and these are all its solves.
struct Resolves {
  std::uint64_t invalid_path = 0;    ///< validation in C found points or edges of its path invalid
  std::uint64_t rejections = 0;      ///< C rejected guided proposals along its path, or they made no progress
  std::uint64_t lost_place = 0;      ///< a level above, or another part of the guide, refuted a place on its path
  std::uint64_t presumed_valid = 0;  ///< a configuration that its path presumed valid is invalid
  std::uint64_t changed_world = 0;   ///< the instance that it is projected from has other obstacles
  std::uint64_t new_turn = 0;        ///< its guide's turn came, and f was applied to the samples since
  std::uint64_t further_path = 0;    ///< its guide requested another path
  std::uint64_t refuted_path = 0;    ///< for the root: the path could not be certified
  /// Whether a search for a path to replace a refuted one found none. The instance is then not solved again.
  bool exhausted = false;
  /// Whether its path was refuted after the maximum number of solves that its guide allows.
  bool limit_reached = false;
};

/// A path of a run that is shorter than all earlier ones.
struct Improvement {
  std::uint64_t validity_checks = 0;  ///< of all levels so far
  double cpu_seconds = 0.0;
  double length = 0.0;  ///< in metres in the metric
};

/// What searches cost, counted twice.
struct RunCost {
  double checks = 0.0;  ///< of configurations
  double work = 0.0;    ///< CPU time by a model, in units of search_cost: checks, proposals, searches of graphs, set-up

  /// Adds both counts.
  /// \param a, b  costs of the same run
  friend RunCost operator+(const RunCost& a, const RunCost& b) { return {a.checks + b.checks, a.work + b.work}; }
  /// Subtracts both counts; the difference may be negative.
  /// \param a, b  costs of the same run
  friend RunCost operator-(const RunCost& a, const RunCost& b) { return {a.checks - b.checks, a.work - b.work}; }
};

/// A place where paths of robots of a team conflict, found by a guide that divides the team, and what became of it.
/// Robots have their numbers (TeamMember::number).
struct TeamConflict {
  enum class Resolved : std::uint8_t {
    none,        ///< no path was found that resolves it
    schedule,    ///< the robots keep their paths, and one waits for the other
    order,       ///< `prioritise`: a robot found no path among those before it, and plans earlier
    one_by_one,  ///< the robots leave their paths, each among the paths of those before it
    together,    ///< the robots are planned together, as one
  };
  std::vector<std::vector<std::size_t>> touching;  ///< the pairs of robots that touch
  std::vector<std::size_t> robots;                 ///< those that leave their paths, or wait
  /// Seconds on the path of the team, at which it was found; from where to where robots leave their paths. NaN where
  /// the whole of the paths changes.
  double at = std::numeric_limits<double>::quiet_NaN();
  double from = std::numeric_limits<double>::quiet_NaN();
  double to = std::numeric_limits<double>::quiet_NaN();
  Resolved resolved = Resolved::none;
  std::uint64_t checks = 0;  ///< validity checks, from when it was found until it was resolved
};

/// The constants of bounded loss.
inline constexpr RunCost companion_constant = {800.0, 1200.0};
/// What the guided search spends at most between two comparisons with the planner beside it, except in one call of a
/// function of a script.
inline constexpr RunCost companion_step = {64.0, 200.0};

/// The shares of a guided run in its cost. Bounded loss, of checks as of work: guided + unguided <=
/// bound * U + constant + largest_step, where largest_step is at most companion_step, and U is the cost of the same
/// planner without guides on this seed, which is at least `unguided`.
struct BoundedLoss {
  double bound = 0.0;  ///< 0: the guided search ran alone
  RunCost constant;
  RunCost largest_step;  ///< of the guided search: between two places where it can wait, or up to its end. A part that
                         ///< was announced before it began does not count
  RunCost guided;        ///< of all levels
  RunCost unguided;      ///< of the planner that ran beside them without guides
  double set_up = 0.0;   ///< work of the guides' set-up: part of `guided`, or an estimate where they were not set up
  bool guides_set_up = false;            ///< false: the unguided planner ended before it had done as much work as that
  bool unguided_won = false;             ///< it found the path
  std::uint64_t unguided_proposals = 0;  ///< the last proposals of level 0
};

/// What a run found and spent.
struct RunTotals {
  Status status = Status::untried;
  bool solved = false;
  /// Wall-clock time to set up and plan, all levels, without completion of the record and without
  /// `shared_set_up_seconds`, whichever run computed that.
  double seconds = 0.0;
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
  /// The runs that share that, by assumption (PlannerCommon::queries). NaN where nothing depends on the world alone.
  double queries = std::numeric_limits<double>::quiet_NaN();
  double set_up_seconds = 0.0;  ///< part of `seconds`: the time to set up the guides
  /// The time that the set-ups took that depend on the world alone and that this run uses, in whichever run they were
  /// computed. 0 of a run that shares none (PlannerCommon::queries is 1).
  double shared_set_up_seconds = 0.0;
  std::uint64_t shortcut_checks = 0;  ///< validity checks of shortcutting; the sums above exclude them
  /// Whether `path` is certified: everywhere on it the robot is free of contact (PathCertificate). Every path that is
  /// reported is.
  bool certified = false;
  double clearance = 0.0;  ///< of a certified path, in metres: a lower bound on the robot's distance from contact
  std::uint64_t refuted_paths = 0;  ///< paths found before `path` that could not be certified
  std::uint64_t path_checks = 0;    ///< configurations checked for certificates; the sums and times above exclude them
  double path_seconds = 0.0;        ///< CPU time of the thread for certificates; not in the times above
  BoundedLoss bounded;
  std::vector<TeamConflict> conflicts;  ///< of a team, in the order in which they were found
  /// The root's paths before shortcutting: the first one and each shorter one, without those that could not be
  /// certified. Those of the planner that runs beside a guided search are among them, if they are not shorter than the
  /// reported path.
  std::vector<Improvement> improvements;
};

/// Whether a run set up its guides: not where its planner, which runs beside them, solved the problem before.
/// \param run  of a strategy with a guide; of another strategy true
inline bool sets_up_guides(const RunTotals& run) { return !(run.bounded.bound > 0.0) || run.bounded.guides_set_up; }

/// The place of a level in its hierarchy, and its accounts.
struct LevelAccounts {
  int level = 0;             ///< position in the run's list, depth first
  int parent = -1;           ///< the level that this one guides; -1 at the root
  int depth = 0;             ///< 0 at the root
  std::string key;           ///< path in the hierarchy, the key of random streams: "0", "0.0", "0.1.0"
  std::string name;          ///< "root" or the guide as written: "shrink(0.5)"
  std::string planner;       ///< name of the planner in scripts
  std::uint64_t solves = 0;  ///< number of solves, including further ones
  Resolves resolves;         ///< number of further solves, by reason
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
};

/// The key of the guide whose space a level searches, from the level's key; "" for the root and for halves of a split
/// search, which no guide made.
/// \param level_key  LevelAccounts::key
std::string guide_key(const std::string& level_key);

}  // namespace trellis
