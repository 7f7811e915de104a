// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <utility>
#include <vector>

#include <trellis/base/configurations.hpp>
#include <trellis/space/nearest.hpp>
#include <trellis/space/space.hpp>

namespace trellis {

/// An instance whose path costs are measured; no call counts as a check.
struct CostFieldInstance {
  Space space;
  Configuration start;
  Configuration goal;
  std::function<bool(View)> valid;
  std::function<bool(View, View)> valid_motion;  ///< of the straight motion between two valid configurations
};

struct CostFieldSettings {
  std::size_t samples = 2000;  ///< valid ones of the roadmap
};

/// Computes the length of the shortest path through a configuration, for the target "configurations on paths within (1
/// + epsilon) of the optimum". A PRM* (Karaman and Frazzoli 2011) of valid quasi-random samples connects each sample to
/// the ceil(e (1 + 1/d) log n) nearest by straight motions, and stores the shortest paths from the start and from the
/// goal to every sample. Paths are shortcut: a sample connects directly to its grandparent where the straight motion is
/// valid.
///
/// All lengths are those of valid paths, so they are upper bounds that converge to the true lengths as the number of
/// samples grows. Deterministic. Only one thread may use it at a time.
class CostField {
 public:
  /// \param known  valid paths from the start to the goal or within its tolerance: their points join the roadmap, so
  ///     that the optimum is at most as long as each of them
  CostField(CostFieldInstance instance, const CostFieldSettings& settings, std::uint64_t seed,
            const std::vector<Configurations>& known = {});

  /// Returns the length of the shortest path found from the start to the goal; infinity where there is none.
  [[nodiscard]] double optimum() const { return optimum_; }
  /// Returns that path; empty where there is none.
  [[nodiscard]] const Configurations& path() const { return path_; }
  /// Returns the length of the shortest path found from the start through q to the goal, over samples near q with valid
  /// motions; infinity where q is invalid or reaches no sample that is connected to both.
  [[nodiscard]] double cost(View q) const;

  /// Returns the number of samples of the roadmap, including start, goal and the points of known paths.
  [[nodiscard]] std::size_t size() const { return nodes_.size(); }
  /// Returns the number of nearest samples that each sample, and each query, tries to connect to.
  [[nodiscard]] std::size_t neighbours() const { return neighbours_; }

 private:
  struct Edge {
    std::uint32_t to = 0;
    double length = 0.0;
  };
  /// Shortest paths from one node to all nodes.
  struct CostTree {
    std::vector<double> cost;
    std::vector<std::uint32_t> before;  ///< the parent of each node; the root's is itself
  };

  void sample(std::size_t count, std::uint64_t seed);
  void join(const std::vector<Configurations>& known);
  [[nodiscard]] CostTree search(std::uint32_t root) const;
  /// Returns the least cost from the root of the shortest paths to q, by a straight motion from a node near q or from
  /// that node's parent.
  [[nodiscard]] double reach(const CostTree& tree, View q) const;

  CostFieldInstance instance_;
  std::size_t neighbours_ = 0;
  Configurations nodes_;  ///< the start, the goal, samples, points of known paths
  NearestIndex index_;
  std::vector<std::vector<Edge>> edges_;
  CostTree from_start_;
  CostTree to_goal_;
  double optimum_;
  Configurations path_;
  mutable std::vector<NearestIndex::Neighbour> near_;
  mutable std::vector<std::pair<double, std::uint32_t>> candidates_;
};

}  // namespace trellis
