// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <string>

#include <trellis/draw/chart.hpp>
#include <trellis/report/summary.hpp>

namespace trellis {

/// The pictures of one strategy on one problem; those that have anything to show.
struct StrategyFigures {
  std::optional<draw::Figure> waterfall;
  std::optional<draw::Figure> profile;
};
StrategyFigures strategy_figures(const std::string& problem, const std::string& strategy, const RunsSummary& summary);

}  // namespace trellis
