// SPDX-License-Identifier: GPL-3.0-or-later
// What a strategy will run on a problem, level by level, before it runs.
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

/// A guide of a level, or guides combined. What is said of it comes from the registry (component, claims); values come
/// from the guide that the executor makes. Pointers are to the registry, which lives as long as the program, or to the
/// custom guide of `spec`.
struct GuideExplanation {
  GuideSpec spec;
  std::string summary;                      ///< one line; "" of a custom guide
  const Component* component = nullptr;     ///< describes the options of `spec`; nullptr where it has none
  const GuideClaims* claims = nullptr;      ///< f, h, density and feedback
  std::int64_t resolves = 0;                ///< times that its space may be solved again; 0 of combinators and S = {0}
  double effort = Budget::unlimited;        ///< proposals that the first search of its space may spend
  double effort_again = Budget::unlimited;  ///< proposals that each further search may spend
  /// Edges of the path found in S are validated in C before it guides, at C's expense.
  bool validates_edges = false;
  std::shared_ptr<const LevelExplanation> level;  ///< the search of its space; nullptr of combinators and where S = {0}
  std::vector<double> shares;           ///< of a mixture: of each part, the share of its proposals; they sum to 1
  std::vector<GuideExplanation> parts;  ///< of a combinator
};

/// The search of one space.
struct LevelExplanation {
  struct Graph {
    std::size_t vertices = 0;
    std::size_t edges = 0;
    bool verified = true;  ///< its edges are known to be valid; else the search checks those that it reaches
  };

  int number = 0;                  ///< as in reports: depth first, the root is 0
  std::string name;                ///< "root", or the guide that made it: "shrink(0.5)"
  Space space;                     ///< C of the root, S of the others
  std::size_t goals = 1;           ///< goals of its instance, at least 1
  std::string motion_model;        ///< "" for straight motions
  bool presumed = false;           ///< validity is presumed: the level spends no checks
  std::string collision;           ///< the backend, "planar" or "fcl"
  double resolution = 0.0;         ///< metres between two checked configurations of a motion
  double shared_resolution = 0.0;  ///< the same of motions that are checked in the level above first; 0: none are
  std::optional<Graph> graph;      ///< an explicit graph that the planner searches
  PlannerSpec planner;
  const PlannerKind* kind = nullptr;  ///< of the registry; of a split that of the undivided halves
  bool planner_given = false;         ///< the script names it; else it is the default
  PlannerCommon common;               ///< shares, bound and budget that apply
  /// Work that guided proposals and the levels below may spend before the bound limits them: validity checks and
  /// proposals.
  double grant = 0.0;
  std::optional<GuideExplanation> guide;
  std::vector<int> below;  ///< numbers of all levels that the guide searches, and of those below these
};

/// The root of what `execute` would run; nothing is searched. Throws Error as `check` does, where a guide cannot make
/// its space or a planner does not suit it.
LevelExplanation explain(const StrategySpec& strategy, const Problem& problem);

}  // namespace trellis
