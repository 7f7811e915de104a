// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include <trellis/space/nearest.hpp>

namespace trellis {

/// Selects the nodes of a tree or roadmap that a planner tries to connect a new node to.
class Connection {
 public:
  /// The nearest `neighbours` nodes within the distance `radius`, in metres in the metric.
  Connection(std::int64_t neighbours, double radius)
      : rule_(Rule::fixed), neighbours_(static_cast<double>(neighbours)), radius_(radius) {}

  // The number or the radius that asymptotic optimality requires for n nodes (Karaman and Frazzoli 2011). `factor`
  // multiplies the published bound; the proofs require a factor > 1.
  /// The k nearest nodes, k = factor e (1 + 1/d) log n.
  static Connection k_nearest(const Space& space, double factor);
  /// All nodes within r = factor 2 ((1 + 1/d) |C| / (volume of the unit ball))^(1/d) (log n / n)^(1/d). |C| is the
  /// volume of the space, an upper bound of the volume of its valid part.
  static Connection within(const Space& space, double factor);

  /// Finds the nodes to connect a new node at q to.
  void find(const NearestIndex& index, View q, std::vector<NearestIndex::Neighbour>& out) const;
  /// The same, where the nodes found before others were added are known.
  /// \param old  those that `find` found in the index of `old_nodes` nodes
  /// \param added  the nodes that were added to that one since
  /// \return false where that does not say which nodes `find` finds now; then `out` is undefined
  bool find_since(const NearestIndex& index, View q, const std::vector<NearestIndex::Neighbour>& old,
                  std::size_t old_nodes, const NearestIndex& added, std::vector<NearestIndex::Neighbour>& out) const;
  /// The same among the nodes for which `usable` returns true. Other nodes do not count towards the k nearest.
  template <class Usable>
  void find(const NearestIndex& index, View q, std::vector<NearestIndex::Neighbour>& out, const Usable& usable) const {
    const std::size_t wanted = most(index);
    for (double more = 1.0;; more *= 2.0) {
      const bool all = find(index, q, out, more);
      std::erase_if(out, [&](const auto& neighbour) { return !usable(neighbour.id); });
      if (!all && out.size() < wanted) continue;
      if (out.size() > wanted) out.resize(wanted);
      return;
    }
  }

 private:
  /// \param more  factor on the number of neighbours
  /// \return whether a larger factor finds no further node
  bool find(const NearestIndex& index, View q, std::vector<NearestIndex::Neighbour>& out, double more) const;
  /// The maximum number of nodes to connect a new node to.
  [[nodiscard]] std::size_t most(const NearestIndex& index) const { return most(index.size()); }
  [[nodiscard]] std::size_t most(std::size_t nodes) const;

  enum class Rule : std::uint8_t { fixed, k_nearest, within };
  Connection(Rule rule, double neighbours, double radius, double dimension)
      : rule_(rule), neighbours_(neighbours), radius_(radius), dimension_(dimension) {}

  Rule rule_;
  double neighbours_;  ///< k, or k / log n
  double radius_;      ///< r, or r / (log n / n)^(1/d)
  double dimension_ = 1.0;
};

}  // namespace trellis
