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

/// The contribution of a node to the roadmap of the earlier nodes.
enum class NodeClass : std::uint8_t {
  create,      ///< it sees no earlier node: a new component
  merge,       ///< it connects two or more components
  expand,      ///< it joins one component, and sees a new witness
  oversample,  ///< it joins one component and contributes nothing new
  invalid,     ///< it is invalid, as some nodes of a lazy roadmap; not part of the roadmap
};
std::string_view to_string(NodeClass c);

struct SearchMetricsSettings {
  std::size_t neighbours = 10;       ///< nearest earlier nodes, and nearest witnesses, that a node tries to connect to
  std::size_t witnesses = 256;       ///< in each of the two sets
  std::size_t model_neighbours = 5;  ///< nearest labelled samples that predict a configuration's validity
};

/// Metrics of one level's search other than its efficiency. NaN where there is nothing to measure.
///
/// The metrics use the roadmap that the nodes induce, whatever edges the planner made, so that trees, roadmaps and lazy
/// roadmaps are comparable. Nodes enter in the planner's order. Each connects to those of its `neighbours` nearest
/// valid earlier nodes that it sees, which means that the straight motion is valid. Once a node sees one node of a
/// component, the component's other nodes are not checked: they would connect nothing more. A node at the position of
/// an earlier one is an oversample.
///
/// Witnesses are valid quasi-random configurations of the space, equal for all searches of one space, validity and
/// seed. A node sees a witness likewise: one of its `neighbours` nearest witnesses, by a valid straight motion. Each
/// component checks motions to a witness only until it sees that witness, so that checks occur at the frontier of the
/// search only.
struct SearchMetrics {
  static constexpr double none = std::numeric_limits<double>::quiet_NaN();

  // Morales, Pearce and Amato 2006, Metrics for analyzing the evolution of C-space models.
  std::vector<NodeClass> classes;      ///< of each node
  std::array<std::size_t, 5> nodes{};  ///< by class
  std::size_t components = 0;          ///< of the final roadmap
  double coverage = none;              ///< share of the witnesses that at least one node sees
  double connectivity = none;          ///< share of the pairs of witnesses that one component sees

  // Burns and Brock 2003, Information theoretic construction of probabilistic roadmaps.
  /// The information that the proposals give about C, nats: log 2, the loss without information, minus the mean log
  /// loss of their model over a second set of witnesses, uniform on the whole space. The model predicts a configuration
  /// as valid with probability (v + 1) / (k + 2), with v the number of valid ones among the k = `model_neighbours`
  /// nearest proposals (all, where there are fewer). A repeated proposal adds no information. At most log(2 (k + 1) /
  /// (k + 2)); negative where the proposals mislead.
  double information = none;
  double information_per_sample = none;  ///< per proposal, repetitions included

  // Shares of the proposals; they sum to 1.
  double invalid = none;    ///< the proposal itself is invalid, whatever extension it caused
  double trapped = none;    ///< it is valid, and its extension was rejected
  double redundant = none;  ///< it is valid, and its node is an oversample
  double useful = none;     ///< the rest
};

/// Does not count its checks. Deterministic.
/// \param valid         of configurations of the space
/// \param valid_motion  of the straight motion from a valid configuration to another
SearchMetrics search_metrics(const Space& space, const Search& search, const std::function<bool(View)>& valid,
                             const std::function<bool(View, View)>& valid_motion,
                             const SearchMetricsSettings& settings = {}, std::uint64_t seed = 0);

/// Returns the first set of witnesses: at most `count` valid configurations; fewer where validity is rare.
Configurations valid_witnesses(const Space& space, const std::function<bool(View)>& valid, std::size_t count,
                               std::uint64_t seed);

}  // namespace trellis
