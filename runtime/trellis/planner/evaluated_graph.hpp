// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <limits>
#include <map>
#include <memory>
#include <vector>

#include <trellis/planner/loop.hpp>

namespace trellis {

/// What the planners of explicit graphs share: the outcomes of edge evaluations, which outlast a solve, and the level's
/// record. The task outlives it.
class EvaluatedGraph {
 public:
  static constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();

  explicit EvaluatedGraph(Planner::Task& task) : task_(task) {}

  /// Begins a search of the instance's graph: forgets the outcomes of another graph. True where it is another one.
  bool begin();
  /// Edges found invalid at an earlier epoch are to be evaluated again, and valid ones to be rechecked.
  void renew();

  /// Whether the edge that leads to the vertex is valid; evaluates an edge once as long as nothing changes what is
  /// valid, and reports one found invalid to the guidance.
  bool valid(std::uint32_t edge, std::uint32_t to);
  /// The first invalid configuration on an edge found invalid.
  [[nodiscard]] View invalid_at(std::uint32_t edge) const { return blocked_.at(edge); }

  /// The first time that a vertex is reached it becomes a node of the level.
  /// \param edge  that reaches it; `none` for the start
  void add_node(std::uint32_t vertex, std::uint32_t edge);
  /// Of a verified graph: the first time that the search takes an edge into account, its points become nodes, joined in
  /// a row.
  void record(std::uint32_t edge);

  /// Per vertex how many of the guidance's proposals it was nearest to.
  struct Proposals {
    std::vector<double> hits;
    double drawn = 0.0;
  };
  /// Draws `samples` proposals, or fewer where the budget ends.
  Proposals draw(std::int64_t samples, Meter& meter);

  /// The path along the tree to the goal, or where it was not reached to the vertex reached nearest to it.
  /// \param parent   of each vertex reached the edge of the tree
  /// \param reached  of each vertex whether it was
  [[nodiscard]] Solution solution(const std::vector<std::uint32_t>& parent, const std::vector<char>& reached,
                                  Status otherwise) const;

 private:
  static constexpr char found_valid = 1;
  static constexpr char found_invalid = 2;
  static constexpr char stale = 3;  ///< found valid before the instance changed

  /// Of each vertex whether the graph joins it to the start: its edges are verified or presumed valid, but for those
  /// found invalid.
  [[nodiscard]] std::vector<char> reachable() const;

  Planner::Task& task_;
  std::shared_ptr<Graph> graph_;                    ///< that the rest is about
  std::vector<char> seen_;                          ///< per edge: whether it was recorded, or what was found of it
  std::map<std::uint32_t, Configuration> blocked_;  ///< of edges found invalid
  std::vector<std::uint32_t> rows_;                 ///< per vertex of an unverified graph: its node
  std::uint64_t epoch_ = 0;                         ///< of the validity that `seen_` tells of
};

}  // namespace trellis
