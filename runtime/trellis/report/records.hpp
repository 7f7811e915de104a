// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include <trellis/experiment/experiment.hpp>

/// The parts of the JSON document of `trellis run --json`, for programs that store runs one by one.
namespace trellis {

/// Returns the entry of `runs` for one run, on one line without its end.
std::string run_line(const RunResult& run);

/// Returns the field `experiment`, on one line without its end.
std::string experiment_line(const Experiment& experiment);

/// The parts of a document of stored runs: its beginning, each run, its end. `summary`, `comparisons` and `warnings`
/// are empty. \param script      the path as given on the command line \param experiment  a result of experiment_line()
std::string runs_document_begin(const std::string& script, const std::string& experiment);
/// \param line   a result of run_line()
/// \param first  whether it is the first run
std::string runs_document_run(const std::string& line, bool first);
/// \param any  whether the document has a run
std::string runs_document_end(bool any);

/// The parts of the runs as a table in CSV: its header, and the row of a run. Cells without a value are empty.
std::string runs_csv_header();
/// \param line  a result of run_line()
std::string runs_csv_row(const std::string& line);
/// Returns the whole table.
std::string runs_csv(const ExperimentResult& result);

}  // namespace trellis
