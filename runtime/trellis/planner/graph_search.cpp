// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <limits>
#include <memory>
#include <optional>
#include <queue>
#include <tuple>
#include <utility>

#include <trellis/base/error.hpp>
#include <trellis/planner/evaluated_graph.hpp>
#include <trellis/planner/kinds.hpp>
#include <trellis/planner/loop.hpp>

namespace trellis {

namespace {

struct GraphSearchSettings : CommonSettings {
  GraphSearchSettings() { goal_bias = 0.0; }
  std::int64_t samples = 200;
};

const Settings<GraphSearchSettings>& graph_search_settings() {
  static const Settings<GraphSearchSettings> settings = with_common(
      Settings<GraphSearchSettings>(
          Component::Kind::planner, "graph_search",
          "exact shortest path on an explicit graph; where it is guided, proposals make the edges near them cheaper; "
          "edges that no search has checked yet are checked when the search reaches them (A*)",
          "Dijkstra 1959; Hart, Nilsson and Raphael 1968")
          .integer("samples", &GraphSearchSettings::samples, "proposals", Range::at_least(1),
                   "proposals drawn per search where it is guided"));
  return settings;
}

class GraphSearch final : public Planner {
 public:
  GraphSearch(const GraphSearchSettings& settings, PlannerContext context)
      : settings_(settings), context_(std::move(context)), evaluated_(context_) {}

  Solution solve(const Budget& budget) override {
    const Graph& graph = *context_.instance.graph;
    BudgetMonitor monitor(context_, budget);
    const std::vector<double> cost = weighed(monitor);
    const auto n = graph.vertices.size();
    std::vector<std::vector<std::uint32_t>> adjacency(n);
    for (std::uint32_t e = 0; e < graph.edges.size(); ++e) {
      adjacency[graph.edges[e].from].push_back(e);
      adjacency[graph.edges[e].to].push_back(e);
    }
    std::vector<std::uint32_t> parent(n, EvaluatedGraph::none);
    std::vector<char> done(n, 0);
    evaluated_.begin();
    std::optional<Status> ended;
    if (graph.verified) {
      dijkstra(graph, cost, adjacency, parent, done);
    } else {
      if (auto found = remove_invalid_goals(context_.instance)) return *found;
      // The search draws no more proposals, so the limit of proposals must not end it.
      Budget looks = budget;
      looks.proposals = Budget::unlimited;
      BudgetMonitor looking(context_, looks);
      ended = verify(graph, cost, adjacency, parent, done, looking);
    }
    return evaluated_.solution(parent, done, ended.value_or(Status::no_path));
  }

 private:
  using Adjacency = std::vector<std::vector<std::uint32_t>>;  ///< edges of each vertex

  void dijkstra(const Graph& graph, const std::vector<double>& cost, const Adjacency& adjacency,
                std::vector<std::uint32_t>& parent, std::vector<char>& done) {
    std::vector<double> distance(graph.vertices.size(), std::numeric_limits<double>::infinity());
    using Entry = std::pair<double, std::uint32_t>;
    std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
    distance[graph.start] = 0.0;
    queue.emplace(0.0, graph.start);
    while (!queue.empty()) {
      const auto [d, v] = queue.top();
      queue.pop();
      if (done[v] != 0) continue;
      done[v] = 1;
      for (const std::uint32_t e : adjacency[v]) {
        evaluated_.record(e);
        const std::uint32_t next = graph.edges[e].from == v ? graph.edges[e].to : graph.edges[e].from;
        if (d + cost[e] < distance[next]) {
          distance[next] = d + cost[e];
          parent[next] = e;
          queue.emplace(distance[next], next);
        }
      }
      if (v == graph.goal) break;
    }
  }

  /// A* over edges that may be invalid. Evaluates the edge to a vertex when the vertex is next in the queue; if the
  /// edge is invalid, the search continues with the vertex's other edges. Evaluates each edge once per epoch of
  /// validity.
  /// \return the reason if it stops early, else none
  std::optional<Status> verify(const Graph& graph, const std::vector<double>& cost, const Adjacency& adjacency,
                               std::vector<std::uint32_t>& parent, std::vector<char>& done, BudgetMonitor& monitor) {
    const Instance& instance = context_.instance;
    evaluated_.renew();
    // The remaining path costs at least its length times the lowest rate.
    double rate = 1.0;
    for (std::size_t e = 0; e < cost.size(); ++e) {
      if (graph.edges[e].cost > 0.0) rate = std::min(rate, cost[e] / graph.edges[e].cost);
    }
    const auto ahead = [&](std::uint32_t v) {
      return rate * instance.space.distance(std::as_const(graph.vertices)[v], instance.goal());
    };
    struct Entry {
      double estimate = 0.0;
      double cost = 0.0;
      std::uint32_t vertex = 0;
      std::uint32_t edge = 0;  ///< the edge that leads to it
    };
    const auto later = [](const Entry& a, const Entry& b) {
      return std::tie(a.estimate, b.cost, a.vertex, a.edge) > std::tie(b.estimate, a.cost, b.vertex, b.edge);
    };
    std::priority_queue<Entry, std::vector<Entry>, decltype(later)> queue(later);
    queue.push({ahead(graph.start), 0.0, graph.start, EvaluatedGraph::none});
    while (!queue.empty()) {
      const Entry entry = queue.top();
      queue.pop();
      const std::uint32_t v = entry.vertex;
      if (done[v] != 0) continue;
      if (const auto status = monitor.spent()) return status;
      if (entry.edge != EvaluatedGraph::none && !evaluated_.valid(entry.edge, v)) continue;
      done[v] = 1;
      parent[v] = entry.edge;
      evaluated_.add_node(v, entry.edge);
      if (v == graph.goal) break;
      for (const std::uint32_t e : adjacency[v]) {
        const std::uint32_t next = graph.edges[e].from == v ? graph.edges[e].to : graph.edges[e].from;
        if (done[next] == 0) queue.push({entry.cost + cost[e] + ahead(next), entry.cost + cost[e], next, e});
      }
    }
    return std::nullopt;
  }

  /// The edges' costs, reduced near the guidance's proposals: an edge whose ends are nearest to a share s of them costs
  /// length / (1 + s * vertices). With the share of the mean vertex it costs half.
  std::vector<double> weighed(BudgetMonitor& monitor) {
    const Graph& graph = *context_.instance.graph;
    std::vector<double> cost;
    for (const auto& edge : graph.edges) cost.push_back(edge.cost);
    if (!context_.guided) return cost;
    const EvaluatedGraph::Proposals proposals = evaluated_.draw(settings_.samples, monitor);
    if (proposals.drawn == 0.0) return cost;
    const auto n = static_cast<double>(graph.vertices.size());
    for (std::size_t e = 0; e < cost.size(); ++e) {
      const double share =
          0.5 * (proposals.hits[graph.edges[e].from] + proposals.hits[graph.edges[e].to]) / proposals.drawn;
      cost[e] /= 1.0 + share * n;
    }
    return cost;
  }

  GraphSearchSettings settings_;
  PlannerContext context_;
  EvaluatedGraph evaluated_;
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
