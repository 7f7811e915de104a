// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <trellis/base/component.hpp>
#include <trellis/instance/instance.hpp>
#include <trellis/planner/guidance.hpp>
#include <trellis/planner/status.hpp>

namespace trellis {

class Lookahead;

/// The budget of a level. Prefer limits on counts: only they are reproducible.
struct Budget {
  static constexpr double unlimited = std::numeric_limits<double>::infinity();
  double proposals = 50000;    ///< number of proposals, over all solves of the level
  double checks = unlimited;   ///< number of validity checks, over all solves of the level
  double seconds = unlimited;  ///< wall-clock seconds, over all solves of the level
};

/// The controls under which a planner with a motion model extended nodes towards its proposals.
struct ControlRecord {
  Configurations controls;            ///< of each piece of a motion
  std::vector<std::uint32_t> steps;   ///< of each piece: its duration as chosen, in steps of the model
  std::vector<std::uint32_t> driven;  ///< of each piece: how many of its steps are valid and part of the tree
  std::vector<std::uint32_t> ends;    ///< for each proposal, one more than the index of its last piece
  std::uint32_t longest = 0;          ///< the planner's longest motion, in steps
  bool curves = false;                ///< the planner drives along curves where it can
  double dt = 0.0;                    ///< duration of a step, in seconds

  /// The index of the first piece of a proposal's motion.
  /// \param proposal  index into Search::proposals; their number gives the number of pieces
  [[nodiscard]] std::size_t begin_of(std::size_t proposal) const { return proposal == 0 ? 0 : ends[proposal - 1]; }
};

/// The record of a level's search over all its solves: the source of all reports and measures.
struct Search {
  Configurations nodes;                ///< nodes of the tree or roadmap in order of insertion, the start first
  std::vector<std::uint32_t> parents;  ///< parent of each node; a root's parent is itself; no_node without a tree
  Configurations proposals;            ///< all proposals that h drew, including those that failed
  std::vector<Fate> fates;             ///< result of each proposal
  std::vector<std::uint32_t> near;     ///< for each proposal, the node that was extended; no_node if none
  std::vector<std::uint32_t> added;    ///< for each proposal, the node that was added; no_node if none
  std::vector<Guidance::Source> proposal_sources;  ///< for each proposal, the part of h that drew it
  std::vector<std::string> sources;                ///< names of the parts of h
  ControlRecord controls;                          ///< empty without a motion model
  DensityRecord density;                           ///< distribution of h over all proposals
  /// For each node, whether its validity was checked; empty if all nodes were checked. Unchecked nodes of a lazy
  /// roadmap cost no checks, so the measure leaves them out.
  std::vector<std::uint8_t> validated;
  /// Whether the proposals expand a tree or roadmap. An unguided lazy roadmap draws its proposals before it checks any,
  /// so the measure leaves them out.
  bool expands = true;
  /// Pairs of connected nodes of a roadmap or graph, in order of insertion; in a lazy roadmap they may be invalid.
  std::vector<std::array<std::uint32_t, 2>> edges;
  Checks checks;         ///< of all solves of the level
  double seconds = 0.0;  ///< wall clock of all solves of the level, without the levels that it waited for

  /// The samples of the tree: of `rows`, one per node, those whose node was checked.
  /// \param rows  as many as nodes, in this space or another
  [[nodiscard]] Configurations tree_samples(const Configurations& rows) const {
    if (validated.empty()) return rows;
    Configurations chosen(rows.dimension());
    chosen.reserve(rows.size());
    for (std::size_t i = 0; i < rows.size(); ++i) {
      if (validated[i] != 0) chosen.push(rows[i]);
    }
    return chosen;
  }

  Search() = default;
  /// \param dimension  of the level's space
  explicit Search(std::size_t dimension) : nodes(dimension), proposals(dimension) {
    // Short searches are common, and repeated reallocation would take much of their time.
    constexpr std::size_t rows = 64;
    nodes.reserve(rows);
    parents.reserve(rows);
    proposals.reserve(rows);
    fates.reserve(rows);
    near.reserve(rows);
    added.reserve(rows);
    proposal_sources.reserve(rows);
  }
};

/// The result of a search.
struct Solution {
  Status status = Status::untried;
  /// From start to goal if solved. Else from the start to the reached node nearest to the goal; it contains at least
  /// the start, if valid.
  Configurations path;
  /// The controls of the path if the instance has a motion model. Replayed from the start, they give the path.
  Trajectory trajectory = {};
  [[nodiscard]] bool solved() const { return status == Status::solved; }
};

/// The context of a planner. The referenced objects outlive the planner.
struct PlannerContext {
  Instance& instance;
  Advice& guidance;
  Stream proposals;  ///< random stream that proposals are drawn from
  Search& search;    ///< the planner appends to it
  bool guided;       ///< whether h is more than uniform sampling and goal bias; without such h, an exact graph search
                     ///< draws no proposal
  Lookahead* ahead = nullptr;  ///< what helper threads computed for the present step; nullptr: nothing
  std::string_view name = {};  ///< of the planner in scripts, for messages; empty without an executor
};

/// What the next step of a planner is.
struct Plan {
  bool proposal = true;               ///< it extends towards a proposal of h; else it works without one
  std::optional<TreeSide> tree = {};  ///< the tree that the proposal is for; none: the planner has one tree
};

class StepsAhead;

/// A planner of one instance with one guidance, which searches in steps. A step with a proposal is `plan`, a proposal
/// that its caller draws from h, `extend`, the guidance's observation of the outcome, and `follow`; one without is
/// `plan` and `work`. `solve` is that loop. A planner does not depend on guides, on limits or on other levels. It lives
/// as long as its level, and only one thread uses it at a time.
///
/// Its functions throw what the instance's validity and the guidance throw; the run ends with that. A search without a
/// path is no error but a Status.
class Planner {
 public:
  /// \param context  its references outlive the planner
  explicit Planner(PlannerContext context) : context_(std::move(context)) {}
  virtual ~Planner() = default;

  /// Begins a solve, or continues the one that a limit ended. If the instance changed (Instance::epoch), a roadmap is
  /// repaired and a tree loses its invalid branches. If it did not change, a tree that had reached the goal is
  /// discarded and a new one is grown to find another path.
  /// \param budget  limit over all solves of the level, which the loop observes; a planner reads it only to divide it
  /// \return the status if the solve ends here; none if it takes steps
  virtual std::optional<Status> begin(const Budget& budget) = 0;
  /// Whether the next step may draw a proposal: then the limit of proposals applies.
  [[nodiscard]] virtual bool draws() const { return true; }
  /// Decides what the next step is, after the levels below have been searched: planners of graphs ask h for paths here.
  virtual Plan plan() { return {}; }
  /// Extends towards a proposal.
  /// \param proposal  valid until the next call
  /// \return the outcome, which the guidance observes next; its views are valid until the next call of a function of
  ///     this planner
  virtual Outcome extend(View proposal) = 0;
  /// The rest of a step with a proposal: motions to the goal or to another tree, or a search of the roadmap.
  /// \return the status if the solve ends; none if it continues
  virtual std::optional<Status> follow() { return std::nullopt; }
  /// A step without a proposal: the repair of a branch, an expansion of a graph, a search of the roadmap. A planner
  /// whose `plan` never returns such a step does without this function.
  /// \return the status if the solve ends; none if it continues
  /// \throws Fault where the planner plans such a step and does not override this function: nothing would end its
  ///     search, as neither proposals nor checks would be spent
  virtual std::optional<Status> work();
  /// Called instead of a step when a limit is reached.
  /// \param limit  why the solve stops: budget_spent, or the status that the caller's limit returned
  /// \return `limit` or another status if the solve ends; none if it continues without proposals: then `draws` returns
  ///     false
  virtual std::optional<Status> stopped(Status limit) { return limit; }
  /// The solution of a solve that ended with this status, which is neither invalid_start nor invalid_goal.
  /// \param status  that the solve ended with
  [[nodiscard]] virtual Solution solution(Status status) = 0;
  /// The stream that its proposals are drawn from.
  [[nodiscard]] virtual Stream& stream() { return context_.proposals; }
  /// Its coming steps, where helper threads can compute them ahead; nullptr: they cannot.
  [[nodiscard]] virtual StepsAhead* coming() { return nullptr; }

  /// Runs the loop without an executor: searches until solved or until the budget is spent. Each further call continues
  /// the search.
  /// \param h  that proposals are drawn from: the context's guidance
  /// \param budget  over all calls
  /// \param limit  called before each step; a status ends the solve, as a limit does
  Solution solve(Guidance& h, const Budget& budget, const std::function<std::optional<Status>()>& limit = {});

 protected:
  PlannerContext context_;
};

/// Options of every planner that the planner's level reads.
struct PlannerCommon {
  Budget budget;
  double uniform = 0.05;    ///< share of uniform proposals of a guided level
  double goal_bias = 0.05;  ///< share of proposals that are the goal
  double step = 0.0;        ///< longest extension of a tree, in metres in the metric; 0: the planner has none
  /// More than 1. At the root: limit of the work of a guided run, per work of the same planner without guides. Below:
  /// 0.8 (bound - 1) limits the work of guided proposals and of the levels below, per work of unguided proposals,
  /// beyond an initial grant and the work that progress earns. 0: no limit.
  double bound = 2.0;
  double queries = 1000.0;  ///< runs in one world that share what is set up for it
};

/// A kind of planner: its description and its factory.
struct PlannerKind {
  const Component* component = nullptr;  ///< name, options and documentation; it outlives the program's use of the kind
  /// Returns the options that the level reads, of validated options.
  PlannerCommon (*common)(const Options&) = nullptr;
  /// Makes the planner of one level of one run, from validated options. Called by the threads of several runs at the
  /// same time.
  std::unique_ptr<Planner> (*make)(const Options&, PlannerContext) = nullptr;
  /// Whether it searches explicit graphs, and only these.
  bool graph = false;
  /// Whether its nodes may be invalid, because it checks few of them.
  bool unverified = false;
  /// Whether it plans with a motion model, and only with one. The other planners connect configurations by straight
  /// motions.
  bool kinodynamic = false;
};

/// Returns all planners, in the order of the reference; those of register_planner() are the last. Thread-safe.
const std::vector<PlannerKind>& planner_kinds();
/// Returns the planner with this name in scripts, as "rrt_connect"; nullptr if there is none. Thread-safe.
/// \param name  exact
/// \return valid as long as the program
const PlannerKind* find_planner(std::string_view name);

/// Shortcuts a path: in each round, tries to replace the part between two random points of the path by a straight
/// motion. The result is never longer. The instance counts the checks.
/// \param instance  checks the motions
/// \param path  of valid motions, at least one configuration
/// \param rounds  at most so many; each checks at most three motions and one configuration
/// \param stream  draws the points; the same stream gives the same result
/// \param certified  if not empty: whether a part of the path that would be new is certified; else it is not taken
/// \throws what the instance's validity throws
Configurations shortcut(Instance& instance, const Configurations& path, std::int64_t rounds, Stream& stream,
                        const std::function<bool(const Configurations&)>& certified = {});

}  // namespace trellis
