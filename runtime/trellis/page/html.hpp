// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include <trellis/pictures/run_samples.hpp>
#include <trellis/report/experiment_summary.hpp>

namespace trellis {

struct HtmlOptions {
  /// Limit for the runs' samples, in a page of at most 5 MB. The page thins long searches. If the runs of all seeds
  /// exceed the limit, it contains those of the first seeds, and says so.
  std::size_t most_bytes = 5'000'000;
  std::function<void(std::size_t, std::size_t)> progress = {};  ///< called for each packed run: finished, all
  std::string document = "a document of results";               ///< the name of the file that the results are from
};

/// Returns one self-contained HTML page: the results, and every run for replay and inspection (docs/formats.md). UTF-8.
/// \param facts    with their scenery
/// \param summary  of the experiment
/// \param samples  of the runs; nullptr: the page has its tables and figures, without replays
/// \throws Error where the samples cannot be read
std::string report_html(const ExperimentFacts& facts, const ExperimentSummary& summary, RunSamples* samples,
                        const HtmlOptions& options = {});
/// Writes that page.
/// \throws Error where it cannot write the file.
void write_html(const ExperimentFacts& facts, const ExperimentSummary& summary, RunSamples* samples,
                const std::string& path, const HtmlOptions& options = {});

}  // namespace trellis
