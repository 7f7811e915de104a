// SPDX-License-Identifier: GPL-3.0-or-later
// Greedy best-first search as a planner of explicit graphs: what it finds, evaluates, reports and refuses.
#include <algorithm>
#include <cmath>
#include <fstream>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <trellis/base/error.hpp>
#include <trellis/instance/grid_graph.hpp>
#include <trellis/memory/search_model.hpp>
#include <trellis/planner/planner.hpp>
#include <trellis/scene/planar/scene.hpp>

#include "support/catch.hpp"
#include "support/families.hpp"
#include "support/fault.hpp"
#include "support/folder.hpp"
#include "support/recording_guidance.hpp"

using namespace trellis;
using Catch::Matchers::Contains;

namespace {

constexpr double cell = 0.25;

LearningTask task_of(const Problem& problem) {
  return {problem.name,
          planar(*problem.scene).world,
          {problem.start[0], problem.start[1]},
          {problem.goal()[0], problem.goal()[1]}};
}

/// A planner with the grid of a problem of a point.
struct Search2 {
  std::unique_ptr<Instance> instance;
  std::unique_ptr<test::RecordingGuidance> guidance;
  Search search{2};
  std::unique_ptr<Planner> planner;
  Budget budget;

  explicit Search2(const Problem& problem, const std::vector<Options::Entry>& given = {}, bool guided = false,
                   const std::string& name = "best_first") {
    instance = make_instance(problem);
    instance->graph = std::make_shared<Graph>(grid_graph(*instance, cell));
    guidance = std::make_unique<test::RecordingGuidance>(*instance, guided ? 1.0 : 0.0);
    const PlannerKind& kind = *find_planner(name);
    const Options options = Options::validate(*kind.component, given);
    budget = kind.common(options).budget;
    planner = kind.make(options, {*instance, *guidance, Stream(1, "0", "proposals"), search, guided});
  }
  Solution solve() const { return planner->solve(*guidance, budget); }
};

void check_path(Search2& run, const Solution& solution) {
  REQUIRE(solution.solved());
  CHECK(std::equal(solution.path.front().begin(), solution.path.front().end(), run.instance->start.begin()));
  CHECK(std::equal(solution.path.back().begin(), solution.path.back().end(), run.instance->goal().begin()));
  for (std::size_t i = 1; i < solution.path.size(); ++i) {
    CHECK(run.instance->validity->motion(solution.path[i - 1], solution.path[i]).valid);
  }
}

std::string fault(const std::vector<Options::Entry>& given, const Problem& problem) {
  return test::fault_of([&] {
    Search2 run(problem, given);
    static_cast<void>(run.solve());
  });
}

}  // namespace

TEST_CASE("best_first finds valid paths of a grid and evaluates what the search of the state evaluates",
          "[planner][best_first]") {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const Problem problem = test::upper_gaps(seed);
    KnownWorld world(task_of(problem), 40);
    for (const auto& [when, evaluation] : {std::pair("expansion", BestFirstSearch::Evaluation::expansion),
                                           std::pair("selection", BestFirstSearch::Evaluation::selection)}) {
      Search2 run(problem, {{"evaluate", std::string(when)}});
      const Solution solution = run.solve();
      const Checks spent = run.instance->checks;
      check_path(run, solution);
      BestFirstSearch expected = world.search(
          [&](const SearchState& state, std::uint32_t v) {
            return norm(SearchState::position(state.graph().vertices[state.graph().goals.front()]) -
                        SearchState::position(state.graph().vertices[v]));
          },
          {.evaluation = evaluation});
      while (!expected.goal()) expected.expand(*expected.open().begin());
      CHECK(spent.motion == expected.evaluations());
      const bool goal_is_expanded = expected.state().at(world.graph().goals.front()).expanded;
      CHECK(run.search.nodes.size() == expected.expansions() + (goal_is_expanded ? 0 : 1));
      // Each edge found invalid is reported.
      CHECK(std::all_of(run.guidance->outcomes.begin(), run.guidance->outcomes.end(),
                        [](const auto& o) { return !o.mine && !o.blocked_at.empty(); }));
    }
  }
}

TEST_CASE("best_first spends fewer checks than A* where greed is right, and finds longer paths",
          "[planner][best_first]") {
  double shortest = 0.0;
  double found = 0.0;
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    Search2 exact(test::upper_gaps(seed), {}, false, "graph_search");
    Search2 greedy(test::upper_gaps(seed), {{"evaluate", std::string("selection")}});
    shortest += path_length(exact.instance->space, exact.solve().path);
    found += path_length(greedy.instance->space, greedy.solve().path);
    CHECK(greedy.instance->checks.validity < exact.instance->checks.validity);
  }
  CHECK(found >= shortest - 1e-9);
}

TEST_CASE("a continued best_first search avoids the edges whose costs grew, and evaluates no edge again",
          "[planner][best_first]") {
  Search2 run(test::make_problem("two gaps", test::rectangle_world({{4, 0, 4.4, 2}, {4, 3, 4.4, 7}, {4, 8, 4.4, 10}}),
                                 Robot::point(), {0.5, 5.0}, {9.5, 5.0}));
  const Solution first = run.solve();
  check_path(run, first);
  const auto crosses_below = [](const Solution& solution) {
    for (std::size_t i = 0; i < solution.path.size(); ++i) {
      if (std::abs(solution.path[i][0] - 4.25) < 0.2) return solution.path[i][1] < 5.0;
    }
    return false;
  };
  const bool below = crosses_below(first);
  Graph& graph = *run.instance->graph;
  for (auto& edge : graph.edges) {
    const View a = std::as_const(graph.vertices)[edge.from];
    if (std::abs(a[0] - 4.2) < 0.5 && (a[1] < 5.0) == below) edge.cost *= 1000.0;
  }
  const Solution second = run.solve();
  check_path(run, second);
  CHECK(crosses_below(second) != below);
  CHECK(run.instance->checks.motion <= graph.edges.size());
  // What had been evaluated costs nothing.
  const auto spent = run.instance->checks.motion;
  static_cast<void>(run.solve());
  CHECK(run.instance->checks.motion == spent);
}

TEST_CASE("a closed world has no path for best_first, and it says how near it came", "[planner][best_first]") {
  Search2 run(
      test::make_problem("closed", test::rectangle_world({{4, 0, 4.4, 10}}), Robot::point(), {0.5, 5.0}, {9.5, 5.0}));
  const Solution solution = run.solve();
  CHECK(solution.status == Status::no_path);
  CHECK(solution.path.back()[0] == Approx(4.0).margin(cell));
}

TEST_CASE("a budget of checks ends best_first, and it continues where it ended", "[planner][best_first]") {
  Search2 run(test::upper_gaps(1));
  Search2 whole(test::upper_gaps(1));
  const Solution expected = whole.solve();
  run.budget.checks = 200;
  CHECK(run.solve().status == Status::budget_spent);
  run.budget.checks = Budget::unlimited;
  const Solution solution = run.solve();
  REQUIRE(solution.solved());
  CHECK(path_length(run.instance->space, solution.path) == Approx(path_length(whole.instance->space, expected.path)));
}

TEST_CASE("vertices near a guide's proposals are expanded earlier", "[planner][best_first]") {
  // All proposals are the goal, so that only its own vertex is nearer.
  Search2 guided(test::upper_gaps(1), {{"samples", std::int64_t{50}}}, true);
  const Solution solution = guided.solve();
  check_path(guided, solution);
  CHECK(guided.search.proposals.size() == 50);
  CHECK(std::count_if(guided.guidance->outcomes.begin(), guided.guidance->outcomes.end(),
                      [](const auto& o) { return o.mine; }) == 50);
}

TEST_CASE("best_first searches by a model, and says which models it cannot use", "[planner][best_first]") {
  std::vector<LearningTask> tasks;
  for (std::uint64_t seed = 1; seed <= 12; ++seed) tasks.push_back(task_of(test::upper_gaps(seed)));
  SearchTrainingSettings settings;
  settings.rounds = 6;
  settings.forest.trees = 20;
  const SearchModel model = SearchModel::train(tasks, settings, "upper gaps");
  const test::Folder folder;
  std::ofstream(folder.file("gaps.model"), std::ios::binary) << model.bytes();
  double learned = 0.0;
  double greedy = 0.0;
  for (std::uint64_t seed = 101; seed <= 110; ++seed) {
    Search2 by_model(test::upper_gaps(seed), {{"model", folder.file("gaps.model")}});
    check_path(by_model, by_model.solve());
    Search2 by_distance(test::upper_gaps(seed));
    check_path(by_distance, by_distance.solve());
    learned += static_cast<double>(by_model.instance->checks.validity);
    greedy += static_cast<double>(by_distance.instance->checks.validity);
  }
  CHECK(learned < 0.8 * greedy);

  CHECK_THAT(fault({{"model", folder.file("none.model")}}, test::upper_gaps(1)),
             Contains("best_first: option 'model'") && Contains("there is no file"));
  std::ofstream(folder.file("text.model")) << "hello";
  CHECK_THAT(fault({{"model", folder.file("text.model")}}, test::upper_gaps(1)), Contains("is no model"));

  // A graph in a space of three coordinates.
  auto instance = make_instance(test::cup_problem());
  auto graph = std::make_shared<Graph>();
  graph->vertices = Configurations(3);
  graph->start = graph->vertices.push(instance->start);
  graph->goals = {graph->vertices.push(instance->goal())};
  graph->edges.push_back({0, 1, 8.0, Configurations()});
  instance->graph = graph;
  test::RecordingGuidance guidance(*instance);
  Search search(3);
  const PlannerKind& kind = *find_planner("best_first");
  const Options options = Options::validate(*kind.component, {{"model", folder.file("gaps.model")}});
  const auto planner = kind.make(options, {*instance, guidance, Stream(1, "0", "proposals"), search, false});
  CHECK_THROWS_WITH(planner->solve(guidance, kind.common(options).budget), Contains("needs a graph in the plane"));
}
