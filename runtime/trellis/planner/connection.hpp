// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include <trellis/planner/nearest.hpp>

namespace trellis {

/// Which nodes of a tree or roadmap a new node may be joined to.
class Connection {
 public:
  /// The `neighbours` nearest, no farther than `radius`.
  Connection(std::int64_t neighbours, double radius)
      : rule_(Rule::fixed), neighbours_(static_cast<double>(neighbours)), radius_(radius) {}

  // As many or as far as n nodes need for shortest paths to come as near to the optimum as one likes (Karaman and
  // Frazzoli 2011); `factor` times the published bound, which it has to be above.
  /// The k nearest, k = factor e (1 + 1/d) log n.
  static Connection k_nearest(const Space& space, double factor);
  /// All within r = factor 2 ((1 + 1/d) |C| / (volume of the unit ball))^(1/d) (log n / n)^(1/d). |C| stands for the
  /// volume of what is valid, which is no more.
  static Connection within(const Space& space, double factor);

  /// The nodes for a new one at q.
  void find(const NearestIndex& index, View q, std::vector<NearestIndex::Neighbour>& out) const;
  /// The same among the nodes for which `usable` holds: others take no place among the nearest.
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
  /// \param more  times as many as the nearest asked for; whether no more would be found
  bool find(const NearestIndex& index, View q, std::vector<NearestIndex::Neighbour>& out, double more) const;
  /// How many nodes a new one is joined to at most.
  [[nodiscard]] std::size_t most(const NearestIndex& index) const;

  enum class Rule : std::uint8_t { fixed, k_nearest, within };
  Connection(Rule rule, double neighbours, double radius, double dimension)
      : rule_(rule), neighbours_(neighbours), radius_(radius), dimension_(dimension) {}

  Rule rule_;
  double neighbours_;  ///< k, or k / log n
  double radius_;      ///< r, or r / (log n / n)^(1/d)
  double dimension_ = 1.0;
};

}  // namespace trellis
