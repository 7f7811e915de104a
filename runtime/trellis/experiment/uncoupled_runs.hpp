// SPDX-License-Identifier: GPL-3.0-or-later
// Runs the strategies that divide a team with robots that pass through each other, which decides who needs
// coordination.
#pragma once

#include <trellis/experiment/experiment.hpp>

namespace trellis {

/// Whether a guide of the strategy divides the robots of a team: decouple, prioritise or couple.
bool divides_team(const StrategySpec& strategy);

/// Runs each strategy of an experiment that divides a team with all robots passing through each other; where such paths
/// do not always serve, with each robot passing through the others; then with each two of the robots that need the
/// others. Sequential tests decide each stage (SequentialRuns), with what is left of `ablation_budget` on a problem. A
/// run counts as solved where its path is certified among all robots. The result does not depend on the number of
/// threads.
/// \param result  has the runs of the experiment; receives the costs
/// \throws Interrupted
void run_uncoupled(const Experiment& experiment, ExperimentResult& result, const ExperimentOptions& options);

}  // namespace trellis
