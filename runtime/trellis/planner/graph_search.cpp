// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <limits>
#include <memory>
#include <optional>
#include <queue>
#include <tuple>
#include <utility>

#include <trellis/base/error.hpp>
#include <trellis/planner/kinds.hpp>
#include <trellis/planner/loop.hpp>
#include <trellis/planner/nearest.hpp>

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
          "edges that nobody has looked at are checked as the search comes to them (A*)",
          "Dijkstra 1959; Hart, Nilsson and Raphael 1968")
          .integer("samples", &GraphSearchSettings::samples, "proposals", Range::at_least(1),
                   "proposals drawn per search where it is guided"));
  return settings;
}

class GraphSearch final : public Planner {
 public:
  GraphSearch(const GraphSearchSettings& settings, Task task) : settings_(settings), task_(std::move(task)) {}

  Solution solve(const Budget& budget) override {
    const Graph& graph = *task_.instance.graph;
    Meter meter(task_, budget);
    const std::vector<double> cost = weighed(meter);
    const auto n = graph.vertices.size();
    std::vector<std::vector<std::uint32_t>> adjacency(n);
    for (std::uint32_t e = 0; e < graph.edges.size(); ++e) {
      adjacency[graph.edges[e].from].push_back(e);
      adjacency[graph.edges[e].to].push_back(e);
    }
    std::vector<std::uint32_t> parent(n, none);
    std::vector<char> done(n, 0);
    if (graph_ != task_.instance.graph) {
      graph_ = task_.instance.graph;
      seen_.assign(graph.edges.size(), 0);
      rows_.assign(n, no_node);
    }
    std::optional<Status> ended;
    if (graph.verified) {
      dijkstra(graph, cost, adjacency, parent, done);
    } else {
      if (auto found = invalid_ends(task_.instance)) return *found;
      // It draws no more proposals, so that these are spent does not end it.
      Budget looks = budget;
      looks.proposals = Budget::unlimited;
      Meter looking(task_, looks);
      ended = verify(graph, cost, adjacency, parent, done, looking);
    }
    Solution solution{done[graph.goal] != 0 ? Status::solved : ended.value_or(Status::no_path),
                      Configurations(task_.instance.space.dimension())};
    std::uint32_t end = graph.goal;
    if (!solution.solved()) {
      end = graph.start;
      double least = std::numeric_limits<double>::infinity();
      for (std::uint32_t v = 0; v < n; ++v) {
        if (done[v] == 0) continue;
        const double to_goal = task_.instance.space.distance(graph.vertices[v], task_.instance.goal);
        if (to_goal < least) {
          least = to_goal;
          end = v;
        }
      }
    }
    std::vector<std::uint32_t> edges;
    for (std::uint32_t at = end; at != graph.start;) {
      const auto& edge = graph.edges[parent[at]];
      edges.push_back(parent[at]);
      at = edge.from == at ? edge.to : edge.from;
    }
    solution.path.push(graph.vertices[graph.start]);
    std::uint32_t at = graph.start;
    for (auto it = edges.rbegin(); it != edges.rend(); ++it) {
      const auto& edge = graph.edges[*it];
      const bool forward = edge.from == at;
      const std::size_t count = edge.points.size();
      for (std::size_t i = 1; i < count; ++i) solution.path.push(edge.points[forward ? i : count - 1 - i]);
      at = forward ? edge.to : edge.from;
      if (count == 0) solution.path.push(graph.vertices[at]);
    }
    return solution;
  }

 private:
  static constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();
  static constexpr char found_valid = 1;
  static constexpr char found_invalid = 2;
  static constexpr char stale = 3;                            // found valid before the instance changed
  using Adjacency = std::vector<std::vector<std::uint32_t>>;  ///< of each vertex its edges

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
        record(graph, e);
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

  /// A* over edges that may be invalid: the edge to a vertex is looked at when the vertex is next, and the vertex is
  /// reached another way where it is invalid. An edge is looked at once as long as nothing changes what is valid.
  /// Returns why it ended before its time, if it did.
  std::optional<Status> verify(const Graph& graph, const std::vector<double>& cost, const Adjacency& adjacency,
                               std::vector<std::uint32_t>& parent, std::vector<char>& done, Meter& meter) {
    Instance& instance = task_.instance;
    if (instance.epoch() != epoch_) {
      epoch_ = instance.epoch();
      for (char& seen : seen_) seen = seen == found_valid || seen == stale ? stale : char{0};
    }
    // What is left of the way costs at least its length at the cheapest rate.
    double rate = 1.0;
    for (std::size_t e = 0; e < cost.size(); ++e) {
      if (graph.edges[e].cost > 0.0) rate = std::min(rate, cost[e] / graph.edges[e].cost);
    }
    const auto ahead = [&](std::uint32_t v) {
      return rate * instance.space.distance(std::as_const(graph.vertices)[v], instance.goal);
    };
    struct Entry {
      double estimate = 0.0;
      double cost = 0.0;
      std::uint32_t vertex = 0;
      std::uint32_t edge = 0;  ///< that it is come to by
    };
    const auto later = [](const Entry& a, const Entry& b) {
      return std::tie(a.estimate, b.cost, a.vertex, a.edge) > std::tie(b.estimate, a.cost, b.vertex, b.edge);
    };
    std::priority_queue<Entry, std::vector<Entry>, decltype(later)> queue(later);
    queue.push({ahead(graph.start), 0.0, graph.start, none});
    while (!queue.empty()) {
      const Entry entry = queue.top();
      queue.pop();
      const std::uint32_t v = entry.vertex;
      if (done[v] != 0) continue;
      if (const auto status = meter.spent()) return status;
      if (entry.edge != none && !is_valid(graph, entry.edge, v)) continue;
      done[v] = 1;
      parent[v] = entry.edge;
      add_node(graph, v, entry.edge);
      if (v == graph.goal) break;
      for (const std::uint32_t e : adjacency[v]) {
        const std::uint32_t next = graph.edges[e].from == v ? graph.edges[e].to : graph.edges[e].from;
        if (done[next] == 0) queue.push({entry.cost + cost[e] + ahead(next), entry.cost + cost[e], next, e});
      }
    }
    return std::nullopt;
  }

  /// Whether the edge that leads to the vertex is valid.
  bool is_valid(const Graph& graph, std::uint32_t e, std::uint32_t to) {
    if (seen_[e] == 0 || seen_[e] == stale) {
      const std::uint32_t from = graph.edges[e].from == to ? graph.edges[e].to : graph.edges[e].from;
      const View a = std::as_const(graph.vertices)[from];
      const View b = std::as_const(graph.vertices)[to];
      const MotionReport report = seen_[e] == stale ? task_.instance.recheck_motion(a, b) : task_.instance.motion(a, b);
      seen_[e] = report.valid ? found_valid : found_invalid;
      if (!report.valid) {
        Configuration blocked(a.size());
        task_.instance.space.interpolate(a, b, report.invalid_at, blocked);
        Outcome outcome;
        outcome.proposal = b;
        outcome.near = a;
        outcome.blocked_at = blocked;
        task_.guidance.observe(outcome, false);
      }
    }
    return seen_[e] == found_valid;
  }

  /// The first time that a vertex is reached it becomes a node of the level.
  void add_node(const Graph& graph, std::uint32_t v, std::uint32_t edge) {
    if (rows_[v] != no_node) return;
    auto& search = task_.search;
    rows_[v] = search.nodes.push(graph.vertices[v]);
    search.parents.push_back(no_node);
    if (edge == none) return;
    const std::uint32_t from = graph.edges[edge].from == v ? graph.edges[edge].to : graph.edges[edge].from;
    search.edges.push_back({rows_[from], rows_[v]});
  }

  /// The edges' costs, those near the guidance's proposals made cheaper: an edge whose ends drew a share s of them
  /// costs length / (1 + s * vertices), so that one with as many as the mean vertex costs half.
  std::vector<double> weighed(Meter& meter) {
    const Graph& graph = *task_.instance.graph;
    std::vector<double> cost;
    for (const auto& edge : graph.edges) cost.push_back(edge.cost);
    if (!task_.guided) return cost;
    NearestIndex index(task_.instance.space);
    for (std::uint32_t v = 0; v < graph.vertices.size(); ++v) index.add(graph.vertices[v]);
    std::vector<double> hits(graph.vertices.size(), 0.0);
    Configuration q(task_.instance.space.dimension());
    double drawn = 0.0;
    const std::vector<char> connected = reachable(graph);
    for (std::int64_t i = 0; i < settings_.samples && !meter.spent(); ++i) {
      propose(task_, q);
      const auto near = index.nearest(q);
      hits[near.id] += 1.0;
      drawn += 1.0;
      Outcome outcome;
      outcome.proposal = q;
      outcome.near = std::as_const(graph.vertices)[near.id];
      outcome.added = outcome.near;
      outcome.fate = Fate::advanced;
      outcome.connected = connected[near.id] != 0;
      settle(task_, outcome);
    }
    if (drawn == 0.0) return cost;
    const auto n = static_cast<double>(graph.vertices.size());
    for (std::size_t e = 0; e < cost.size(); ++e) {
      const double share = 0.5 * (hits[graph.edges[e].from] + hits[graph.edges[e].to]) / drawn;
      cost[e] /= 1.0 + share * n;
    }
    return cost;
  }

  /// Of each vertex whether the graph joins it to the start: its edges are verified or presumed valid, but for those
  /// found invalid.
  [[nodiscard]] std::vector<char> reachable(const Graph& graph) const {
    std::vector<std::vector<std::uint32_t>> neighbours(graph.vertices.size());
    for (std::uint32_t e = 0; e < graph.edges.size(); ++e) {
      if (!graph.verified && e < seen_.size() && seen_[e] == found_invalid) continue;
      neighbours[graph.edges[e].from].push_back(graph.edges[e].to);
      neighbours[graph.edges[e].to].push_back(graph.edges[e].from);
    }
    std::vector<char> reached(graph.vertices.size(), 0);
    std::vector<std::uint32_t> open = {graph.start};
    reached[graph.start] = 1;
    while (!open.empty()) {
      const std::uint32_t at = open.back();
      open.pop_back();
      for (const std::uint32_t next : neighbours[at]) {
        if (reached[next] != 0) continue;
        reached[next] = 1;
        open.push_back(next);
      }
    }
    return reached;
  }

  /// The first time that the search looks along an edge its points become nodes of the level, joined in a row.
  void record(const Graph& graph, std::uint32_t e) {
    if (seen_[e] != 0) return;
    seen_[e] = 1;
    auto& search = task_.search;
    for (std::size_t i = 0; i < graph.edges[e].points.size(); ++i) {
      const std::uint32_t row = search.nodes.push(graph.edges[e].points[i]);
      search.parents.push_back(no_node);
      if (i > 0) search.edges.push_back({row - 1, row});
    }
  }

  GraphSearchSettings settings_;
  Task task_;
  std::shared_ptr<Graph> graph_;     ///< that the rest is about
  std::vector<char> seen_;           ///< per edge: whether it was recorded, or what was found of it
  std::vector<std::uint32_t> rows_;  ///< per vertex of a graph that nobody verified: its node
  std::uint64_t epoch_ = 0;          ///< of the validity that `seen_` tells of
};

}  // namespace

PlannerKind graph_search_kind() {
  return {&graph_search_settings().component(),
          [](const Options& o) { return common_of(graph_search_settings().read(o)); },
          [](const Options& o, Planner::Task task) -> std::unique_ptr<Planner> {
            if (!task.instance.graph) throw Fault("graph_search needs an instance with an explicit graph");
            return std::make_unique<GraphSearch>(graph_search_settings().read(o), std::move(task));
          },
          true};
}

}  // namespace trellis
