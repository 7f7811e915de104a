// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include <trellis/experiment/experiment.hpp>

/// The parts of the JSON document of `trellis run --json`, for programs that store runs one by one.
namespace trellis {

/// Returns the entry of `runs` for one run, on one line without its end.
std::string run_line(const RunResult& run);

/// Returns the field `experiment`, on one line without its end.
std::string experiment_line(const Experiment& experiment);

/// Returns a document of stored runs. `summary`, `comparisons` and `warnings` are empty.
/// \param script      the path as given on the command line
/// \param experiment  a result of experiment_line()
/// \param runs        results of run_line()
std::string runs_document(const std::string& script, const std::string& experiment,
                          const std::vector<std::string>& runs);

/// Returns the runs as a table in CSV: a header and a row for each run. Cells without a value are empty.
/// \param runs  results of run_line()
std::string runs_csv(const std::vector<std::string>& runs);
std::string runs_csv(const ExperimentResult& result);

}  // namespace trellis
