// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include <trellis/instance/search_cost.hpp>
#include <trellis/planner/common.hpp>
#include <trellis/space/nearest.hpp>

namespace trellis {

/// Shared by the planners that search explicit graphs: the results of edge evaluations, which remain from one solve to
/// the next, and the level's record. The referenced context outlives this object.
class EvaluatedGraph {
 public:
  static constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();

  explicit EvaluatedGraph(PlannerContext& context) : context_(context) {}

  /// Begins a search of the instance's graph. If the graph is another one than before, discards the results and returns
  /// true.
  bool begin();
  /// What a search of the graph depends on, apart from proposals: a search that was paused continues where this is the
  /// same.
  struct Version {
    std::uint64_t epoch = 0;
    std::uint64_t costs = 0;
    std::vector<Configuration> goals;
    bool operator==(const Version&) const = default;
  };
  [[nodiscard]] Version version() const {
    const Instance& instance = context_.instance;
    return {instance.epoch(), instance.graph->revision, instance.goals};
  }
  /// Marks edges found invalid at an earlier epoch for evaluation, and valid edges for a recheck.
  void renew();

  /// An edge of a vertex.
  struct Incident {
    std::uint32_t edge = 0;
    std::uint32_t to = 0;  ///< its other end
    double cost = 0.0;     ///< of a verified graph, as `read_costs` read it
  };
  /// The edges of a vertex, in their order.
  [[nodiscard]] std::span<const Incident> incident(std::uint32_t vertex) const {
    context_.instance.spend(search_cost::edge * static_cast<double>(first_[vertex + 1] - first_[vertex]));
    return std::span(incident_).subspan(first_[vertex], first_[vertex + 1] - first_[vertex]);
  }

  /// Whether an edge is valid. Evaluates each edge once per epoch and reports an invalid one to the guidance.
  /// \param to  the vertex that the edge leads to
  bool valid(std::uint32_t edge, std::uint32_t to);
  /// The first invalid configuration on an invalid edge.
  [[nodiscard]] View invalid_at(std::uint32_t edge) const { return blocked_.at(edge); }

  /// Adds a vertex to the level's nodes when the search first reaches it.
  /// \param edge  the edge that reaches it; `none` for the start
  void add_node(std::uint32_t vertex, std::uint32_t edge);
  /// For a verified graph: adds the points of an edge to the level's nodes, connected in a chain, when the search first
  /// uses the edge.
  void record(std::uint32_t edge);
  /// For a verified graph: the same for all edges of a vertex, in their order, when a search first expands the vertex.
  void record_edges(std::uint32_t vertex, std::span<const Incident> edges) {
    if (std::exchange(expanded_[vertex], char{1}) != 0) return;
    for (const Incident& next : edges) record(next.edge);
  }
  /// Copies the costs that changed to the edges of the vertices, where a search reads them in order: it would read each
  /// from memory where the graph has it.
  void read_costs();

  /// Counts the work of the beginning of a search: labels of all edges and vertices, with their costs.
  void count_search() {
    const auto size = static_cast<double>(graph_->edges.size() + graph_->vertices.size());
    context_.instance.spend(search_cost::label * size);
  }

  /// Begins to draw `samples` proposals.
  void begin_proposals(std::int64_t samples);
  /// Draws one of them.
  Outcome extend(View proposal);
  /// How many are left to draw.
  [[nodiscard]] std::int64_t proposals_left() const { return proposals_left_; }
  /// Whether the guidance has paths that weigh the edges: then no further proposals are required. Asks after each power
  /// of two of proposals, for a few edges.
  [[nodiscard]] bool finds_paths();

  /// Begins to weigh edges and vertices for a search: by the guidance's paths if it has any, else by the proposals
  /// drawn, else not at all.
  void begin_weighing();
  /// The factor on an edge's cost: the mean of Guidance::edge_factor along the whole edge; or, by proposals, 1 / (1 +
  /// r), where r is the number of proposals that are nearest to the edge by the number expected of its length, each
  /// plus 1.
  [[nodiscard]] double edge_factor(std::uint32_t edge);
  /// Whether there are other factors than 1.
  [[nodiscard]] bool weighs() const { return weights_ != Weights::none; }
  /// A lower bound of `edge_factor` over all edges.
  [[nodiscard]] double least_edge_factor();
  /// The same at a vertex; by proposals, the mean over its edges.
  [[nodiscard]] double vertex_factor(std::uint32_t vertex);

  /// The result of a search that has ended: solved if it reached a goal, else no_path.
  /// \param reached  for each vertex, whether the search reached it
  [[nodiscard]] Status result(const std::vector<char>& reached) const;
  /// The solution from the search tree: its path to a goal, or to the reached vertex that is nearest to one.
  /// \param parent  for each reached vertex, the tree's edge to it
  /// \param reached  for each vertex, whether the search reached it
  /// \param otherwise  the status if the search reached no goal
  [[nodiscard]] Solution solution(const std::vector<std::uint32_t>& parent, const std::vector<char>& reached,
                                  Status otherwise) const;

 private:
  static constexpr char found_valid = 1;
  static constexpr char found_invalid = 2;
  static constexpr char stale = 3;  ///< found valid before the instance changed

  /// For each vertex, whether the graph connects it to the start without edges found invalid. Edges of a verified
  /// graph, and edges presumed valid, count as connections.
  [[nodiscard]] std::vector<char> reachable() const;

  enum class Weights : std::uint8_t { none, paths, proposals };

  /// Computes the lengths of the edges, when first needed.
  void measure();
  /// Calls `visit(from, to)` for the pieces of an edge, at most `piece_` long, in order. Requires `measure`.
  template <class Visit>
  void for_pieces(std::uint32_t edge, const Visit& visit) const;
  /// The mean of the guidance's factor along an edge; infinite if the guidance has no path.
  [[nodiscard]] double path_factor(std::uint32_t edge) const;
  /// Sets `paths_`: asks for the factors of a few edges.
  void ask_for_paths();
  /// Makes the index of the edges' pieces, when first needed.
  void make_index();
  /// Counts a proposal for the edge nearest to it. Requires the index. Returns the row of `middles_`.
  std::uint32_t hit(View q);
  [[nodiscard]] std::uint32_t nearest_vertex(View q) const;

  PlannerContext& context_;
  std::vector<double> lengths_;             ///< per edge, in metres in the metric; empty until measured
  double length_ = 0.0;                     ///< sum of `lengths_`
  double piece_ = 0.0;                      ///< longest piece of an edge, in metres in the metric
  std::optional<NearestIndex> index_;       ///< middles of the pieces of all edges
  Configurations middles_;                  ///< the points of the index
  std::vector<std::uint32_t> middle_edge_;  ///< for each of them, its edge
  std::vector<double> hits_;                ///< per edge: number of proposals nearest to it
  double drawn_ = 0.0;                      ///< number of proposals
  std::int64_t proposals_left_ = 0;
  Configuration first_proposal_;  ///< the first proposal, which has no index yet
  std::vector<char> connected_;   ///< `reachable` when the proposals began
  bool paths_ = false;            ///< the guidance had paths when last asked
  Weights weights_ = Weights::none;
  std::vector<double> edge_factors_;    ///< those computed; else 0
  std::vector<double> vertex_factors_;  ///< those computed; else 0
  std::shared_ptr<Graph> graph_;        ///< the graph that the other members refer to
  std::vector<std::uint32_t> first_;    ///< per vertex: its first edge in `incident_`; then the size of that
  std::vector<Incident> incident_;
  std::vector<double> costs_;   ///< per edge: as last read
  std::vector<char> expanded_;  ///< per vertex of a verified graph: whether its edges were recorded
  std::vector<char> seen_;      ///< per edge: whether it was recorded, or the result of its evaluation
  std::map<std::uint32_t, Configuration> blocked_;  ///< first invalid configuration of each invalid edge
  std::vector<std::uint32_t> rows_;                 ///< per vertex of an unverified graph: its node
  std::uint64_t epoch_ = 0;                         ///< epoch of the validity that `seen_` refers to
};

/// Shared by the planners of explicit graphs. Where they are guided, each search first draws proposals, until the
/// guidance has paths or all proposals are drawn; then it weighs the edges. A search that pauses continues where it
/// was.
class GraphPlanner : public Planner {
 public:
  /// The search draws no more proposals, so the limit of proposals must not end it.
  [[nodiscard]] bool draws() const final { return drawing_; }
  Plan plan() final;
  Outcome extend(View proposal) final { return evaluated_.extend(proposal); }
  std::optional<Status> follow() final;
  std::optional<Status> work() final;
  /// If a budget is spent, the search uses the proposals drawn so far.
  std::optional<Status> stopped(Status limit) final;
  [[nodiscard]] Solution solution(Status status) final;

 protected:
  /// \param samples  proposals of each search where it is guided
  GraphPlanner(std::int64_t samples, PlannerContext context)
      : Planner(std::move(context)), evaluated_(context_), samples_(samples) {}

  /// Begins to draw proposals, or continues what a pause ended; without a guide, begins the search.
  /// \param anew  whether the graph is another one than before
  std::optional<Status> begin_drawing(bool anew);
  /// Begins the search, or continues one that a limit ended. Returns the status if it ends here.
  virtual std::optional<Status> begin_search() = 0;
  /// Whether there is a paused search of the graph as it is now.
  [[nodiscard]] virtual bool continues() const = 0;
  /// Takes a step of the search. Returns the status if it ends.
  virtual std::optional<Status> search_step() = 0;
  /// The solution of the search, which has begun.
  virtual Solution found(Status status) = 0;

  EvaluatedGraph evaluated_;

 private:
  std::optional<Status> end_drawing();

  std::int64_t samples_;
  bool drawing_ = false;
  bool paused_ = false;  ///< while it drew proposals or searched
};

}  // namespace trellis
