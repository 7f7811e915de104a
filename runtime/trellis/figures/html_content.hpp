// SPDX-License-Identifier: GPL-3.0-or-later
// What the page's tables and figures show, from an experiment's runs or from a document of `trellis run --json`.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include <trellis/report/costs.hpp>
#include <trellis/report/experiment_summary.hpp>

namespace trellis {

struct RunResult;

/// The end of one run, in words.
struct HtmlOutcome {
  std::string text;
  bool solved = false;
  const RunResult* run = nullptr;  ///< nullptr where its samples are not stored
};

/// The ends of the runs of one problem and strategy, by seed.
using HtmlOutcomes = std::map<std::uint64_t, HtmlOutcome>;

struct HtmlContent {
  const ExperimentSummary& summary;
  std::vector<std::vector<HtmlOutcomes>> runs;  ///< by problem and strategy
  CostData costs;                               ///< without ablations
};

/// "solved, path of 14.42 m · 433 validity checks · 0.4 ms".
struct HtmlRunFacts {
  bool solved = false;
  double length = 0.0;
  std::string status;     ///< of an unsolved run
  double duration = 0.0;  ///< seconds that the path takes; 0 without a motion model
  std::uint64_t checks = 0;
  double seconds = 0.0;
};
std::string html_outcome(const HtmlRunFacts& facts);

/// Reads what a document of `trellis run --json` stores of a page: all but the samples.
/// \param summary  of the document
/// \param file     for messages
/// \throws Error that names the file, for another kind of document.
HtmlContent stored_html_content(const ExperimentSummary& summary, const std::string& document, const std::string& file);

}  // namespace trellis
