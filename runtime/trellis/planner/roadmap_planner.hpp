// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include <trellis/planner/anytime.hpp>
#include <trellis/planner/roadmap.hpp>

namespace trellis {

/// The probabilistic roadmap in all its forms: checked when it is built or only along the shortest path, ended by the
/// first path or improved after it.
class RoadmapPlanner final : public Planner {
 public:
  struct Mode {
    bool lazy_nodes = false;   ///< nodes are checked when the shortest path has them
    bool lazy_edges = false;   ///< so are edges
    std::int64_t samples = 0;  ///< proposals before the first search
    std::int64_t batch = 1;    ///< proposals where start and goal are not connected
    std::int64_t again = 1;    ///< proposals at least when another path is asked for
    double improve = 0.0;      ///< proposals spent on a shorter path once one is known
    /// How far a new node may be from the nearest; where that is finite, proposals are only what it grows towards.
    double step = std::numeric_limits<double>::infinity();
    bool remove_first = false;
    bool coarse_to_fine = false;
    double enhance = 0.0;
    double spread = 0.25;
  };

  RoadmapPlanner(Connection connection, const Mode& mode, Task task);

  Solution solve(const Budget& budget) override;

 private:
  enum class Known : std::uint8_t { unknown, valid, invalid };
  static constexpr std::uint32_t goal = LifelongSearch::goal;
  /// Of an edge that stands for no motion: too little to tell one way from another.
  static constexpr double jump_cost = 1e-12;

  [[nodiscard]] std::size_t dimension() const { return task_.instance.space.dimension(); }
  [[nodiscard]] View node(std::uint32_t id) const { return std::as_const(task_.search.nodes)[rows_[id]]; }

  void grow();
  /// Places nodes about the middles of removed edges, where the way was found to be narrow.
  void enhance();
  void insert(View q, Known known);
  /// Looks at the shortest path, nodes first and then edges, each from both ends inwards, and removes the invalid nodes
  /// or the first invalid edge. True when the whole path is valid.
  bool validated();
  /// Looks at the edges of the path at their middles, then at their quarters, and so on, each time from both ends of
  /// the path inwards, while what is left between is at least four times the resolution; the rest is the motions' own
  /// check. Removes the first invalid edge.
  bool coarsely_valid();
  /// Removes an edge of the path, found invalid at t.
  void remove_edge(std::size_t at, double t);
  /// What was found invalid long after it was proposed is still news to h.
  void tell_blocked();
  /// The way to a node of the search tree.
  [[nodiscard]] Configurations way_to(std::uint32_t end);
  [[nodiscard]] Solution finish(Status status);

  Mode mode_;
  Task task_;
  Connection connection_;
  BestPath best_;
  NearestIndex index_;
  LifelongSearch paths_;
  std::vector<std::uint32_t> rows_;
  std::vector<Known> nodes_;
  std::vector<Known> edges_;
  std::vector<std::uint32_t> jumps_;  ///< edges from further goals to the first
  std::vector<NearestIndex::Neighbour> neighbours_;
  std::vector<std::uint32_t> path_;                  ///< edges
  std::vector<std::uint32_t> stops_;                 ///< the nodes between them
  std::vector<std::uint8_t> passes_;                 ///< of each edge how finely it was looked at
  std::vector<std::array<std::uint32_t, 2>> seeds_;  ///< ends of the edges that were removed
  double best_cost_ = std::numeric_limits<double>::infinity();
  Configuration sample_;
  Configuration target_;
  Configuration blocked_;
  std::int64_t owed_ = 0;      ///< proposals to make before the next search
  double enhancements_ = 0.0;  ///< owed
  bool judged_ = false;        ///< which nodes were looked at is kept
  std::uint64_t epoch_ = 0;
  bool solved_ = false;
};

}  // namespace trellis
