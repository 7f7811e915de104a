// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <utility>
#include <vector>

#include <trellis/base/configurations.hpp>
#include <trellis/planner/nearest.hpp>
#include <trellis/space/space.hpp>

namespace trellis {

/// An instance whose paths are to be measured; nothing that is asked is counted.
struct CostFieldInstance {
  Space space;
  Configuration start;
  Configuration goal;
  std::function<bool(View)> valid;
  std::function<bool(View, View)> valid_motion;  ///< of the straight motion from a valid configuration to another
};

struct CostFieldSettings {
  std::size_t samples = 2000;  ///< valid ones that the roadmap is made of
};

/// The length of the shortest path through a configuration, for the target "configurations on paths within (1 +
/// epsilon) of the optimum": a PRM* (Karaman and Frazzoli 2011) of valid quasi-random samples, each joined to the
/// ceil(e (1 + 1/d) log n) nearest by straight motions, with the shortest ways from the start and from the goal to
/// every sample. Ways are pulled taut: what sees the sample before its last but one goes there straight.
///
/// All lengths are those of valid paths, so they are never too small, and come down to the truth as the samples grow
/// in number. Deterministic. One thread at a time.
class CostField {
 public:
  /// \param known  valid paths from the start to the goal or within its tolerance: their points join the roadmap, so
  ///               that the optimum is no longer than any of them
  CostField(CostFieldInstance instance, const CostFieldSettings& settings, std::uint64_t seed,
            const std::vector<Configurations>& known = {});

  /// The length of the shortest path found from the start to the goal; infinity where there is none.
  [[nodiscard]] double optimum() const { return optimum_; }
  /// That path; empty where there is none.
  [[nodiscard]] const Configurations& path() const { return path_; }
  /// The length of the shortest way found from the start through q to the goal, by samples near q that it sees;
  /// infinity where q is invalid or sees none that is joined to both.
  [[nodiscard]] double cost(View q) const;

  /// Samples of the roadmap, start, goal and the points of known paths among them.
  [[nodiscard]] std::size_t size() const { return nodes_.size(); }
  /// Nearest samples that each is joined to, and that `cost` looks at.
  [[nodiscard]] std::size_t neighbours() const { return neighbours_; }

 private:
  struct Edge {
    std::uint32_t to = 0;
    double length = 0.0;
  };
  /// Shortest ways from one node to all.
  struct Ways {
    std::vector<double> cost;
    std::vector<std::uint32_t> before;  ///< the node before on the way; the root's itself
  };

  void sample(std::size_t count, std::uint64_t seed);
  void join(const std::vector<Configurations>& known);
  [[nodiscard]] Ways search(std::uint32_t root) const;
  /// The least cost from the root of `ways` straight to q from a node near it, or from the node before that one.
  [[nodiscard]] double reach(const Ways& ways, View q) const;

  CostFieldInstance instance_;
  std::size_t neighbours_ = 0;
  Configurations nodes_;  ///< the start, the goal, samples, points of known paths
  NearestIndex index_;
  std::vector<std::vector<Edge>> edges_;
  Ways from_start_;
  Ways to_goal_;
  double optimum_;
  Configurations path_;
  mutable std::vector<NearestIndex::Neighbour> near_;
  mutable std::vector<std::pair<double, std::uint32_t>> candidates_;
};

}  // namespace trellis
