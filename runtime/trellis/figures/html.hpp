// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <functional>
#include <string>

#include <trellis/report/experiment_summary.hpp>

namespace trellis {

struct Experiment;
struct ExperimentResult;

struct HtmlOptions {
  /// Limit for the runs' samples, in a page of at most 5 MB. The page thins long searches. If the runs of all seeds
  /// exceed the limit, it contains those of the first seeds, and says so.
  std::size_t most_bytes = 5'000'000;
  std::function<void(std::size_t, std::size_t)> progress = {};  ///< called for each packed run: finished, all
};

/// Returns one self-contained HTML page: the results, and every run for replay and inspection (docs/formats.md). UTF-8.
/// \param facts, summary  of the experiment
std::string report_html(const Experiment& experiment, const ExperimentResult& result, const ExperimentFacts& facts,
                        const ExperimentSummary& summary, const HtmlOptions& options = {});
/// Returns the page of a document: its tables and figures, without replays.
/// \param file  the document's, for the page
std::string stored_report_html(const ExperimentFacts& facts, const ExperimentSummary& summary, const std::string& file);
/// \throws Error where it cannot write the file.
void write_html(const Experiment& experiment, const ExperimentResult& result, const ExperimentFacts& facts,
                const ExperimentSummary& summary, const std::string& path, const HtmlOptions& options = {});

}  // namespace trellis
