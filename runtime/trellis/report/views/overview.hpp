// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <string>

#include <trellis/report/experiment_summary.hpp>

namespace trellis {

/// Returns the report that a run prints: what each strategy costs relative to the baseline, what each of its guides
/// saves, and the next step.
std::string overview_text(const ExperimentSummary& experiment, std::size_t width);

/// Returns the same level by level, for every strategy with its ablations: verdicts, the search of each level, why it
/// was solved again, and the obstacle that rejected most of its proposals.
std::string levels_report_text(const ExperimentSummary& experiment, std::size_t width);

}  // namespace trellis
