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
  std::int64_t samples = 60;  ///< vertices sampled from each world and round
  double mixing = 0.7;        ///< round i follows the oracle with this probability to the power of i
  ForestSettings forest = {.trees = 40, .leaf = 5, .seed = 1};
};

/// A world with the exact cost-to-go of each vertex of its grid: the clairvoyant oracle.
class KnownWorld {
 public:
  /// \param cells  of the grid along the longer side of the world
  KnownWorld(const LearningTask& task, std::size_t cells);

  [[nodiscard]] const std::string& name() const { return name_; }
  [[nodiscard]] const Graph& graph() const { return graph_; }
  [[nodiscard]] bool has_path() const;
  /// Returns for each vertex the cost of the shortest path over valid edges to the goal; infinity where there is none.
  [[nodiscard]] const std::vector<double>& cost_to_go() const { return cost_to_go_; }
  /// Returns a new search of the grid. The world must outlive it.
  [[nodiscard]] BestFirstSearch search(BestFirstSearch::Priority priority, BestFirstSearch::Rules rules = {});

 private:
  std::string name_;
  std::unique_ptr<Instance> instance_;
  Graph graph_;
  std::vector<double> cost_to_go_;
  Configuration invalid_;
};

/// A search heuristic learnt by imitation of the oracle, after SaIL (Bhardwaj, Choudhury and Scherer 2017): a
/// regression of the cost-to-go on the state of the search.
class SearchModel {
 public:
  /// \param progress  called after each episode with the numbers of finished and of all episodes; an exception from it
  ///     ends the training
  /// \throws Error where no task has a path from start to goal.
  static SearchModel train(const std::vector<LearningTask>& tasks, const SearchTrainingSettings& settings,
                           std::string description, const std::function<void(std::size_t, std::size_t)>& progress = {});
  /// \throws Error for a file that is missing, no model, of another kind, damaged, or of another version.
  static SearchModel load(const std::string& file);

  /// Serialises the model for `load`.
  [[nodiscard]] std::string bytes() const;
  /// Returns the number of cells of the training grid along the longer side of the world.
  [[nodiscard]] std::size_t cells() const { return cells_; }
  /// Returns a description of the training data.
  [[nodiscard]] const std::string& description() const { return description_; }
  /// Returns the predicted cost from a vertex, which the search has generated, to the goal. The graph must be planar.
  [[nodiscard]] double cost_to_go(const SearchState& state, std::uint32_t vertex) const;

 private:
  SearchModel(Forest forest, std::size_t cells, std::string description);
  Forest forest_;
  std::size_t cells_;
  std::string description_;
};

/// Returns the model in a file as of this process's first call; nullptr where there is no such file.
/// \throws Error as SearchModel::load does.
std::shared_ptr<const SearchModel> known_search_model(const std::string& file);

/// The effort of searches of one world's grid until they reach the goal.
struct SearchTrial {
  struct Effort {
    double expansions = 0.0;
    double evaluations = 0.0;  ///< edges
    double length = 0.0;       ///< of the path, metres
  };
  std::string name;
  Effort learned;
  Effort euclidean;  ///< greedy best-first search by Euclidean distance
  Effort a_star;     ///< edges evaluated at selection
};
/// Returns the trial of each task that has a path over the model's grid. The first two searches use `evaluation`.
std::vector<SearchTrial> try_searches(const SearchModel& model, const std::vector<LearningTask>& tasks,
                                      BestFirstSearch::Evaluation evaluation = BestFirstSearch::Evaluation::expansion);

}  // namespace trellis
