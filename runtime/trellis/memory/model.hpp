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
  std::int64_t samples = 500;  ///< cells drawn from each world
  double tolerance = 0.01;     ///< a way this much longer than the shortest is near-optimal, as a share
  ForestSettings forest = {};
};

/// Where ways that are nearly the shortest lie, as the oracle tells by exact search of the grid.
struct Oracle {
  double shortest = 0.0;     ///< metres
  std::vector<char> on_way;  ///< of each cell whether a near-optimal way leads through it
};
/// None where the oracle finds no way.
std::optional<Oracle> ask_oracle(const WorldGrid& grid, Vec2 start, Vec2 goal, double tolerance);

/// A classifier of cells: the probability that a near-optimal path leads through a cell, from features of the cell that
/// need no search. Static: it uses no state of a search. In a file it is the same on every machine.
class Model {
 public:
  /// Throws Error where no task has a way from start to goal.
  /// \param looked_at  called after each task, done and in all; what it throws ends the training
  static Model train(const std::vector<LearningTask>& tasks, const TrainingSettings& settings, std::string description,
                     const std::function<void(std::size_t, std::size_t)>& looked_at = {});
  /// Throws Error for a file that is missing, no model, damaged, or of another version.
  static Model load(const std::string& file);

  /// What `load` reads.
  [[nodiscard]] std::string bytes() const;
  [[nodiscard]] std::size_t cells() const { return cells_; }
  /// What it was trained on.
  [[nodiscard]] const std::string& description() const { return description_; }
  /// Of each cell of a grid the probability; 0 where the cell is not free.
  [[nodiscard]] std::vector<double> probabilities(const WorldGrid& grid, Vec2 start, Vec2 goal) const;

 private:
  Model(Forest forest, std::size_t cells, std::string description);
  Forest forest_;
  std::size_t cells_;
  std::string description_;
};

/// A model as it was when this process first asked for it; nullptr where there is no such file. Throws Error as
/// Model::load does.
std::shared_ptr<const Model> known_model(const std::string& file);

/// How well distributions over a world's cells tell where near-optimal ways lie: the divergence from the uniform
/// distribution over the cells of these ways, nats, the mean over the tasks; lower is better.
struct Validation {
  std::size_t tasks = 0;  ///< that have a way
  double learned = 0.0;   ///< by the model, with `share` of the free cells' uniform distribution
  double uniform = 0.0;   ///< by the uniform distribution over the free cells
  double straight = 0.0;  ///< by one that falls off with the detour that a cell means, obstacles ignored, at its best
  double error = 0.0;     ///< standard error of learned - uniform, over the tasks
};
Validation validate(const Model& model, const std::vector<LearningTask>& tasks, double tolerance, double share = 0.1);

}  // namespace trellis
