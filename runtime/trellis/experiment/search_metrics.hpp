// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <string_view>
#include <vector>

#include <trellis/planner/planner.hpp>
#include <trellis/space/space.hpp>

namespace trellis {

/// What a node added to the roadmap of the nodes that came before it.
enum class NodeClass : std::uint8_t {
  create,      ///< it sees no earlier node: a component of its own
  merge,       ///< it joins two or more components
  expand,      ///< it joins one component, and sees a witness that none saw before
  oversample,  ///< it joins one component and brings nothing new
  invalid,     ///< it is not valid, as some nodes of a lazy roadmap; part of no roadmap
};
std::string_view to_string(NodeClass c);

struct SearchMetricsSettings {
  std::size_t neighbours = 10;       ///< nearest earlier nodes, and nearest witnesses, that a node tries to see
  std::size_t witnesses = 256;       ///< of either set
  std::size_t model_neighbours = 5;  ///< nearest labelled samples that foretell a configuration's validity
};

/// Measures of one level's search other than its efficiency. NaN where there is nothing to measure.
///
/// The roadmap is the one that the nodes induce, whatever edges the planner made, so that trees, roadmaps and lazy
/// roadmaps are judged alike: nodes come in the planner's order, and each is joined to those of its `neighbours`
/// nearest valid earlier nodes that it sees, by a valid straight motion. Where some node of a component is seen
/// already, its others are not looked at: that joins nothing more. A node where another one is already is an
/// oversample.
///
/// Witnesses are valid configurations of the space, quasi-random, the same for all searches of one space, validity and
/// seed. A node sees a witness likewise: one of its `neighbours` nearest witnesses, by a valid straight motion.
/// Each component looks at a witness that it sees no more than once, so that motions are checked at the edge of what
/// is known only.
struct SearchMetrics {
  static constexpr double none = std::numeric_limits<double>::quiet_NaN();

  // Morales, Pearce and Amato 2006, Metrics for analyzing the evolution of C-space models.
  std::vector<NodeClass> classes;      ///< of each node
  std::array<std::size_t, 5> nodes{};  ///< by class
  std::size_t components = 0;          ///< of the roadmap in the end
  double coverage = none;              ///< share of the witnesses that a node sees
  double connectivity = none;          ///< share of the pairs of witnesses that one component sees

  // Burns and Brock 2003, Information theoretic construction of probabilistic roadmaps.
  /// What the proposals tell of C, nats: log 2, which knowing nothing costs, less the mean log loss of the model that
  /// they make, over a second set of witnesses uniform on the whole space. The model takes a configuration to be valid
  /// with probability (v + 1) / (k + 2), v the valid ones of the k = `model_neighbours` proposals nearest to it (all,
  /// where there are fewer). A proposal made before tells nothing. At most log(2 (k + 1) / (k + 2)); negative where the
  /// proposals mislead.
  double information = none;
  double information_per_sample = none;  ///< per proposal, repeated ones too

  // Shares of the proposals; they add up to 1.
  double invalid = none;    ///< the proposal itself is not valid, whatever grew towards it
  double trapped = none;    ///< it is valid, and its extension was rejected
  double redundant = none;  ///< it is valid, and the node that came of it is an oversample
  double useful = none;     ///< the rest
};

/// Checks are counted by nobody. Deterministic.
/// \param valid         of configurations of the space
/// \param valid_motion  of the straight motion from a valid configuration to another
SearchMetrics search_metrics(const Space& space, const Search& search, const std::function<bool(View)>& valid,
                             const std::function<bool(View, View)>& valid_motion,
                             const SearchMetricsSettings& settings = {}, std::uint64_t seed = 0);

/// The first set of witnesses: at most `count` valid configurations; fewer where validity is rare.
Configurations valid_witnesses(const Space& space, const std::function<bool(View)>& valid, std::size_t count,
                               std::uint64_t seed);

}  // namespace trellis
