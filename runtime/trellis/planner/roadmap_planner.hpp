// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <unordered_set>
#include <utility>
#include <vector>

#include <trellis/instance/edge_evaluator.hpp>
#include <trellis/planner/anytime.hpp>
#include <trellis/planner/connectivity.hpp>
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
    /// The planner's budget of proposals: once it is spent, a lazy roadmap reconnects its nodes before it ends.
    double proposals = std::numeric_limits<double>::infinity();
    double improve = 0.0;  ///< proposals spent on a shorter path once one is known
    /// How far a new node may be from the nearest; where that is finite, proposals are only what it grows towards.
    double step = std::numeric_limits<double>::infinity();
    bool remove_first = false;
    bool coarse_to_fine = false;
    double enhance = 0.0;
    double spread = 0.25;
  };

  RoadmapPlanner(Connection connection, const Mode& mode, Task task);

  Solution solve(const Budget& budget) override;
  /// Vertices that its graph search has expanded so far.
  [[nodiscard]] std::uint64_t expanded() const { return paths_.expanded(); }

 private:
  /// `stale`: valid before the instance changed, and not checked since. `evaluated`: found valid by the evaluator, in
  /// the space that this one was made from; the instance's own changes leave that as it is.
  enum class Known : std::uint8_t { unknown, valid, stale, evaluated, invalid };
  static constexpr std::uint32_t goal = LifelongSearch::goal;
  /// Of an edge that stands for no motion: too little to tell one way from another.
  static constexpr double jump_cost = 1e-12;

  [[nodiscard]] std::size_t dimension() const { return task_.instance.space.dimension(); }
  [[nodiscard]] View node(std::uint32_t id) const { return std::as_const(task_.search.nodes)[rows_[id]]; }

  /// The start and the goals become the first vertices.
  void begin();
  /// The instance changed: what was valid becomes stale, but for edges whose validity costs no check to find out.
  /// Begins anew where start or goals are others.
  void repair();
  /// What a vertex is by itself, as in Connectivity: the start, a goal, or neither.
  [[nodiscard]] std::uint8_t side_of(std::uint32_t vertex) const {
    if (vertex == LifelongSearch::start) return Connectivity::to_start;
    return vertex < goals_end_ ? Connectivity::to_goal : std::uint8_t{0};
  }
  /// The instance changed: looks which edges that were valid still are, as long as that costs no validity check.
  void recheck_edges();
  /// Removes all edges of a goal that is invalid now.
  void remove_goal(std::uint32_t vertex);
  void grow();
  /// Places nodes about the middles of removed edges, where the way was found to be narrow.
  void enhance();
  /// Adds a node and its edges. \param unless_there  not where there is one already, at the same place
  /// \return whether it was added
  bool insert(View q, Known known, bool unless_there = false);
  /// Asks the instance for what evaluates edges where they are presumed valid.
  void begin_evaluation();
  /// Searches until the evaluator's event, or for the shortest path to the goal: the vertex to validate the path to.
  std::uint32_t next_candidate();
  /// Whether the path to a vertex that the search has come to is to be evaluated.
  [[nodiscard]] bool is_event(std::uint32_t vertex);
  /// How long a motion is until it is invalid, on average: the maximum likelihood of what was evaluated, with one
  /// motion from start to goal found invalid as the prior.
  [[nodiscard]] double mean_valid_length() const;
  /// Looks at the shortest path to a vertex, nodes first and then edges, each from both ends
  /// inwards, and removes the invalid nodes or the first invalid edge. True when the whole path is valid.
  bool validated(std::uint32_t end);
  /// The same by the evaluator, in the order of its selector, as long as it is not exhausted.
  bool evaluated(std::uint32_t end);
  bool nodes_evaluated();
  bool edges_evaluated();
  /// The node or edge of a path of n that the selector takes as the i-th.
  [[nodiscard]] std::size_t selected(std::size_t i, std::size_t n) const;
  /// Notes and reports that a node is invalid.
  void refute_node(std::uint32_t id);
  /// Whether a node is valid; if not, it is to be removed.
  bool node_valid(std::uint32_t id);
  void remove_refuted_nodes();
  /// Whether an edge of the path is valid; removes it if not.
  bool edge_valid(std::size_t at);
  /// Where start and goal are not connected, validates the path to a node of the last proposals from the start on,
  /// until something invalid, so that a guide learns how far the roadmap is known to reach.
  void validate_ahead();
  void validate_prefix(std::uint32_t end);
  /// Joins nodes that lost a neighbour to the nearest that are not known to be invalid. The number of edges added.
  std::size_t reconnect();
  /// Whether the planner's own budget of proposals is spent, and the roadmap is lazy.
  [[nodiscard]] bool lacks_proposals() const {
    return mode_.lazy_nodes && static_cast<double>(task_.search.proposals.size()) >= mode_.proposals;
  }
  /// No proposals are left: searches the roadmap as it is.
  /// \param reconnects  where start and goal are not connected, reconnect the nodes until they are, by valid motions,
  /// or
  ///                    no edge is left to add
  Solution without_proposals(const Budget& budget, bool reconnects = true);
  /// Factor on the length of an edge in the cost of a lazily validated roadmap: what it takes to validate, and whether
  /// it leaves what guides.
  [[nodiscard]] double cost_factor(View a, View b) const;
  void add_edge(std::uint32_t a, std::uint32_t b, double length, Known known);
  /// Looks at the edges of the path at their middles, then at their quarters, and so on, each time from both ends of
  /// the path inwards, while what is left between is at least four times the resolution; the rest is the motions' own
  /// check. Removes the first invalid edge.
  bool coarsely_valid();
  /// Removes an edge of the path, found invalid at t.
  void remove_edge(std::size_t at, double t);
  /// Reports what was found invalid on the motion from one configuration to another; of a node both are the node.
  void report_blocked(View from, View to);
  /// Whether an edge leads from a further goal to the first.
  [[nodiscard]] bool is_jump(std::uint32_t edge) const {
    return std::find(jumps_.begin(), jumps_.end(), edge) != jumps_.end();
  }
  /// Counts an edge as checked: its ends are joined.
  void join(std::uint32_t edge);
  /// Reports the vertices that became connected to the start or to a goal.
  void report_joined();
  /// Whether an edge counts as checked.
  [[nodiscard]] bool checked(std::uint32_t edge) const {
    return edges_[edge] == Known::valid || (presumed_ && edges_[edge] != Known::invalid);
  }
  /// Computes anew which vertices are connected, where edges that counted as checked were removed.
  void rebuild_connectivity();
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
  std::unordered_set<std::uint64_t> pairs_;          ///< of nodes that were ever joined, once nodes are reconnected
  std::vector<std::uint32_t> lost_neighbour_;        ///< nodes that lost a neighbour since they were reconnected
  std::vector<std::uint32_t> looked_at_;             ///< edges, where validity is presumed, that are not unknown
  std::vector<std::uint32_t> refuted_;               ///< nodes or edges, to be removed together
  std::vector<std::uint8_t> passes_;                 ///< of each edge how finely it was validated
  std::vector<std::array<std::uint32_t, 2>> seeds_;  ///< ends of the edges that were removed
  Connectivity connectivity_;
  std::vector<Connectivity::Joined> joined_;  ///< not yet reported
  std::vector<std::uint8_t> reported_;        ///< of each node the sides that it was reported to be connected to
  BlockedMotions blocked_motions_;
  EdgeEvaluator* evaluator_ = nullptr;  ///< of edges that are presumed valid; nullptr: there is none
  LazyEvaluation how_;
  std::uint64_t evaluation_epoch_ = 0;
  double nearest_evaluated_ = std::numeric_limits<double>::infinity();  ///< to the goal: end of an evaluated subpath
  double evaluated_length_ = 0.0;                                       ///< of edges found valid
  double evaluated_invalid_ = 0.0;                                      ///< edges found invalid
  double best_cost_ = std::numeric_limits<double>::infinity();
  Configuration sample_;
  Configuration target_;
  Configuration blocked_;
  std::uint32_t goals_end_ = goal + 1;  ///< the vertex after the last goal
  std::uint32_t validated_ahead_ = 0;   ///< nodes inserted before were candidates of validate_ahead
  std::int64_t owed_ = 0;               ///< proposals to make before the next search
  double enhancements_ = 0.0;           ///< owed
  bool reconnecting_ = false;           ///< the proposals were spent, and nodes are reconnected
  bool judged_ = false;                 ///< records which nodes were validated
  bool presumed_ = false;               ///< validity costs no checks: an edge that was not refuted counts as checked
  bool tracked_ = true;                 ///< which vertices are connected is computed and reported
  bool disconnected_ = false;           ///< an edge that counted as checked was removed since connectivity was computed
  std::uint64_t epoch_ = 0;
  bool solved_ = false;
};

}  // namespace trellis
