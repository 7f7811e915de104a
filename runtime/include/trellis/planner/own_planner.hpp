// SPDX-License-Identifier: GPL-3.0-or-later
// For planners outside of the library: parts of their steps (common.hpp) and the registration. docs/planner.md
// has an example.
#pragma once

#include <cstdint>
#include <memory>
#include <utility>

#include <trellis/planner/common.hpp>

namespace trellis {

// The functions below change the context's search: only the thread that runs the planner may call them. They throw what
// the instance's validity and the guidance throw.

/// Adds a node to the search, and returns its row in Search::nodes.
/// \param context  of the planner; views of nodes are invalid afterwards
/// \param q  of the instance's space
/// \param parent  its parent's row; no_node for a root, which is its own parent
std::uint32_t add_node(PlannerContext& context, View q, std::uint32_t parent = no_node);

/// Extends nodes of a search by straight motions.
class NodeExtension {
 public:
  /// \param context  outlives this object
  /// \param step  longest extension, in metres in the metric
  NodeExtension(PlannerContext& context, double step);

  /// Checks the motion from a node towards a proposal, which the instance counts, and adds its end if it is valid.
  /// \param from  the node's row in Search::nodes
  /// \param proposal  of the instance's space; valid until the next call, because the outcome has a view of it
  /// \return the outcome of Planner::extend, valid until the next call; its `added_row` is the new node, or no_node
  Outcome extend(std::uint32_t from, View proposal);

 private:
  PlannerContext& context_;
  double step_;
  Configuration target_;
  Configuration blocked_;
};

/// Returns the path from the root to a node, both included.
/// \param search  with parents: of a tree
/// \param row  of the node in Search::nodes
Configurations branch_to(const Search& search, std::uint32_t row);

/// Adds a planner to planner_kinds(): then strategies, scripts, help and the reference have it. Call it at the
/// beginning of the program, from one thread.
/// \param kind  with component, `common` and `make`; the component outlives the program's use of the kind
/// \throws Error for a kind without one of these three or whose component is no planner, for a name that is no
///     identifier or that a planner has already, for a missing summary or option of every planner (with_common), for an
///     option that is declared twice, has no description, or does not accept its own default, and after the first use
///     of planner_kinds()
void register_planner(const PlannerKind& kind);

/// The same for a class P that has a constructor P(S, PlannerContext).
/// \tparam settings  a function that returns a static `const Settings<S>&`, made by with_common()
template <auto settings, class P>
void register_planner() {
  register_planner({.component = &settings().component(),
                    .common = [](const Options& options) { return common_of(settings().read(options)); },
                    .make = [](const Options& options, PlannerContext context) -> std::unique_ptr<Planner> {
                      return std::make_unique<P>(settings().read(options), std::move(context));
                    }});
}

}  // namespace trellis
