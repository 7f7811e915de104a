// SPDX-License-Identifier: GPL-3.0-or-later
// Documents of results and files of records, written and read run by run.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <trellis/results/facts.hpp>

namespace trellis {

/// Returns the entry of `runs` for one run, on one line without its end.
std::string run_line(const RunFacts& run);
/// Reads what run_line() returns. \throws Error for another text
RunFacts read_run(const std::string& line);

/// Returns the measured set of samples relative to one target, on one line.
std::string measured_set(const Efficiency& efficiency);
/// Returns what one estimator finds of them. \param of  the set, which bounds it
std::string estimate_line(const Estimate& estimate, const Efficiency& of);

/// Reads a document of `trellis run --json`, `sweep` or `merge`.
/// \param file  for messages
/// \throws Error that names the file, for another kind of document
ExperimentFacts read_results(const std::string& document, const std::string& file);
/// \throws Error where the document has another format, whose reports would differ
void require_format(const ExperimentFacts& facts, const std::string& file);

/// Writes a document of stored runs, run by run: its beginning, each run, its end. `summary`, `comparisons` and
/// `warnings` are empty. Stores the tables beside the runs until the end, a few hundred bytes for each level.
class RunsDocument {
 public:
  RunsDocument();
  ~RunsDocument();
  RunsDocument(const RunsDocument&) = delete;
  RunsDocument& operator=(const RunsDocument&) = delete;
  RunsDocument(RunsDocument&&) = delete;
  RunsDocument& operator=(RunsDocument&&) = delete;

  /// \param script      the path as given on the command line
  /// \param experiment  a result of experiment_line()
  /// \param scenery     a result of scenery_of()
  [[nodiscard]] std::string begin(const std::string& script, const std::string& experiment,
                                  const Scenery& scenery) const;
  std::string add(const RunFacts& run);
  [[nodiscard]] std::string end() const;

 private:
  struct Tables;
  std::unique_ptr<Tables> tables_;
  bool any_ = false;
};

/// The parts of the runs as a table in CSV: its header, and the row of a run. Cells without a value are empty.
std::string runs_csv_header();
/// \param line  a result of run_line()
std::string runs_csv_row(const std::string& line);
/// Returns the whole table.
std::string runs_csv(const ExperimentFacts& experiment);

// For programs that continue an interrupted experiment.

std::string pooled_line(const std::string& problem, const std::vector<PooledScores>& pooled);
/// Appends what pooled_line() stored. \throws Error for another text.
void restore_pooled(std::vector<PooledScores>& pooled, const std::string& line);

/// Returns a run_line() without times, which differ from run to run.
std::string without_times(const std::string& line);

/// Whether two results of run_line() are equal but for the scores, which one of them may lack.
bool equal_but_for_scores(const std::string& a, const std::string& b);

}  // namespace trellis
