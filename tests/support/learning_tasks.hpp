// SPDX-License-Identifier: GPL-3.0-or-later
// Worlds for training and validating heuristics.
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include <trellis/memory/learning_task.hpp>
#include <trellis/reader/readers.hpp>
#include <trellis/scene/planar/scene.hpp>

#include "support/scenes.hpp"

namespace trellis::test {

inline LearningTask task_of(const Problem& problem) {
  return {problem.name,
          planar(*problem.scene).world,
          {problem.start[0], problem.start[1]},
          {problem.goal()[0], problem.goal()[1]}};
}

/// `count` worlds of a family, from seed `first` on.
inline std::vector<LearningTask> family(Problem (*make)(std::uint64_t), std::uint64_t first, std::uint64_t count) {
  std::vector<LearningTask> tasks;
  for (std::uint64_t seed = first; seed < first + count; ++seed) tasks.push_back(task_of(make(seed)));
  return tasks;
}

/// The worlds of a family of mp_datasets. Empty where these scenes are missing.
/// \param split  "train" or "validation"
inline std::vector<LearningTask> stored_family(const std::string& name, const std::string& split) {
  namespace fs = std::filesystem;
  const fs::path folder = scene(fs::path("mp_datasets") / name / split);
  if (folder.empty()) return {};
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(folder)) files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  std::vector<LearningTask> tasks;
  for (const auto& file : files) tasks.push_back(task_of(read_problems(file.string(), {}).front()));
  return tasks;
}

}  // namespace trellis::test
