// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <trellis/report/experiment_summary.hpp>
#include <trellis/results/files.hpp>

namespace trellis {

/// The content of the printed report.
enum class ReportKind : std::uint8_t {
  overview,    ///< solved runs, costs relative to the baseline, the verdict on each level, and the next step
  levels,      ///< each level's search and verdict, and the obstacles that reject its proposals
  efficiency,  ///< how each level samples, with all values of the measure
  full,        ///< the tables of `levels` and `efficiency`, and a summary of all strategies
};
/// Returns their names, in this order.
const std::vector<std::string>& report_kinds();

/// Returns the printed report, problem by problem; reports more than six problems together. UTF-8, no colour, at most
/// `width` columns where the content allows; an overview fits into 100.
std::string report_text(const ExperimentSummary& experiment, int width = 160, ReportKind kind = ReportKind::full);

/// A part of the printed report: the search of each level.
std::string levels_text(const RunsSummary& run, int width = 160);
/// A part of the printed report: how each level samples, where it was scored.
std::string efficiency_text(const RunsSummary& run, int width = 160);
/// A part of the printed report: the strategies and their comparisons, problem by problem.
std::string summary_text(const ExperimentSummary& experiment, int width = 160);

/// Returns the JSON document that docs/formats.md describes. A missing value is null.
/// \param summary  of the experiment
std::string report_json(const ExperimentFacts& experiment, const ExperimentSummary& summary);

}  // namespace trellis
