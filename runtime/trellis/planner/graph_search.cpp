// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <limits>
#include <memory>
#include <optional>
#include <queue>
#include <tuple>
#include <utility>

#include <trellis/base/error.hpp>
#include <trellis/planner/common.hpp>
#include <trellis/planner/evaluated_graph.hpp>
#include <trellis/planner/vertex_queue.hpp>

namespace trellis {

namespace {

struct GraphSearchSettings : CommonSettings {
  GraphSearchSettings() {
    goal_bias = 0.0;
    bound = 0.0;
  }
  std::int64_t samples = 200;
};

const Settings<GraphSearchSettings>& graph_search_settings() {
  static const Settings<GraphSearchSettings> settings = with_common(
      Settings<GraphSearchSettings>(
          Component::Kind::planner, "graph_search",
          "exact shortest path on an explicit graph; where it is guided, an edge costs the more, the farther it lies "
          "from the guiding path along its whole length; a guide without a path draws proposals, which make the edges "
          "nearest to them cheaper; edges that no search has checked yet are checked when the search reaches them (A*)",
          "Dijkstra 1959; Hart, Nilsson and Raphael 1968")
          .integer("samples", &GraphSearchSettings::samples, "proposals", Range::at_least(1),
                   "proposals drawn per search where it is guided and the guide has no path"));
  return settings;
}

class GraphSearch final : public GraphPlanner {
 public:
  GraphSearch(const GraphSearchSettings& settings, PlannerContext context)
      : GraphPlanner(settings.samples, std::move(context)) {}

  std::optional<Status> begin(const Budget& budget) override {
    static_cast<void>(budget);
    const bool anew = evaluated_.begin();
    if (anew) paused_.reset();
    return begin_drawing(anew);
  }

 private:
  /// The vertices that a search has reached.
  struct Tree {
    Tree() = default;
    explicit Tree(const Graph& graph)
        : parent(graph.vertices.size(), EvaluatedGraph::none), done(graph.vertices.size(), 0) {}
    std::vector<std::uint32_t> parent;  ///< the edge that leads to a vertex
    std::vector<char> done;
  };

  void dijkstra(const Graph& graph, Tree& tree) {
    auto& [parent, done] = tree;
    evaluated_.read_costs();
    const bool weighs = evaluated_.weighs();
    std::vector<double>& distance = distances_;
    distance.assign(graph.vertices.size(), std::numeric_limits<double>::infinity());
    queue_.clear();
    distance[graph.start] = 0.0;
    queue_.push(0.0, graph.start);
    while (!queue_.empty()) {
      const auto [d, v] = queue_.pop();
      if (done[v] != 0) continue;
      done[v] = 1;
      const auto edges = evaluated_.incident(v);
      evaluated_.record_edges(v, edges);
      for (const auto& [e, next, cost] : edges) {
        // No cost is negative, so an expanded vertex keeps its distance. A factor takes longer than this condition.
        if (weighs && done[next] != 0) continue;
        const double to = d + (weighs ? cost * evaluated_.edge_factor(e) : cost);
        if (to < distance[next]) {
          distance[next] = to;
          parent[next] = e;
          queue_.push(to, next);
        }
      }
      if (graph.is_goal(v)) break;
    }
  }

  /// An A* search over edges that may be invalid. A pause between two steps does not change what it finds.
  struct Verifying {
    struct Entry {
      double estimate = 0.0;
      double cost = 0.0;
      std::uint32_t vertex = 0;
      std::uint32_t edge = 0;  ///< the edge that leads to it
    };
    struct Later {
      bool operator()(const Entry& a, const Entry& b) const {
        return std::tie(a.estimate, b.cost, a.vertex, a.edge) > std::tie(b.estimate, a.cost, b.vertex, b.edge);
      }
    };

    /// \param lowest the lowest factor on the costs of edges
    Verifying(const Instance& instance, EvaluatedGraph::Version of, double lowest)
        : version(std::move(of)), tree(*instance.graph), to_goal(tree.done.size(), unknown), rate(lowest) {
      queue.push({ahead(instance, instance.graph->start), 0.0, instance.graph->start, EvaluatedGraph::none});
    }

    /// A lower bound of the cost of a path from the vertex to a goal.
    [[nodiscard]] double ahead(const Instance& instance, std::uint32_t v) {
      double& distance = to_goal[v];
      if (distance == unknown) {
        distance = std::numeric_limits<double>::infinity();
        const View vertex = std::as_const(instance.graph->vertices)[v];
        for (const Configuration& goal : version.goals) {
          distance = std::min(distance, instance.space.distance(vertex, goal));
        }
      }
      return rate * distance;
    }

    static constexpr double unknown = -1.0;
    EvaluatedGraph::Version version;
    Tree tree;
    std::vector<double> to_goal;  ///< distances of the vertices to the nearest goal, metres in the metric; or unknown
    double rate;                  ///< the remaining path costs at least its length times this
    std::priority_queue<Entry, std::vector<Entry>, Later> queue;
  };

  [[nodiscard]] bool continues() const override { return paused_ && paused_->version == evaluated_.version(); }

  [[nodiscard]] Solution found(Status status) override {
    const Tree& tree = paused_ ? paused_->tree : ended_;
    return evaluated_.solution(tree.parent, tree.done, status);
  }

  /// A search of a verified graph ends at once.
  std::optional<Status> begin_search() override {
    const Graph& graph = *context_.instance.graph;
    evaluated_.begin_weighing();
    if (graph.verified) {
      evaluated_.count_search();
      ended_ = Tree(graph);
      dijkstra(graph, ended_);
      return evaluated_.result(ended_.done);
    }
    if (const auto invalid = remove_invalid_goals(context_.instance)) return invalid;
    evaluated_.renew();
    if (context_.guided || !continues()) {
      evaluated_.count_search();
      paused_.emplace(context_.instance, evaluated_.version(), evaluated_.least_edge_factor());
    }
    return std::nullopt;
  }

  /// Evaluates the edge to the next vertex in the queue; if the edge is invalid, the search continues with the vertex's
  /// other edges. Evaluates each edge once per epoch of validity.
  std::optional<Status> search_step() override {
    const Graph& graph = *context_.instance.graph;
    auto& queue = paused_->queue;
    auto& [parent, done] = paused_->tree;
    const auto entry = queue.top();
    const std::uint32_t v = entry.vertex;
    queue.pop();
    if (entry.edge == EvaluatedGraph::none || evaluated_.valid(entry.edge, v)) {
      done[v] = 1;
      parent[v] = entry.edge;
      evaluated_.add_node(v, entry.edge);
      if (graph.is_goal(v)) return end_search();
      for (const EvaluatedGraph::Incident& next : evaluated_.incident(v)) {
        if (done[next.to] != 0) continue;
        const double to = entry.cost + cost(next.edge);
        queue.push({to + paused_->ahead(context_.instance, next.to), to, next.to, next.edge});
      }
    }
    while (!queue.empty() && done[queue.top().vertex] != 0) queue.pop();
    return queue.empty() ? end_search() : std::nullopt;
  }

  std::optional<Status> end_search() {
    ended_ = std::move(paused_->tree);
    paused_.reset();
    return evaluated_.result(ended_.done);
  }

  /// The cost of an edge, with the guidance's factor.
  [[nodiscard]] double cost(std::uint32_t edge) {
    return context_.instance.graph->edges[edge].cost * evaluated_.edge_factor(edge);
  }

  std::optional<Verifying> paused_;  ///< the search of an unverified graph until it ends
  Tree ended_;                       ///< of the search that has ended
  std::vector<double> distances_;    ///< of the vertices of a verified graph from the start
  VertexQueue queue_;                ///< of its search
};

}  // namespace

PlannerKind graph_search_kind() {
  return {&graph_search_settings().component(),
          [](const Options& o) { return common_of(graph_search_settings().read(o)); },
          [](const Options& o, PlannerContext context) -> std::unique_ptr<Planner> {
            if (!context.instance.graph) throw Fault("graph_search needs an instance with an explicit graph");
            return std::make_unique<GraphSearch>(graph_search_settings().read(o), std::move(context));
          },
          true};
}

}  // namespace trellis
