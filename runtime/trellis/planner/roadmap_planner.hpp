// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <unordered_set>
#include <utility>
#include <vector>

#include <trellis/instance/edge_evaluator.hpp>
#include <trellis/planner/anytime.hpp>
#include <trellis/planner/connectivity.hpp>
#include <trellis/planner/lookahead.hpp>
#include <trellis/planner/roadmap.hpp>

namespace trellis {

/// The probabilistic roadmap planners: eager or lazy validation, first path or anytime improvement.
class RoadmapPlanner final : public Planner, private StepsAhead {
 public:
  struct Mode {
    bool lazy_nodes = false;  ///< checks a node when the shortest path contains it
    bool lazy_edges = false;  ///< checks an edge when the shortest path contains it
    /// Checks an edge between nodes that are already connected only when the shortest path contains it. Such edges
    /// change which path is the shortest, never whether there is one.
    bool between_components = false;
    std::int64_t samples = 0;  ///< proposals before the first search
    std::int64_t batch = 1;    ///< proposals per round while start and goal are not connected
    std::int64_t again = 1;    ///< minimum of proposals when a solve has to find another path
    /// Limit of the planner's proposals. A lazy roadmap that has spent it reconnects its nodes before it ends.
    double proposals = std::numeric_limits<double>::infinity();
    double improve = 0.0;  ///< proposals spent on a shorter path after the first path
    /// Maximum distance of a new node from the nearest one, in metres in the metric. If finite, the planner steers
    /// towards proposals instead of inserting them.
    double step = std::numeric_limits<double>::infinity();
    bool remove_first = false;
    bool coarse_to_fine = false;
    double enhance = 0.0;
    double spread = 0.25;
  };

  RoadmapPlanner(Connection connection, const Mode& mode, PlannerContext context);

  std::optional<Status> begin(const Budget& budget) override;
  [[nodiscard]] bool draws() const override { return !without_proposals_; }
  Plan plan() override { return {.proposal = !without_proposals_ && owed_ > 0}; }
  Outcome extend(View proposal) override;
  std::optional<Status> follow() override;
  std::optional<Status> work() override;
  std::optional<Status> stopped(Status limit) override;
  [[nodiscard]] Solution solution(Status status) override;
  [[nodiscard]] StepsAhead* coming() override { return this; }
  /// Vertices expanded so far by the graph search.
  [[nodiscard]] std::uint64_t expanded() const { return paths_.expanded(); }

 private:
  /// `stale`: valid before the instance changed, not rechecked since. `evaluated`: the evaluator found it valid in the
  /// space from which this one was made; changes of this instance do not affect that.
  enum class Known : std::uint8_t { unknown, valid, stale, evaluated, invalid };
  static constexpr std::uint32_t goal = LifelongSearch::goal;
  /// Cost of an edge that represents no motion: too small to change the order of paths.
  static constexpr double jump_cost = 1e-12;

  /// Whether each proposal becomes a node, if it is valid: then the search for neighbours finds the nearest node, too.
  [[nodiscard]] bool inserts_proposals() const {
    return !mode_.lazy_nodes && mode_.step == std::numeric_limits<double>::infinity();
  }
  [[nodiscard]] std::size_t nodes() const override { return inserts_proposals() ? rows_.size() : 0; }
  void look_ahead(std::size_t step, StepAhead& ahead, Validity& validity) const override;
  void mark_new_nodes(bool begins) override;
  /// Whether the proposal at target_ is valid: checks it, or takes the answer that was computed ahead.
  [[nodiscard]] bool target_valid();
  /// Finds the neighbours of the proposal at q.
  void find_neighbours(View q);

  /// What was computed for the present step; nullptr: nothing.
  [[nodiscard]] const StepAhead* present() const {
    return context_.ahead != nullptr ? context_.ahead->present() : nullptr;
  }
  /// Counts the edges that the graph search has considered since the last call.
  void count_search();
  /// Empties the graph that is searched, and counts what its search has considered.
  void discard_paths();
  [[nodiscard]] std::size_t dimension() const { return context_.instance.space.dimension(); }
  [[nodiscard]] View node(std::uint32_t id) const { return std::as_const(context_.search.nodes)[rows_[id]]; }

  /// Inserts the start and the goals as the first vertices.
  void insert_ends();
  /// Called when the instance changed. Marks what was valid as stale, except edges whose recheck costs no validity
  /// check. Begins a new roadmap if start or goals changed.
  void repair();
  /// The sides of a vertex without its edges, as in Connectivity: the start, a goal, or neither.
  [[nodiscard]] std::uint8_t side_of(std::uint32_t vertex) const {
    if (vertex == LifelongSearch::start) return Connectivity::to_start;
    return vertex < goals_end_ ? Connectivity::to_goal : std::uint8_t{0};
  }
  /// Called when the instance changed. Rechecks the edges that were valid as long as that costs no validity check.
  void recheck_edges();
  /// Removes all edges of an invalid goal.
  void remove_goal(std::uint32_t vertex);
  /// Inserts nodes near the middles of removed edges: invalid edges indicate narrow passages.
  void enhance();
  /// Completes the outcome of a proposal with the node that was added last.
  void note_added(Outcome& outcome);
  /// Adds a node and its edges.
  /// \param unless_there  adds none if a node at the same configuration exists
  /// \return whether it added a node
  bool insert(View q, Known known, bool unless_there = false);
  /// As `insert`, with the neighbours that were found before.
  void insert_found(View q, Known known);
  /// Whether a node among the neighbours found has the configuration that they were found for.
  [[nodiscard]] bool is_neighbour() const;
  /// Work of a search for the neighbours of a new node, and of connecting it.
  [[nodiscard]] double connection_work(bool among_valid) const;
  /// Obtains the instance's evaluator of edges that are presumed valid.
  void begin_evaluation();
  /// Searches until the evaluator's event, or for the shortest path to the goal. Returns the vertex to whose path
  /// validation applies next.
  std::uint32_t next_candidate();
  /// Whether the evaluator's event occurs at a vertex that the search has reached.
  [[nodiscard]] bool is_event(std::uint32_t vertex);
  /// Mean length of a motion up to its first invalid configuration, in metres in the metric: the maximum likelihood
  /// estimate from the evaluated edges, with one invalid motion from start to goal as the prior.
  [[nodiscard]] double mean_valid_length() const;
  /// Validates the shortest path to a vertex: first its nodes, then its edges, each from both ends inwards. Removes the
  /// invalid nodes or the first invalid edge.
  /// \return whether the whole path is valid
  bool validated(std::uint32_t end);
  /// As `validated`, by the evaluator and in the order of its edge selector, until the evaluator is exhausted.
  bool evaluated(std::uint32_t end);
  bool nodes_evaluated();
  bool edges_evaluated();
  /// The index of the i-th of a path's n nodes or edges in the order of the edge selector.
  [[nodiscard]] std::size_t selected(std::size_t i, std::size_t n) const;
  /// Marks a node as invalid and reports it.
  void refute_node(std::uint32_t id);
  /// Whether a node is valid. Adds an invalid node to those to remove.
  bool node_valid(std::uint32_t id);
  void remove_refuted_nodes();
  /// Whether an edge of the path is valid. Removes an invalid edge.
  bool edge_valid(std::size_t at);
  /// Marks an edge as valid.
  void found_valid(std::uint32_t id);
  /// Checks all deferred edges of the path's nodes and removes the invalid ones: a repair of the search for each of
  /// them would cost more than these checks.
  void check_deferred();
  /// While start and goal are not connected: validates the path to a node of the last proposals, from the start to its
  /// first invalid part. This shows the guide which nodes are connected.
  void validate_ahead();
  void validate_prefix(std::uint32_t end);
  /// Connects nodes that lost a neighbour to their nearest nodes that are not known to be invalid. Returns the number
  /// of edges added.
  std::size_t reconnect();
  /// Whether the roadmap is lazy and has spent its own limit of proposals.
  [[nodiscard]] bool lacks_proposals() const {
    return mode_.lazy_nodes && static_cast<double>(context_.search.proposals.size()) >= mode_.proposals;
  }
  /// Searches the roadmap, validates the path found, and determines how many proposals to draw next. Returns the status
  /// if the solve ends.
  std::optional<Status> look();
  /// The same without new proposals. While start and goal are not connected, adds edges between existing nodes if
  /// `reconnects_`, until valid motions connect start and goal or no edge is left to add.
  std::optional<Status> look_without_proposals();
  /// Factor on an edge's length in the cost of a lazy roadmap: the effort to validate the edge, times the guidance's
  /// factor for edges that leave the guiding paths.
  [[nodiscard]] double cost_factor(View a, View b) const;
  void add_edge(std::uint32_t a, std::uint32_t b, double length, Known known);
  /// Whether an edge is checked only when the shortest path contains it.
  [[nodiscard]] bool deferred(std::uint32_t a, std::uint32_t b) {
    return mode_.lazy_edges || (mode_.between_components && !presumed_ && connectivity_.same(a, b));
  }
  /// Checks the edges of the path at their middles, then at their quarters, and so on, each time from both ends of the
  /// path inwards, while the interval is at least four times the resolution. The motion check covers the rest. Removes
  /// the first invalid edge.
  bool coarsely_valid();
  /// Removes an edge of the path that is invalid at position t in [0, 1].
  void remove_edge(std::size_t at, double t);
  /// Reports an invalid motion; for an invalid node, both arguments are the node.
  void report_blocked(View from, View to);
  /// Whether an edge connects a further goal to the first.
  [[nodiscard]] bool is_jump(std::uint32_t edge) const {
    return std::find(jumps_.begin(), jumps_.end(), edge) != jumps_.end();
  }
  /// Counts an edge as checked, so that it connects its ends.
  void join(std::uint32_t edge);
  /// Reports the vertices that became connected to the start or to a goal.
  void report_joined();
  /// Whether an edge counts as checked.
  [[nodiscard]] bool checked(std::uint32_t edge) const {
    return edges_[edge] == Known::valid || (presumed_ && edges_[edge] != Known::invalid);
  }
  /// Recomputes connectivity after edges that counted as checked were removed.
  void rebuild_connectivity();
  /// The path to a node of the search tree.
  [[nodiscard]] Configurations path_to(std::uint32_t end);

  Mode mode_;
  Connection connection_;
  BestPath best_;
  NearestIndex index_;
  std::optional<NearestIndex> new_nodes_;  ///< nodes that steps computed ahead do not contain
  LifelongSearch paths_;
  std::vector<std::uint32_t> rows_;
  std::vector<Known> nodes_;
  std::size_t invalid_nodes_ = 0;
  std::vector<Known> edges_;
  std::vector<std::uint32_t> jumps_;  ///< edges that connect further goals to the first
  std::vector<NearestIndex::Neighbour> neighbours_;
  std::vector<std::uint32_t> path_;          ///< edges of the path
  std::vector<std::uint32_t> stops_;         ///< nodes of the path
  std::unordered_set<std::uint64_t> pairs_;  ///< pairs of nodes connected at any time; filled once reconnection begins
  std::vector<std::uint32_t> lost_neighbour_;        ///< nodes that lost a neighbour since the last reconnection
  std::vector<std::uint32_t> presumed_edges_;        ///< edges that are not unknown, if validity is presumed
  std::vector<std::uint32_t> refuted_;               ///< nodes or edges to remove together
  std::vector<std::uint8_t> passes_;                 ///< for each edge, the finest resolution of its validation
  std::vector<std::array<std::uint32_t, 2>> seeds_;  ///< ends of the removed edges
  Connectivity connectivity_;
  std::vector<Connectivity::Joined> joined_;  ///< not yet reported
  std::vector<std::uint8_t> reported_;        ///< for each node, the sides that its reports named
  BlockedMotions blocked_motions_;
  EdgeEvaluator* evaluator_ = nullptr;  ///< of edges presumed valid; nullptr: none
  LazyEvaluation how_;
  std::uint64_t evaluation_epoch_ = 0;
  double nearest_evaluated_ = std::numeric_limits<double>::infinity();  ///< distance from the goal to the nearest end
                                                                        ///< of a valid evaluated subpath
  double evaluated_length_ = 0.0;   ///< of edges found valid, in metres in the metric
  double evaluated_invalid_ = 0.0;  ///< number of edges found invalid
  double best_cost_ = std::numeric_limits<double>::infinity();
  Configuration sample_;
  Configuration target_;
  Configuration blocked_;
  std::uint32_t goals_end_ = goal + 1;  ///< the vertex after the last goal
  std::uint32_t validated_ahead_ = 0;   ///< validate_ahead has treated all nodes with smaller ids
  std::int64_t owed_ = 0;               ///< proposals to draw before the next search
  double enhancements_ = 0.0;           ///< proposals that `enhance` still has to insert
  bool repaired_ = false;               ///< this solve began with a repair
  bool without_proposals_ = false;      ///< the proposals are spent: this solve searches the nodes that exist
  bool reconnects_ = false;             ///< that search may add edges
  bool reconnecting_ = false;           ///< the proposals are spent, and the planner reconnects nodes
  bool judged_ = false;                 ///< records which nodes were validated
  bool presumed_ = false;               ///< validity costs no checks: an edge counts as checked unless refuted
  bool tracked_ = true;                 ///< computes and reports connectivity
  bool disconnected_ = false;           ///< connectivity is outdated: a checked edge was removed
  std::uint64_t counted_ = 0;           ///< edges that the search of `paths_` has considered, as counted so far
  std::uint64_t epoch_ = 0;
  bool solved_ = false;
};

}  // namespace trellis
