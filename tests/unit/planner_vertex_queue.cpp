// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cstdint>
#include <limits>
#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <trellis/base/random.hpp>
#include <trellis/planner/vertex_queue.hpp>

#include "support/catch.hpp"
#include "support/recording_guidance.hpp"
#include "support/worlds.hpp"

using namespace trellis;
using test::PlannerRun;

TEST_CASE("a queue of vertices returns the least cost, then the least id", "[planner][graph]") {
  Stream stream(1, "", "queue");
  VertexQueue queue;
  std::multiset<std::pair<double, std::uint32_t>> expected;
  for (int i = 0; i < 20000; ++i) {
    // Grows in the first half, shrinks in the second. Few values, so that many are equal.
    if (expected.empty() || stream.uniform() < (i < 10000 ? 0.7 : 0.3)) {
      const double cost = stream.uniform() < 0.01 ? std::numeric_limits<double>::infinity()
                                                  : 1e-9 * static_cast<double>(stream.below(50));
      const auto vertex = static_cast<std::uint32_t>(stream.below(100));
      queue.push(cost, vertex);
      expected.emplace(cost, vertex);
    } else {
      REQUIRE(queue.pop() == *expected.begin());
      expected.erase(expected.begin());
    }
    REQUIRE(queue.empty() == expected.empty());
  }
  queue.push(1.0, 1);
  queue.clear();
  CHECK(queue.empty());
}

namespace {

/// A verified graph of random vertices with random edges, some of them between the same vertices.
std::shared_ptr<Graph> random_graph(Stream& stream) {
  auto graph = std::make_shared<Graph>();
  graph->vertices = Configurations(2);
  const std::uint64_t size = 2 + stream.below(40);
  for (std::uint64_t v = 0; v < size; ++v) {
    graph->vertices.push(Configuration{stream.uniform(0.0, 10.0), stream.uniform(0.0, 10.0)});
  }
  for (std::uint64_t e = 0; e < 2 * size; ++e) {
    const auto from = static_cast<std::uint32_t>(stream.below(size));
    const auto to = static_cast<std::uint32_t>(stream.below(size));
    if (from != to) graph->edges.push_back({from, to, stream.uniform(), {}});
  }
  graph->start = 0;
  graph->goals = {1};
  return graph;
}

/// The costs of the vertices from the start by Bellman and Ford's method.
std::vector<double> costs_from_start(const Graph& graph) {
  std::vector<double> costs(graph.vertices.size(), std::numeric_limits<double>::infinity());
  costs[graph.start] = 0.0;
  for (std::size_t round = 0; round < costs.size(); ++round) {
    for (const Graph::Edge& edge : graph.edges) {
      costs[edge.to] = std::min(costs[edge.to], costs[edge.from] + edge.cost);
      costs[edge.from] = std::min(costs[edge.from], costs[edge.to] + edge.cost);
    }
  }
  return costs;
}

/// The least cost of a path along these vertices, which differ.
double cost_along(const Graph& graph, const Configurations& path) {
  const auto vertex = [&](View q) {
    std::uint32_t v = 0;
    while (!std::ranges::equal(std::as_const(graph.vertices)[v], q)) ++v;
    return v;
  };
  double sum = 0.0;
  for (std::size_t i = 1; i < path.size(); ++i) {
    const std::uint32_t a = vertex(path[i - 1]);
    const std::uint32_t b = vertex(path[i]);
    double least = std::numeric_limits<double>::infinity();
    for (const Graph::Edge& edge : graph.edges) {
      if ((edge.from == a && edge.to == b) || (edge.from == b && edge.to == a)) least = std::min(least, edge.cost);
    }
    sum += least;
  }
  return sum;
}

}  // namespace

TEST_CASE("a search of a graph finds a shortest path after every change of costs", "[planner][graph]") {
  Stream stream(2, "", "changes");
  int solved = 0;
  for (int i = 0; i < 100; ++i) {
    PlannerRun run("graph_search", test::point_problem(1), 1);
    const auto graph = random_graph(stream);
    run.instance->graph = graph;
    for (int change = 0; change < 10; ++change) {
      CAPTURE(i, change);
      const double expected = costs_from_start(*graph)[1];
      const Solution found = run.solve();
      REQUIRE(found.solved() == (expected < std::numeric_limits<double>::infinity()));
      if (found.solved()) {
        ++solved;
        CHECK_THAT(cost_along(*graph, found.path), Catch::Matchers::WithinAbs(expected, 1e-12));
      }
      const std::uint64_t changes = stream.below(5);
      for (std::uint64_t k = 0; k < changes && !graph->edges.empty(); ++k) {
        graph->set_cost(stream.below(graph->edges.size()), stream.uniform() < 0.1 ? 0.0 : stream.uniform());
      }
    }
  }
  CHECK(solved > 300);
}
