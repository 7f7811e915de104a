// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>

#include <trellis/experiment/experiment.hpp>

namespace trellis {

/// Runs one cell of an experiment as far as the options let it, without scoring it.
/// \param name  the strategy's
RunResult run_cell(const std::string& name, const StrategySpec& strategy, const Problem& problem, std::uint64_t seed,
                   const ExecuteOptions& options = {});

/// Lets go of what only scoring asks: the checkers, scenes and guides of all levels.
void release(RunResult& run);

/// What two runs of the same strategy, problem and seed do not have in common, times apart: "the nodes of level 1
/// differ"; "" where they agree to the last bit.
std::string difference_text(const RunResult& a, const RunResult& b);

}  // namespace trellis
