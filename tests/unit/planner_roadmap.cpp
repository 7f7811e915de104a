// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <limits>
#include <queue>
#include <vector>

#include <trellis/base/random.hpp>
#include <trellis/planner/roadmap.hpp>

#include "support/catch.hpp"

using namespace trellis;

namespace {

/// Dijkstra over what is left of the graph: the independent answer.
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

TEST_CASE("the repaired search always holds the shortest path of the graph as it is", "[roadmap]") {
  const auto seed = static_cast<std::uint64_t>(GENERATE(1, 2, 3, 4, 5, 6));
  Stream stream(seed, "", "roadmap");
  LifelongSearch graph;
  std::vector<std::pair<double, double>> points;
  const auto add = [&](double x, double y) {
    points.emplace_back(x, y);
    const auto id = graph.add_vertex(std::hypot(x - 1.0, y - 1.0));
    for (std::uint32_t other = 0; other < id; ++other) {
      const double length = std::hypot(points[other].first - x, points[other].second - y);
      if (length < 0.35 && length > 0.0) graph.add_edge(other, id, length);
    }
  };
  add(0, 0);
  add(1, 1);
  int solved = 0;
  for (int round = 0; round < 400; ++round) {
    const double u = stream.uniform();
    if (u < 0.5 || graph.edges() == 0) {
      add(stream.uniform(), stream.uniform());
    } else if (u < 0.9) {
      graph.remove_edge(static_cast<std::uint32_t>(stream.below(graph.edges())));
    } else if (graph.vertices() > 2) {
      graph.isolate(static_cast<std::uint32_t>(2 + stream.below(graph.vertices() - 2)));
    }
    const double expected = shortest(graph);
    const bool found = graph.search();
    REQUIRE(found == std::isfinite(expected));
    if (!found) continue;
    ++solved;
    REQUIRE(graph.cost() == Approx(expected).epsilon(1e-12));
    std::vector<std::uint32_t> edges;
    graph.path(LifelongSearch::goal, edges);
    double length = 0.0;
    std::uint32_t at = LifelongSearch::start;
    for (const auto e : edges) {
      REQUIRE_FALSE(graph.edge(e).removed);
      length += graph.edge(e).cost;
      at = graph.other(e, at);
    }
    REQUIRE(at == LifelongSearch::goal);
    REQUIRE(length == Approx(expected).epsilon(1e-12));
  }
  CHECK(solved > 50);
}

TEST_CASE("repairing after one edge is deleted expands a fraction of what a search from scratch does", "[roadmap]") {
  // A long grid: the deleted edge lies near the goal.
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
  graph.remove_edge(edges.back());
  REQUIRE(graph.search());
  CHECK(graph.expanded() - first < first / 10);
}
