// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <trellis/experiment/experiment.hpp>

namespace trellis {

/// Runs one cell of an experiment, within the limits of the options, without scoring it.
/// \param name  the strategy's name
RunResult run_cell(const std::string& name, const StrategySpec& strategy, const Problem& problem, std::uint64_t seed,
                   const ExecuteOptions& options = {});

/// The cell of a run that was executed.
RunResult make_cell(const std::string& strategy, const std::string& problem, std::uint64_t seed, RunRecord run);

/// Returns why a run found no path: the budget that the root's planner spent, the levels that reached their limit of
/// re-solves, and those without a path. Empty where it found one.
std::vector<std::string> unsolved_reasons(const RunResult& run, const StrategySpec& strategy);

/// Releases the objects that only scoring uses: the checkers, scenes and guides of all levels.
void release(RunResult& run);

/// Returns the first difference of two runs of the same strategy, problem and seed, times ignored: "the nodes of level
/// 1 differ"; "" where they are bitwise equal.
std::string difference_text(const RunResult& a, const RunResult& b);

}  // namespace trellis
