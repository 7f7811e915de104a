// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <trellis/draw/chart.hpp>
#include <trellis/draw/strips.hpp>
#include <trellis/figures/charts/pictures.hpp>
#include <trellis/report/experiment_summary.hpp>

namespace trellis {

/// The pictures of one strategy on one problem; omits empty ones.
struct StrategyFigures {
  std::optional<draw::Figure> waterfall;
  std::optional<draw::Figure> profile;
  std::optional<draw::StripFigure> strip;  ///< the profile as heat strips
  std::optional<draw::Figure> plane;       ///< levels by mass and spread; of a strategy with guides
};
StrategyFigures strategy_figures(const std::string& problem, const std::string& strategy, const RunsSummary& summary);

/// A strategy's name and the summary of its runs on a problem.
struct NamedSummary {
  std::string strategy;
  const RunsSummary* summary = nullptr;
};
/// Draws the waterfalls of all strategies with guides on one scale, side by side. The scale ends at perfect guidance
/// and equally far below uniform sampling; arrows mark values beyond it. None for fewer than two such strategies.
std::optional<draw::Figure> waterfalls_figure(const std::string& problem, const std::vector<NamedSummary>& strategies);

/// Draws the measure: DIR/<problem>/<strategy>/waterfall.svg, profile.svg, strip.svg and plane.svg, and the same as
/// .png and .pdf, for every scored strategy; `jobs` of them concurrently. DIR/<problem>/waterfalls.* has those of all
/// strategies with guides on one scale. Omits empty pictures.
/// \throws Error where it cannot write a file.
void write_figures(const ExperimentSummary& experiment, const std::string& directory, unsigned jobs = 1,
                   const FigureStyle& style = {});

}  // namespace trellis
