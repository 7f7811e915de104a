// SPDX-License-Identifier: GPL-3.0-or-later
// Runs the strategies of an experiment without each of their guides, which decides whether a guide pays.
#pragma once

#include <cstddef>
#include <string>
#include <utility>

#include <trellis/experiment/experiment.hpp>

namespace trellis {

/// Whether two strategies make the same search. With uniform sampling in place of its guide, a strategy samples as its
/// planner alone does.
bool same_search(const StrategySpec& a, const StrategySpec& b);

/// Whether no run of a strategy on a problem set up the guides, because its planner solved the problem before.
/// \param problem, strategy  indices
bool never_set_up(const Experiment& experiment, const ExperimentResult& result, std::size_t problem,
                  std::size_t strategy);

/// Whether a strategy of an experiment is an ablation of another one.
/// \param strategy  a name
bool is_ablation(const Experiment& experiment, const std::string& strategy);

/// Returns the strategy of an experiment, other than `strategy`, that searches as `spec` does; nullptr if there is
/// none. Its runs are those of the strategy without a guide: `skeleton() >> rrt()` is `skeleton() >> lazy() >> rrt()`
/// without `lazy()`.
/// \param strategy  a name
const std::pair<std::string, StrategySpec>* equal_strategy(const Experiment& experiment, const std::string& strategy,
                                                           const StrategySpec& spec);

/// Returns the work that the runs without each guide may take on a problem, see RunCost: `Experiment::ablation`
/// times the work of the experiment's runs there and 20 000 for each run that is scored, but for at least 200 000. It
/// counts work instead of time, so that it is the same for every machine and every number of threads.
double ablation_budget(const Experiment& experiment, const ExperimentResult& result, const std::string& problem);

/// Runs each strategy of an experiment without each of its guides (decisive_ablations), unscored, until a sequential
/// test decides whether the guide pays (SequentialRuns). Where a strategy of the experiment searches so, its runs
/// serve. Strategies whose guides were never set up are not tested. The result does not depend on the number of
/// threads. \param result  has the runs of the experiment; receives the costs \throws Interrupted
void run_left_out(const Experiment& experiment, ExperimentResult& result, const ExperimentOptions& options);

}  // namespace trellis
