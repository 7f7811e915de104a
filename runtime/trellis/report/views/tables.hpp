// SPDX-License-Identifier: GPL-3.0-or-later
// Tables that several kinds of the printed report share.
#pragma once

#include <cstddef>
#include <string>

#include <trellis/report/summary.hpp>

namespace trellis {

/// Returns the search of each level: solves, proposals, nodes, checks and time, medians over the runs.
std::string search_table(const RunsSummary& summary, std::size_t width);
/// Returns the sampling of each level: the measure of tree and expansion, its waterfalls, and notes.
std::string efficiency_tables(const RunsSummary& summary, std::size_t width);

}  // namespace trellis
