// SPDX-License-Identifier: GPL-3.0-or-later
// For programs that continue an interrupted experiment.
#pragma once

#include <string>

namespace trellis {

struct RunResult;

/// Returns the scores of a run, with the points of the target, on one line without its end.
std::string scores_line(const RunResult& run);
/// Sets what scores_line() stored. \throws Error for another text, and for a run with other levels.
void restore_scores(RunResult& run, const std::string& line);

/// Sets all times of a run to those of its run_line(). \throws Error for another text, and for a run with other levels.
void restore_times(RunResult& run, const std::string& line);

}  // namespace trellis
