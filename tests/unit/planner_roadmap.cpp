// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <limits>
#include <queue>
#include <vector>

#include <trellis/base/random.hpp>
#include <trellis/planner/roadmap.hpp>

#include "support/catch.hpp"

using namespace trellis;

namespace {

/// Dijkstra's search over the remaining graph: the independent result.
double shortest(const LifelongSearch& graph) {
  const double infinity = std::numeric_limits<double>::infinity();
  std::vector<double> distance(graph.vertices(), infinity);
  std::vector<std::vector<std::uint32_t>> adjacency(graph.vertices());
  for (std::uint32_t e = 0; e < graph.edges(); ++e) {
    if (graph.edge(e).removed) continue;
    adjacency[graph.edge(e).a].push_back(e);
    adjacency[graph.edge(e).b].push_back(e);
  }
  using Entry = std::pair<double, std::uint32_t>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
  distance[0] = 0.0;
  queue.emplace(0.0, 0U);
  while (!queue.empty()) {
    const auto [d, v] = queue.top();
    queue.pop();
    if (d != distance[v]) continue;
    for (const auto e : adjacency[v]) {
      const auto next = graph.other(e, v);
      if (d + graph.edge(e).cost < distance[next]) {
        distance[next] = d + graph.edge(e).cost;
        queue.emplace(distance[next], next);
      }
    }
  }
  return distance[1];
}

}  // namespace

namespace {

/// A random graph of points in the unit square, that changes.
class ChangingGraph {
 public:
  explicit ChangingGraph(bool both_bounds) : both_bounds_(both_bounds) {
    add(0, 0);
    add(1, 1);
  }
  /// Edges cost their length; later at least that, so that the bounds stay bounds.
  void add(double x, double y) {
    points_.emplace_back(x, y);
    const auto id = graph.add_vertex(std::hypot(x - 1.0, y - 1.0), both_bounds_ ? std::hypot(x, y) : 0.0);
    for (std::uint32_t other = 0; other < id; ++other) {
      const double length = std::hypot(points_[other].first - x, points_[other].second - y);
      if (length < 0.35 && length > 0.0) {
        graph.add_edge(other, id, length);
        lengths.push_back(length);
      }
    }
  }

  [[nodiscard]] double x(std::uint32_t vertex) const { return points_[vertex].first; }

  LifelongSearch graph;
  std::vector<double> lengths;  ///< of each edge when it was added

 private:
  bool both_bounds_;
  std::vector<std::pair<double, double>> points_;
};

/// Searches, and compares with Dijkstra's search. Whether there is a path.
bool check_search(LifelongSearch& graph) {
  const double expected = shortest(graph);
  const bool found = graph.search();
  REQUIRE(found == std::isfinite(expected));
  REQUIRE(std::isfinite(graph.cost()) == found);
  std::vector<std::uint32_t> edges;
  graph.path(LifelongSearch::goal, edges);
  if (!found) {
    REQUIRE(edges.empty());
    return false;
  }
  REQUIRE(graph.cost() == Approx(expected).epsilon(1e-12));
  double length = 0.0;
  std::uint32_t at = LifelongSearch::start;
  for (const auto e : edges) {
    REQUIRE_FALSE(graph.edge(e).removed);
    length += graph.edge(e).cost;
    at = graph.other(e, at);
  }
  REQUIRE(at == LifelongSearch::goal);
  REQUIRE(length == graph.cost());
  return true;
}

}  // namespace

TEST_CASE("the repaired search always holds the shortest path of the graph as it is", "[roadmap]") {
  const auto seed = static_cast<std::uint64_t>(GENERATE(1, 2, 3, 4, 5, 6));
  const bool both_bounds = GENERATE(false, true);
  Stream stream(seed, "", "roadmap");
  ChangingGraph changing(both_bounds);
  auto& graph = changing.graph;
  int solved = 0;
  for (int round = 0; round < 400; ++round) {
    const double u = stream.uniform();
    if (u < 0.5 || graph.edges() == 0) {
      changing.add(stream.uniform(), stream.uniform());
    } else if (u < 0.9) {
      graph.remove_edge(static_cast<std::uint32_t>(stream.below(graph.edges())));
    } else if (graph.vertices() > 2) {
      graph.isolate(static_cast<std::uint32_t>(2 + stream.below(graph.vertices() - 2)));
    }
    solved += check_search(graph) ? 1 : 0;
  }
  CHECK(solved > 50);
}

TEST_CASE("costs may rise and fall, and edges go in batches, between searches", "[roadmap]") {
  const auto seed = static_cast<std::uint64_t>(GENERATE(range(1, 13)));
  Stream stream(seed, "", "costs");
  ChangingGraph changing(seed % 2 == 0);
  auto& graph = changing.graph;
  for (int i = 0; i < 60; ++i) changing.add(stream.uniform(), stream.uniform());
  int solved = 0;
  for (int round = 0; round < 500; ++round) {
    // Several changes between searches, some of which undo others.
    for (std::uint64_t i = 0; i < 1 + stream.below(6); ++i) {
      const double u = stream.uniform();
      const auto edge = static_cast<std::uint32_t>(stream.below(graph.edges()));
      if (u < 0.15) {
        changing.add(stream.uniform(), stream.uniform());
      } else if (u < 0.75) {
        graph.set_cost(edge, changing.lengths[edge] * (stream.uniform() < 0.4 ? 1.0 : 1.0 + 3.0 * stream.uniform()));
      } else if (u < 0.95) {
        std::vector<std::uint32_t> edges;
        for (std::uint64_t k = 0; k < stream.below(5); ++k) {
          edges.push_back(static_cast<std::uint32_t>(stream.below(graph.edges())));
        }
        graph.remove_edges(edges);
      } else {
        std::vector<std::uint32_t> vertices;
        for (std::uint64_t k = 0; k < stream.below(3); ++k) {
          vertices.push_back(static_cast<std::uint32_t>(2 + stream.below(graph.vertices() - 2)));
        }
        graph.isolate(vertices);
      }
    }
    solved += check_search(graph) ? 1 : 0;
  }
  CHECK(solved > 50);
}

TEST_CASE("completed, the tree from the start holds all vertices that can be reached, by shortest paths", "[roadmap]") {
  const auto seed = static_cast<std::uint64_t>(GENERATE(1, 2, 3));
  Stream stream(seed, "", "tree");
  ChangingGraph changing(true);
  auto& graph = changing.graph;
  for (int i = 0; i < 80; ++i) changing.add(stream.uniform(), stream.uniform());
  for (int round = 0; round < 30; ++round) {
    for (int i = 0; i < 5; ++i) graph.remove_edge(static_cast<std::uint32_t>(stream.below(graph.edges())));
    const bool found = graph.search();
    CHECK(graph.search_all() == found);
    for (std::uint32_t vertex = 2; vertex < graph.vertices(); ++vertex) {
      // The goal's place is taken by the vertex.
      LifelongSearch alone;
      alone.add_vertex(0.0);
      alone.add_vertex(0.0);
      std::vector<std::uint32_t> ids(graph.vertices());
      for (std::uint32_t v = 1; v < graph.vertices(); ++v) ids[v] = v == vertex ? 1 : alone.add_vertex(0.0);
      for (std::uint32_t e = 0; e < graph.edges(); ++e) {
        const auto& edge = graph.edge(e);
        if (!edge.removed) alone.add_edge(ids[edge.a], ids[edge.b], edge.cost);
      }
      const double expected = shortest(alone);
      REQUIRE(graph.reached(vertex) == std::isfinite(expected));
      if (!graph.reached(vertex)) continue;
      std::vector<std::uint32_t> edges;
      graph.path(vertex, edges);
      double length = 0.0;
      for (const auto e : edges) length += graph.edge(e).cost;
      REQUIRE(length == Approx(expected).epsilon(1e-12));
    }
  }
}

TEST_CASE("repairing after one edge is deleted expands a fraction of what a search from scratch does", "[roadmap]") {
  // A long grid. The deleted edge lies near the middle, where the trees from both ends meet.
  constexpr std::uint32_t columns = 200;
  constexpr std::uint32_t rows = 10;
  LifelongSearch graph;
  const auto heuristic = [](double x, double y) { return std::hypot(x - (columns - 1), y - (rows - 1)); };
  graph.add_vertex(heuristic(0, 0));
  graph.add_vertex(0.0);
  std::vector<std::vector<std::uint32_t>> id(columns, std::vector<std::uint32_t>(rows));
  for (std::uint32_t x = 0; x < columns; ++x) {
    for (std::uint32_t y = 0; y < rows; ++y) {
      id[x][y] = x == 0 && y == 0 ? 0 : x == columns - 1 && y == rows - 1 ? 1 : graph.add_vertex(heuristic(x, y));
      if (x > 0) graph.add_edge(id[x - 1][y], id[x][y], 1.0);
      if (y > 0) graph.add_edge(id[x][y - 1], id[x][y], 1.0);
    }
  }
  REQUIRE(graph.search());
  const auto first = graph.expanded();
  std::vector<std::uint32_t> edges;
  graph.path(LifelongSearch::goal, edges);
  graph.remove_edge(edges[edges.size() / 2]);
  REQUIRE(graph.search());
  CHECK(graph.expanded() - first < first / 10);
  // Near an end only the tree from that end changes.
  graph.path(LifelongSearch::goal, edges);
  const auto second = graph.expanded();
  graph.remove_edge(edges.back());
  REQUIRE(graph.search());
  CHECK(graph.expanded() - second < first / 2);
}

TEST_CASE("without a path nothing is expanded until an edge may join the two parts of the graph", "[roadmap]") {
  ChangingGraph changing(true);
  auto& graph = changing.graph;
  for (int i = 0; i < 200; ++i) {
    const double side = i % 2 == 0 ? 0.0 : 0.7;
    changing.add(side + 0.3 * (i % 7) / 7.0, (i % 13) / 13.0);
  }
  // The vertices on the left lose their edges to those on the right.
  const auto left = [&](std::uint32_t id) { return changing.x(id) < 0.5; };
  for (std::uint32_t id = 0; id < graph.edges(); ++id) {
    if (left(graph.edge(id).a) != left(graph.edge(id).b)) graph.remove_edge(id);
  }
  CHECK_FALSE(graph.search());
  const auto expanded = graph.expanded();
  std::vector<std::uint32_t> added;
  for (int i = 0; i < 100; ++i) {
    const std::uint32_t near = i % 2 == 0 ? LifelongSearch::start : LifelongSearch::goal;
    added.push_back(graph.add_vertex(0.0));
    graph.add_edge(near, added.back(), 2.0);
    if (i > 1) graph.add_edge(added.back(), added[added.size() - 3], 0.5);
    CHECK_FALSE(graph.search());
  }
  CHECK(graph.expanded() == expanded);
  graph.add_edge(added.back(), added[added.size() - 2], 1.0);
  REQUIRE(graph.search());
  CHECK(graph.cost() == Approx(shortest(graph)).epsilon(1e-12));
  CHECK(graph.cost() == Approx(5.0));
}

TEST_CASE("a search that stops at events comes to the shortest path, and to every event before", "[roadmap]") {
  const auto seed = static_cast<std::uint64_t>(GENERATE(1, 2, 3, 4));
  Stream stream(seed, "", "events");
  ChangingGraph changing(false);
  auto& graph = changing.graph;
  for (int i = 0; i < 150; ++i) changing.add(stream.uniform(), stream.uniform());
  // Edges are evaluated where the tree comes to them: a third of them are invalid.
  std::vector<int> known(graph.edges(), 0);
  std::vector<std::uint32_t> edges;
  std::size_t events = 0;
  std::uint32_t end = LifelongSearch::none;
  const auto open = [&](std::uint32_t vertex) {
    graph.path(vertex, edges);
    return std::any_of(edges.begin(), edges.end(), [&](auto id) { return known[id] == 0; });
  };
  while ((end = graph.search_until(open)) != LifelongSearch::none) {
    graph.path(end, edges);
    REQUIRE_FALSE(edges.empty());
    bool valid = true;
    for (const auto id : edges) {
      if (known[id] != 0) continue;
      known[id] = 1;
      if (id % 3 != 0) continue;
      graph.remove_edge(id);
      valid = false;
      break;
    }
    ++events;
    if (end == LifelongSearch::goal && valid) break;
  }
  for (std::uint32_t id = 0; id < graph.edges(); ++id) {
    if (id % 3 == 0) graph.remove_edge(id);
  }
  const double expected = shortest(graph);
  CHECK(events > 10);
  REQUIRE((end == LifelongSearch::goal) == std::isfinite(expected));
  if (end != LifelongSearch::goal) return;
  CHECK(graph.search());
  CHECK(graph.cost() == Approx(expected).epsilon(1e-12));
  double length = 0.0;
  for (const auto id : edges) length += graph.edge(id).cost;
  CHECK(length == Approx(expected).epsilon(1e-12));
}
