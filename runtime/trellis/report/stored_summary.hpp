// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include <trellis/report/summary.hpp>
#include <trellis/report/verdict.hpp>

namespace trellis {

/// The summary of a strategy's runs on a problem, from a document of `trellis run --json`.
struct StoredSummary {
  std::string problem;  ///< "": all problems together
  std::string strategy;
  bool ablation = false;
  RunsSummary summary;              ///< without the reasons of missing scores, which documents do not store
  std::vector<Verdict> verdicts;    ///< on its levels; empty for an ablation
  std::vector<GuideVerdict> parts;  ///< on its guides without a level
  std::string unsolved;             ///< why runs found no path, "" where all did
};

/// Returns the summaries of a document, in its order. None of a sweep's document, which is not scored.
/// \param document  JSON of trellis run
/// \param file      for messages
/// \throws Error that names the file, for another kind of document.
std::vector<StoredSummary> read_stored_summaries(const std::string& document, const std::string& file);

}  // namespace trellis
