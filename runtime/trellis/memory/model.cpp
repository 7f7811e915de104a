// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/memory/model.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include <trellis/base/error.hpp>
#include <trellis/base/random.hpp>
#include <trellis/memory/model_file.hpp>

namespace trellis {

namespace {

constexpr double least_probability = 1e-3;  // of a free cell, so that the model excludes none

std::vector<double> normalised(std::vector<double> weights) {
  const double sum = std::accumulate(weights.begin(), weights.end(), 0.0);
  for (double& w : weights) w /= sum;
  return weights;
}

/// Computes KL(T || q), with T uniform over the near-optimal cells.
double divergence(const Oracle& oracle, const std::vector<double>& q) {
  const auto count = static_cast<double>(std::count(oracle.on_path.begin(), oracle.on_path.end(), 1));
  double sum = 0.0;
  for (std::size_t i = 0; i < q.size(); ++i) {
    if (oracle.on_path[i] != 0) sum += std::log(1.0 / count) - std::log(q[i]);
  }
  return sum / count;
}

}  // namespace

std::optional<Oracle> ask_oracle(const WorldGrid& grid, Vec2 start, Vec2 goal, double tolerance) {
  const auto from = grid.free_near(start);
  const auto to = grid.free_near(goal);
  if (!from || !to) return {};
  const auto behind = path_lengths_to(grid, *from);
  const auto ahead = path_lengths_to(grid, *to);
  if (!std::isfinite(ahead[*from])) return {};
  Oracle oracle{ahead[*from], std::vector<char>(grid.size(), 0)};
  for (std::size_t i = 0; i < grid.size(); ++i) {
    oracle.on_path[i] = behind[i] + ahead[i] <= (1.0 + tolerance) * oracle.shortest ? 1 : 0;
  }
  return oracle;
}

Model::Model(Forest forest, std::size_t cells, std::string description)
    : forest_(std::move(forest)), cells_(cells), description_(std::move(description)) {}

Model Model::train(const std::vector<LearningTask>& tasks, const TrainingSettings& settings, std::string description,
                   const std::function<void(std::size_t, std::size_t)>& progress) {
  const auto cells = static_cast<std::size_t>(settings.cells);
  std::vector<double> rows;
  std::vector<double> values;
  for (std::size_t t = 0; t < tasks.size(); ++t) {
    const LearningTask& task = tasks[t];
    const WorldGrid grid(task.world, task.world.bounds(), cells);
    if (const auto oracle = ask_oracle(grid, task.start, task.goal, settings.tolerance)) {
      const auto all = features(grid, task.start, task.goal);
      std::vector<std::size_t> free;
      for (std::size_t i = 0; i < grid.size(); ++i) {
        if (grid.free(i)) free.push_back(i);
      }
      Stream stream(settings.forest.seed, task.name, "training samples");
      for (std::int64_t i = 0; i < settings.samples; ++i) {
        const std::size_t cell = free[stream.below(free.size())];
        const auto row = all.begin() + static_cast<std::ptrdiff_t>(cell * cell_features);
        rows.insert(rows.end(), row, row + cell_features);
        values.push_back(oracle->on_path[cell] != 0 ? 1.0 : 0.0);
      }
    }
    if (progress) progress(t + 1, tasks.size());
  }
  if (values.empty()) throw Error("there is nothing to learn from: no world has a path from start to goal");
  return {Forest::train(rows, cell_features, values, settings.forest), cells, std::move(description)};
}

std::string Model::bytes() const { return model_bytes(cell_classifier, forest_, cells_, description_); }

Model Model::load(const std::string& file) {
  ModelFile read = read_model(cell_classifier, file);
  return {std::move(read.forest), read.cells, std::move(read.description)};
}

std::vector<double> Model::probabilities(const WorldGrid& grid, Vec2 start, Vec2 goal) const {
  const auto all = features(grid, start, goal);
  std::vector<double> result(grid.size(), 0.0);
  for (std::size_t i = 0; i < grid.size(); ++i) {
    if (!grid.free(i)) continue;
    result[i] = std::clamp(forest_(std::span(all).subspan(i * cell_features, cell_features)), least_probability, 1.0);
  }
  return result;
}

std::shared_ptr<const Model> known_model(const std::string& file) { return known_model_of<Model>(file); }

Validation validate(const Model& model, const std::vector<LearningTask>& tasks, double tolerance, double share) {
  Validation result;
  constexpr std::array<double, 8> falls = {0.01, 0.03, 0.1, 0.2, 0.4, 0.8, 1.6, 3.2};
  std::array<double, falls.size()> straight{};
  double squares = 0.0;
  for (const LearningTask& task : tasks) {
    const WorldGrid grid(task.world, task.world.bounds(), model.cells());
    const auto oracle = ask_oracle(grid, task.start, task.goal, tolerance);
    if (!oracle) continue;
    std::vector<double> even(grid.size(), 0.0);
    for (std::size_t i = 0; i < grid.size(); ++i) even[i] = grid.free(i) ? 1.0 : 0.0;
    even = normalised(std::move(even));
    const auto mixed = [&](std::vector<double> weights) {
      weights = normalised(std::move(weights));
      for (std::size_t i = 0; i < weights.size(); ++i) weights[i] = share * even[i] + (1.0 - share) * weights[i];
      return weights;
    };
    const double uniform = divergence(*oracle, even);
    const double learned = divergence(*oracle, mixed(model.probabilities(grid, task.start, task.goal)));
    for (std::size_t k = 0; k < falls.size(); ++k) {
      std::vector<double> weights(grid.size(), 0.0);
      const double direct = norm(task.goal - task.start);
      for (std::size_t i = 0; i < grid.size(); ++i) {
        const double detour = norm(grid.centre(i) - task.start) + norm(task.goal - grid.centre(i)) - direct;
        if (grid.free(i)) weights[i] = std::exp(-detour / (falls[k] * direct));
      }
      straight[k] += divergence(*oracle, mixed(std::move(weights)));
    }
    ++result.tasks;
    result.learned += learned;
    result.uniform += uniform;
    squares += (learned - uniform) * (learned - uniform);
  }
  if (result.tasks == 0) return result;
  const auto n = static_cast<double>(result.tasks);
  result.learned /= n;
  result.uniform /= n;
  result.straight = *std::min_element(straight.begin(), straight.end()) / n;
  const double mean = result.learned - result.uniform;
  result.error = n > 1 ? std::sqrt(std::max(0.0, squares / n - mean * mean) / (n - 1.0)) : 0.0;
  return result;
}

}  // namespace trellis
