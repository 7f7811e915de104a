// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <trellis/memory/best_first_search.hpp>
#include <trellis/memory/forest.hpp>
#include <trellis/memory/learning_task.hpp>
#include <trellis/memory/search_state.hpp>

namespace trellis {

struct SearchTrainingSettings {
  std::int64_t cells = 40;    ///< of the grid along the longer side of the world
  std::int64_t rounds = 10;   ///< of data aggregation
  std::int64_t samples = 60;  ///< vertices drawn from each world and round
  double mixing = 0.7;        ///< round i follows the oracle with this probability to the power of i
  ForestSettings forest = {.trees = 40, .leaf = 5, .seed = 1};
};

/// A world whose grid was searched exactly, so that the cost-to-go of each vertex is known: the clairvoyant oracle.
class KnownWorld {
 public:
  /// \param cells  of the grid along the longer side of the world
  KnownWorld(const LearningTask& task, std::size_t cells);

  [[nodiscard]] const std::string& name() const { return name_; }
  [[nodiscard]] const Graph& graph() const { return graph_; }
  [[nodiscard]] bool has_path() const;
  /// Of each vertex the cost of the shortest path over valid edges to the goal; infinity where there is none.
  [[nodiscard]] const std::vector<double>& cost_to_go() const { return cost_to_go_; }
  /// A search of the grid from the beginning. The world outlives it.
  [[nodiscard]] BestFirstSearch search(BestFirstSearch::Priority priority, BestFirstSearch::Rules rules = {});

 private:
  std::string name_;
  std::unique_ptr<Instance> instance_;
  Graph graph_;
  std::vector<double> cost_to_go_;
  Configuration invalid_;
};

/// A search heuristic learnt by imitation of the oracle, as SaIL (Bhardwaj, Choudhury and Scherer 2017) learns it: a
/// regression of the cost-to-go from the state of the search.
class SearchModel {
 public:
  /// Throws Error where no task has a path from start to goal.
  /// \param progress  called after each episode, done and in all; what it throws ends the training
  static SearchModel train(const std::vector<LearningTask>& tasks, const SearchTrainingSettings& settings,
                           std::string description, const std::function<void(std::size_t, std::size_t)>& progress = {});
  /// Throws Error for a file that is missing, no model, of another kind, damaged, or of another version.
  static SearchModel load(const std::string& file);

  /// What `load` reads.
  [[nodiscard]] std::string bytes() const;
  /// Of the grid that it was trained on, along the longer side of the world.
  [[nodiscard]] std::size_t cells() const { return cells_; }
  /// What it was trained on.
  [[nodiscard]] const std::string& description() const { return description_; }
  /// The predicted cost from a vertex, which the search has generated, to the goal. The graph must be planar.
  [[nodiscard]] double cost_to_go(const SearchState& state, std::uint32_t vertex) const;

 private:
  SearchModel(Forest forest, std::size_t cells, std::string description);
  Forest forest_;
  std::size_t cells_;
  std::string description_;
};

/// A model as it was when this process first asked for it; nullptr where there is no such file. Throws Error as
/// SearchModel::load does.
std::shared_ptr<const SearchModel> known_search_model(const std::string& file);

/// What searches of one world's grid cost until they reached the goal.
struct SearchTrial {
  struct Effort {
    double expansions = 0.0;
    double evaluations = 0.0;  ///< of edges
    double length = 0.0;       ///< of the path, metres
  };
  std::string name;
  Effort learned;
  Effort euclidean;  ///< greedy best-first search by Euclidean distance
  Effort a_star;     ///< edges evaluated at selection
};
/// Of each task that has a path over the model's grid. `evaluation` is that of the first two.
std::vector<SearchTrial> try_searches(const SearchModel& model, const std::vector<LearningTask>& tasks,
                                      BestFirstSearch::Evaluation evaluation = BestFirstSearch::Evaluation::expansion);

}  // namespace trellis
