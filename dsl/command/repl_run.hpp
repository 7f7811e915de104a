// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include <trellis/experiment/experiment.hpp>

namespace trellis::command {

/// A run of a session: what it was made from, and how far it has come.
struct Run {
  std::size_t number = 0;  ///< in the session, from 1
  std::string strategy_name;
  StrategySpec strategy;
  Problem problem;
  std::uint64_t seed = 1;
  RunResult result = {};
  std::uint64_t proposals = 0;  ///< that have been drawn, over all levels
  bool scored = false;

  [[nodiscard]] bool ended() const { return result.run.status != Status::interrupted; }
};
using RunPointer = std::shared_ptr<Run>;

/// Brings a run to where `proposals` have been drawn over all levels, or to its end; where `interrupted` says so it
/// stops before. It never goes back. Throws Error for a problem that cannot be planned.
void advance(Run& run, std::uint64_t proposals, const std::function<bool()>& interrupted);

/// Scores a run that found a path, on that path. Throws Interrupted.
void score(Run& run, const Measure& measure, const std::function<bool()>& interrupted);

/// "run 1: nested on cup, seed 1: solved by 412 proposals and 8123 checks in 35 ms, a path of 12.3 m".
std::string outcome_text(const Run& run);

/// The level that made the last proposal; of a run that has ended, and of one that has not begun, the root.
std::size_t level_at_work(const Run& run);

/// The last proposal: of which level, from which part of h, what became of it and where in the tree.
std::string where_text(const Run& run);

/// What a replayed run said of itself.
struct Replayed {
  std::string text;
  RunPointer run;
};
/// Runs run `index` (from 1) of a results.json again, by the script that the document names, and says whether the same
/// came out. Throws Error that says what is missing.
Replayed replay_file(const std::string& path, std::int64_t index, const std::function<bool()>& interrupted);

}  // namespace trellis::command
