// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <string>

#include <trellis/experiment/experiment.hpp>

namespace trellis {

/// The report that a run prints: what was solved, what it cost beside the baseline, which level pays, what to try next.
std::string overview_text(const Experiment& experiment, const ExperimentResult& result, std::size_t width);

/// The same level by level, for every strategy with its ablations: verdicts, what each level did, why it was solved
/// again, what rejected most of its proposals.
std::string levels_report_text(const Experiment& experiment, const ExperimentResult& result, std::size_t width);

}  // namespace trellis
