// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include <trellis/report/experiment_summary.hpp>

namespace trellis {

/// Returns the summary that a document of `trellis run --json` stores: reports made of it equal those of the run.
/// Without problems for a document of runs alone, as a sweep writes. \param document  JSON of trellis run \param file
/// for messages \throws Error that names the file, for another kind of document.
ExperimentSummary read_summary(const std::string& document, const std::string& file);

}  // namespace trellis
