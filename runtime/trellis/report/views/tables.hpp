// SPDX-License-Identifier: GPL-3.0-or-later
// Tables that several kinds of the printed report share.
#pragma once

#include <cstddef>
#include <string>

#include <trellis/report/experiment_summary.hpp>

namespace trellis {

/// Returns the search of each level: solves, proposals, nodes, checks and time, medians over the runs.
std::string search_table(const RunsSummary& summary, std::size_t width);
/// Returns the sampling of each level: the measure of tree and expansion, its waterfalls, and notes.
std::string efficiency_tables(const RunsSummary& summary, std::size_t width);

/// Returns the strategies and what each of their guides saves, as AnswerTable has it, without its title.
std::string answer_table(const AnswerTable& table, std::size_t width);
/// Returns the table of who needs coordination in a strategy; "" where it divides no team.
/// \param most  rows; of the robots, and of the pairs, those that seeds need most remain
std::string couplings_table(const StrategyFacts& strategy, const StrategySummary& of, std::size_t width,
                            std::size_t most);

}  // namespace trellis
