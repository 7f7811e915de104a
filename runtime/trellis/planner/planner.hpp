// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include <trellis/base/component.hpp>
#include <trellis/instance/instance.hpp>
#include <trellis/planner/guidance.hpp>

namespace trellis {

/// How a search ended.
enum class Status : std::uint8_t {
  untried,  ///< no search was asked for
  solved,
  budget_spent,   ///< proposals, checks or seconds ran out
  no_path,        ///< a finite search space holds no path
  invalid_start,  ///< the start is invalid in this space
  invalid_goal,
  interrupted,
};
std::string_view to_string(Status status);

/// What every planner may spend on its level. Counts come first, because only counts reproduce.
struct Budget {
  static constexpr double unlimited = std::numeric_limits<double>::infinity();
  double proposals = 50000;    ///< over all solves of the level
  double checks = unlimited;   ///< validity checks, over all solves of the level
  double seconds = unlimited;  ///< wall clock, over all solves of the level
};

/// What became of a level's search, kept over all its solves: everything that is reported and measured.
struct Search {
  Configurations nodes;                            ///< tree or roadmap nodes in the order they came, the start first
  std::vector<std::uint32_t> parents;              ///< of each node its parent, a root's itself; no_node without a tree
  Configurations proposals;                        ///< what h drew, before the extension was tried, failed ones too
  std::vector<Fate> fates;                         ///< of each proposal
  std::vector<std::uint32_t> near;                 ///< of each proposal the node it grew from; no_node where none
  std::vector<std::uint32_t> added;                ///< of each proposal the node that came of it; no_node where none
  std::vector<Guidance::Source> proposal_sources;  ///< which part of h drew each proposal
  std::vector<std::string> sources;                ///< their names
  DensityRecord density;                           ///< what h was, over all proposals
  /// Of each node whether its validity was looked at; empty where that of all was. The nodes of a lazy roadmap that
  /// were not are no samples that the search paid for, and are not measured.
  std::vector<std::uint8_t> looked_at;
  /// Whether the proposals are an expansion: drawn to grow what is there. Those of an unguided lazy roadmap are laid
  /// out before anything is known, and are not measured.
  bool expands = true;
  /// Nodes of a roadmap or graph that were joined, in the order they were; a lazy roadmap's may be invalid.
  std::vector<std::array<std::uint32_t, 2>> edges;
  Checks checks;
  double seconds = 0.0;

  /// What the tree sampled: of rows that stand for the nodes, those whose node was looked at.
  [[nodiscard]] Configurations tree_samples(const Configurations& rows) const {
    if (looked_at.empty()) return rows;
    Configurations chosen(rows.dimension());
    chosen.reserve(rows.size());
    for (std::size_t i = 0; i < rows.size(); ++i) {
      if (looked_at[i] != 0) chosen.push(rows[i]);
    }
    return chosen;
  }

  Search() = default;
  /// \param dimension  of the level's space
  explicit Search(std::size_t dimension) : nodes(dimension), proposals(dimension) {
    // Short searches are common, and growing half a dozen blocks from nothing is what they would notice.
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

/// What a search found.
struct Solution {
  Status status = Status::untried;
  /// From start to goal when solved; else the way to what the search reached nearest to the goal (at least the start,
  /// where it is valid).
  Configurations path;
  /// How the path is driven, where the instance has a motion model: replayed from the start it is the path.
  Trajectory trajectory = {};
  [[nodiscard]] bool solved() const { return status == Status::solved; }
};

/// A planner at work on one instance with one guidance. It knows no guides.
class Planner {
 public:
  /// What a planner works with; the referenced objects outlive it.
  struct Task {
    Instance& instance;
    Guidance& guidance;
    Stream proposals;  ///< what h draws with
    Search& search;    ///< appended to
    bool guided;       ///< whether h is more than uniform and goal bias; an exact graph search draws nothing without it
    std::function<bool()> interrupted;
    /// Asked before every proposal whether the search is to pause: it ends with Status::budget_spent, and `solve`
    /// called again continues it. Empty: never.
    std::function<bool()> paused = {};
  };

  virtual ~Planner() = default;

  /// Searches until solved or the budget is spent. Called again, it continues with what it has: where the instance
  /// changed (Instance::epoch), a roadmap is repaired and a tree loses the branches that are not valid any more; where
  /// it did not, a tree that had reached the goal is grown anew for another path.
  /// `budget` holds over all calls: what the level has spent so far is subtracted.
  virtual Solution solve(const Budget& budget) = 0;
};

/// Options that every planner has, read by whoever runs it.
struct PlannerCommon {
  Budget budget;
  double uniform = 0.05;    ///< share of uniform proposals kept when the level is guided
  double goal_bias = 0.05;  ///< share of proposals that are the goal itself
  double step = 0.0;        ///< longest extension of a tree, metres in the metric; 0: the planner has none
  /// Work of guided proposals and of the levels below, per work of unguided proposals, beyond a grant and what progress
  /// earns; 0: without bound.
  double bound = 0.8;
};

/// One kind of planner: its description and how to make it.
struct PlannerKind {
  const Component* component = nullptr;
  PlannerCommon (*common)(const Options&) = nullptr;
  std::unique_ptr<Planner> (*make)(const Options&, Planner::Task) = nullptr;
  /// Searches explicit graphs (and only these).
  bool graph = false;
  /// Its nodes may be invalid: it looks at a few of them only.
  bool unverified = false;
  /// Drives a motion model (and plans for nothing else); the others join configurations by straight motions.
  bool kinodynamic = false;
};

/// All planners, in the order of the reference.
const std::vector<PlannerKind>& planner_kinds();
/// nullptr for an unknown name.
const PlannerKind* find_planner(std::string_view name);

/// Shortcuts a path: `rounds` tries to replace the way between two random points of it by a straight motion. The result
/// is never longer. Checks are counted by the instance.
/// \param finer  the same instance with finer motion checks, which new motions must pass too; nullptr: none
Configurations shortcut(Instance& instance, const Configurations& path, std::int64_t rounds, Stream& stream,
                        Instance* finer = nullptr);

}  // namespace trellis
