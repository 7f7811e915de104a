// SPDX-License-Identifier: GPL-3.0-or-later
// Search heuristics learnt by imitation: the features of a search's state, the oracle, training, and model files.
#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include <trellis/base/error.hpp>
#include <trellis/base/random.hpp>
#include <trellis/instance/grid_graph.hpp>
#include <trellis/memory/model.hpp>
#include <trellis/memory/search_model.hpp>

#include "support/catch.hpp"
#include "support/families.hpp"
#include "support/fault.hpp"
#include "support/folder.hpp"
#include "support/learning_tasks.hpp"

using namespace trellis;
using Catch::Matchers::Contains;

namespace {

constexpr std::size_t cells = 40;

SearchTrainingSettings quick(std::uint64_t seed = 1) {
  SearchTrainingSettings settings;
  settings.cells = cells;
  settings.rounds = 4;
  settings.samples = 40;
  settings.forest.trees = 15;
  settings.forest.seed = seed;
  return settings;
}

/// Learnt in worlds with gaps in their upper halves.
const SearchModel& learnt() {
  static const SearchModel model = SearchModel::train(test::family(test::upper_gaps, 1, 20), quick(), "upper gaps");
  return model;
}

void run(BestFirstSearch& search) {
  while (!search.goal() && !search.open().empty()) search.expand(*search.open().begin());
}

double euclidean(const SearchState& state, std::uint32_t v) {
  const Graph& graph = state.graph();
  return norm(SearchState::position(graph.vertices[graph.goals.front()]) - SearchState::position(graph.vertices[v]));
}

/// The vertices from the start to `v` along the tree.
std::vector<std::uint32_t> branch(const SearchState& state, std::uint32_t v) {
  std::vector<std::uint32_t> vertices = {v};
  while (v != state.graph().start) {
    const Graph::Edge& edge = state.graph().edges[state.at(v).edge];
    v = edge.from == v ? edge.to : edge.from;
    vertices.push_back(v);
  }
  std::reverse(vertices.begin(), vertices.end());
  return vertices;
}

/// The probability of at least `wins` of `n` if either side were equally likely to win.
double sign_test(std::size_t wins, std::size_t n) {
  double tail = 0.0;
  double binomial = 1.0;  // n choose k
  for (std::size_t k = 0; k <= n; ++k) {
    if (k >= wins) tail += binomial;
    binomial *= static_cast<double>(n - k) / static_cast<double>(k + 1);
  }
  return tail / std::pow(2.0, static_cast<double>(n));
}

std::string fault_of(const std::string& file) {
  return test::fault_of([&] { static_cast<void>(SearchModel::load(file)); });
}

}  // namespace

TEST_CASE("the nearest invalid positions are those that a comparison with all gives", "[memory][search]") {
  // 256 lattice cells of 0.01 along the longer side, 128 along the other.
  const Box2 box{{1.0, -2.0}, {3.56, -0.72}};
  constexpr double side = 0.01;
  Stream stream(7, "", "invalid positions");
  for (int round = 0; round < 20; ++round) {
    InvalidPositions positions(box);
    CHECK_FALSE(positions.nearest({2, -1}).has_value());
    std::vector<std::array<int, 2>> all;
    const int count = 1 + static_cast<int>(stream.below(round < 10 ? 5 : 400));
    for (int i = 0; i < count; ++i) {
      const std::array<int, 2> cell = {static_cast<int>(stream.below(256)), static_cast<int>(stream.below(128))};
      all.push_back(cell);
      positions.add(box.lo + Vec2{(cell[0] + 0.3) * side, (cell[1] + 0.8) * side});
    }
    const auto centre = [&](const std::array<int, 2>& cell) {
      return box.lo + Vec2{(cell[0] + 0.5) * side, (cell[1] + 0.5) * side};
    };
    for (int i = 0; i < 100; ++i) {
      const Vec2 p{stream.uniform(box.lo.x, box.hi.x), stream.uniform(box.lo.y, box.hi.y)};
      const std::array<int, 2> own = {static_cast<int>((p.x - box.lo.x) / side),
                                      static_cast<int>((p.y - box.lo.y) / side)};
      double any = std::numeric_limits<double>::infinity();
      std::array<std::pair<int, double>, 2> along;
      along.fill({std::numeric_limits<int>::max(), 0.0});
      for (const auto& cell : all) {
        const double distance = norm(centre(cell) - p);
        any = std::min(any, distance);
        for (std::size_t j = 0; j < 2; ++j) along[j] = std::min(along[j], {std::abs(cell[j] - own[j]), distance});
      }
      const auto found = positions.nearest(p);
      REQUIRE(found.has_value());
      CHECK(norm(found->any - p) == Approx(any));
      CHECK(norm(found->in_x - p) == Approx(along[0].second));
      CHECK(norm(found->in_y - p) == Approx(along[1].second));
      CHECK(std::abs(found->in_x.x - p.x) <= (along[0].first + 0.5) * side + 1e-9);
      CHECK(std::abs(found->in_y.y - p.y) <= (along[1].first + 0.5) * side + 1e-9);
    }
  }
}

TEST_CASE("the features are numbers of the search's state", "[memory][search]") {
  const auto instance = make_instance(test::upper_gaps(3));
  const Graph graph = grid_graph(*instance, 10.0 / cells);
  std::vector<Vec2> invalid;
  Configuration at(2);
  BestFirstSearch search(graph,
                         [&](std::uint32_t e, std::uint32_t to) -> View {
                           const Graph::Edge& edge = graph.edges[e];
                           const View a = graph.vertices[edge.from == to ? edge.to : edge.from];
                           const MotionReport report = instance->motion(a, graph.vertices[to]);
                           if (report.valid) return {};
                           instance->space.interpolate(a, graph.vertices[to], report.invalid_at, at);
                           invalid.push_back({at[0], at[1]});
                           return at;
                         },
                         euclidean, {});
  const SearchState& state = search.state();
  // Nothing was found invalid yet.
  const auto first = state.features(graph.start);
  for (const std::size_t i : {8U, 11U, 14U}) CHECK(first[i] == -1.0);
  CHECK(first[2] == 0.0);
  CHECK(first[5] == 0.0);
  for (int i = 0; i < 150; ++i) search.expand(*search.open().begin());
  REQUIRE(invalid.size() > 20);
  CHECK(state.scale() == Approx(std::hypot(10.0, 10.0)));
  double mean_edge = 0.0;
  for (const auto& edge : graph.edges) mean_edge += edge.cost / static_cast<double>(graph.edges.size());
  const Vec2 goal = SearchState::position(graph.vertices[graph.goals.front()]);
  for (const auto& entry : search.open()) {
    const auto features = state.features(entry.vertex);
    const Vec2 p = SearchState::position(graph.vertices[entry.vertex]);
    const auto vertices = branch(state, entry.vertex);
    double cost = 0.0;
    for (std::size_t i = 1; i < vertices.size(); ++i) {
      cost += norm(SearchState::position(graph.vertices[vertices[i]]) -
                   SearchState::position(graph.vertices[vertices[i - 1]]));
    }
    const auto metres = [&](std::size_t i) { return features[i] * state.scale(); };
    CHECK(metres(0) == Approx(p.x).margin(1e-9));
    CHECK(metres(1) == Approx(p.y).margin(1e-9));
    CHECK(metres(2) == Approx(cost));
    CHECK(metres(3) == Approx(norm(goal - p)).margin(1e-9));
    CHECK(metres(4) == Approx(std::abs(goal.x - p.x) + std::abs(goal.y - p.y)).margin(1e-9));
    CHECK(metres(5) == Approx(static_cast<double>(vertices.size() - 1) * mean_edge));
    CHECK(metres(6) == Approx(goal.x));
    CHECK(metres(7) == Approx(goal.y));
    // As far as the lattice of 256 cells says.
    constexpr double lattice = 10.0 / 256;
    const auto nearest = [&](auto distance) {
      double least = std::numeric_limits<double>::infinity();
      for (const Vec2 q : invalid) least = std::min(least, distance(q));
      return least;
    };
    CHECK(metres(8) == Approx(nearest([&](Vec2 q) { return norm(q - p); })).margin(lattice));
    CHECK(metres(11) == Approx(nearest([&](Vec2 q) { return std::abs(q.x - p.x); })).margin(lattice));
    CHECK(metres(14) == Approx(nearest([&](Vec2 q) { return std::abs(q.y - p.y); })).margin(lattice));
    CHECK(metres(8) == Approx(std::hypot(metres(9), metres(10))));
    CHECK(metres(11) == Approx(std::abs(metres(12))).margin(1e-9));
    CHECK(metres(14) == Approx(std::abs(metres(16))).margin(1e-9));
  }
}

TEST_CASE("a search evaluates each edge at most once, and at selection fewer", "[memory][search]") {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    KnownWorld world(test::task_of(test::upper_gaps(seed)), cells);
    REQUIRE(world.has_path());
    std::vector<double> evaluations;
    for (const auto evaluation : {BestFirstSearch::Evaluation::expansion, BestFirstSearch::Evaluation::selection}) {
      BestFirstSearch search = world.search(euclidean, {.evaluation = evaluation});
      run(search);
      REQUIRE(search.goal());
      CHECK(search.evaluations() <= world.graph().edges.size());
      evaluations.push_back(static_cast<double>(search.evaluations()));
      // The path found leads from start to goal over valid edges, and its length is what the search says.
      const auto vertices = branch(search.state(), world.graph().goals.front());
      CHECK(vertices.front() == world.graph().start);
      for (const std::uint32_t v : vertices) CHECK(std::isfinite(world.cost_to_go()[v]));
      CHECK(search.state().at(world.graph().goals.front()).cost >= world.cost_to_go()[world.graph().start] - 1e-9);
    }
    CHECK(evaluations[1] < evaluations[0]);
  }
}

TEST_CASE("A* over the grid finds the oracle's cost, with the edges evaluated at either time", "[memory][search]") {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    KnownWorld world(test::task_of(test::upper_gaps(seed)), cells);
    for (const auto evaluation : {BestFirstSearch::Evaluation::expansion, BestFirstSearch::Evaluation::selection}) {
      BestFirstSearch search =
          world.search([](const SearchState& state, std::uint32_t v) { return state.at(v).cost + euclidean(state, v); },
                       {.evaluation = evaluation, .ends = BestFirstSearch::Ends::expanded});
      run(search);
      CHECK(search.state().at(world.graph().goals.front()).cost == Approx(world.cost_to_go()[world.graph().start]));
    }
  }
}

TEST_CASE("with the oracle in place of the learner a search expands one path", "[memory][search]") {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    KnownWorld world(test::task_of(test::upper_gaps(seed)), cells);
    const auto& oracle = world.cost_to_go();
    const double shortest = oracle[world.graph().start];
    BestFirstSearch greedy = world.search([&](const SearchState&, std::uint32_t v) { return oracle[v]; });
    run(greedy);
    // Each vertex expanded lies on the path found.
    CHECK(greedy.expansions() + 1 == branch(greedy.state(), world.graph().goals.front()).size());
    CHECK(greedy.state().at(world.graph().goals.front()).cost <= 1.05 * shortest);
    BestFirstSearch exact =
        world.search([&](const SearchState& state, std::uint32_t v) { return state.at(v).cost + oracle[v]; },
                     {.ends = BestFirstSearch::Ends::expanded});
    run(exact);
    for (std::uint32_t v = 0; v < oracle.size(); ++v) {
      if (exact.state().at(v).expanded) CHECK(exact.state().at(v).cost + oracle[v] == Approx(shortest));
    }
  }
}

TEST_CASE("in worlds never shown a learnt search expands fewer vertices than greedy search and A*",
          "[memory][search]") {
  const auto trials = try_searches(learnt(), test::family(test::upper_gaps, 1001, 20));
  REQUIRE(trials.size() == 20);
  std::size_t fewer_than_greedy = 0;
  std::size_t fewer_than_a_star = 0;
  for (const SearchTrial& trial : trials) {
    CAPTURE(trial.name, trial.learned.expansions, trial.euclidean.expansions, trial.a_star.expansions);
    if (trial.learned.expansions < trial.euclidean.expansions) ++fewer_than_greedy;
    if (trial.learned.expansions < trial.a_star.expansions) ++fewer_than_a_star;
    CHECK(trial.learned.length >= trial.a_star.length - 1e-9);
  }
  CAPTURE(fewer_than_greedy, fewer_than_a_star);
  CHECK(sign_test(fewer_than_greedy, trials.size()) < 0.01);
  CHECK(sign_test(fewer_than_a_star, trials.size()) < 0.01);
}

TEST_CASE("what was learnt of a family misleads in the mirror images of its worlds", "[memory][search]") {
  const auto expansions = [](const std::vector<SearchTrial>& trials) {
    double sum = 0.0;
    for (const SearchTrial& trial : trials) sum += trial.learned.expansions;
    return sum / static_cast<double>(trials.size());
  };
  const double own = expansions(try_searches(learnt(), test::family(test::upper_gaps, 1001, 10)));
  const double mirrored = expansions(try_searches(learnt(), test::family(test::lower_gaps, 1001, 10)));
  CHECK(mirrored > 1.5 * own);
}

TEST_CASE("training a search heuristic is deterministic in its seed", "[memory][search]") {
  const auto tasks = test::family(test::upper_gaps, 1, 5);
  SearchTrainingSettings settings = quick(3);
  settings.rounds = 2;
  const std::string one = SearchModel::train(tasks, settings, "a").bytes();
  CHECK(SearchModel::train(tasks, settings, "a").bytes() == one);
  settings.forest.seed = 4;
  CHECK(SearchModel::train(tasks, settings, "a").bytes() != one);
}

TEST_CASE("without a world that has a path there is nothing to learn from", "[memory][search]") {
  const std::vector<LearningTask> closed = {
      {"closed", test::rectangle_world({{4, 0, 4.4, 10}}), {1.0, 1.0}, {9.0, 9.0}}};
  CHECK_THROWS_WITH(SearchModel::train(closed, quick(), "closed"), Contains("in no world is there a path"));
}

TEST_CASE("a search heuristic is in a file what it was, and no other kind of model", "[memory][search]") {
  const test::Folder folder;
  const std::string file = folder.file("a.model");
  const auto write = [&](const std::string& bytes) { std::ofstream(file, std::ios::binary) << bytes; };
  CHECK_THAT(fault_of(file), Contains("there is no such model") && Contains("trellis experience --search"));
  CHECK(known_search_model(file) == nullptr);
  const std::string bytes = learnt().bytes();
  write(bytes);
  const SearchModel read = SearchModel::load(file);
  CHECK(read.bytes() == bytes);
  CHECK(read.description() == "upper gaps");
  CHECK(read.cells() == cells);
  KnownWorld world(test::task_of(test::upper_gaps(77)), cells);
  BestFirstSearch search = world.search(euclidean);
  for (int i = 0; i < 50; ++i) search.expand(*search.open().begin());
  for (const auto& entry : search.open()) {
    CHECK(read.cost_to_go(search.state(), entry.vertex) == learnt().cost_to_go(search.state(), entry.vertex));
  }

  // Each kind names the other one and what makes the kind that was expected.
  CHECK_THROWS_WITH(Model::load(file), Contains("the model is a search heuristic") &&
                                           Contains("expected a classifier of cells") &&
                                           Contains("trellis experience --data"));
  TrainingSettings of_cells;
  of_cells.cells = 40;
  of_cells.samples = 50;
  of_cells.forest.trees = 2;
  write(Model::train(test::family(test::upper_gaps, 1, 2), of_cells, "cells").bytes());
  CHECK_THAT(fault_of(file), Contains("the model is a classifier of cells") &&
                                 Contains("expected a search heuristic") && Contains("trellis experience --search"));
  write("hello");
  CHECK_THAT(fault_of(file), Contains("is no model"));
  write(bytes.substr(0, bytes.size() / 2));
  CHECK_THAT(fault_of(file), Contains("damaged"));
}

TEST_CASE("on the paper's environments a learnt search expands fewer vertices than greedy search and A*",
          "[memory][search][scenes][slow]") {
  const auto worlds = test::stored_family("alternating_gaps", "train");
  if (worlds.empty()) return;
  SearchTrainingSettings settings = quick();
  settings.cells = 67;
  const auto trials = try_searches(SearchModel::train(worlds, settings, "alternating_gaps"),
                                   test::stored_family("alternating_gaps", "validation"));
  REQUIRE(trials.size() >= 10);
  const auto fewer = [&](SearchTrial::Effort SearchTrial::*other) {
    return static_cast<std::size_t>(std::count_if(trials.begin(), trials.end(), [&](const SearchTrial& trial) {
      return trial.learned.expansions < (trial.*other).expansions;
    }));
  };
  CHECK(sign_test(fewer(&SearchTrial::euclidean), trials.size()) < 0.05);
  CHECK(sign_test(fewer(&SearchTrial::a_star), trials.size()) < 0.05);
}
