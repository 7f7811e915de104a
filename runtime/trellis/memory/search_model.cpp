// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/memory/search_model.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <optional>
#include <queue>
#include <utility>

#include <trellis/base/error.hpp>
#include <trellis/base/random.hpp>
#include <trellis/instance/grid_graph.hpp>
#include <trellis/memory/model_file.hpp>
#include <trellis/scene/planar/scene.hpp>

namespace trellis {

namespace {

/// Every fourth world with a path is held out, to choose the round whose forest becomes the model.
constexpr std::size_t held_out_every = 4;

/// The index of the Euclidean distance to the goal among the features.
constexpr std::size_t euclidean_feature = 3;

/// The forest predicts the difference of the cost-to-go and the Euclidean distance, so that its plateaus still have a
/// gradient towards the goal.
double predicted(const Forest& forest, const std::array<double, search_features>& row) {
  const double direct = row[euclidean_feature];
  return direct > 0.0 ? direct + std::max(0.0, forest(row)) : 0.0;
}

double euclidean(const SearchState& state, std::uint32_t vertex) {
  const Vec2 p = SearchState::position(state.graph().vertices[vertex]);
  return norm(state.nearest_goal(p) - p);
}

/// Computes costs-to-go by Dijkstra's search from the goals.
std::vector<double> costs_to_go(const Graph& graph, const std::vector<char>& valid) {
  std::vector<std::vector<std::uint32_t>> adjacency(graph.vertices.size());
  for (std::uint32_t e = 0; e < graph.edges.size(); ++e) {
    if (valid[e] == 0) continue;
    adjacency[graph.edges[e].from].push_back(e);
    adjacency[graph.edges[e].to].push_back(e);
  }
  std::vector<double> cost(graph.vertices.size(), std::numeric_limits<double>::infinity());
  using Entry = std::pair<double, std::uint32_t>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
  for (const std::uint32_t goal : graph.goals) {
    cost[goal] = 0.0;
    queue.emplace(0.0, goal);
  }
  while (!queue.empty()) {
    const auto [c, v] = queue.top();
    queue.pop();
    if (c > cost[v]) continue;
    for (const std::uint32_t e : adjacency[v]) {
      const std::uint32_t next = graph.edges[e].from == v ? graph.edges[e].to : graph.edges[e].from;
      const double reached = c + graph.edges[e].cost;
      if (reached >= cost[next]) continue;
      cost[next] = reached;
      queue.emplace(reached, next);
    }
  }
  return cost;
}

/// The aggregated training samples.
struct Samples {
  std::vector<double> rows;
  std::vector<double> values;
};

/// Runs one search of a world with a mixture of the learner and the oracle. At uniformly sampled steps, samples a
/// vertex of the open list and takes its cost-to-go from the oracle.
void run_episode(KnownWorld& world, const Forest* learner, double oracle_share, std::int64_t samples, Stream& stream,
                 Samples& aggregated) {
  const auto& oracle = world.cost_to_go();
  BestFirstSearch search = world.search([&](const SearchState& state, std::uint32_t v) {
    return learner != nullptr ? predicted(*learner, state.features(v)) : oracle[v];
  });
  struct Sample {
    std::array<double, search_features> row;
    double value;
  };
  std::vector<Sample> drawn;
  const auto wanted = static_cast<std::size_t>(samples);
  for (std::uint64_t step = 0; !search.goal() && !search.open().empty(); ++step) {
    const auto& open = search.open();
    // Reservoir sampling, because the number of steps is unknown in advance.
    const std::size_t place = step < wanted ? step : stream.below(step + 1);
    if (place < wanted) {
      const std::uint32_t v = std::next(open.begin(), static_cast<std::ptrdiff_t>(stream.below(open.size())))->vertex;
      Sample sample{search.state().features(v), 0.0};
      sample.value = oracle[v] / search.state().scale() - sample.row[euclidean_feature];
      if (place < drawn.size()) {
        drawn[place] = sample;
      } else {
        drawn.push_back(sample);
      }
    }
    const bool asks_oracle = stream.uniform() < oracle_share;
    search.expand(asks_oracle ? *std::min_element(
                                    open.begin(), open.end(),
                                    [&](const auto& a, const auto& b) { return oracle[a.vertex] < oracle[b.vertex]; })
                              : *open.begin());
  }
  for (const Sample& sample : drawn) {
    aggregated.rows.insert(aggregated.rows.end(), sample.row.begin(), sample.row.end());
    aggregated.values.push_back(sample.value);
  }
}

SearchTrial::Effort effort(BestFirstSearch search) {
  while (!search.goal() && !search.open().empty()) search.expand(*search.open().begin());
  return {static_cast<double>(search.expansions()), static_cast<double>(search.evaluations()),
          search.state().at(search.state().graph().goals.front()).cost};
}

}  // namespace

KnownWorld::KnownWorld(const LearningTask& task, std::size_t cells) : name_(task.name) {
  Problem problem;
  problem.name = task.name;
  problem.scene = std::make_shared<const PlanarScene>(task.world, Robot::point());
  problem.space = problem.scene->default_space(1.0);
  problem.start = {task.start.x, task.start.y};
  problem.goals = {{task.goal.x, task.goal.y}};
  instance_ = make_instance(problem);
  const Vec2 extent = task.world.bounds().hi - task.world.bounds().lo;
  graph_ = grid_graph(*instance_, std::max(extent.x, extent.y) / static_cast<double>(cells));
  std::vector<char> valid;
  valid.reserve(graph_.edges.size());
  for (const auto& edge : graph_.edges) {
    valid.push_back(
        instance_->motion(std::as_const(graph_.vertices)[edge.from], std::as_const(graph_.vertices)[edge.to]).valid
            ? 1
            : 0);
  }
  cost_to_go_ = costs_to_go(graph_, valid);
}

bool KnownWorld::has_path() const {
  return instance_->validity->state(instance_->start) && std::isfinite(cost_to_go_[graph_.start]);
}

BestFirstSearch KnownWorld::search(BestFirstSearch::Priority priority, BestFirstSearch::Rules rules) {
  const auto evaluate = [this](std::uint32_t e, std::uint32_t to) -> View {
    const Graph::Edge& edge = graph_.edges[e];
    const View a = std::as_const(graph_.vertices)[edge.from == to ? edge.to : edge.from];
    const View b = std::as_const(graph_.vertices)[to];
    const MotionReport report = instance_->motion(a, b);
    if (report.valid) return {};
    invalid_.resize(a.size());
    instance_->space.interpolate(a, b, report.invalid_at, invalid_);
    return invalid_;
  };
  return {graph_, evaluate, std::move(priority), std::move(rules)};
}

SearchModel::SearchModel(Forest forest, std::size_t cells, std::string description)
    : forest_(std::move(forest)), cells_(cells), description_(std::move(description)) {}

SearchModel SearchModel::train(const std::vector<LearningTask>& tasks, const SearchTrainingSettings& settings,
                               std::string description, const std::function<void(std::size_t, std::size_t)>& progress) {
  const auto cells = static_cast<std::size_t>(settings.cells);
  std::vector<KnownWorld> worlds;
  for (const LearningTask& task : tasks) {
    KnownWorld world(task, cells);
    if (world.has_path()) worlds.push_back(std::move(world));
  }
  if (worlds.empty()) {
    throw Error("there is nothing to learn from: in no world is there a path from start to goal over the grid");
  }
  const auto held_out = [&](std::size_t i) { return i % held_out_every == held_out_every - 1; };
  Samples aggregated;
  std::optional<Forest> learner;
  std::optional<Forest> best;
  double least = std::numeric_limits<double>::infinity();
  const auto rounds = static_cast<std::size_t>(settings.rounds);
  for (std::size_t round = 0; round < rounds; ++round) {
    const double oracle_share = std::pow(settings.mixing, static_cast<double>(round));
    double expansions = 0.0;
    for (std::size_t i = 0; i < worlds.size(); ++i) {
      if (!held_out(i)) {
        Stream stream(settings.forest.seed, worlds[i].name(), fmt::format("search episode {}", round));
        run_episode(worlds[i], learner ? &*learner : nullptr, oracle_share, settings.samples, stream, aggregated);
      }
      if (progress) progress(round * worlds.size() + i + 1, rounds * worlds.size());
    }
    learner = Forest::train(aggregated.rows, search_features, aggregated.values, settings.forest);
    // Without held-out worlds, the training worlds decide.
    for (std::size_t i = 0; i < worlds.size(); ++i) {
      if (!held_out(i) && worlds.size() >= held_out_every) continue;
      expansions += effort(worlds[i].search([&](const SearchState& state, std::uint32_t v) {
                      return predicted(*learner, state.features(v));
                    })).expansions;
    }
    if (expansions >= least) continue;
    least = expansions;
    best.emplace(Forest::from_bytes(learner->bytes(), search_features));
  }
  return {std::move(*best), cells, std::move(description)};
}

std::string SearchModel::bytes() const { return model_bytes(search_heuristic, forest_, cells_, description_); }

SearchModel SearchModel::load(const std::string& file) {
  ModelFile read = read_model(search_heuristic, file);
  return {std::move(read.forest), read.cells, std::move(read.description)};
}

double SearchModel::cost_to_go(const SearchState& state, std::uint32_t vertex) const {
  return state.scale() * predicted(forest_, state.features(vertex));
}

std::shared_ptr<const SearchModel> known_search_model(const std::string& file) {
  return known_model_of<SearchModel>(file);
}

std::vector<SearchTrial> try_searches(const SearchModel& model, const std::vector<LearningTask>& tasks,
                                      BestFirstSearch::Evaluation evaluation) {
  std::vector<SearchTrial> trials;
  for (const LearningTask& task : tasks) {
    KnownWorld world(task, model.cells());
    if (!world.has_path()) continue;
    const auto learned = [&](const SearchState& state, std::uint32_t v) { return model.cost_to_go(state, v); };
    const auto a_star = [](const SearchState& state, std::uint32_t v) {
      return state.at(v).cost + euclidean(state, v);
    };
    trials.push_back({task.name, effort(world.search(learned, {.evaluation = evaluation})),
                      effort(world.search(euclidean, {.evaluation = evaluation})),
                      effort(world.search(a_star, {.evaluation = BestFirstSearch::Evaluation::selection,
                                                   .ends = BestFirstSearch::Ends::expanded}))});
  }
  return trials;
}

}  // namespace trellis
