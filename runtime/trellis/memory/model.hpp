// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <trellis/memory/forest.hpp>
#include <trellis/memory/grid.hpp>
#include <trellis/memory/learning_task.hpp>
#include <trellis/scene/scene.hpp>

namespace trellis {

struct TrainingSettings {
  std::int64_t cells = 67;     ///< along the longer side of the world
  std::int64_t samples = 500;  ///< cells sampled from each world
  double tolerance = 0.01;     ///< a path is near-optimal if its length exceeds the shortest by at most this share
  ForestSettings forest = {};
};

/// The cells of near-optimal paths, which the oracle finds by exact search of the grid.
struct Oracle {
  double shortest = 0.0;      ///< metres
  std::vector<char> on_path;  ///< of each cell whether a near-optimal path leads through it
};
/// Returns none where the oracle finds no path.
std::optional<Oracle> ask_oracle(const WorldGrid& grid, Vec2 start, Vec2 goal, double tolerance);

/// A classifier of cells: the probability that a near-optimal path leads through a cell, from features of the cell that
/// need no search. Static: it uses no state of a search. Its file is the same on every machine.
class Model {
 public:
  /// \param progress  called after each task with the numbers of finished and of all tasks; an exception from it ends
  ///     the training
  /// \throws Error where no task has a path from start to goal.
  static Model train(const std::vector<LearningTask>& tasks, const TrainingSettings& settings, std::string description,
                     const std::function<void(std::size_t, std::size_t)>& progress = {});
  /// \throws Error for a file that is missing, no model, damaged, or of another version.
  static Model load(const std::string& file);

  /// Serialises the model for `load`.
  [[nodiscard]] std::string bytes() const;
  [[nodiscard]] std::size_t cells() const { return cells_; }
  /// Returns a description of the training data.
  [[nodiscard]] const std::string& description() const { return description_; }
  /// Returns the probability of each cell of a grid; 0 where the cell is not free.
  [[nodiscard]] std::vector<double> probabilities(const WorldGrid& grid, Vec2 start, Vec2 goal) const;

 private:
  Model(Forest forest, std::size_t cells, std::string description);
  Forest forest_;
  std::size_t cells_;
  std::string description_;
};

/// Returns the model in a file as of this process's first call; nullptr where there is no such file.
/// \throws Error as Model::load does.
std::shared_ptr<const Model> known_model(const std::string& file);

/// How well distributions over a world's cells predict near-optimal paths: the divergence from the uniform distribution
/// over the near-optimal cells, nats, the mean over the tasks; lower is better.
struct Validation {
  std::size_t tasks = 0;  ///< tasks with a path
  double learned = 0.0;   ///< by the model, with `share` of the free cells' uniform distribution
  double uniform = 0.0;   ///< by the uniform distribution over the free cells
  double straight =
      0.0;  ///< by a distribution that decreases with the detour through a cell, obstacles ignored, at its best scale
  double error = 0.0;  ///< standard error of learned - uniform, over the tasks
};
Validation validate(const Model& model, const std::vector<LearningTask>& tasks, double tolerance, double share = 0.1);

}  // namespace trellis
