// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include <trellis/figures/charts/pictures.hpp>
#include <trellis/report/costs.hpp>

namespace trellis {

/// Returns a strategy's colour in all figures that compare strategies, and on the page. The baseline has its own.
draw::Colour strategy_colour(const CostData& data, const std::string& baseline, std::size_t strategy);

/// Draws the share of solved runs over their cost, a curve with a band for each strategy: checks and CPU time side by
/// side, rows of a few strategies and the baseline. All panels of a quantity have one axis. None where no run found
/// a path.
/// \param style  the panels and the number of curves in each
std::optional<draw::Figure> success_figure(const CostData& data, const std::string& baseline, std::size_t problem,
                                           const FigureStyle& style = {});
/// Draws the path length over time and checks, for the strategies that improve their path; none without such a
/// strategy.
std::optional<draw::Figure> length_figure(const CostData& data, const std::string& baseline, std::size_t problem,
                                          const FigureStyle& style = {});
/// Draws the strategies' costs relative to the baseline's, paired by seed, a dot with its interval for each problem.
/// None for a single strategy, and without a baseline. Strategies of a parameter sweep are in sweep_figures() instead.
std::optional<draw::RatioFigure> ratio_figure(const CostData& data, const std::string& baseline,
                                              const FigureStyle& style = {});

/// Draws a figure for each option that strategies differ in alone (parameter_sweeps()): over its value the costs
/// relative to the baseline's, paired by seed, without a baseline the costs, and the share of solved runs; a curve for
/// each problem, with intervals.
std::vector<draw::Figure> sweep_figures(const CostData& data, const std::string& baseline,
                                        const FigureStyle& style = {});

/// Returns the name of the file of the sweep with this index: "sweep", "sweep-2", ...
std::string sweep_name(std::size_t i);

/// Draws how nats above uniform of the root's nodes predict costs (cost_correlation()): over nats by mass, by spread
/// and of SE, a panel each, the validity checks relative to the baseline's, a dot for each strategy with guides on each
/// problem; each panel's title has the rank correlation within problems. None where there is no such correlation.
std::optional<draw::Figure> correlation_figure(const CostData& data, const std::string& baseline);

/// Draws FOLDER/baseline, own_planner and parts as .svg, .png and .pdf: a dot for each problem and strategy;
/// FOLDER/correlation; and for each problem FOLDER/PROBLEM/success and length.
/// \throws Error where it cannot write a file.
void write_cost_figures(const CostData& data, const std::string& baseline, const std::string& folder,
                        const FigureStyle& style = {});
/// Draws success and length of each problem, and ratios and sweeps of each problem and, with several problems, of all;
/// then also FOLDER/correlation.
void write_comparison_figures(const CostData& data, const std::string& folder, const FigureStyle& style = {});

}  // namespace trellis
