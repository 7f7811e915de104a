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
#include <trellis/strategy/spec.hpp>

namespace trellis {

/// Why the instance of a level was solved again, and how often for each reason. The first solve and these are all of
/// its solves.
struct Resolves {
  std::uint64_t invalid_path = 0;  ///< points or edges of its path were found invalid in C when the path was validated
  std::uint64_t rejections = 0;    ///< C rejected guided proposals along its path, or these brought no progress
  std::uint64_t lost_place = 0;    ///< a level above it, or another part of the guide, refuted a place on its path
  std::uint64_t presumed_valid = 0;  ///< a configuration that its path presumes valid was found invalid
  std::uint64_t changed_world = 0;   ///< the instance that it is projected from has other obstacles
  std::uint64_t further_path = 0;    ///< its guide asked for another path
  std::uint64_t finer_check = 0;     ///< of the root: the path found was invalid when it was checked finer
  /// Whether a search for a path that replaces a refuted one found none: it is not solved again after that.
  bool exhausted = false;
  /// Whether its path was refuted when it had been solved again as often as its guide allows.
  bool limit_reached = false;
};

/// A path that a run found, shorter than all before it.
struct Improvement {
  std::uint64_t validity_checks = 0;  ///< of all levels until then
  double cpu_seconds = 0.0;
  double length = 0.0;  ///< in the metric
};

/// What one level of a hierarchy did in one run. Level 0 is the root, the configuration space of the real robot.
struct LevelRecord {
  int level = 0;        ///< position in the run's list, depth first
  int parent = -1;      ///< the level that this one guides
  int depth = 0;        ///< 0 at the root
  std::string key;      ///< path in the hierarchy that random streams are keyed by: "0", "0.0", "0.1.0"
  std::string name;     ///< "root" or the guide as written: "shrink(0.5)"
  Space space;          ///< S
  Configuration start;  ///< of its instance
  Configuration goal;
  std::vector<std::size_t> position_axes;  ///< axes of the reference point's position, empty where none
  std::shared_ptr<const Scene> scene;      ///< world and robot of its instance
  bool presumed = false;                   ///< its validity was presumed, not checked
  std::string planner;                     ///< the planner's name, as a script writes it
  std::uint64_t solves = 0;                ///< how often the instance was solved (re-solves included)
  Resolves resolves;                       ///< why it was solved again
  int solved_as = -1;  ///< levels whose first solve had ended before this one's; -1: it was never solved
  /// Whether a guide, or a path that a guide left, drew proposals for it.
  bool guided = false;
  /// What either side of bounded loss spent. Validity checks of guided proposals and of validating what guides; those
  /// of the other proposals; those of all levels that the guide searches, and of the levels below these.
  std::uint64_t guided_checks = 0;
  std::uint64_t unguided_checks = 0;
  std::uint64_t checks_below = 0;
  /// The same of proposals: the unguided ones are the others of `search`.
  std::uint64_t guided_proposals = 0;
  std::uint64_t proposals_below = 0;
  Search search;      ///< proposals, nodes, their fates, checks and time, over all solves
  Solution solution;  ///< the last one found
  /// Validity in S as it was when the run ended, of configurations and of the straight motion from a valid one; counted
  /// nowhere; for scoring. One thread at a time, as all functions of all levels of a run: levels may share a checker.
  std::function<bool(View)> valid;
  std::function<bool(View, View)> valid_motion;
  /// The density that the level's proposals were drawn from, the mean over them all, with respect to volume in metric
  /// coordinates; its absolutely continuous part. Empty where there were no proposals or a part of h had no closed
  /// form.
  std::function<double(View)> proposal_density;
  /// The same of the proposals lifted to the root's space.
  std::function<double(View)> root_proposal_density;
  /// The share of the proposals that came from atoms, in either space: what the densities' integrals fall short of 1.
  /// NaN where these are empty.
  double proposal_atoms = std::numeric_limits<double>::quiet_NaN();
  /// Nodes and proposals lifted to the root's space by the chain of h's (the same rows for level 0).
  Configurations root_nodes;
  Configurations root_proposals;

  /// Lets go of the functions above and all that they hold.
  void release() {
    valid = nullptr;
    valid_motion = nullptr;
    proposal_density = nullptr;
    root_proposal_density = nullptr;
  }
};

/// A level and what it guides, up to the root: "skeleton() >> lazy() >> rrt, level 2".
/// \param at  the level of a number, of the same run
std::string level_path(const LevelRecord& level, const std::function<const LevelRecord&(int)>& at);

/// Levels take turns: one that asks for the solution of a level below waits for it. What one of them did in a turn is
/// what its records hold beyond its turn before.
struct Turn {
  int level = 0;
  std::uint32_t proposals = 0;  ///< length of the level's Search::proposals when the turn ended
  std::uint32_t nodes = 0;
  bool solve_ended = false;  ///< else it waits for a level below
  Configurations path;       ///< that its solve found; empty where none ended or none was found
};

struct RunRecord {
  Status status = Status::untried;
  bool solved = false;
  double seconds = 0.0;               ///< to set up and plan, all levels; not to complete the record
  double cpu_seconds = 0.0;           ///< of the thread, for the same
  Configurations path;                ///< from start to goal; empty when unsolved
  double length = 0.0;                ///< of `path` in the metric
  Trajectory trajectory;              ///< how the path is driven, where the problem has a motion model
  std::uint64_t validity_checks = 0;  ///< over all levels
  std::uint64_t motion_checks = 0;
  std::uint64_t shortcut_checks = 0;  ///< validity checks that shortcutting spent, not in the sums above
  std::uint64_t refuted_paths = 0;    ///< found before `path`, and refuted when they were checked finer
  std::uint64_t path_checks = 0;      ///< validity checks of paths found, finer; neither they nor their time are above
  std::vector<Improvement> improvements;  ///< the root's paths before shortcutting, the first one and each shorter one
  std::vector<LevelRecord> levels;
  std::vector<Turn> turns;  ///< in the order in which they were taken
};

struct ExecuteOptions {
  std::int64_t shortcut = 0;               ///< rounds of shortcutting on the found path; not of one that is driven
  std::function<bool()> interrupted = {};  ///< polled between proposals; true ends the run with Status::interrupted
  /// Shown h as it was when it drew a proposal, before the outcome is known, and the level that it drew for.
  std::function<void(const LevelRecord& level, const Guidance& h)> watch = {};
};

/// Checks a problem: finite coordinates of the right number, inside the space, start and goal valid. Throws Error that
/// names the obstacle a start or goal touches.
void check(const Problem& problem);

/// Makes the levels of a strategy for a problem, without searching in any: throws Error where a guide cannot make its
/// space, as `execute` would.
void check(const StrategySpec& strategy, const Problem& problem);

/// The guides of a strategy that will never draw a proposal, whatever the problem, a sentence each with where they were
/// written: the planner above leaves them no share, or its budget ends before their turn.
std::vector<std::string> unreachable_guides(const StrategySpec& strategy);

/// Runs a strategy on a problem. Deterministic in (strategy, problem, seed), times apart. Throws Error for a problem
/// that does not pass `check`.
RunRecord execute(const StrategySpec& strategy, const Problem& problem, std::uint64_t seed,
                  const ExecuteOptions& options = {});

}  // namespace trellis
