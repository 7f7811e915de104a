// SPDX-License-Identifier: GPL-3.0-or-later
// Describes how a strategy will run on a problem, level by level, without running it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <trellis/guide/claims.hpp>
#include <trellis/planner/planner.hpp>
#include <trellis/space/space.hpp>
#include <trellis/strategy/spec.hpp>

namespace trellis {

struct LevelExplanation;

/// A guide of a level, or a combination of guides. Descriptions come from the registry (component, claims), values from
/// the guide that the executor makes. Pointers refer to the registry, which lives as long as the program, or to the
/// custom guide of `spec`.
struct GuideExplanation {
  GuideSpec spec;
  std::string summary = {};              ///< one line; "" for a custom guide
  const Component* component = nullptr;  ///< describes the options of `spec`; nullptr if it has none
  const GuideClaims* claims = nullptr;   ///< f, h, density and feedback of the guide
  std::int64_t resolves = 0;          ///< maximum number of further solves of its space; 0 for combinators and S = {0}
  double effort = Budget::unlimited;  ///< maximum number of proposals of the first search of its space
  double effort_again = Budget::unlimited;  ///< maximum number of proposals of each further search
  /// Whether edges of the path found in S are validated in C before it guides. C counts these checks.
  bool validates_edges = false;
  std::shared_ptr<const LevelExplanation> level = {};  ///< the search of its space; nullptr for combinators and S = {0}
  std::vector<double> shares = {};           ///< for a mixture: the share of proposals of each part; they sum to 1
  std::vector<GuideExplanation> parts = {};  ///< for a combinator
};

/// The search of one space.
struct LevelExplanation {
  struct Graph {
    std::size_t vertices = 0;
    std::size_t edges = 0;
    bool verified = true;  ///< all edges are known to be valid; else the search checks the edges that it reaches
  };

  int number = 0;                   ///< as in reports: depth first, 0 for the root
  std::string name;                 ///< "root", or the guide that made it: "shrink(0.5)"
  Space space;                      ///< C for the root, S for the other levels
  std::size_t goals = 1;            ///< number of goals of its instance, at least 1
  std::string motion_model;         ///< "" for straight motions
  bool presumed = false;            ///< validity is presumed: the level makes no checks
  std::string collision;            ///< the backend, "planar" or "fcl"
  double resolution = 0.0;          ///< distance between checked configurations of a motion, metres
  double shared_resolution = 0.0;   ///< the same for motions that the level above checks first; 0: none
  std::optional<Graph> graph = {};  ///< the explicit graph that the planner searches
  PlannerSpec planner;
  const PlannerKind* kind = nullptr;  ///< in the registry; for a split, the planner of its undivided halves
  bool planner_given = false;         ///< the script names it; else it is the default
  /// The options of a default planner that it takes from the levels above.
  std::vector<std::string> inherited = {};
  PlannerCommon common;  ///< the applicable shares, bound and budget
  /// Below the root: work that guided proposals and the levels below may spend before the bound applies.
  double grant = 0.0;
  double set_up = 0.0;  ///< of the root: estimated work of setting up all guides, see RunCost
  std::optional<GuideExplanation> guide = {};
  std::vector<int> below = {};  ///< numbers of all levels below that the guide searches
};

/// The root of the hierarchy that `execute` would run, without a search.
/// \throws Error as `check` does, if a guide cannot make its space or a planner does not suit it
LevelExplanation explain(const StrategySpec& strategy, const Problem& problem);

}  // namespace trellis
