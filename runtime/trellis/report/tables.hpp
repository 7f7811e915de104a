// SPDX-License-Identifier: GPL-3.0-or-later
// Tables that several kinds of the printed report have.
#pragma once

#include <cstddef>
#include <string>

#include <trellis/report/summary.hpp>

namespace trellis {

/// What each level did: solves, proposals, nodes, checks and time, medians over the runs.
std::string search_table(const RunsSummary& summary, std::size_t width);
/// How each level sampled: the measure of tree and expansion, its waterfalls, and what is to be said about them.
std::string efficiency_tables(const RunsSummary& summary, std::size_t width);
/// "uniform share of proposals 0.05 at each guided level".
std::string shares_text(const StrategySpec& spec);

}  // namespace trellis
