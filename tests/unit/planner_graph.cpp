// SPDX-License-Identifier: GPL-3.0-or-later
// Searches of explicit graphs that pause, and instances that change meanwhile.
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <trellis/instance/grid_graph.hpp>
#include <trellis/planner/planner.hpp>

#include "support/catch.hpp"
#include "support/recording_guidance.hpp"
#include "support/worlds.hpp"

using namespace trellis;
using test::PlannerRun;

namespace {

struct Kind {
  std::string planner;
  std::vector<Options::Entry> options = {};
};

const std::vector<Kind>& kinds() {
  static const std::vector<Kind> all = {{"graph_search"},
                                        {"best_first", {{"evaluate", std::string("expansion")}}},
                                        {"best_first", {{"evaluate", std::string("selection")}}}};
  return all;
}

/// A search of the grid of a world of discs, whose edges no search has checked.
PlannerRun make_run(const Kind& kind, std::uint64_t seed) {
  PlannerRun run(kind.planner, test::point_problem(seed), 1, kind.options);
  run.instance->graph = std::make_shared<Graph>(grid_graph(*run.instance, 0.25));
  return run;
}

/// A search of a graph with two routes around the middle of an empty square. The lower one is shorter.
PlannerRun make_two_routes(const Kind& kind, std::vector<Options::Entry> options = {}) {
  options.insert(options.end(), kind.options.begin(), kind.options.end());
  PlannerRun run(kind.planner, test::make_problem("empty", test::rectangle_world({}), Robot::point(), {1, 5}, {9, 5}),
                 1, options);
  auto graph = std::make_shared<Graph>();
  graph->vertices = Configurations(2);
  for (const Configuration& q : {Configuration{1, 5}, {9, 5}, {5, 9}, {5, 2}}) graph->vertices.push(q);
  graph->goals = {1};
  const auto join = [&](std::uint32_t from, std::uint32_t to, const std::vector<Configuration>& corners) {
    Configurations points(2);
    for (const Configuration& q : corners) points.push(q);
    const double length = path_length(run.instance->space, points);
    graph->edges.push_back({from, to, length, std::move(points)});
  };
  join(0, 2, {{1, 5}, {1, 9}, {5, 9}});
  join(1, 2, {{9, 5}, {9, 9}, {5, 9}});
  join(0, 3, {{1, 5}, {1, 2}, {5, 2}});
  join(1, 3, {{9, 5}, {9, 2}, {5, 2}});
  run.instance->graph = std::move(graph);
  return run;
}

double highest(const Configurations& path) {
  double most = 0.0;
  for (std::size_t i = 0; i < path.size(); ++i) most = std::max(most, path[i][1]);
  return most;
}

bool equal(const Configurations& a, const Configurations& b) {
  return std::equal(a.values().begin(), a.values().end(), b.values().begin(), b.values().end());
}

/// Solves in slices of a few steps.
/// \param between  called after each slice with its number
template <class Between>
Solution solve_in_slices(PlannerRun& run, std::size_t& asked, const Between& between) {
  int left = 0;
  run.paused = [&] {
    ++asked;
    return left-- <= 0;
  };
  for (int slice = 1; slice < 100000; ++slice) {
    left = 3;
    Solution solution = run.solve();
    if (solution.status != Status::paused) return solution;
    CHECK_FALSE(solution.path.empty());
    between(slice);
  }
  return {};
}

}  // namespace

TEST_CASE("a search of a graph continues where it paused", "[planner][graph]") {
  for (const Kind& kind : kinds()) {
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
      CAPTURE(kind.planner, seed);
      PlannerRun whole = make_run(kind, seed);
      std::size_t steps = 0;
      whole.paused = [&] {
        ++steps;
        return false;
      };
      const Solution expected = whole.solve();
      REQUIRE(expected.solved());

      PlannerRun sliced = make_run(kind, seed);
      std::size_t asked = 0;
      std::size_t slices = 1;
      const Solution found = solve_in_slices(sliced, asked, [&](int) { ++slices; });
      REQUIRE(found.solved());
      REQUIRE(slices > 3);
      CHECK(equal(found.path, expected.path));
      CHECK(equal(sliced.search.nodes, whole.search.nodes));
      CHECK(sliced.search.edges == whole.search.edges);
      CHECK(sliced.instance->checks.motion == whole.instance->checks.motion);
      // No step is repeated: each slice ends with one more question, whose answer is yes.
      CHECK(asked == steps + slices - 1);
    }
  }
}

TEST_CASE("a search of a graph begins again where the world or the costs changed while it paused", "[planner][graph]") {
  const auto disc = [](View q) { return std::hypot(q[0] - 5.0, q[1] - 5.0) <= 1.5; };
  const auto dearer_below = [](Graph& graph) {
    for (std::size_t e = 0; e < graph.edges.size(); ++e) {
      const View q = std::as_const(graph.vertices)[graph.edges[e].from];
      if (q[1] < q[0]) graph.multiply_cost(e, 3.0);
    }
  };
  for (const Kind& kind : kinds()) {
    for (const bool world : {true, false}) {
      CAPTURE(kind.planner, world);
      const auto change = [&](PlannerRun& run) {
        if (world) {
          run.validity->exclude(disc);
        } else {
          dearer_below(*run.instance->graph);
        }
      };
      PlannerRun fresh = make_run(kind, 2);
      const double before = path_length(fresh.instance->space, fresh.solve().path);
      change(fresh);
      const Solution expected = fresh.solve();
      REQUIRE(expected.solved());
      if (kind.planner == "graph_search") CHECK(path_length(fresh.instance->space, expected.path) > before);

      PlannerRun run = make_run(kind, 2);
      std::size_t asked = 0;
      const Solution found = solve_in_slices(run, asked, [&](int slice) {
        if (slice == 3) change(run);
      });
      REQUIRE(found.solved());
      for (std::size_t i = 1; i < found.path.size(); ++i) {
        CHECK(run.instance->validity->motion(found.path[i - 1], found.path[i]).valid);
      }
      CHECK(equal(found.path, expected.path));
    }
  }
}

TEST_CASE("a search of a graph ends at the nearest of several goals, whatever their order", "[planner][graph][goals]") {
  for (const Kind& kind : kinds()) {
    CAPTURE(kind.planner);
    Problem problem = test::point_problem(4);
    problem.goals = {{9.5, 9.5}, {0.6, 3.0}, {5.0, 9.8}};
    std::ranges::sort(problem.goals);
    Configurations first;
    do {
      PlannerRun run(kind.planner, problem, 1, kind.options);
      run.instance->graph = std::make_shared<Graph>(grid_graph(*run.instance, 0.25));
      CHECK(run.instance->graph->goals.size() == 3);
      const Solution found = run.solve();
      REQUIRE(found.solved());
      CHECK(std::ranges::equal(found.path.back(), Configuration{0.6, 3.0}));
      if (first.empty()) first = found.path;
      CHECK(equal(found.path, first));
    } while (std::ranges::next_permutation(problem.goals).found);
  }
}

TEST_CASE("a search of a graph passes by a goal that is invalid or shut in", "[planner][graph][goals]") {
  for (const Kind& kind : kinds()) {
    CAPTURE(kind.planner);
    // The first goal lies in a box, the second in an obstacle.
    Problem problem = test::make_problem(
        "shut in",
        test::rectangle_world({{2, 2, 4, 2.2}, {2, 3.8, 4, 4}, {2, 2, 2.2, 4}, {3.8, 2, 4, 4}, {0, 2, 1, 3}}),
        Robot::point(), {1, 1}, {3, 3});
    problem.goals.insert(problem.goals.end(), {{0.5, 2.5}, {9, 9}});
    PlannerRun run(kind.planner, problem, 1, kind.options);
    run.instance->graph = std::make_shared<Graph>(grid_graph(*run.instance, 0.25));
    const Solution found = run.solve();
    REQUIRE(found.solved());
    CHECK(std::ranges::equal(found.path.back(), Configuration{9, 9}));
  }
}

TEST_CASE("a guide's path weighs whole edges of a graph, and needs one proposal", "[planner][graph][guided]") {
  for (const Kind& kind : kinds()) {
    CAPTURE(kind.planner);
    PlannerRun plain = make_two_routes(kind);
    CHECK(highest(plain.solve().path) < 6.0);
    CHECK(plain.search.proposals.empty());

    PlannerRun guided = make_two_routes(kind);
    guided.guided = true;
    guided.guidance.weigh_edge = [](View a, View b) { return 1.0 + std::abs(0.5 * (a[1] + b[1]) - 9.0); };
    const Solution found = guided.solve();
    REQUIRE(found.solved());
    CHECK(highest(found.path) == 9.0);
    CHECK(guided.search.proposals.size() == 1);
  }
}

TEST_CASE("a proposal counts for the edge that it is nearest to, however far its vertices are",
          "[planner][graph][guided]") {
  for (const Kind& kind : kinds()) {
    CAPTURE(kind.planner);
    PlannerRun guided = make_two_routes(kind, {{"samples", std::int64_t{30}}});
    guided.guided = true;
    // The start is the nearest vertex.
    guided.guidance.always = {1.2, 7.9};
    // A guide without a path has no opinion.
    guided.guidance.weigh_edge = [](View, View) { return std::nullopt; };
    const Solution found = guided.solve();
    REQUIRE(found.solved());
    CHECK(highest(found.path) == 9.0);
    CHECK(guided.search.proposals.size() == 30);
    CHECK(guided.guidance.outcomes.size() == 30);
  }
}

TEST_CASE("a guided search of a graph continues where it paused", "[planner][graph][guided]") {
  for (const Kind& kind : kinds()) {
    for (const bool with_path : {false, true}) {
      CAPTURE(kind.planner, with_path);
      const auto make = [&] {
        PlannerRun run = make_run(kind, 2);
        run.guided = true;
        if (with_path) run.guidance.weigh_edge = [](View a, View b) { return 1.0 + std::abs(a[1] - 9.0) + b[0]; };
        return run;
      };
      PlannerRun whole = make();
      const Solution expected = whole.solve();
      REQUIRE(expected.solved());
      PlannerRun sliced = make();
      std::size_t asked = 0;
      const Solution found = solve_in_slices(sliced, asked, [](int) {});
      REQUIRE(found.solved());
      CHECK(equal(found.path, expected.path));
      CHECK(equal(sliced.search.proposals, whole.search.proposals));
      CHECK(sliced.instance->checks.motion == whole.instance->checks.motion);
    }
  }
}
