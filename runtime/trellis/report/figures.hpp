// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <trellis/draw/chart.hpp>
#include <trellis/draw/strips.hpp>
#include <trellis/report/summary.hpp>

namespace trellis {

/// The pictures of one strategy on one problem; those that have anything to show.
struct StrategyFigures {
  std::optional<draw::Figure> waterfall;
  std::optional<draw::Figure> profile;
  std::optional<draw::StripFigure> strip;  ///< the profile as heat strips
  std::optional<draw::Figure> plane;       ///< levels by mass and spread; of a strategy with guides
};
StrategyFigures strategy_figures(const std::string& problem, const std::string& strategy, const RunsSummary& summary);

/// A strategy's name and what its runs on a problem show.
struct NamedSummary {
  std::string strategy;
  const RunsSummary* summary = nullptr;
};
/// The waterfalls of all strategies with guides on one scale, side by side. It ends at perfect guidance and as far
/// below uniform sampling; what is beyond has an arrow. None for fewer than two such strategies.
std::optional<draw::Figure> waterfalls_figure(const std::string& problem, const std::vector<NamedSummary>& strategies);

}  // namespace trellis
