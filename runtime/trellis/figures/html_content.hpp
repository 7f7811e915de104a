// SPDX-License-Identifier: GPL-3.0-or-later
// What the page's tables and figures show, from an experiment's runs or from a document of `trellis run --json`.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include <trellis/experiment/experiment.hpp>
#include <trellis/report/costs.hpp>
#include <trellis/report/summary.hpp>
#include <trellis/report/verdict.hpp>

namespace trellis {

struct HtmlStrategy {
  std::string name;
  std::string text;  ///< in the syntax of a script
  bool ablation = false;
};

/// The end of one run, in words.
struct HtmlOutcome {
  std::string text;
  bool solved = false;
  const RunResult* run = nullptr;  ///< nullptr where its samples are not stored
};

/// One problem and strategy.
struct HtmlCell {
  RunsSummary summary;
  std::vector<Verdict> verdicts;    ///< on its levels; empty for an ablation
  std::vector<GuideVerdict> parts;  ///< on its guides without a level
  std::map<std::uint64_t, HtmlOutcome> runs;
};

struct HtmlContent {
  std::string script;  ///< the path as given on the command line, "" for none
  std::string about;
  bool measured = false;
  std::vector<std::string> problems;
  std::vector<HtmlStrategy> strategies;
  std::vector<std::uint64_t> seeds;
  std::vector<std::vector<HtmlCell>> cells;                   ///< by problem and strategy
  std::vector<RunsSummary> together;                          ///< by strategy; none for a single problem
  std::vector<std::pair<std::string, std::string>> warnings;  ///< a problem, and a sentence about it
  CostData costs;                                             ///< without ablations
};

/// The sentences at the head of the page.
/// \param target  of the measure, "" where nothing was measured
std::string html_about(std::size_t problems, std::size_t strategies, const std::vector<std::uint64_t>& seeds,
                       const std::string& target, const std::string& version);

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
/// \param file  for messages
/// \throws Error that names the file, for another kind of document and for one without summaries, as of a sweep.
HtmlContent stored_html_content(const std::string& document, const std::string& file);

}  // namespace trellis
