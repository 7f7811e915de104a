// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include <trellis/experiment/experiment.hpp>
#include <trellis/strategy/executor.hpp>

namespace trellis::command {

/// A run of a session: its inputs and its progress.
struct Run {
  std::size_t number = 0;  ///< in the session, from 1
  std::string strategy_name;
  StrategySpec strategy;
  Problem problem;
  std::uint64_t seed = 1;
  std::uint64_t proposals = 0;  ///< number of proposals, over all levels
  bool scored = false;

  /// The last proposal: its level, and its number there from 0.
  struct Last {
    int level = 0;  ///< -1: the unguided planner beside the levels
    std::size_t row = 0;
  };
  std::optional<Last> last = {};
  std::unique_ptr<Execution> execution = {};  ///< of a run that has not ended
  /// The result; of a run that has not ended, made by `result` when it is first needed.
  mutable std::optional<RunResult> known = {};

  [[nodiscard]] bool ended() const { return execution == nullptr; }
  [[nodiscard]] const RunResult& result() const;
};
using RunPointer = std::shared_ptr<Run>;

/// Advances a run until it has made `proposals` over all levels, or to its end; stops earlier if `interrupted` returns
/// true. Continues where the run stopped. \throws Error for an invalid problem.
void advance(Run& run, std::uint64_t proposals, const std::function<bool()>& interrupted);

/// Scores a solved run relative to its path. \throws Interrupted.
void score(Run& run, const Measure& measure, const std::function<bool()>& interrupted);

/// "run 1: nested on cup, seed 1: solved by 412 proposals and 8123 checks in 35 ms, a path of 12.3 m".
std::string outcome_text(const Run& run);

/// Returns the level of the last proposal; the root for a run that has ended or not begun.
std::size_t level_at_work(const Run& run);

/// Describes the last proposal: its level, its part of h, its outcome and its position in the tree.
std::string where_text(const Run& run);

/// The result of replaying a run.
struct Replayed {
  std::string text;
  RunPointer run;
};
/// Runs run `index` (from 1) of a results.json again, with the script that the document names, and compares the
/// results. \throws Error that states the missing part.
Replayed replay_file(const std::string& path, std::int64_t index, const std::function<bool()>& interrupted);

}  // namespace trellis::command
