// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include <trellis/experiment/experiment.hpp>

/// Scores as lines of JSON that restore every number bit by bit, for programs that continue an interrupted experiment.
/// The entries of the JSON document do not: they bound estimates.
namespace trellis {

/// Returns the scores of all levels, the metrics and the points of the target, on one line without its end.
std::string scores_line(const RunResult& run);
/// Sets what scores_line() stored. \throws Error for another text, and for a run with other levels.
void restore_scores(RunResult& run, const std::string& line);

std::string pooled_line(const std::string& problem, const std::vector<PooledScores>& pooled);
/// Appends what pooled_line() stored. \throws Error for another text.
void restore_pooled(std::vector<PooledScores>& pooled, const std::string& line);

/// Sets all times of a run to those of its run_line(). \throws Error for another text, and for a run with other levels.
void restore_times(RunResult& run, const std::string& line);

/// Whether two results of run_line() are equal but for the scores, which one of them may lack.
bool equal_but_for_scores(const std::string& a, const std::string& b);

}  // namespace trellis
